// Two flanges of a tube, face to face, and bolts through wide holes all around. Millimetres.
SetFactory("OpenCASCADE");
DefineConstant[
  bolts = {8, Name "Parameters/number of bolts"}
  hole = {4.5, Name "Parameters/radius of their holes"}
];
circle = 38; outer = 50; bore = 20; wall = 26; thick = 10; tube = 20; r = 4; head = 7; e = 0.01;

For side In {0:1}
  s = 2*side - 1;
  v = 1000*(side + 1);
  Cylinder(v) = {0, 0, 0, 0, 0, s*thick, outer};
  Cylinder(v + 1) = {0, 0, 0, 0, 0, s*(thick + tube), wall};
  BooleanUnion(v + 2) = { Volume{v}; Delete; }{ Volume{v + 1}; Delete; };
  Cylinder(v + 3) = {0, 0, 0, 0, 0, s*(thick + tube), bore};
  tools() = {v + 3};
  For i In {0:bolts - 1}
    a = 2*Pi*i/bolts;
    Cylinder(v + 10 + i) = {circle*Cos(a), circle*Sin(a), 0, 0, 0, s*thick, hole};
    tools() += {v + 10 + i};
  EndFor
  BooleanDifference(v + 5) = { Volume{v + 2}; Delete; }{ Volume{tools()}; Delete; };
EndFor
Physical Volume("below") = {1005};
Physical Volume("above") = {2005};

ends() = {};
seats_0() = {}; seats_1() = {};
For i In {0:bolts - 1}
  a = 2*Pi*i/bolts; x = circle*Cos(a); y = circle*Sin(a);
  v = 3000 + 20*i;
  For side In {0:1}
    s = 2*side - 1;
    Cylinder(v + 4*side) = {x, y, s*thick, 0, 0, s*5, head};
    Cylinder(v + 4*side + 1) = {x, y, s*thick/2, 0, 0, s*thick, r};
    BooleanUnion(v + 4*side + 2) = { Volume{v + 4*side}; Delete; }{ Volume{v + 4*side + 1}; Delete; };
  EndFor
  Cylinder(v + 8) = {x, y, -thick/2, 0, 0, thick, r};
  parts() = BooleanFragments{ Volume{v + 2, v + 6, v + 8}; Delete; }{};
  middle() = Volume In BoundingBox{x - r - e, y - r - e, -thick/2 - e, x + r + e, y + r + e, thick/2 + e};
  parts() -= middle();
  ends() += parts();
  Physical Volume(Sprintf("shank_%g", i)) = middle();
  seats_0() += Surface In BoundingBox{x - head - e, y - head - e, -thick - e, x + head + e, y + head + e, -thick + e};
  seats_1() += Surface In BoundingBox{x - head - e, y - head - e, thick - e, x + head + e, y + head + e, thick + e};
EndFor
Physical Volume("bolt_ends") = ends();

face_0() = {}; face_1() = {};
both() = Surface In BoundingBox{-outer - e, -outer - e, -e, outer + e, outer + e, e};
of_0() = Boundary{ Volume{1005}; };
face_1() = both(); face_1() -= of_0();
face_0() = both(); face_0() -= face_1();
Physical Surface("face_0") = face_0();
Physical Surface("face_1") = face_1();
back_0() = Surface In BoundingBox{-outer - e, -outer - e, -thick - e, outer + e, outer + e, -thick + e};
back_0() -= seats_0();
back_1() = Surface In BoundingBox{-outer - e, -outer - e, thick - e, outer + e, outer + e, thick + e};
back_1() -= seats_1();
Physical Surface("back_0") = back_0();
Physical Surface("back_1") = back_1();
Physical Surface("seats_0") = seats_0();
Physical Surface("seats_1") = seats_1();
foot() = Surface In BoundingBox{-outer, -outer, -thick - tube - e, outer, outer, -thick - tube + e};
end() = Surface In BoundingBox{-outer, -outer, thick + tube - e, outer, outer, thick + tube + e};
Physical Surface("foot") = foot();
Physical Surface("end") = end();
