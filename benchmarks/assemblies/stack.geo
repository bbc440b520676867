// Plates that lie on each other, each turned a little. Millimetres.
SetFactory("OpenCASCADE");
DefineConstant[
  plates = {10, Name "Parameters/number of plates"}
  gap = {0, Name "Parameters/between two plates"}
  turn = {3, Name "Parameters/of each against the one below (degrees)"}
];
side = 20; thick = 3; e = 0.001;
For i In {0:plates - 1}
  z = i*(thick + gap);
  Box(i + 1) = {-side/2, -side/2, z, side, side, thick};
  Rotate {{0, 0, 1}, {0, 0, 0}, i*turn*Pi/180} { Volume{i + 1}; }
EndFor
For i In {0:plates - 1}
  z = i*(thick + gap);
  Physical Volume(Sprintf("plate_%g", i)) = {i + 1};
  // Gmsh 4.13 gives signs to surfaces of a boundary.
  own() = Abs(Boundary{ Volume{i + 1}; });
  low() = Surface In BoundingBox{-side, -side, z - e, side, side, z + e};
  high() = Surface In BoundingBox{-side, -side, z + thick - e, side, side, z + thick + e};
  // Faces of the plates below and above, which may lie in the same plane, are not of this one.
  others() = low(); others() -= own(); low() -= others();
  others() = high(); others() -= own(); high() -= others();
  Physical Surface(Sprintf("low_%g", i)) = low();
  Physical Surface(Sprintf("high_%g", i)) = high();
EndFor
