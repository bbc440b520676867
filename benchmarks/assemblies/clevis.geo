// A lug between the cheeks of a fork, and the pin through their holes. Millimetres.
SetFactory("OpenCASCADE");
DefineConstant[
  clearance = {0, Name "Parameters/between holes and pin, of the radius"}
  play = {0.2, Name "Parameters/between lug and each cheek"}
];
r = 5; lug = 8; cheek = 6; high = 10; e = 0.001;
outer = lug/2 + play + cheek; inner = lug/2 + play;

Box(1) = {-30, -high, -outer, 42, 2*high, 2*outer};
Box(2) = {-18, -high - 1, -inner, 60, 2*high + 2, 2*inner};
Cylinder(3) = {0, 0, -2*outer, 0, 0, 4*outer, r + clearance};
BooleanDifference(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Box(5) = {-12, -high, -lug/2, 42, 2*high, lug};
Cylinder(6) = {0, 0, -2*outer, 0, 0, 4*outer, r + clearance};
BooleanDifference(7) = { Volume{5}; Delete; }{ Volume{6}; Delete; };
Cylinder(8) = {0, 0, -outer, 0, 0, 2*outer, r};

Physical Volume("fork") = {4};
Physical Volume("lug") = {7};
Physical Volume("pin") = {8};
pin() = Boundary{ Volume{8}; };
ends() = Surface In BoundingBox{-r - e, -r - e, -outer - e, r + e, r + e, -outer + e};
ends() += Surface In BoundingBox{-r - e, -r - e, outer - e, r + e, r + e, outer + e};
pin() -= ends();
Physical Surface("pin_side") = pin();
h = r + clearance;
bore() = Surface In BoundingBox{-h - e, -h - e, -lug/2 - e, h + e, h + e, lug/2 + e};
Physical Surface("lug_bore") = bore();
eyes() = Surface In BoundingBox{-h - e, -h - e, inner - e, h + e, h + e, outer + e};
eyes() += Surface In BoundingBox{-h - e, -h - e, -outer - e, h + e, h + e, -inner + e};
eyes() -= pin(); eyes() -= ends();
Physical Surface("eyes") = eyes();
foot() = Surface In BoundingBox{-30 - e, -high - e, -outer - e, -30 + e, high + e, outer + e};
Physical Surface("foot") = foot();
pulled() = Surface In BoundingBox{30 - e, -high - e, -outer - e, 30 + e, high + e, outer + e};
Physical Surface("pulled") = pulled();
