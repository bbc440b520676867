// Unit cube above or below z = 0, of hexahedra or tetrahedra: one of two bricks on each other.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  base = {0, Name "Parameters/z of its lower side"}
  cells_along = {2, Name "Parameters/cells along x and y"}
  cells_across = {1, Name "Parameters/cells along z"}
  hexahedra = {1, Choices{0, 1}, Name "Parameters/hexahedra, else tetrahedra"}
];

For i In {0:3}
  Point(i + 1) = {(i == 1 || i == 2), (i >= 2), base, 0};
EndFor
For i In {1:4}
  Line(i) = {i, 1 + i % 4};
EndFor
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = cells_along + 1;
Transfinite Surface{1};
If (hexahedra)
  Recombine Surface{1};
  sides[] = Extrude {0, 0, 1} { Surface{1}; Layers{cells_across}; Recombine; };
Else
  sides[] = Extrude {0, 0, 1} { Surface{1}; Layers{cells_across}; };
EndIf

Physical Surface("bottom") = {1};
Physical Surface("top") = {sides[0]};
Physical Surface("front") = {sides[2]};
Physical Surface("left") = {sides[5]};
Physical Volume("brick") = {sides[1]};
