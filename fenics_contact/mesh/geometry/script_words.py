"""Gmsh's geometry scripts as words and statements, and those words that a scene's script may have.

The words are those that make geometries and meshes, and no others, from Gmsh's grammar (``Gmsh.l``
and ``Gmsh.y``, version 4.15) and its reference manual. What is not in these lists is refused
(``script_safety``): also what a later version of Gmsh adds.

Scripts are read as words, numbers, texts and signs, and written again from them: without comments,
with a blank between any two, and a statement a line. What Gmsh reads is then what was examined:
Gmsh itself skips conditionals and repeats loops by characters and by lines, so that comments and
texts could hide statements from an examination.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple


def _words(listed: str) -> frozenset[str]:
    return frozenset(listed.split())


_ENTITIES = """
    Point Curve Line Surface Volume GeoEntity Physical Parent
"""
_SHAPES = """
    Circle Ellipse Ellipsis Elliptic Spline CatmullRom BSpline Bezier Nurbs Knots Order Wire Plane
    Ruled Compound Sphere PolarSphere Box Block Torus Rectangle Disk Cylinder Cone Wedge
    ThickSolid ThruSections Parametric Euclidean Euclidian Coordinates Sewing
"""
_TRANSFORMS = """
    Translate Rotate Symmetry Dilate Affine Closest Split Intersect Extrude Layers ScaleLastLayer
    Hole QuadTriAddVerts QuadtriAddverts QuadTriNoNewVerts QuadtriNonewverts RecombLaterals
    Fillet Chamfer Using Delete Recursive Slide
    BooleanUnion BooleanFuse BooleanIntersection BooleanCommon BooleanDifference BooleanCut
    BooleanSection BooleanFragments BooleanCoherence Coherence HealShapes
    ShapeFromFile SetFactory SetTag SetMaxTag SyncModel NewModel
"""
_MESHING = """
    MeshSize Characteristic Length Transfinite TransfQuadTri Transfquadtri Recombine Smoother
    Periodic Degenerated
    Reverse ReverseMesh RelocateMesh ReorientMesh MeshAlgorithm MeshSizeFromBoundary Field
    RefineMesh RecombineMesh TransformMesh RenumberMeshNodes RenumberMeshElements CreateMeshEdges
    CreateMeshFaces CreateTopology CreateGeometry ClassifySurfaces Homology Cohomology Betti
    Show Hide Color SetPartition BoundingBox SetChanged
"""
_BLOCKS = """
    For EndFor If ElseIf Else EndIf Macro Function Return Call
"""
_FUNCTIONS = """
    Abs Acos ArcCos Asin ArcSin Atan ArcTan Atan2 ArcTan2 Catenary Ceil Cos Cosh Exp Fabs Floor Fmod
    Hypot LinSpace List Log Log10 LogSpace Max Min Modulo Pi Rand Round Sin Sinh Sqrt Step Tan Tanh
    Find Unique Exists GetForced GetForcedStr GetNumber GetString GetValue GetStringValue
    Mass CenterOfMass MatrixOfInertia Normal Curvature MPI_Rank MPI_Size Cpu Memory TotalMemory
    GMSH_MAJOR_VERSION GMSH_MINOR_VERSION GMSH_PATCH_VERSION TestLevel Today
    Str StrCat StrChoice StrCmp StrFind StrLen StrPrefix StrRelative StrReplace StrSub Sprintf
    UpperCase LowerCase LowerCaseIn NameToString N2S CurrentDirectory CurrentDir
    DefineConstant UndefineConstant DefineNumber DefineString
    In Printf Warning Error TextAttributes T2 T3 TIME INTERPOLATION_SCHEME
"""

#: Words of Gmsh's own that a script may use.
KEYWORDS = _words(_ENTITIES + _SHAPES + _TRANSFORMS + _MESHING + _BLOCKS + _FUNCTIONS)

#: Words that do other things: keywords of Gmsh, commands, fields and their options. They are no
#: names of variables either.
FORBIDDEN = _words("""
    Abort AbsolutePath AdaptMesh Alias AliasWithOptions CodeName ColorTable Combine CopyOptions
    CurrentFileName DirName Draw Ellipsoid Exit FileExists FixRelativePath GetEnv
    GmshExecutableName Levelset ListFromFile OnelabAction OnelabRun Plugin Quadric S2N
    SetNumber SetString StringToName UnsplitWindow
    Append DimNameSpace NameStruct Struct
    CommandLine CreateDir ExternalProcess FileName NonBlockingSystemCall SendToServer SetName Sleep
    Structured System SystemCall
    """)

#: These are statements by themselves, or begin one.
STATEMENTS = frozenset([*_BLOCKS.split(), "Printf", "Warning", "Error"])

#: With these a statement begins that ends with its last brace, without a semicolon.
BRACED = _words("""
    Translate Rotate Symmetry Dilate Affine Closest Intersect Delete Recursive Color SetPartition
    Show Hide Extrude ThruSections Ruled Fillet Chamfer CreateGeometry BooleanUnion BooleanFuse
    BooleanIntersection BooleanCommon BooleanDifference BooleanCut BooleanSection BooleanFragments
    BooleanCoherence
    """)

#: Words followed by shapes in braces: a copy of them, or what bounds them.
OF_SHAPES = _words(
    "Duplicata Boundary CombinedBoundary OrientedBoundary OrientedCombinedBoundary PointsOf"
)

#: Words that mean something after another one only.
PHRASES = frozenset(
    {
        *(("Curve", "Loop"), ("Line", "Loop"), ("Surface", "Loop")),
        *(("Using", "Progression"), ("Using", "Power"), ("Using", "Bump"), ("Using", "Beta")),
        *(("Using", "Progression_HWall"), ("Using", "Index"), ("Using", "View")),
        *(("Coherence", "Mesh"), ("Coherence", "Geometry")),
        *(("Delete", "Model"), ("Delete", "All"), ("Delete", "Meshes"), ("Delete", "Physicals")),
        *(("Delete", "Variables"), ("Delete", "Embedded"), ("Delete", "View"), ("Delete", "Empty")),
        *(("Empty", "Views"), ("Background", "Mesh"), ("Mesh", "View")),
    }
)

#: How a transfinite surface is cut into triangles.
ARRANGEMENTS = _words("Left Right Alternate AlternateLeft AlternateRight")

#: What a field of sizes is for: ``Background Field = 1;``.
FIELD_ROLES = frozenset({"Background", "BoundaryLayer"})

#: Functions whose value is a text.
TEXT_FUNCTIONS = _words("""
    Str StrCat StrChoice StrPrefix StrRelative StrReplace StrSub Sprintf UpperCase LowerCase
    LowerCaseIn NameToString N2S GetString GetForcedStr GetStringValue DefineString Today
    CurrentDirectory CurrentDir
    """)

#: Commands of one number; those of a file's name are in ``READS``.
COMMANDS = _words("Mesh SetOrder")

#: Commands that read a file.
READS = _words("Include Merge MergeFile MergeWithBoundingBox ShapeFromFile")

#: Names that a script has without defining them: the next free number of a part.
NUMBERS = _words("newp newl newc newll newcl news newsl newv newreg newf")

#: What describes a constant of ``DefineConstant``.
ATTRIBUTES = _words("""
    Name Label Help ShortHelp Min Max Step Range Choices Visible ReadOnly ReadOnlyRange Units
    Highlight AutoCheck Closed Kind MultipleSelection NeverChanged
    """)

#: Options whose numbers shape geometries and meshes.
OPTIONS = frozenset({"Mesh", "Geometry"})
#: Options of what Gmsh shows, which have no effect here: numbers and colours are passed over.
DISPLAY_OPTIONS = frozenset({"General", "View", "PostProcessing", "Print"})
#: Options of geometries and meshes without effect here, too: colours, and threads, of which Gmsh's
#: process has one.
WITHOUT_EFFECT = re.compile(r"Color|ColorTable|MaxNumThreads[123]D|OCCParallel")
#: Such numbers that a script may read.
READABLE_OPTION = re.compile(r"General\.(?:Min|Max)[XYZ]|PostProcessing\.NbViews")
#: Options that are a text, and may be set.
TEXT_OPTIONS = frozenset({"Geometry.OCCTargetUnit", "Geometry.PipeDefaultTrihedron"})

#: Fields of sizes that are computed, and neither read from a file nor asked of a program.
FIELDS = _words("""
    Attractor AttractorAnisoCurve Ball BoundaryLayer Box Constant Curvature Cylinder Distance Extend
    Frustum Gradient IntersectAniso Laplacian LonLat MathEval MathEvalAniso Max MaxEigenHessian Mean
    Min MinAniso Octree Param PostView Restrict Threshold
    """)
#: Options of these: numbers, lists of them and formulas; none names a file or a program.
FIELD_OPTIONS = _words("""
    AnisoMax Beta BetaLaw CropNegativeValues CurvesList Delta DistMax DistMin EdgesList
    ExcludedFaceList ExcludedSurfacesList F FX FY FZ FacesList FanNodesList FanPointsList
    FanPointsSizesList FieldX FieldY FieldZ FieldsList FromStereo IField IView InField
    IncludeBoundary IncludeEmbedded InnerR1 InnerR2 InnerV1 InnerV2 IntersectMetrics Kind LcMax
    LcMin M11 M12 M13 M22 M23 M33 NNodesByEdge NbLayers NodesList NumPointsPerCurve OuterR1
    OuterR2 OuterV1 OuterV2 PointsList Quads R1_inner R1_outer R2_inner R2_outer Radius
    RadiusStereo Ratio RegionsList Sampling Sigmoid Size SizeFar SizeMax SizeMaxNormal
    SizeMaxTangent SizeMin SizeMinNormal SizeMinTangent SizesList StopAtDistMax SurfacesList
    Thickness UseClosest V1_inner V1_outer V2_inner V2_outer VIn VOut VerticesList ViewIndex
    ViewTag VolumesList X1 X2 XAxis XCenter XMax XMin Y1 Y2 YAxis YCenter YMax YMin Z1 Z2 ZAxis
    ZCenter ZMax ZMin dMax dMin hfar hwall_n hwall_n_nodes lMaxNormal lMaxTangent lMinNormal
    lMinTangent m11 m12 m13 m22 m23 m33 ratio thickness
    """)

#: Kinds of values in a view: scalars, vectors or tensors on points, lines, triangles …
VIEW_ELEMENT = re.compile(r"[SVT][PLTQSHIY]2?|T2|T3|TIME|INTERPOLATION_SCHEME")


_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r\n\f]+|//[^\n]*|/\*.*?\*/)
    |(?P<word>[A-Za-z_][A-Za-z0-9_]*)
    |(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)
    |(?P<text>"[^"\x00-\x08\x0a-\x1f\x7f]*"|'[^'\x00-\x08\x0a-\x1f\x7f]*')
    |(?P<sign>\.\.\.|\+\+|--|[-+*/=!<>]=|<<|>>|&&|\|\||::|[-+*%^=<>!&|~\#?:;,.(){}\[\]]
        |/(?!\*))""",
    re.VERBOSE | re.DOTALL,
)
_OPENING = {"(": ")", "[": "]", "{": "}"}
_CLOSING = frozenset(_OPENING.values())
# Gmsh would take these for the end of what it skips, and go on with the rest of the word.
_MISREAD = re.compile(r"(?:EndIf|EndFor|ElseIf|Else|Return)(?![A-Za-z_])")
_FLOW = frozenset({"EndIf", "EndFor", "ElseIf", "Else", "Return"})
_MOST = 2**21  # words and signs of a script: half a minute, and 250 MB
_LONGEST = 1000  # of a text; Gmsh takes what is beyond 1023 characters for statements
# Gmsh looks for the end of what it skips by characters, and may pass over five of them.
_BEFORE_TEXT = 8 * " "


class ScriptError(Exception):
    """Raised with what is wrong with a script.

    Attributes:
        line: Where, counted from 1.
        is_forbidden: Whether Gmsh would do it, but a scene's geometry may not.
    """

    def __init__(self, line: int, message: str, is_forbidden: bool = False) -> None:
        super().__init__(message)
        self.line, self.is_forbidden = line, is_forbidden


class Token(NamedTuple):
    """A word, number, text (with its quotes) or sign.

    Attributes:
        kind: Which of these: ``word``, ``number``, ``text``, ``sign``.
        text: As it stands in the script.
        line: Counted from 1.
    """

    kind: str
    text: str
    line: int

    @property
    def content(self) -> str:
        """Content of a text between its quotes."""
        return self.text[1:-1]


def tokens_of(text: str) -> Iterator[Token]:
    """The words, numbers, texts and signs of a script, without blanks and comments.

    Raises:
        ScriptError: There is something else, or too much.
    """
    position, line, number = 0, 1, 0
    while position < len(text):
        found = _TOKEN.match(text, position)
        if found is None:
            raise ScriptError(line, _not_read(text, position))
        kind, word = str(found.lastgroup), found[0]
        if kind != "blank":
            if len(word) > _LONGEST:
                raise ScriptError(line, f"has a {kind} longer than {_LONGEST} characters")
            if kind == "word" and word not in _FLOW and _MISREAD.search(word):
                raise ScriptError(line, f"the name '{word}' ends as a word of Gmsh's; change it")
            number += 1
            if number > _MOST:
                raise ScriptError(line, f"has more than {_MOST} words, numbers and signs")
            yield Token(kind, word, line)
        line += word.count("\n")
        position = found.end()


def _not_read(text: str, position: int) -> str:
    if text[position] in "\"'":
        return "has a text with a control character, or that does not end on its line"
    if text.startswith("/*", position):
        return "has a comment that does not end"
    return f"has the character {text[position]!r}, which is no part of a geometry"


def statements_of(tokens: Sequence[Token]) -> Iterator[list[Token]]:
    """The statements of a script: up to a semicolon or the last brace, or the head of a block.

    Raises:
        ScriptError: One does not end, or Gmsh would not come back to its start.
    """
    start = 0
    while start < len(tokens):
        end = _end(tokens, start)
        statement = list(tokens[start:end])
        is_followed = end < len(tokens) and tokens[end].line == statement[-1].line
        if is_followed and _is_come_back_to(statement):
            word = statement[0].text
            raise ScriptError(tokens[end].line, f"must begin a new line after {word} …")
        yield statement
        start = end


def _end(tokens: Sequence[Token], start: int) -> int:
    """One past the last token of the statement that begins at ``start``."""
    first = tokens[start].text
    if first in ("Else", "EndIf", "EndFor", "Return"):
        return start + 1
    if first in ("Macro", "Function"):
        return min(start + 2, len(tokens))
    is_head = first in ("If", "ElseIf", "For")
    is_braced = first in BRACED or first in OF_SHAPES
    closing: list[str] = []
    for number in range(start, len(tokens)):
        token = tokens[number]
        sign = token.text if token.kind == "sign" else ""
        if sign in _OPENING:
            closing.append(_OPENING[sign])
        elif sign in _CLOSING:
            if not closing or closing.pop() != sign:
                raise ScriptError(token.line, f"has a '{sign}' too many")
            if closing:
                continue
            if is_head or (is_braced and sign == "}" and _is_last(tokens, number, first)):
                return number + 1
        elif sign == ";" and not closing:
            return number + 1
        elif sign == "=" and not closing:
            is_braced = False
    raise ScriptError(tokens[start].line, f"the statement '{first}' does not end")


def _is_last(tokens: Sequence[Token], number: int, first: str) -> bool:
    """Whether a statement without a semicolon ends with this brace."""
    if number + 1 == len(tokens):
        return True
    following = tokens[number + 1]
    if following.kind != "word":
        return following.kind == "text"
    if following.text == "Using":
        return first != "Extrude"
    return not (first == "Intersect" and following.text == "Surface")


def _is_come_back_to(statement: Sequence[Token]) -> bool:
    """Whether Gmsh goes on at the line after it, in a loop or after a macro."""
    return statement[0].text in ("For", "Macro", "Function", "Call")


def written(statements: Sequence[Sequence[Token]]) -> str:
    """A script of these statements, each begun on its line where there is room."""
    lines: list[str] = []
    for statement in statements:
        parts = [_BEFORE_TEXT + t.text if t.kind == "text" else t.text for t in statement]
        line = " ".join(parts)
        missing = statement[0].line - 1 - len(lines)
        if missing >= 0:
            lines += [""] * missing + [line]
        else:
            lines[-1] += f" {line}"
    return "\n".join(lines) + "\n"
