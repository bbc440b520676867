// Half of a disc with its straight side on the axis x = 0: a ball for axisymmetric models, that
// touches y = 0 at the origin. Cells are as large as `size` around the origin, up to `fine` from
// it, and grow from there to `coarse`.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  radius = {10, Name "Parameters/radius"}
  fine = {1.2, Name "Parameters/how far from the origin cells are fine"}
  size = {0.12, Name "Parameters/side of a cell there"}
  coarse = {1.0, Name "Parameters/side of a cell far from there"}
];

Point(1) = {0, 0, 0};
Point(2) = {radius * Sin(fine / radius), radius * (1 - Cos(fine / radius)), 0};
Point(3) = {radius, radius, 0};
Point(4) = {0, 2 * radius, 0};
Point(5) = {0, radius, 0};

Circle(1) = {1, 5, 2};
Circle(2) = {2, 5, 3};
Circle(3) = {3, 5, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};

Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};

Field[1] = Distance;
Field[1].PointsList = {1};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = size;
Field[2].SizeMax = coarse;
Field[2].DistMin = fine;
Field[2].DistMax = radius;
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;

Physical Curve("contact") = {1};
Physical Curve("free") = {2, 3};
Physical Curve("axis") = {4, 5};
Physical Surface("ball") = {1};
