model Body "Vehicle body that rolls freely; rolling resistance is set-valued"
  parameter Real M = 1500 "kg";
  parameter Real cd = 0.5*1.2*0.29*2.2 "drag, N.s2/m2";
  parameter Real Cr = 0.009;
  parameter Real sina = 0 "sine of the slope";
  parameter Real g = 9.80665;
  parameter Real mode = 1 "1: forward, -1: backward, 0: stands";
  Real v(start = 0, fixed = true) "m/s";
  Real x(start = 0, fixed = true) "m";
  Real leave "falls through 0 where the mode ends";
equation
  M*der(v) = (-mode^2*(cd*v*abs(v) + M*g*sina)) - mode*Cr*M*g*sqrt(1 - sina^2);
  der(x) = v;
  leave = mode*v + (1 - mode^2);
  when leave < 0 then
    terminate("mode");
  end when;
end Body;
