model PidLag "PID with limits, frozen integral and smoothed output, round a first-order lag"
  parameter Real K = 4;
  parameter Real I = 6 "1/s";
  parameter Real D = 0 "s";
  parameter Real Smt = 200 "1/s";
  parameter Real Limit = 1 "of the output, both ways";
  parameter Real gain = 2 "of the lag";
  parameter Real tau = 0.5 "of the lag, s";
  parameter Real r0 = 0 "constant part of the reference";
  parameter Real r1 = 0 "amplitude of its sine";
  parameter Real omega = 0 "rad/s";
  parameter Real t0 = 0 "time at the start of this piece, s";
  parameter Real mode = 0 "1: at the upper limit, -1: at the lower, 0: free";
  Real z(start = 0, fixed = true) "integral of the error, while free";
  Real u(start = 0, fixed = true) "output";
  Real y(start = 0, fixed = true) "measurement";
  Real ref;
  Real raw;
  Real leave "falls through 0 where the mode ends";
equation
  ref = r0 + r1*sin(omega*(t0 + time));
  raw = K*(ref - y) + I*z + D*(r1*omega*cos(omega*(t0 + time)) - (gain*u - y)/tau);
  der(z) = (1 - mode^2)*(ref - y);
  der(u) = Smt*(mode*Limit + (1 - mode^2)*raw - u);
  tau*der(y) = gain*u - y;
  leave = mode*raw - mode^2*Limit + (1 - mode^2)*(Limit - abs(raw));
  when leave < 0 then
    terminate("mode");
  end when;
end PidLag;
