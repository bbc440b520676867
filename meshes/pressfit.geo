// Half a section through a shaft in a hub of the same length, as two parts that touch at `radius`:
// x is the radius, y the axis. What is too large of the shaft a scene says by an interference.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  bore = {10, Name "Parameters/radius of the shaft's bore"}
  radius = {20, Name "Parameters/radius at which they touch"}
  outer = {30, Name "Parameters/outer radius of the hub"}
  length = {20, Name "Parameters/length of both"}
  size = {2, Name "Parameters/side of a cell, about"}
];

from[] = {bore, radius};
to[] = {radius, outer};
For part In {0:1}
  first = 4 * part;
  across = Ceil((to[part] - from[part]) / size);
  along = Ceil(length / size) + 2 * part; // the meshes need not match
  Point(first + 1) = {from[part], 0, 0};
  Point(first + 2) = {to[part], 0, 0};
  Point(first + 3) = {to[part], length, 0};
  Point(first + 4) = {from[part], length, 0};
  For i In {1:4}
    Line(first + i) = {first + i, first + 1 + i % 4};
  EndFor
  Curve Loop(1 + part) = {first + 1, first + 2, first + 3, first + 4};
  Plane Surface(1 + part) = {1 + part};
  Transfinite Curve{first + 1, first + 3} = across + 1;
  Transfinite Curve{first + 2, first + 4} = along + 1;
  Transfinite Surface{1 + part};
EndFor

Physical Surface("shaft") = {1};
Physical Surface("hub") = {2};
Physical Curve("shaft_bottom") = {1};
Physical Curve("shaft_outside") = {2};
Physical Curve("shaft_top") = {3};
Physical Curve("shaft_bore") = {4};
Physical Curve("hub_bottom") = {5};
Physical Curve("hub_outside") = {6};
Physical Curve("hub_top") = {7};
Physical Curve("hub_bore") = {8};
