model Battery "RC battery under a given current, discharge positive"
  parameter Real Q = 60 "A.h";
  parameter Real Ve = 343.22 "V at SOC 0";
  parameter Real Vf = 399.8 "V at SOC 1";
  parameter Real Rs = 0.1051 "Ohm";
  parameter Real Rp = 1.7834e-4 "Ohm";
  parameter Real C = 9532.9 "F";
  parameter Real I = 0 "A";
  Real soc(start = 0.869, fixed = true);
  Real vrc(start = 0, fixed = true) "V";
  Real V "terminal voltage, V";
equation
  der(soc) = -I/(3600*Q);
  der(vrc) = I/C - vrc/(Rp*C);
  V = Ve + (Vf - Ve)*soc - Rs*I - vrc;
end Battery;
