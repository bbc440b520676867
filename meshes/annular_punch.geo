// Rectangle [0, extent] x [-extent, 0] that stands for a half-space below y = 0, x being the
// radius, under a ring that is pressed on it. The pressure is singular at both edges of the
// ring: the cells grow from there, in both directions, and from the surface downwards.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  inner_radius = {0.5, Name "Parameters/inner radius of the ring"}
  outer_radius = {1, Name "Parameters/outer radius of the ring"}
  extent = {200, Name "Parameters/side of the rectangle"}
  size = {0.005, Name "Parameters/largest cell at an edge"}
  growth = {1.3, Name "Parameters/largest ratio of neighbouring cells"}
];

// Columns of cells: inside the ring, the ring's two halves, and outside; last, the rows.
middle = (inner_radius + outer_radius) / 2;
x[] = {0, inner_radius, middle, outer_radius, extent};
length[] = {inner_radius, middle - inner_radius, outer_radius - middle,
            extent - outer_radius, extent};

// As many cells in each as a growth from `size` takes, and the ratio r of neighbours for
// which they fit in: size (r^cells - 1) / (r - 1) = length. It becomes 1 if one cell does.
For i In {0:4}
  cells[i] = Ceil(Log(1 + length[i] / size * (growth - 1)) / Log(growth));
  ratio[i] = 4;
  For j In {1:500}
    ratio[i] = (1 + length[i] / size * (ratio[i] - 1))^(1 / cells[i]);
  EndFor
EndFor

// Lines 1 to 4 along the surface, 11 to 14 along the bottom, and 21 to 25 downwards.
For i In {0:4}
  Point(1 + i) = {x[i], 0, 0};
  Point(11 + i) = {x[i], -extent, 0};
  Line(21 + i) = {1 + i, 11 + i};
  Transfinite Curve{21 + i} = cells[4] + 1 Using Progression ratio[4];
EndFor
For i In {0:3}
  Line(1 + i) = {1 + i, 2 + i};
  Line(11 + i) = {11 + i, 12 + i};
  Curve Loop(1 + i) = {21 + i, 11 + i, -(22 + i), -(1 + i)};
  Plane Surface(1 + i) = {1 + i};
EndFor

// The columns inside and in the outer half of the ring grow against the line's direction.
Transfinite Curve{-1, -11} = cells[0] + 1 Using Progression ratio[0];
Transfinite Curve{2, 12} = cells[1] + 1 Using Progression ratio[1];
Transfinite Curve{-3, -13} = cells[2] + 1 Using Progression ratio[2];
Transfinite Curve{4, 14} = cells[3] + 1 Using Progression ratio[3];
Transfinite Surface{1, 2, 3, 4};

Physical Curve("axis") = {21};
Physical Curve("inside") = {1};
Physical Curve("contact") = {2, 3};
Physical Curve("surface") = {4};
Physical Curve("outer") = {11, 12, 13, 14, 25};
Physical Surface("body") = {1, 2, 3, 4};
