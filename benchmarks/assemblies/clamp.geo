// A split clamp on a shaft, closed by a bolt whose shank stands free in its hole. Millimetres.
SetFactory("OpenCASCADE");
DefineConstant[
  clearance = {0, Name "Parameters/between bore and shaft, of the radius"}
  width = {16, Name "Parameters/of the clamp along the shaft"}
  hole = {3.3, Name "Parameters/radius of the bolt's holes"}
];
r = 10; slot = 2; reach = 34; ear = 13; at = 26.5; e = 0.01;

Cylinder(1) = {0, 0, -width/2, 0, 0, width, 18};
Box(2) = {0, -ear, -width/2, reach, 2*ear, width};
Box(3) = {-34, -6, -width/2, 20, 12, width};
BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Cylinder(5) = {0, 0, -width, 0, 0, 2*width, r};
Box(6) = {0, -slot/2, -width, 2*reach, slot, 2*width};
Cylinder(7) = {at, -2*ear, 0, 0, 4*ear, 0, hole};
BooleanDifference(8) = { Volume{4}; Delete; }{ Volume{5, 6, 7}; Delete; };
Cylinder(9) = {0, 0, -14, 0, 0, 44, r - clearance};

// The bolt: head, the part that is preloaded, and nut.
Cylinder(10) = {at, ear, 0, 0, 6, 0, 5};
Cylinder(11) = {at, 5, 0, 0, ear, 0, 3};
BooleanUnion(12) = { Volume{10}; Delete; }{ Volume{11}; Delete; };
Cylinder(13) = {at, -ear, 0, 0, -5, 0, 5};
Cylinder(14) = {at, -5, 0, 0, -ear, 0, 3};
BooleanUnion(15) = { Volume{13}; Delete; }{ Volume{14}; Delete; };
Cylinder(16) = {at, -5, 0, 0, 10, 0, 3};
parts() = BooleanFragments{ Volume{12, 15, 16}; Delete; }{};
middle() = Volume In BoundingBox{at - 4, -6, -4, at + 4, 6, 4};

Physical Volume("clamp") = {8};
Physical Volume("shaft") = {9};
others() = parts(); others() -= middle();
Physical Volume("bolt_ends") = others();
Physical Volume("shank") = middle();
bore() = Surface In BoundingBox{-r - e, -r - e, -width/2 - e, r + e, r + e, width/2 + e};
end() = Surface In BoundingBox{-r - e, -r - e, 30 - e, r + e, r + e, 30 + e};
start() = Surface In BoundingBox{-r - e, -r - e, -14 - e, r + e, r + e, -14 + e};
journal() = Surface In BoundingBox{-r - e, -r - e, -14 - e, r + e, r + e, 30 + e};
journal() -= bore(); journal() -= end(); journal() -= start();
arm() = Surface In BoundingBox{-34 - e, -7, -width, -34 + e, 7, width};
Physical Surface("bore") = bore();
Physical Surface("journal") = journal();
Physical Surface("shaft_end") = end();
Physical Surface("arm_end") = arm();
For side In {-1:1:2}
  flat() = Surface In BoundingBox{-1, side*ear - e, -width, reach + 1, side*ear + e, width};
  seat() = Surface In BoundingBox{at - 5 - e, side*ear - e, -5 - e, at + 5 + e, side*ear + e, 5 + e};
  flat() -= seat();
  Physical Surface(Sprintf("ear_%g", (side + 1)/2)) = flat();
  Physical Surface(Sprintf("seat_%g", (side + 1)/2)) = seat();
EndFor
inner() = Surface In BoundingBox{at - hole - e, -ear - e, -hole - e, at + hole + e, ear + e, hole + e};
rod() = Surface In BoundingBox{at - 3 - e, -ear - e, -3 - e, at + 3 + e, ear + e, 3 + e};
inner() -= rod();
Physical Surface("hole") = inner();
cut() = Surface In BoundingBox{at - 3 - e, -5 - e, -3 - e, at + 3 + e, -5 + e, 3 + e};
cut() += Surface In BoundingBox{at - 3 - e, 5 - e, -3 - e, at + 3 + e, 5 + e, 3 + e};
rod() -= cut();
Physical Surface("rod") = rod();
