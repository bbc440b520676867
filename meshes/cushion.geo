// Rectangle whose side at y = 0 bulges as a circle does, by an arc through the origin: a body large
// against a contact at its apex. One of two cylinders, or half of it or of a sphere, right of x = 0.
// It is fine and uniform around the apex and has growing cells further out.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  side = {1, Choices{1, -1}, Name "Parameters/1 above y = 0, -1 below"}
  half = {1, Choices{0, 1}, Name "Parameters/only the part right of x = 0"}
  radius = {50, Name "Parameters/of the arc"}
  extent = {25, Name "Parameters/half the width of the body, and its depth; less than the radius"}
  fine = {1.5, Name "Parameters/half the width of the fine part, and its depth"}
  size = {0.125, Name "Parameters/side of a cell in the fine part"}
  cells_outside = {20, Name "Parameters/cells from the fine part to each outer boundary"}
];

cells = Round(fine / size);
first = fine / cells;

// The ratio r of neighbours that fits the cells in, starting from the fine ones:
// first (r^cells_outside - 1) / (r - 1) = extent - fine.
ratio = 4;
For i In {1:500}
  ratio = (1 + (extent - fine) / first * (ratio - 1))^(1 / cells_outside);
EndFor

// Rows of points from the surface into the body; the first two are arcs about the same point.
Point(100) = {0, side * radius, 0};
x[] = {-extent, -fine, 0, fine, extent};
left = half ? 2 : 0;
For row In {0:2}
  For column In {left:4}
    inside = radius - row * fine;
    bulge = (row == 2) ? extent : radius - Sqrt(inside^2 - (x[column] * inside / radius)^2);
    across = (row == 1) ? x[column] * inside / radius : x[column];
    Point(1 + 5 * row + column) = {across, side * bulge, 0};
  EndFor
EndFor

// Along the rows from 1 + 4 row + column, and into the body from 21 + 5 row + column.
For row In {0:2}
  For column In {left:3}
    from = 1 + 5 * row + column;
    If (row < 2)
      Circle(1 + 4 * row + column) = {from, 100, from + 1};
    Else
      Line(1 + 4 * row + column) = {from, from + 1};
    EndIf
    If (column == 0)
      Transfinite Curve{1 + 4 * row} = cells_outside + 1 Using Progression 1 / ratio;
    ElseIf (column == 3)
      Transfinite Curve{4 + 4 * row} = cells_outside + 1 Using Progression ratio;
    Else
      Transfinite Curve{1 + 4 * row + column} = cells + 1;
    EndIf
  EndFor
EndFor
For row In {0:1}
  For column In {left:4}
    from = 1 + 5 * row + column;
    Line(21 + 5 * row + column) = {from, from + 5};
    If (row == 0)
      Transfinite Curve{21 + column} = cells + 1;
    Else
      Transfinite Curve{26 + column} = cells_outside + 1 Using Progression ratio;
    EndIf
  EndFor
EndFor
For row In {0:1}
  For column In {left:3}
    block = 1 + 4 * row + column;
    into = 21 + 5 * row + column;
    Curve Loop(block) = {block, into + 1, -(block + 4), -into};
    Plane Surface(block) = {block};
    Transfinite Surface{block};
  EndFor
EndFor

If (half)
  Physical Curve("contact") = {3};
  Physical Curve("free") = {4};
  Physical Curve("foot") = {11, 12};
  Physical Curve("axis") = {23, 28};
Else
  Physical Curve("contact") = {2, 3};
  Physical Curve("free") = {1, 4};
  Physical Curve("foot") = {9, 10, 11, 12};
EndIf
Physical Surface("body") = {Surface{:}};
