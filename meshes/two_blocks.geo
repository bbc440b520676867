// Two unit squares on each other with meshes that do not match, as parts of one mesh: what two
// meshes of block.geo are otherwise.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  cells_below = {4, Name "Parameters/cells along a side of the lower block"}
  cells_above = {6, Name "Parameters/cells along a side of the upper block"}
];

cells[] = {cells_below, cells_above};
For block In {0:1}
  first = 4 * block;
  Point(first + 1) = {0, block - 1, 0};
  Point(first + 2) = {1, block - 1, 0};
  Point(first + 3) = {1, block, 0};
  Point(first + 4) = {0, block, 0};
  For i In {1:4}
    Line(first + i) = {first + i, first + 1 + i % 4};
  EndFor
  Curve Loop(1 + block) = {first + 1, first + 2, first + 3, first + 4};
  Plane Surface(1 + block) = {1 + block};
  Transfinite Curve{first + 1, first + 2, first + 3, first + 4} = cells[block] + 1;
  Transfinite Surface{1 + block};
EndFor

Physical Curve("lower.bottom") = {1};
Physical Curve("lower.top") = {3};
Physical Curve("lower.left") = {4};
Physical Curve("upper.bottom") = {5};
Physical Curve("upper.top") = {7};
Physical Curve("upper.left") = {8};
Physical Surface("lower") = {1};
Physical Surface("upper") = {2};
