// A block of rubber, 8 wide and 3 high, its top at y = 0: under a cylinder that is dragged along.
DefineConstant[ cells = {4, Name "cells along a length of 1"} ];
Point(1) = {-4, -3, 0};
Point(2) = {4, -3, 0};
Point(3) = {4, 0, 0};
Point(4) = {-4, 0, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 8 * cells + 1;
Transfinite Curve {2, 4} = 3 * cells + 1;
Transfinite Surface {1};
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};
Physical Surface("rubber") = {1};
