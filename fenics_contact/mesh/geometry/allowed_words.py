"""The words of Gmsh's geometry scripts that make geometries and meshes, and no others.

From Gmsh's grammar (``Gmsh.l`` and ``Gmsh.y``, version 4.15) and its reference manual. What is not
in these lists is refused (``geometry_script``): also what a later version of Gmsh adds.
"""

from __future__ import annotations

import re


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
