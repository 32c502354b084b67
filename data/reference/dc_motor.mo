model DcMotor "DC motor at a given voltage; turns forward throughout (w > 0)"
  parameter Real R = 30.9 "Ohm";
  parameter Real L = 0.438 "H";
  parameter Real K = 1.323 "V.s/rad and N.m/A";
  parameter Real J = 0.0036 "kg.m2";
  parameter Real b = 0.0005 "N.m.s/rad";
  parameter Real Tc = 0 "static torque, N.m";
  parameter Real V = 0 "V";
  Real i(start = 0, fixed = true) "A";
  Real w(start = 0, fixed = true) "rad/s";
equation
  V = R*i + L*der(i) + K*w;
  J*der(w) = K*i - b*w - Tc;
end DcMotor;
