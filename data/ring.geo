// A ring in the plane, 0.1 m across outside, 8 mm thick; `gmsh ring.geo -2 -order 2 -format msh41 -o ring.msh` makes the mesh:
// 96 x 3 squares in polar coordinates, each in two curved triangles.
outside = 0.05;
inside = 0.042;
around = 24;  // of a quarter
across = 3;
Point(1) = {0, 0, 0};
For q In {0 : 3}
  c = Cos(q * Pi / 2);
  s = Sin(q * Pi / 2);
  Point(2 + q) = {inside * c, inside * s, 0};
  Point(6 + q) = {outside * c, outside * s, 0};
EndFor
For q In {0 : 3}
  next = (q + 1) % 4;
  Circle(1 + q) = {2 + q, 1, 2 + next};
  Circle(5 + q) = {6 + q, 1, 6 + next};
  Line(9 + q) = {2 + q, 6 + q};
EndFor
For q In {0 : 3}
  next = (q + 1) % 4;
  Curve Loop(1 + q) = {9 + q, 5 + q, -(9 + next), -(1 + q)};
  Plane Surface(1 + q) = {1 + q};
EndFor
Transfinite Curve{1 : 8} = around + 1;
Transfinite Curve{9 : 12} = across + 1;
Transfinite Surface{1 : 4} Alternate;
Physical Surface("body") = {1 : 4};
