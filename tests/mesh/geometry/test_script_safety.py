"""Geometry scripts: what makes a geometry is taken as it is, and nothing else runs.

No test here looks at messages alone: each command tried would leave a file.
"""

import dataclasses
import re
import subprocess
import sys
import tempfile
import time

import pytest
from mpi4py import MPI

from fenics_contact import MeshSource, main
from fenics_contact.mesh.geometry import file_kinds as mesh_files
from fenics_contact.mesh.geometry import gmsh_call
from fenics_contact.mesh.geometry import script_words as geometry_tokens
from fenics_contact.mesh.geometry.script_safety import GeometryScript
from fenics_contact.mesh.geometry.script_words import ScriptError
from fenics_contact.mesh.loading import load_body
from tests.mesh.test_loading import RECTANGLE, TWO_TRIANGLES, area, refusal, write
from tests.messages import refused, says
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD

# What Gmsh would do with each is to write {x}, or to read what is none of the scene's business.
ATTACKS = [
    ('SystemCall "touch {x}";', "no_statement", "SystemCall"),
    ('System "touch {x}";', "no_statement", "System"),
    ('NonBlockingSystemCall "touch {x}";', "no_statement", "NonBlockingSystemCall"),
    ('/* harmless */ SystemCall\n// really\n"touch {x}";', "no_statement", "SystemCall"),
    ('SystemCall Str("touch {x}");', "no_statement", "SystemCall"),
    ('SystemCall = 1;\nSystemCall "touch {x}";', "word_not_allowed", "SystemCall"),
    ('touch = 1;\ntouch "{x}";', "no_statement", "touch"),
    ('DefineConstant[ a SystemCall Str("touch {x}") ];', "word_not_allowed", "SystemCall"),
    ('Color SystemCall "touch {x}";', "word_not_allowed", "SystemCall"),
    (
        'Extrude {0, 0, 1} { Surface{1}; } Using SystemCall "touch {x}";',
        "word_not_allowed",
        "SystemCall",
    ),
    ('If (0)\nEndIf\nSystemCall "touch {x}";', "no_statement", "SystemCall"),
    ('S2N["System"] "touch {x}";', "no_statement", "S2N"),
    ('OnelabRun("touch", "{x}");', "no_statement", "OnelabRun"),
    ('Save "{x}";', "no_statement", "Save"),
    ('Print "{x}";', "no_statement", "Print"),
    ('1Print "{x}";', "no_statement", "1"),
    ('Print = 1;\nPrint "{x}";', "no_statement", "Print"),
    ('CreateDir "{x}";', "no_statement", "CreateDir"),
    ('Printf("a") > "{x}";', "word_writes_a_file", "Printf"),
    ('Printf("a;", 1) // >\n /* " */ >> "{x}";', "word_writes_a_file", "Printf"),
    ('Warning("a") > "{x}";', "word_writes_a_file", "Warning"),
    ('Error("%n%n", 1);', "no_format_of_numbers", '"%n%n"'),
    ('a = Sprintf("%1$n", 1);', "no_format_of_numbers", '"%1$n"'),
    ('a = Sprintf("%s", 1);', "no_format_of_numbers", '"%s"'),
    ('a = Sprintf("%*f", 1);', "no_format_of_numbers", '"%*f"'),
    ('a = Sprintf("%999g", 1);', "no_format_of_numbers", '"%999g"'),
    ('a = Sprintf("' + 300 * "x" + '%g", 1);', "no_format_of_numbers", "…"),
    ('a = "%";\nError(StrCat(a, "n"), 1);', "text_must_follow", "Error"),
    ("Plugin(MathEval).Run;", "no_statement", "Plugin"),
    (
        'Field[1] = ExternalProcess;\nField[1].CommandLine = "touch {x}";',
        "word_not_allowed",
        "ExternalProcess",
    ),
    ("ExternalProcess = 1;\nField[1] = ExternalProcess;", "word_not_allowed", "ExternalProcess"),
    ('Field[1] = Box;\nField[1].CommandLine = "touch {x}";', "word_not_allowed", "CommandLine"),
    (
        'Field[1] = Structured;\nField[1].FileName = "/etc/passwd";',
        "word_not_allowed",
        "Structured",
    ),
    ("Field[1] = AutomaticMeshSizeField;", "no_type_of_field", "AutomaticMeshSizeField"),
    ('General.ErrorFileName = "{x}";', "text_for_an_option", "…"),
    ('General[0].ErrorFileName = "{x}";', "text_for_an_option", "…"),
    ('Geometry.DoubleClickedPointCommand = "x";', "option_may_not_be_set", '"x"'),
    ('Solver.Executable0 = "touch {x}";', "no_statement", "Solver"),
    ('DefineConstant[ a = {1, Name "x", Macro "Action"} ];', "word_must_begin", "Macro"),
    ('DefineConstant[ a = {1, GmshOption "x"} ];', "word_not_defined", "GmshOption"),
    ("x[] = ListFromFile('/etc/passwd');", "word_not_allowed", "ListFromFile"),
    ('x = Sprintf(GetEnv("HOME"));', "text_must_follow", "Sprintf"),
    ('x = GetEnv("HOME");', "word_not_allowed", "GetEnv"),
    ("x = Str(General.ExecutableFileName);", "no_option_of_geometry", "General"),
    ("Delete Options;", "word_not_defined", "Options"),
    ("For i In {0:1} x = Str(\nSystemCall\n'touch {x}'\n); EndFor", "new_line_must_follow", "For"),
    ('Macro a Printf(\nSave "{x}"; Return', "new_line_must_follow", "Macro"),
    ("xEndIf1 = 1;", "name_ends_as_a_word", "xEndIf1"),
    ('a = "' + 1100 * "x" + '";', "text_too_long", ""),
    ('a = "b\nSystemCall "touch {x}";', "text_does_not_end", ""),
    ("/* SystemCall", "comment_does_not_end", ""),
    ("a = $b;", "character_refused", "$"),
    ("a = (1;", "statement_does_not_end", "a"),
    ("a = 1);", "bracket_too_many", ")"),
    ('Include "/etc/passwd";', "geometry_outside", 'Include "/etc/passwd"'),
    ('Merge "../x.geo";', "geometry_outside", 'Merge "../x.geo"'),
    ('Include "link.geo";', "geometry_outside", 'Include "link.geo"'),
    ('Merge StrCat("/etc/", "passwd");', "file_must_follow", "Merge"),
    ('Merge StrCat(CurrentDirectory, "g", "x");', "file_must_follow", "Merge"),
    ('Merge "notes.txt";', "merge_of_another_kind", 'Merge "notes.txt"'),
    ('Merge "missing.geo";', "geometry_is_missing", 'Merge "missing.geo"'),
    ('Include "' + 900 * "x" + '.geo";', "geometry_is_missing", "…"),
    ('Include "bad.inc";', "save_in_another_file", "bad.inc"),
    ('Merge "BAD.GEO";', "save_in_another_file", "BAD.GEO"),
    ('Merge "bad.Msh";', "no_gmsh_mesh", "bad.Msh"),
    ('Merge "late.msh";', "no_gmsh_mesh", "late.msh"),
    ('Merge "bad.pos";', "save_in_another_file", "bad.pos"),
    ('v() = ShapeFromFile("bad.geo");', "save_in_another_file", "bad.geo"),
]


@pytest.fixture
def target(folder):
    """What a command would write; beside it files with such commands."""
    target = folder / "written"
    for name in ("bad.inc", "BAD.GEO", "bad.pos", "bad.geo"):
        write(folder, f'Save "{target}";', name)
    write(folder, f'System "touch {target}";', "bad.Msh")
    write(folder, f'\n$MeshFormat\n2.2 0 8;\nSystem "touch {target}";', "late.msh")
    if COMM.rank == 0:
        (folder / "link.geo").symlink_to("/etc/hosts")
    COMM.barrier()
    return target


@pytest.mark.parametrize(("text", "message", "word"), ATTACKS)
def test_what_does_more_than_a_geometry_is_refused(folder, target, text, message, word):
    source = write(folder, RECTANGLE + text.replace("{x}", str(target)))
    with refused(message, word=word):
        load_body(source, 2, COMM)
    assert not target.exists()


@pytest.mark.parametrize("name", ["x.GEO", "x.Geo", "x.MSH"])
def test_suffix_in_capitals_is_examined_as_any(folder, target, name):
    said = refusal(write(folder, RECTANGLE + f'SystemCall "touch {target}";', name))
    assert "'SystemCall'" in said or "does not start as a Gmsh mesh" in said
    assert not target.exists()


@pytest.mark.parametrize(
    "text",
    [
        # Gmsh repeats a loop, and begins a macro, at the line after its head; this may be in what
        # was a comment.
        'For i In {0:1} /*\nSystemCall "touch {x}";\n*/ \nEndFor',
        'Macro a /*\nSystemCall "touch {x}";\nReturn\n*/\nReturn\nCall a;',
        'If (0) // "\nE" // "\nEndIf\n// SystemCall "touch {x}";\n'.replace('E"', "x = 1;"),
        '// \\\n/* SystemCall "touch {x}"; */',
        'If (0)\nx = "EndIf SystemCall"; y = "touch {x}";\nEndIf',
    ],
)
def test_commands_in_comments_and_texts_are_neither_refused_nor_run(folder, target, text):
    source = write(folder, RECTANGLE + text.replace("{x}", str(target)) + "\n")
    body = load_body(source, 2, COMM)
    assert area(body, "3", body.numbers) == pytest.approx(2)
    assert not target.exists()


def test_check_runs_nothing_and_ends_with_2(folder, target, capfd):
    field = f'Field[1] = ExternalProcess;\nField[1].CommandLine = "touch {target}";\n'
    write(folder, RECTANGLE + field + "Background Field = 1;\n", "x.geo")
    scene = (ROOT / "demos" / "slab.toml").read_text(encoding="utf-8")
    scene = re.sub(r"cell = .*\nparameters = .*\n", "", scene)
    write(folder, scene.replace("../meshes/slab.geo", "x.geo"), "s.toml")
    assert main(["check", str(folder / "s.toml")]) == 2
    says("process_in_x_geo", COMM.bcast(capfd.readouterr().err))
    assert not target.exists()


def test_options_beside_a_file_are_not_read(folder, target):
    """Gmsh would run them: for a mesh and a geometry, and for what these read."""
    write(folder, TWO_TRIANGLES, "a.msh")
    write(folder, 'Merge "a.msh";\n', "b.geo")
    for name in ("a.msh.opt", "b.geo.opt"):
        write(folder, f'Print "{target}"; Mesh.ElementOrder = 2;\n', name)
    for name in ("a.msh", "b.geo"):
        body = load_body(MeshSource(str(folder / name)), 2, COMM)
        assert body.mesh.topology.index_map(2).size_global == 2
        assert body.mesh.ufl_domain().ufl_coordinate_element().degree == 1
    assert not target.exists()


def test_what_was_examined_is_what_is_meshed(folder, target, monkeypatch):
    """A file that changes as soon as it was examined."""
    source, call = write(folder, RECTANGLE), gmsh_call.call

    def changed(*arguments):
        (folder / "g.geo").write_text(f'SystemCall "touch {target}";\n')
        return call(*arguments)

    monkeypatch.setattr(gmsh_call, "call", changed)
    body = load_body(source, 2, COMM)
    assert area(body, "3", body.numbers) == pytest.approx(2)
    assert not target.exists()
    monkeypatch.undo()
    says("no_statement", refusal(source), word="SystemCall")


def test_files_of_the_folder_are_read(folder):
    """By their names, by the names of those that name them, and whatever they are called."""
    if COMM.rank == 0:
        (folder / "below").mkdir()
    COMM.barrier()
    write(folder, "width = height;\n", "below/sizes.inc")
    write(folder, 'height = 2; Include "below/sizes.inc";\n', "sizes.dat")
    write(folder, TWO_TRIANGLES, "a.msh")
    text = (
        'Include "sizes.dat";\nMesh.SaveAll = 1;\nPrintf("width %g", width); // a > b\n'
        "If (width > 1)\nRectangle(1) = {0, 0, 0, width, 1};\nEndIf\n"
    )
    body = load_body(write(folder, 'SetFactory("OpenCASCADE");\n' + text, "G.GEO"), 2, COMM)
    assert area(body, "3", body.numbers) == pytest.approx(2)
    write(folder, 'Merge StrCat(CurrentDirectory, "a.msh");\n', "h.geo")
    assert set(load_body(MeshSource(str(folder / "h.geo")), 2, COMM).groups) >= {"left", "plate"}


def test_size_of_a_view_is_a_background(folder):
    """As Gmsh's tutorial has it: sizes from a file of values."""
    view = 'View "sizes" { ST(0,0,0, 2,0,0, 2,1,0){.1,.1,.1}; ST(0,0,0, 2,1,0, 0,1,0){.1,.1,.1}; };'
    write(folder, view, "sizes.pos")
    text = RECTANGLE + 'Merge "sizes.pos";\nBackground Mesh View[0];\n'
    text += "Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;\n"
    body = load_body(write(folder, text), 2, COMM)
    assert 200 < body.mesh.topology.index_map(2).size_global < 800  # 462 of that size


@pytest.mark.parametrize("word", ["PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS", "PDWAD"])
@pytest.mark.parametrize("name", ["x.step", "x.STP", "x.geo"])
def test_step_that_refers_to_other_files_is_refused(folder, word, name):
    """OpenCASCADE would open them, wherever they are."""
    text = (ROOT / "meshes" / "bracket.step").read_text(encoding="utf-8")
    documents = f"DOCUMENT('','{folder}/other.step','',#9999);\n#9999 = DOCUMENT_TYPE('');"
    own, number = re.compile(r"= PRODUCT_DEFINITION\((.*?)\);", re.DOTALL).subn(
        lambda found: f"= {word}({found[1]},(#9998));\n#9998 = {documents}", text
    )
    assert number == 1
    write(folder, own, "a.Step" if name == "x.geo" else name)
    write(folder, 'SetFactory("OpenCASCADE");\nMerge "a.Step";\n')
    source = MeshSource(str(folder / ("g.geo" if name == "x.geo" else name)))
    file = "a.Step" if name == "x.geo" else name
    says("step_of_another_file", refusal(source, 3), word=word, file=file)


def test_documents_that_are_no_files_are_taken(folder):
    """Of drawings, which many programs name in STEP files."""
    text = (ROOT / "meshes" / "bracket.step").read_text(encoding="utf-8")
    drawing = "#9998 = DOCUMENT('D 7','drawing','',#9999);\n#9999 = DOCUMENT_TYPE('');\n"
    head, _, rest = text.rpartition("ENDSEC;")
    source = write(folder, f"{head}{drawing}ENDSEC;{rest}", "a.step")
    body = load_body(dataclasses.replace(source, size=30), 3, COMM)
    assert body.mesh.topology.index_map(3).size_global > 100


def test_gmsh_names_the_users_file_and_line(folder):
    said = refusal(write(folder, RECTANGLE + "/* two\nlines */\nx = (1 +) * 2;\n"))
    assert re.search(r"g\.geo', line 5", said), said
    assert "fenics_contact_" not in said


@pytest.mark.serial
def test_gmsh_process_may_not_write_nor_leave_anything(folder, monkeypatch):
    """The second line of defence: what the words let pass."""
    target, own = folder / "written", folder / "tmp"
    own.mkdir(exist_ok=True)
    monkeypatch.setattr(tempfile, "tempdir", str(own))
    (folder / "g.geo").write_text(RECTANGLE + f'Printf("a") > "{target}"; Printf("a") > "b";')
    file = mesh_files.MeshFile("mesh.file", folder / "g.geo", "geo", "")
    job = {"key": "mesh", "kind": "geo", "name": "g.geo", "dimension": 2, "version": 0}
    job |= {
        "cell": "as meshed",
        "order": 1,
        "size": None,
        "curvature": None,
        "least_size": None,
        "parameters": {},
        "groups": [],
    }
    job["body_sizes"] = {}
    job |= {"curved": False, "sizes": False, "folder": str(folder), "file": str(file.path)}
    gmsh_call.call(mesh_files.Prepared(file.path), job, b"", gmsh_call.Limits("mesh", 60))
    assert not target.exists() or target.stat().st_size == 0
    load_body(MeshSource(str(ROOT / "meshes" / "slab.geo")), 2, COMM)
    assert not list(own.iterdir())


# Statements of Gmsh's manual, most in one script.
FLAT = """
lc = .2; n() = {1, 2, 3}; name = "plate"; k~{1} = 4;
DefineConstant[ a = {2, Min 1, Max 3, Step .5, Name "Parameters/a", ReadOnlyRange 1}
  b = {1, Choices{0="no", 1="yes"}, Name "Parameters/b", Visible 0}, c = 1 ];
n() += {4:6}; n[0] *= 1; x() = LinSpace[0, 1, 3]; y = #n() + n(2)*0 - 1^2; z = (a > 1) ? Pi : 0;
Point(1) = {0, 0, 0, lc}; Point(2) = {a, 0, 0, lc}; Point(3) = {a, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Curve(3) = {3, 4}; Line(4) = {4, 1};
Macro MakeHole
  p = newp; Point(p) = {xc, .5, 0, lc}; r = .1 * Cos(0) + Hypot(0, 0) + Fmod(2, 2);
  For i In {1:4}
    Point(p + i) = {xc + r * Cos(i * Pi / 2), .5 + r * Sin(i * Pi / 2), 0, lc};
  EndFor
  For i In {1:4}
    j = newc; arcs~{i} = j; Circle(j) = {p + i, p, (i == 4) ? p + 1 : p + i + 1};
  EndFor
  loop = newcl; Curve Loop(loop) = {arcs~{1}, arcs~{2}, arcs~{3}, arcs~{4}};
  loops() += loop;
Return
loops() = {};
xc = .5;
Call MakeHole;
If (b == 1 && !(a < 0))
  xc = 1.5;
  Call MakeHole;
ElseIf (b == 2)
  xc = 1.2;
Else
  xc = 1;
EndIf
Line Loop(100) = {1, 2, 3, 4}; Plane Surface(1) = {100, loops()};
Physical Surface(StrCat(name, "s")) = {1}; Physical Curve(Sprintf("side %g", 1), 7) = {1:4};
Physical Curve("holes") = Boundary{ Surface{1}; }; Physical Curve("holes") -= {1, 2, 3, 4};
Transfinite Curve{1, -3} = 11 Using Progression 1.1; Transfinite Curve{2, 4} = 6 Using Bump .5;
MeshSize{ PointsOf{ Surface{1}; } } = lc; Characteristic Length{1} = lc;
Field[1] = Distance; Field[1].CurvesList = {arcs~{1}}; Field[1].Sampling = 20;
Field[2] = Threshold; Field[2].InField = 1; Field[2].SizeMin = .05; Field[2].SizeMax = lc;
Field[2].DistMin = .1; Field[2].DistMax = .5;
Field[3] = MathEval; Field[3].F = Sprintf("0.1 + %g * x^2", .1);
Field[4] = Box; Field[4].VIn = .05; Field[4].VOut = .2; Field[4].XMax = 1;
Field[5] = Min; Field[5].FieldsList = {2:4}; Background Field = 5;
Mesh.Algorithm = 5; Geometry.Tolerance = 1e-8;
General.Terminal = 0; General.Color.Text = Black; Mesh.Color.Points = {255, 0, 0}; View.Light = 1;
Color Red{ Surface{1}; } Show "*"; Hide { Point{1}; } Coherence;
Printf("%g holes", #loops());
"""

SOLID = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1}; Sphere(2) = {1, 1, 1, .4}; Cylinder(3) = {.5, .5, -1, 0, 0, 3, .2};
Cone(4) = {3, 0, 0, 0, 0, 1, .5, .2}; Sphere(5) = {3, 0, .5, .5}; Wedge(6) = {9, 0, 0, 1, 1, 1, .5};
v() = BooleanDifference{ Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
BooleanUnion(20) = { Volume{4}; Delete; }{ Volume{5}; Delete; };
f() = BooleanFragments{ Volume{v()}; Delete; }{ Volume{6}; Delete; };
Rectangle(200) = {0, 5, 0, 1, 1, .1}; Disk(201) = {3, 5, 0, .5};
e() = Extrude{0, 0, 1}{ Surface{200}; Layers{2}; Recombine; };
Extrude{{0, 1, 0}, {4, 5, 0}, Pi / 2}{ Surface{201}; }
c() = Translate{0, 3, 0}{ Duplicata{ Volume{e(1)}; } };
Rotate{{0, 0, 1}, {0, 0, 0}, Pi / 7}{ Volume{c()}; }
Dilate{{0, 0, 0}, .9}{ Volume{c()}; }
Recursive Delete{ Volume{20}; }
Physical Volume("all") = Volume{:}; bb() = BoundingBox Volume{v()};
Physical Surface("low") = Surface In BoundingBox{-9, -9, -.01, 19, 19, .01};
Torus(70) = {19, 0, 0, 1, .4}; Delete{ Volume{70}; }
Mesh.MeshSizeMin = .3; Mesh.MeshSizeMax = .5; Mesh.Algorithm3D = 1;
"""

EXTRUDED = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Point(5) = {.5, -.2, 0}; Spline(1) = {1, 5, 2}; Line(2) = {2, 3};
BSpline(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Surface(1) = {1};
Transfinite Curve{:} = 5; Transfinite Surface{1} = {1, 2, 3, 4} Alternate; Recombine Surface{1};
out() = Extrude{0, 0, 2}{ Surface{1}; Layers{{2, 3}, {.5, 1}}; Recombine; };
Periodic Surface{out(0)} = {1} Translate{0, 0, 2};
Physical Volume("body") = {out(1)}; Physical Surface("top") = {out(0)};
q = 1; Mesh.ElementOrder = 2; Mesh.RecombineAll = 1;
For (1:3)
  q += 1;
EndFor
"""

# Gmsh itself, on a script as it is written and as it is given to Gmsh.
COMPARE = """
import sys, gmsh, json
gmsh.initialize(readConfigFiles=False, interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
gmsh.merge(sys.argv[1])
gmsh.model.mesh.generate(gmsh.model.getDimension())
tags, points, _ = gmsh.model.mesh.getNodes()
names = [(*g, gmsh.model.getPhysicalName(*g)) for g in gmsh.model.getPhysicalGroups()]
parts = [[int(p) for p in gmsh.model.getEntitiesForPhysicalGroup(*g[:2])] for g in names]
kinds = [int(k) for k in gmsh.model.mesh.getElementTypes()]
print("FOUND" + json.dumps([[round(x, 9) for x in points], names, parts, kinds]))
"""


@pytest.mark.serial
@pytest.mark.parametrize("text", [FLAT, SOLID, EXTRUDED], ids=["flat", "solid", "extruded"])
def test_gmsh_makes_the_same_of_a_script_and_of_what_it_is_given(folder, text):
    script = GeometryScript(text)
    (folder / "a.geo").write_text(text)
    (folder / "b.geo").write_text(script.checked(script.defined(), lambda file: file.name))
    assert (folder / "b.geo").read_text() != text
    found = []
    for name in ("a.geo", "b.geo"):
        command = [sys.executable, "-c", COMPARE, str(folder / name)]
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100)
        found.append(done.stdout.partition("FOUND")[2])
    assert len(found[0]) > 1000
    assert found[0] == found[1]


LEGAL = """
Ellipse(1) = {1, 2, 3, 4}; Bezier(2) = {1, 2, 3}; Wire(1) = {1, 2}; Surface Loop(1) = {1:6};
Nurbs(3) = {1, 2, 3} Knots {0, 0, 1, 1} Order 2; Circle(4) = {0, 0, 0, 1, 0, Pi}; Volume(1) = {1};
ThruSections(1) = {1, 2}; Ruled ThruSections{1, 2}; ThickSolid(2) = {1, 3, -.1}; Curve(9) = {1, 2};
Ruled Surface(2) = {1} In Sphere{1}; Compound Curve{1, 2}; Compound Surface{1, 2};
Compound Spline(5) = {1, 2} Using 10; Chamfer{1}{1, 2}{3}{.1}
Symmetry{1, 0, 0, 0}{ Duplicata{ Surface{1}; } }
Affine{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}{ Volume{1}; }
Split Curve{1} Point{2}; Intersect Curve{1, 2} Surface{3}
Extrude{ Surface{1}; } Using Wire{1}
Extrude{ Surface{1}; Layers{5, .1}; Using Index[0]; }
Point{5} In Surface{1}; Curve{2} In Surface{1}; Surface{3} In Volume{1};
Transfinite Surface "*"; Transfinite Volume{1} = {1, 2, 3, 4, 5, 6, 7, 8}; TransfQuadTri{1};
Recombine Surface{:} = 30; Recombine Volume{1}; Smoother Surface{1} = 4; Reverse Surface{1};
Periodic Curve{1} = {2}; Periodic Surface{1} = {2} Rotate{{0, 0, 1}, {0, 0, 0}, Pi};
MeshAlgorithm Surface{1} = 6; MeshSizeFromBoundary Surface{1} = 0; Degenerated Curve{1};
Field[1] = BoundaryLayer; Field[1].CurvesList = {1}; Field[1].Quads = 1; BoundaryLayer Field = 1;
Field[2] = Param; Field[2].FX = "x"; Field[3] = PostView; Field[3].ViewIndex = 0; Delete Field[2];
Delete Model; Delete Physicals; Delete{ Surface{1}; } Delete Embedded{ Surface{1}; }
a = Exists(b) ? GetValue("c", 1) : 2; d = StrCmp("x", Str("y")); Mesh 2; SetOrder 2; Coherence Mesh;
e() = Unique(Abs(Boundary{ Volume{1}; })); m() = MatrixOfInertia Volume{1}; g() = Point{1};
If (StrFind("abc", "b"))
  h() = Closest{0, 0, 0}{ Surface{1}; };
EndIf
Physical Point("p", 3) = {1}; Physical Surface("s") += {2}; i() = Physical Surface{3}; a++;
n~{a}~{2} = 1; l() = List[e()]; SetTag Surface(1, 2); SetMaxTag Point(8); HealShapes;
Parametric Surface(7) = "u" "v" "u * v"; s = 1e-3; t = .5; u = 1.E+3; CreateTopology;
Euclidian Coordinates;
"""


@pytest.mark.skipif(COMM.rank > 0, reason="of texts; one rank will do")
def test_statements_that_make_geometries_pass():
    """As Gmsh's manual spells them; some stand for nothing that could be meshed."""
    script = GeometryScript(LEGAL)
    written = script.checked(script.defined(), lambda file: file.name)
    again = GeometryScript(written)
    assert again.checked(again.defined(), lambda file: file.name) == written


@pytest.mark.skipif(COMM.rank > 0, reason="of texts; one rank will do")
@pytest.mark.parametrize("path", sorted((ROOT / "meshes").glob("*.geo")), ids=lambda p: p.stem)
def test_own_geometries_are_written_as_they_are(path):
    script = GeometryScript(path.read_text(encoding="utf-8"))
    written = script.checked(script.defined(), lambda file: file.name)
    bare = re.sub(r"//[^\n]*|/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert "".join(written.split()) == "".join(bare.split())


@pytest.mark.skipif(COMM.rank > 0, reason="of texts; one rank will do")
def test_every_word_of_gmsh_that_is_not_listed_is_refused():
    """Words that a later version of Gmsh may add, in each place where it could."""
    for text, said in (
        ("Ask;", "ask_is_no_statement"),
        ("Ask 3;", "ask_is_no_statement"),
        ('x = Ask("ls");', "ask_is_no_word"),
        ("x = Ask;", "ask_is_no_word"),
        ("Ask { Point{1}; };", "ask_is_no_statement"),
        ("a = Ask.b;", "ask_has_no_option"),
    ):
        script = GeometryScript(text)
        with refused(said, ScriptError):
            script.checked(script.defined(), lambda file: file.name)


@pytest.mark.skipif(COMM.rank > 0, reason="of texts; one rank will do")
@pytest.mark.parametrize(
    "text",
    [
        "a = 1;\nx() = {" + ",".join(["a"] * 40000) + "};",
        "DefineConstant[" + ",".join(f"a{n}=1" for n in range(20000)) + "];",
        "v() = {" + ",".join(['ShapeFromFile("a.step")'] * 20000) + "};",
    ],
    ids=["words", "constants", "files"],
)
def test_long_statements_take_time_by_their_length(text):
    """Not by its square, which would be minutes here: that is before Gmsh's limit of time."""
    began = time.process_time()
    script = GeometryScript(text)
    assert script.checked(script.defined(), lambda file: file.name)
    assert time.process_time() - began < 20


def test_script_of_too_many_words_is_refused(folder, monkeypatch):
    """Each takes time and memory before Gmsh's limits hold."""
    monkeypatch.setattr(geometry_tokens, "_MOST", 1000)
    text = RECTANGLE + "x = 1" + "+1" * 1000 + ";"
    says("script_of_too_many_words", refusal(write(folder, text)))


def test_large_script_is_refused_before_it_is_read(folder, monkeypatch):
    monkeypatch.setattr(mesh_files, "_LARGEST", 2**10)
    text = RECTANGLE + "x = 1;\n" * 2000
    says("script_is_too_large", refusal(write(folder, text)))
