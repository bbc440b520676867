// Right half of a body with a round recess, in which a pin stands: a sector of a ring whose inner
// arc is lowest at (0, -drop). It is fine and uniform around there and has growing cells further out.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  radius = {33, Name "Parameters/of the recess"}
  drop = {0, Name "Parameters/how far the lowest point lies below the origin"}
  depth = {25, Name "Parameters/of the body below the recess"}
  sector = {30, Name "Parameters/angle from the axis to the end of the body, in degrees"}
  fine = {1.5, Name "Parameters/length of the fine part of the arc, and its depth"}
  size = {0.125, Name "Parameters/side of a cell in the fine part"}
  cells_outside = {16, Name "Parameters/cells from the fine part to each outer boundary"}
];

cells = Round(fine / size);
first = fine / cells;
angle[] = {0, fine / radius, sector * Pi / 180};
r[] = {radius, radius + fine, radius + depth};

// The ratios of neighbours that fit the cells in along the arc and in depth, starting from the
// fine ones: first (ratio^cells_outside - 1) / (ratio - 1) = length.
length[] = {radius * angle[2] - fine, depth - fine};
For i In {0:1}
  ratio[i] = 4;
  For j In {1:500}
    ratio[i] = (1 + length[i] / first * (ratio[i] - 1))^(1 / cells_outside);
  EndFor
EndFor

Point(20) = {0, radius - drop, 0};
For i In {0:2}
  For j In {0:2}
    Point(1 + 3 * i + j) = {r[i] * Sin(angle[j]), radius - drop - r[i] * Cos(angle[j]), 0};
  EndFor
EndFor

// Arcs from 1 + 2 i + j, and lines into the body from 11 + 3 i + j.
For i In {0:2}
  For j In {0:1}
    Circle(1 + 2 * i + j) = {1 + 3 * i + j, 20, 2 + 3 * i + j};
  EndFor
EndFor
For i In {0:1}
  For j In {0:2}
    Line(11 + 3 * i + j) = {1 + 3 * i + j, 4 + 3 * i + j};
  EndFor
EndFor
Transfinite Curve{1, 3, 5, 11, 12, 13} = cells + 1;
Transfinite Curve{2, 4, 6} = cells_outside + 1 Using Progression ratio[0];
Transfinite Curve{14, 15, 16} = cells_outside + 1 Using Progression ratio[1];
For i In {0:1}
  For j In {0:1}
    block = 1 + 2 * i + j;
    Curve Loop(block) = {block, 12 + 3 * i + j, -(block + 2), -(11 + 3 * i + j)};
    Plane Surface(block) = {block};
    Transfinite Surface{block};
  EndFor
EndFor

Physical Curve("axis") = {11, 14};
Physical Curve("contact") = {1, 2};
Physical Curve("foot") = {5, 6};
Physical Curve("end") = {13, 16};
Physical Surface("body") = {1, 2, 3, 4};
