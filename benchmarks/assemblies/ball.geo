// A ball, cut flat above, in a socket that holds it from below. Millimetres.
SetFactory("OpenCASCADE");
DefineConstant[
  clearance = {0, Name "Parameters/between the radii of socket and ball"}
  lowered = {0, Name "Parameters/of the ball, so that it touches at the lowest point"}
];
r = 10; e = 0.01;
Box(1) = {-16, -16, -16, 32, 32, 16};
Sphere(2) = {0, 0, 0, r + clearance};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Sphere(4) = {0, 0, -lowered, r};
Box(5) = {-20, -20, 6, 40, 40, 20};
BooleanDifference(6) = { Volume{4}; Delete; }{ Volume{5}; Delete; };
Physical Volume("socket") = {3};
Physical Volume("ball") = {6};
top() = Surface In BoundingBox{-r, -r, 6 - e, r, r, 6 + e};
round() = Boundary{ Volume{6}; };
round() -= top();
Physical Surface("top") = top();
Physical Surface("round") = round();
h = r + clearance;
hollow() = Surface In BoundingBox{-h - e, -h - e, -h - e, h + e, h + e, e};
hollow() -= round();
Physical Surface("hollow") = hollow();
foot() = Surface In BoundingBox{-17, -17, -16 - e, 17, 17, -16 + e};
Physical Surface("foot") = foot();
