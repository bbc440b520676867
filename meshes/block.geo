// Rectangle anywhere in the plane, such as one of two blocks on each other, on a slope or not.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  left = {0, Name "Parameters/x of its lower left corner, before it is turned"}
  base = {0, Name "Parameters/y of its lower left corner, before it is turned"}
  length = {1, Name "Parameters/length"}
  height = {1, Name "Parameters/height"}
  cells_along = {4, Name "Parameters/cells along"}
  cells_across = {4, Name "Parameters/cells across"}
  slope = {0, Name "Parameters/tangent of the angle by which it is turned about the origin"}
];

x[] = {left, left + length, left + length, left};
y[] = {base, base, base + height, base + height};
cosine = 1 / Hypot(1, slope);
sine = slope * cosine;
For i In {0:3}
  Point(i + 1) = {cosine * x[i] - sine * y[i], sine * x[i] + cosine * y[i], 0};
EndFor
For i In {1:4}
  Line(i) = {i, 1 + i % 4};
EndFor
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Transfinite Curve{1, 3} = cells_along + 1;
Transfinite Curve{2, 4} = cells_across + 1;
Transfinite Surface{1};

Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("block") = {1};
