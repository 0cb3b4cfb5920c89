// One yarn: `Call Yarn` makes its corners, curves, surfaces and volumes, and names them.
//
// A yarn is a row of blocks, a quarter of a crossing each: eight corners, twelve curves, six
// surfaces and a volume. Two blocks share their corners, curves and the surface between them.
//
//     i   along the yarn    at the places stations(i), block i from stations(i) to stations(i+1)
//     j   across it         at the distances sides(j) from its centreline
//     k   through it        0 below, 1 above
//
// A point of the faces is the centreline moved by (v, q): (s, axis + v, z(s) -+ q(v)) in a warp
// (family 0), (axis + v, s, z(s) -+ q(v)) in a weft (family 1), with
//
//     z(s) = side height cos(pi (s - first) / (2 half_length)) + up shift / 2
//
// from a crossing where it is on one side to one where it is on the other; level where it floats on. The
// shift is that of the whole yarn, by its side `up` at the first crossing.
// ups(m + 1) is the side, +1 or -1, at crossing m, from the one before the first to the one behind the last.

Macro Centreline
  at = Floor((s - first) / (2 * half_length(family)));
  angle = Pi * ((s - first) / (2 * half_length(family)) - at);
  If (ups(at + 1) == ups(at + 2))
    angle = 0;
  EndIf
  z = ups(at + 1) * height(family) * Cos(angle) + ups(1) * shift / 2;
Return

Macro Section
  If (family == 0)
    Call WarpSection;
  Else
    Call WeftSection;
  EndIf
Return

// a point at (s, v) on the lower (k = 0) or the upper face
Macro Place
  Call Centreline;
  Call Section;
  z = z + (2 * k - 1) * q;
  p = newp;
  If (family == 0)
    Point(p) = {s, axis + v, z};
  Else
    Point(p) = {axis + v, s, z};
  EndIf
Return

Macro Yarn
  na = #stations() - 1;
  nb = #sides() - 1;

  corners() = {};
  For i In {0 : na}
    For j In {0 : nb}
      For k In {0 : 1}
        s = stations(i);
        v = sides(j);
        Call Place;
        corners() += p;
      EndFor
    EndFor
  EndFor

  fibres() = {};
  For i In {0 : na - 1}
    For j In {0 : nb}
      For k In {0 : 1}
        line() = {corners((i * (nb + 1) + j) * 2 + k)};
        For m In {1 : samples - 1}
          s = stations(i) + m / samples * (stations(i + 1) - stations(i));
          v = sides(j);
          Call Place;
          line() += p;
        EndFor
        line() += corners(((i + 1) * (nb + 1) + j) * 2 + k);
        c = newl;
        Spline(c) = line();
        Transfinite Curve {c} = along + 1;
        fibres() += c;
      EndFor
    EndFor
  EndFor

  arcs() = {};
  For i In {0 : na}
    For j In {0 : nb - 1}
      For k In {0 : 1}
        line() = {corners((i * (nb + 1) + j) * 2 + k)};
        For m In {1 : samples - 1}
          s = stations(i);
          v = sides(j) + m / samples * (sides(j + 1) - sides(j));
          Call Place;
          line() += p;
        EndFor
        line() += corners((i * (nb + 1) + j + 1) * 2 + k);
        c = newl;
        Spline(c) = line();
        // the steps shrink towards the tip, by this factor from one to the next
        factor = grading(family);
        If (sides(j) < 0)
          factor = 1 / factor;
        EndIf
        Transfinite Curve {c} = across + 1 Using Progression factor;
        arcs() += c;
      EndFor
    EndFor
  EndFor

  verticals() = {};
  For i In {0 : na}
    For j In {0 : nb}
      c = newl;
      Line(c) = {corners((i * (nb + 1) + j) * 2), corners((i * (nb + 1) + j) * 2 + 1)};
      Transfinite Curve {c} = through + 1;
      verticals() += c;
    EndFor
  EndFor

  faces() = {};
  contact() = {};
  plate() = {};
  For i In {0 : na - 1}
    s = (stations(i) + stations(i + 1)) / 2;
    Call Centreline;
    For j In {0 : nb - 1}
      For k In {0 : 1}
        lower = (i * (nb + 1) + j) * 2 + k;
        start = (i * nb + j) * 2 + k;
        b = newl;
        Curve Loop(b) = {fibres(lower), arcs(start + 2 * nb), -fibres(lower + 2), -arcs(start)};
        c = news;
        Surface(c) = {b};
        faces() += c;
        // the yarn that is crossed lies below where this one is above its middle plane
        If ((z > 0 && k == 0) || (z < 0 && k == 1))
          contact() += c;
        Else
          plate() += c;
        EndIf
      EndFor
    EndFor
  EndFor

  sections() = {};
  For i In {0 : na}
    For j In {0 : nb - 1}
      arc = (i * nb + j) * 2;
      edge = i * (nb + 1) + j;
      b = newl;
      Curve Loop(b) = {arcs(arc), verticals(edge + 1), -arcs(arc + 1), -verticals(edge)};
      c = news;
      Surface(c) = {b};
      sections() += c;
    EndFor
  EndFor

  flanks() = {};
  For i In {0 : na - 1}
    For j In {0 : nb}
      fibre = (i * (nb + 1) + j) * 2;
      edge = i * (nb + 1) + j;
      b = newl;
      Curve Loop(b) = {fibres(fibre), verticals(edge + nb + 1), -fibres(fibre + 1), -verticals(edge)};
      c = news;
      Surface(c) = {b};
      flanks() += c;
    EndFor
  EndFor

  volumes() = {};
  For i In {0 : na - 1}
    For j In {0 : nb - 1}
      b = newsl;
      face = (i * nb + j) * 2;
      flank = i * (nb + 1) + j;
      Surface Loop(b) = {faces(face), faces(face + 1), sections(i * nb + j),
        sections((i + 1) * nb + j), flanks(flank), flanks(flank + 1)};
      c = newv;
      Volume(c) = {b};
      volumes() += c;
    EndFor
  EndFor

  first_section() = {};
  last_section() = {};
  For j In {0 : nb - 1}
    first_section() += sections(j);
    last_section() += sections(na * nb + j);
  EndFor
  low_flank() = {};
  high_flank() = {};
  For i In {0 : na - 1}
    low_flank() += flanks(i * (nb + 1));
    high_flank() += flanks(i * (nb + 1) + nb);
  EndFor

  Transfinite Surface {faces(), sections(), flanks()};
  Recombine Surface {faces(), sections(), flanks()};
  Transfinite Volume {volumes()};

  Physical Volume(StrCat(name, "")) = volumes();
  Physical Surface(StrCat(name, "_contact")) = contact();
  Physical Surface(StrCat(name, "_plate")) = plate();
  Physical Surface(StrCat(name, "_end")) = last_section();
  If (quarter)
    Physical Surface(StrCat(name, "_tip")) = high_flank();
    If (family == 0)
      Physical Surface(StrCat(name, "_symx")) = first_section();
      Physical Surface(StrCat(name, "_symy")) = low_flank();
    Else
      Physical Surface(StrCat(name, "_symy")) = first_section();
      Physical Surface(StrCat(name, "_symx")) = low_flank();
    EndIf
  Else
    Physical Surface(StrCat(name, "_start")) = first_section();
    Physical Surface(StrCat(name, "_tip")) = {low_flank(), high_flank()};
  EndIf
Return
