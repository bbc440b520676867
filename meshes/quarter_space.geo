// Box [0, extent] x [0, extent] x [-extent, 0], a quarter of a block that stands for a
// half-space below z = 0. Its corner at the origin is a fine cube of uniform cells; outside of
// it the cells grow by a constant ratio.
// Values in DefineConstant may be replaced by a scene's [mesh.parameters].
DefineConstant[
  fine = {3.6, Name "Parameters/side of the fine cube"}
  size = {0.6, Name "Parameters/side of a cell in the fine cube"}
  extent = {60, Name "Parameters/side of the box"}
  cells_outside = {8, Name "Parameters/cells from the fine cube to the outer boundary"}
  hexahedra = {0, Choices{0, 1}, Name "Parameters/hexahedra instead of tetrahedra"}
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

// A grid of 3 x 3 x 3 points: point p is at[i[0]], at[i[1]], -at[i[2]], p = 1 + i . step. The
// line from it along the axis a, the face from it normal to a, and the block from it have the
// numbers 100 (a + 1) + p, 100 (a + 1) + p and p. Backwards: each needs those further out.
at[] = {0, fine, extent};
step[] = {1, 3, 9};
near_0[] = {}; // faces in the planes x = 0, y = 0 and z = 0
near_1[] = {};
near_2[] = {};
far[] = {};
For p In {27:1:-1}
  i[] = {(p - 1) % 3, Floor((p - 1) / 3) % 3, Floor((p - 1) / 9)};
  Point(p) = {at[i[0]], at[i[1]], -at[i[2]]};
  For a In {0:2}
    If (i[a] < 2)
      Line(100 * (a + 1) + p) = {p, p + step[a]};
    EndIf
    If (i[a] == 0)
      Transfinite Curve{100 * (a + 1) + p} = cells + 1;
    ElseIf (i[a] == 1)
      Transfinite Curve{100 * (a + 1) + p} = cells_outside + 1 Using Progression ratio;
    EndIf
  EndFor
  For a In {0:2}
    b = (a == 0) ? 1 : 0; // the two other axes
    c = (a == 2) ? 1 : 2;
    If (i[b] < 2 && i[c] < 2)
      f = 100 * (a + 1) + p;
      u = 100 * (b + 1) + p;
      v = 100 * (c + 1) + p;
      Curve Loop(f) = {u, v + step[b], -(u + step[c]), -v};
      Plane Surface(f) = {f};
      Transfinite Surface{f} = {p, p + step[b], p + step[b] + step[c], p + step[c]};
      If (i[a] == 0)
        near~{a}[] += f;
      ElseIf (i[a] == 2)
        far[] += f;
      EndIf
    EndIf
  EndFor
  If (i[0] < 2 && i[1] < 2 && i[2] < 2)
    Surface Loop(p) = {100 + p, 101 + p, 200 + p, 203 + p, 300 + p, 309 + p};
    Volume(p) = {p};
    Transfinite Volume{p} = {p, p + 1, p + 4, p + 3, p + 9, p + 10, p + 13, p + 12};
  EndIf
EndFor
If (hexahedra)
  Recombine Surface{:};
EndIf

near_2[] -= 301; // the top of the fine cube
Physical Surface("contact") = {301};
Physical Surface("surface") = {near_2[]};
Physical Surface("symmetry_x") = {near_0[]};
Physical Surface("symmetry_y") = {near_1[]};
Physical Surface("outer") = {far[]};
Physical Volume("body") = {Volume{:}};
