// Rectangle [-extent, extent] x [-extent, 0], symmetric about x = 0, that stands for a half-plane
// below y = 0 where a load on it is not symmetric. The middle of its top is a fine rectangle of
// uniform cells, twice as wide as deep; outside of it the cells grow by a constant ratio.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  fine = {1.5, Name "Parameters/half the width of the fine rectangle, and its depth"}
  size = {0.05, Name "Parameters/side of a cell in the fine rectangle"}
  extent = {40, Name "Parameters/half the width of the rectangle, and its depth"}
  cells_outside = {16, Name "Parameters/cells from the fine rectangle to each outer boundary"}
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

// Three rows of four points, from the surface downwards.
x[] = {-extent, -fine, fine, extent};
y[] = {0, -fine, -extent};
For row In {0:2}
  For column In {0:3}
    Point(1 + 4 * row + column) = {x[column], y[row], 0};
  EndFor
EndFor

// Along x, three to a row, numbered 1 to 9; downwards, four to a row, numbered 11 to 18.
For row In {0:2}
  For column In {0:2}
    Line(1 + 3 * row + column) = {1 + 4 * row + column, 2 + 4 * row + column};
  EndFor
EndFor
For row In {0:1}
  For column In {0:3}
    Line(11 + 4 * row + column) = {1 + 4 * row + column, 5 + 4 * row + column};
  EndFor
EndFor

For row In {0:1}
  For column In {0:2}
    block = 1 + 3 * row + column;
    left = 11 + 4 * row + column;
    Curve Loop(block) = {left, block + 3, -(left + 1), -block};
    Plane Surface(block) = {block};
  EndFor
EndFor

Transfinite Curve{2, 5, 8} = 2 * cells + 1;
Transfinite Curve{11, 12, 13, 14} = cells + 1;
Transfinite Curve{-1, -4, -7} = cells_outside + 1 Using Progression ratio;
Transfinite Curve{3, 6, 9, 15, 16, 17, 18} = cells_outside + 1 Using Progression ratio;
Transfinite Surface{1, 2, 3, 4, 5, 6};

Physical Curve("contact") = {2};
Physical Curve("surface") = {1, 3};
Physical Curve("bottom") = {7, 8, 9};
Physical Curve("left") = {11, 15};
Physical Curve("right") = {14, 18};
Physical Surface("body") = {1, 2, 3, 4, 5, 6};
