// Quarter of a disc that touches y = 0 at the origin: the right lower one, with its centre at
// (0, radius). The cells are fine and uniform up to `fine` from the origin, along the arc and
// in depth, and grow from there.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  radius = {8, Name "Parameters/radius"}
  contact_angle = {20, Name "Parameters/angle of the contact's arc, in degrees"}
  fine = {1.5, Name "Parameters/length of the fine part of the arc, and its depth"}
  size = {0.05, Name "Parameters/side of a cell in the fine part"}
  growth = {1.2, Name "Parameters/ratio of neighbouring cells outside of it, about"}
];

// The arc: its fine part, which ends where the contact does or before, and two parts with
// growing cells, the rest of the contact, if any, and the free one.
contact = contact_angle * Pi / 180 * radius;
arc = (contact - fine > size / 2) ? fine : contact;
cells_along = Round(arc / size);
cells_deep = Round(fine / size);
angle = arc / radius;
end = contact / radius;
depth = radius - fine;

// The fine block has the corners 1, 2, 6 and 5. The two others meet it, and each other along
// the line from 6 to 7, with the angles 90, 135 and 135 degrees or so.
Point(1) = {0, 0, 0};
Point(2) = {radius * Sin(angle), radius * (1 - Cos(angle)), 0};
Point(3) = {radius * Sin(end), radius * (1 - Cos(end)), 0};
Point(4) = {radius, radius, 0};
Point(5) = {0, fine, 0};
Point(6) = {depth * Sin(angle), radius - depth * Cos(angle), 0};
Point(7) = {0.65 * radius, radius, 0};
Point(8) = {0, radius, 0};

// Growing cells: number and ratio r of neighbours in the two parts of the arc, then on the two
// lines opposite to both, with first (r^cells - 1) / (r - 1) = length.
to[] = Point{7};
from[] = Point{6};
length[] = {contact - arc, Pi / 2 * radius - contact, depth,
            Hypot(to[0] - from[0], to[1] - from[1])};
first[] = {arc / cells_along, arc / cells_along, fine / cells_deep, fine / cells_deep};
For i In {0:3}
  cells[i] = Ceil(Log(1 + length[i] / first[i] * (growth - 1)) / Log(growth));
  If (i >= 2)
    cells[i] = cells[0] + cells[1];
  EndIf
  ratio[i] = 4;
  For j In {1:(cells[i] > 0) ? 500 : 0}
    ratio[i] = (1 + length[i] / first[i] * (ratio[i] - 1))^(1 / cells[i]);
  EndFor
  first[1] *= (i == 0) ? ratio[0]^cells[0] : 1; // the free part goes on from the contact's
EndFor

Circle(1) = {1, 8, 2};
rest[] = {};
If (cells[0] > 0)
  Circle(2) = {2, 8, 3};
  Transfinite Curve{2} = cells[0] + 1 Using Progression ratio[0];
  rest[] = {2};
EndIf
Circle(3) = {(cells[0] > 0) ? 3 : 2, 8, 4};
Line(4) = {4, 7};
Line(5) = {7, 8};
Line(6) = {5, 8};
Line(7) = {1, 5};
Circle(8) = {5, 8, 6};
Line(9) = {2, 6};
Line(10) = {6, 7};

Transfinite Curve{1, 5, 8} = cells_along + 1;
Transfinite Curve{4, 7, 9} = cells_deep + 1;
Transfinite Curve{3} = cells[1] + 1 Using Progression ratio[1];
Transfinite Curve{6} = cells[2] + 1 Using Progression ratio[2];
Transfinite Curve{10} = cells[3] + 1 Using Progression ratio[3];

Curve Loop(1) = {1, 9, -8, -7};
Curve Loop(2) = {8, 10, 5, -6};
Curve Loop(3) = {rest[], 3, 4, -10, -9};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Plane Surface(3) = {3};
Transfinite Surface{1, 2};
Transfinite Surface{3} = {2, 4, 7, 6};

Physical Curve("axis") = {7, 6};
Physical Curve("contact") = {1, rest[]};
Physical Curve("free") = {3};
Physical Curve("top") = {4, 5};
Physical Surface("body") = {1, 2, 3};
