// A cantilever with a hook in the plane, in millimetres; `gmsh snap_hook.geo -2 -format msh41 -o snap_hook.msh` makes the mesh.
Point(1) = {0, 0, 0, 1.5};
Point(2) = {36, 0, 0, 0.8};
Point(3) = {36, -3, 0, 0.5};   // it holds by this face ...
Point(4) = {37, -3, 0, 0.5};
Point(5) = {46, 1.5, 0, 0.8};  // ... and rides up on this slope
Point(6) = {46, 3, 0, 0.8};
Point(7) = {0, 3, 0, 1.5};
For i In {1 : 7}
  Line(i) = {i, (i % 7) + 1};
EndFor
Curve Loop(1) = {1 : 7};
Plane Surface(1) = {1};
Physical Surface("body") = {1};
Mesh.Optimize = 1;
