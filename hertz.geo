// Rectangle [0, extent] x [-extent, 0] that stands for a half-space below y = 0: axisymmetric
// with x as radius, or half of a plane model. Its corner at the origin is a fine square of
// uniform cells; outside of it the cells grow by a constant ratio.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  fine = {5, Name "Parameters/side of the fine square"}
  size = {0.125, Name "Parameters/side of a cell in the fine square"}
  extent = {60, Name "Parameters/side of the rectangle"}
  cells_outside = {24, Name "Parameters/cells from the fine square to the outer boundary"}
];

cells = Round(fine / size);
first = fine / cells;

// The ratio r of neighbours that fits the cells in, starting from the fine ones:
// first (r^cells_outside - 1) / (r - 1) = extent - fine. It becomes 1 if there are too many
// cells for that: they are then equal, and finer.
ratio = 4;
For i In {1:500}
  ratio = (1 + (extent - fine) / first * (ratio - 1))^(1 / cells_outside);
EndFor

// Three rows of points, from the surface downwards.
Point(1) = {0, 0, 0};
Point(2) = {fine, 0, 0};
Point(3) = {extent, 0, 0};
Point(4) = {0, -fine, 0};
Point(5) = {fine, -fine, 0};
Point(6) = {extent, -fine, 0};
Point(7) = {0, -extent, 0};
Point(8) = {fine, -extent, 0};
Point(9) = {extent, -extent, 0};

// Outwards along x, row by row, and downwards, column by column.
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 5};
Line(4) = {5, 6};
Line(5) = {7, 8};
Line(6) = {8, 9};
Line(7) = {1, 4};
Line(8) = {4, 7};
Line(9) = {2, 5};
Line(10) = {5, 8};
Line(11) = {3, 6};
Line(12) = {6, 9};

// The fine square, and the blocks at its right, below it and at its corner.
Curve Loop(1) = {7, 3, -9, -1};
Curve Loop(2) = {9, 4, -11, -2};
Curve Loop(3) = {8, 5, -10, -3};
Curve Loop(4) = {10, 6, -12, -4};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Plane Surface(4) = {4};

Transfinite Curve{1, 3, 5, 7, 9, 11} = cells + 1;
Transfinite Curve{2, 4, 6, 8, 10, 12} = cells_outside + 1 Using Progression ratio;
Transfinite Surface{1, 2, 3, 4};

Physical Curve("axis") = {7, 8};
Physical Curve("contact") = {1};
Physical Curve("surface") = {2};
Physical Curve("outer") = {5, 6, 11, 12};
Physical Surface("body") = {1, 2, 3, 4};
