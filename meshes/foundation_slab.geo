// Rectangle [0, length] x [0, height], such as half of a slab on a foundation: symmetric about
// its left end, with a patch on the top, next to it, to be loaded.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  length = {10, Name "Parameters/length"}
  height = {1, Name "Parameters/height"}
  patch = {1, Name "Parameters/length of the patch"}
  cells_along = {40, Name "Parameters/cells along"}
  cells_across = {4, Name "Parameters/cells across"}
];

// Cells along the patch and along the rest, equally long if the patch is a number of cells.
cells_patch = Round(patch / length * cells_along);
If (cells_patch < 1)
  cells_patch = 1;
EndIf

Point(1) = {0, 0, 0};
Point(2) = {patch, 0, 0};
Point(3) = {length, 0, 0};
Point(4) = {length, height, 0};
Point(5) = {patch, height, 0};
Point(6) = {0, height, 0};

Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Line(7) = {2, 5};

Curve Loop(1) = {1, 7, 5, 6};
Curve Loop(2) = {2, 3, 4, -7};
Plane Surface(1) = {1};
Plane Surface(2) = {2};

Transfinite Curve{1, 5} = cells_patch + 1;
Transfinite Curve{2, 4} = cells_along - cells_patch + 1;
Transfinite Curve{3, 6, 7} = cells_across + 1;
Transfinite Surface{1, 2};

Physical Curve("bottom") = {1, 2};
Physical Curve("right") = {3};
Physical Curve("top") = {4};
Physical Curve("patch") = {5};
Physical Curve("left") = {6};
Physical Surface("slab") = {1, 2};
