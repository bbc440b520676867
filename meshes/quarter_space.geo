// Box [0, extent] x [0, extent] x [-extent, 0], a quarter of a block that stands for a
// half-space below z = 0, or half of it, with x from -extent. Around the origin is a fine cube of
// uniform cells, or two side by side; outside of it the cells grow by a constant ratio.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  fine = {3.6, Name "Parameters/side of the fine cube"}
  size = {0.6, Name "Parameters/side of a cell in the fine cube"}
  extent = {60, Name "Parameters/side of the box"}
  cells_outside = {8, Name "Parameters/cells from the fine cube to the outer boundary"}
  hexahedra = {0, Choices{0, 1}, Name "Parameters/hexahedra instead of tetrahedra"}
  half = {0, Choices{0, 1}, Name "Parameters/half of the block instead of a quarter"}
];

// The ratio r of neighbours that fits the outer cells in, starting from the fine ones:
// first (r^cells_outside - 1) / (r - 1) = extent - fine. It becomes 1 if there are too many
// cells for that: they are then equal, and finer.
cells = Round(fine / size);
first = fine / cells;
ratio = 4;
For n In {1:500}
  ratio = (1 + (extent - fine) / first * (ratio - 1))^(1 / cells_outside);
EndFor

// A grid of points, 3 along each axis, 4 along x in a half: point p is x[i[0]], at[i[1]], -at[i[2]],
// p = 1 + i . step. The line from it along the axis a, the face from it normal to a, and the block
// from it have the numbers 100 (a + 1) + p, 100 (a + 1) + p and p. Backwards: each needs those
// further out.
at[] = {0, fine, extent};
x[] = {0, fine, extent};
If (half)
  x[] = {-extent, -fine, fine, extent};
EndIf
wide = 3 + half;
step[] = {1, wide, 3 * wide};
last[] = {wide - 1, 2, 2};
near_0[] = {}; // faces in the planes x = 0, y = 0 and z = 0
near_1[] = {};
near_2[] = {};
far[] = {};
For p In {9 * wide:1:-1}
  i[] = {(p - 1) % wide, Floor((p - 1) / wide) % 3, Floor((p - 1) / (3 * wide))};
  Point(p) = {x[i[0]], at[i[1]], -at[i[2]]};
  For a In {0:2}
    doubled = half && a == 0;
    If (i[a] < last[a])
      Line(100 * (a + 1) + p) = {p, p + step[a]};
    EndIf
    If (i[a] == doubled)
      Transfinite Curve{100 * (a + 1) + p} = (1 + doubled) * cells + 1;
    ElseIf (i[a] == 1 + doubled)
      Transfinite Curve{100 * (a + 1) + p} = cells_outside + 1 Using Progression ratio;
    ElseIf (i[a] == 0)
      Transfinite Curve{100 * (a + 1) + p} = cells_outside + 1 Using Progression 1 / ratio;
    EndIf
  EndFor
  For a In {0:2}
    b = (a == 0) ? 1 : 0; // the two other axes
    c = (a == 2) ? 1 : 2;
    If (i[b] < last[b] && i[c] < last[c])
      f = 100 * (a + 1) + p;
      u = 100 * (b + 1) + p;
      v = 100 * (c + 1) + p;
      Curve Loop(f) = {u, v + step[b], -(u + step[c]), -v};
      Plane Surface(f) = {f};
      Transfinite Surface{f} = {p, p + step[b], p + step[b] + step[c], p + step[c]};
      If (i[a] == last[a] || (half && a == 0 && i[a] == 0))
        far[] += f;
      ElseIf (i[a] == 0)
        near~{a}[] += f;
      EndIf
    EndIf
  EndFor
  If (i[0] < last[0] && i[1] < 2 && i[2] < 2)
    x_y = 1 + step[1];
    Surface Loop(p) = {100 + p, 101 + p, 200 + p, 200 + p + step[1], 300 + p, 300 + p + step[2]};
    Volume(p) = {p};
    Transfinite Volume{p} = {p, p + 1, p + x_y, p + step[1],
      p + step[2], p + step[2] + 1, p + step[2] + x_y, p + step[2] + step[1]};
  EndIf
EndFor
If (hexahedra)
  Recombine Surface{:};
EndIf

top = 301 + half; // of the fine part
near_2[] -= top;
Physical Surface("contact") = {top};
Physical Surface("surface") = {near_2[]};
If (!half)
  Physical Surface("symmetry_x") = {near_0[]};
EndIf
Physical Surface("symmetry_y") = {near_1[]};
Physical Surface("outer") = {far[]};
Physical Volume("body") = {Volume{:}};
