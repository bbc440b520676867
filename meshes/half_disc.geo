// Half of a disc that touches y = 0 at the origin, with its centre at (0, radius) and a straight
// face through it; turned about the origin by half a turn with side = -1. Along the arc the
// cells are uniform up to `fine` from the origin on either side, and so they are in depth; from
// there they grow.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  radius = {8, Name "Parameters/radius"}
  side = {1, Choices{1, -1}, Name "Parameters/1: above y = 0, -1: below"}
  fine = {1.5, Name "Parameters/half the length of the fine part of the arc, and its depth"}
  size = {0.1, Name "Parameters/side of a cell in the fine part"}
  growth = {1.25, Name "Parameters/ratio of neighbouring cells outside of it, about"}
];

cells_fine = Round(fine / size);
angle = fine / radius;
depth = radius - fine;

// Four columns of points, from the left to the right: on the arc, and inside of it. The fine
// block lies between the points 2, 3, 13 and 12, and the block behind it reaches the face.
x[] = {-radius, -radius * Sin(angle), radius * Sin(angle), radius};
y[] = {radius, radius * (1 - Cos(angle)), radius * (1 - Cos(angle)), radius};
inner_x[] = {-0.65 * radius, -depth * Sin(angle), depth * Sin(angle), 0.65 * radius};
inner_y[] = {radius, radius - depth * Cos(angle), radius - depth * Cos(angle), radius};
Point(20) = {0, side * radius, 0};
For i In {0:3}
  Point(1 + i) = {side * x[i], side * y[i], 0};
  Point(11 + i) = {side * inner_x[i], side * inner_y[i], 0};
EndFor

// Growing cells: how many along the free arcs, and the ratios r of neighbours there and from the
// fine block to the face, with size (r^cells - 1) / (r - 1) = length.
length[] = {Pi / 2 * radius - fine, Hypot(inner_x[3] - inner_x[2], inner_y[3] - inner_y[2])};
cells = Ceil(Log(1 + length[0] / size * (growth - 1)) / Log(growth));
For i In {0:1}
  ratio[i] = 4;
  For j In {1:500}
    ratio[i] = (1 + length[i] / size * (ratio[i] - 1))^(1 / cells);
  EndFor
EndFor

Circle(1) = {2, 20, 1};
Circle(2) = {2, 20, 3};
Circle(3) = {3, 20, 4};
Line(4) = {4, 14};
Line(5) = {14, 11};
Line(6) = {11, 1};
Line(7) = {2, 12};
Line(8) = {3, 13};
Circle(9) = {12, 20, 13};
Line(10) = {12, 11};
Line(11) = {13, 14};
Transfinite Curve{2, 5, 9} = 2 * cells_fine + 1;
Transfinite Curve{4, 6, 7, 8} = cells_fine + 1;
Transfinite Curve{1, 3} = cells + 1 Using Progression ratio[0];
Transfinite Curve{10, 11} = cells + 1 Using Progression ratio[1];

Curve Loop(1) = {2, 8, -9, -7};
Curve Loop(2) = {9, 11, 5, -10};
Curve Loop(3) = {3, 4, -11, -8};
Curve Loop(4) = {7, 10, 6, -1};
For i In {1:4}
  Plane Surface(i) = {i};
EndFor
Transfinite Surface{1, 2, 3, 4};

Physical Curve("contact") = {2};
Physical Curve("free") = {1, 3};
Physical Curve("face") = {4, 5, 6};
Physical Surface("body") = {1, 2, 3, 4};
