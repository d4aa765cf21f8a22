// A starfish in the plane, 0.86 m across; `gmsh starfish.geo -2 -format msh41 -o starfish.msh` makes the mesh.
// Its outline in polar coordinates, by a closed spline through 100 points:
//   r(t) = 0.27 + 0.15 cos(5 t) + 0.03 cos(10 t)   [m], one arm up
n = 100;
For i In {0 : n - 1}
  t = 2 * Pi * i / n;
  r = 0.27 + 0.15 * Cos(5 * t) + 0.03 * Cos(10 * t);
  Point(i + 1) = {-r * Sin(t), r * Cos(t), 0};
EndFor
Spline(1) = {1 : n, 1};
Curve Loop(1) = {1};
Plane Surface(1) = {1};
Physical Surface("body") = {1};
Mesh.MeshSizeMin = 0.026;
Mesh.MeshSizeMax = 0.026;
Mesh.Optimize = 1;
