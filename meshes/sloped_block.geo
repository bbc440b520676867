// Block with upright sides, whose bottom and top may slope: y = bottom + bottom_slope x and
// y = top + top_slope x, from x = left on.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  left = {0, Name "Parameters/x of the left side"}
  length = {2, Name "Parameters/length along x"}
  bottom = {0, Name "Parameters/height of the bottom at x = 0"}
  top = {1, Name "Parameters/height of the top at x = 0"}
  bottom_slope = {0, Name "Parameters/slope of the bottom"}
  top_slope = {0, Name "Parameters/slope of the top"}
  cells_along = {20, Name "Parameters/cells along"}
  cells_across = {10, Name "Parameters/cells across"}
];

right = left + length;
Point(1) = {left, bottom + bottom_slope * left, 0};
Point(2) = {right, bottom + bottom_slope * right, 0};
Point(3) = {right, top + top_slope * right, 0};
Point(4) = {left, top + top_slope * left, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};

Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Transfinite Curve{1, 3} = cells_along + 1;
Transfinite Curve{2, 4} = cells_across + 1;
Transfinite Surface{1};

Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("body") = {1};
