"""Each format of another program gives the body that it describes, and runs solve on it."""

from functools import cache

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, MeshSource, Point, Scene, Support, run
from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.test_loading import area, refusal, with_gmsh, write
from tests.messages import says

COMM = MPI.COMM_WORLD
DIMENSION = {"triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 3}
TYPES = [
    *(("triangle", 1, kind) for kind in ("CPS3", "cpe3", "CAX3", "S3R")),
    *(("quadrilateral", 1, kind) for kind in ("CPS4", "CPE4R", "CPE4RH", "CPEG4", "CAX4", "S4R")),
    *(("triangle", 2, kind) for kind in ("CPS6", "CPE6M", "STRI65")),
    *(("quadrilateral", 2, kind) for kind in ("CPS8", "CPE8R", "CAX8R", "S8R5")),
    *(("tetrahedron", 1, kind) for kind in ("C3D4", "C3D4H")),
    *(("tetrahedron", 2, kind) for kind in ("C3D10", "C3D10MH")),
    *(("hexahedron", 1, kind) for kind in ("C3D8", "C3D8R", "C3D8I")),
    *(("hexahedron", 2, kind) for kind in ("C3D20", "C3D20RH")),
]
MESHIO = {
    ("triangle", 1): ("triangle", "line"),
    ("quadrilateral", 1): ("quad", "line"),
    ("tetrahedron", 1): ("tetra", "triangle"),
    ("hexahedron", 1): ("hexahedron", "quad"),
    ("triangle", 2): ("triangle6", ""),
    ("quadrilateral", 2): ("quad8", ""),
    ("tetrahedron", 2): ("tetra10", ""),
    ("hexahedron", 2): ("hexahedron20", ""),
}
# The length of y = 0.2 x (2 - x) from 0 to 2.
_AT, _WEIGHTS = np.polynomial.legendre.leggauss(40)
ARC = _WEIGHTS @ np.sqrt(1 + (0.4 * _AT) ** 2)


def volume(body):
    return COMM.allreduce(
        fem.assemble_scalar(fem.form(fem.Constant(body.mesh, 1.0) * ufl.dx(body.mesh)))
    )


def of_cells(body, name):
    return COMM.allreduce(
        len(
            [
                cell
                for cell in body.entities(body.groups[name])
                if cell < body.mesh.topology.index_map(body.dimension).size_local
            ]
        )
    )


@cache
def reads_med():
    """Whether Gmsh was built with MED: Debian's was not."""
    found = []
    with_gmsh(lambda gmsh: found.append(gmsh.option.getString("General.BuildOptions").split()))
    return COMM.bcast(found and "Med" in found[0])


def need_med(name):
    if name.endswith(".med") and not reads_med():
        pytest.skip("Gmsh was built without MED")


def test_a_gmsh_without_med_is_said(folder):
    source = with_meshio(folder, "b.med", Block("triangle"), 1)
    if reads_med():
        assert load_body(source, 2, COMM).dimension == 2
    else:
        says("gmsh_without_med", refusal(source))


def with_meshio(folder, name, block, order, **options):
    """A file by meshio, with facets as cell data: 1 for the body, 2, 3, 4 for its sides."""
    path = folder / name
    if COMM.rank == 0:
        import meshio

        cell, facet = MESHIO[block.cell, order]
        blocks, values = [(cell, block.cells)], [np.ones(len(block.cells), dtype=np.int32)]
        up = block.dimension - 1
        if facet:
            sides = [block.facets(*at) for at in ((up, 0), (up, 1), (0, 0))]
            blocks.append((facet, np.concatenate(sides)))
            numbers = np.repeat([2, 3, 4], [len(side) for side in sides])
            values.append(numbers.astype(np.int32))
        if name.endswith(".med"):
            data = {"cell_tags": [-value for value in values]}
            mesh = meshio.Mesh(block.points, blocks, cell_data=data)
            tags = np.zeros(len(block.points), dtype=int)
            tags[block.nodes(up - 1, 0)] = 1
            mesh.point_data["point_tags"] = tags
            mesh.point_tags = {1: ["n_back"]}
            mesh.cell_tags = {-1: ["block"], -2: ["bottom"], -3: ["top"], -4: ["left", "more"]}
        else:
            mesh = meshio.Mesh(block.points, blocks, cell_data={"part": values})
        mesh.write(path, **options)
    COMM.barrier()
    return MeshSource(str(path))


@pytest.mark.parametrize(("cell", "order", "kind"), TYPES)
def test_abaqus_types(folder, cell, order, kind):
    block = Block(cell, order, curved=order == 2)
    surfaces = not kind.startswith("S")  # the sides of shells are their faces
    text = inp(block, kind, surfaces=surfaces)
    body = load_body(write(folder, text, "b.inp"), DIMENSION[cell], COMM)
    assert body.mesh.topology.cell_name() == cell
    assert body.mesh.topology.index_map(body.dimension).size_global == len(block.cells)
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == order
    # the bent block is as large as the straight one, with curved cells only
    assert volume(body) == pytest.approx(2, rel=1e-13)
    wanted = {"BLOCK", "Nall", "body", "n_bottom", "n_top", "n_left", "n_back"}
    assert set(body.groups) == wanted | ({"bottom", "top", "left"} if surfaces else set())
    long = ARC if body.dimension == 2 and order == 2 else 2
    for first in ("n_", "") if surfaces else ("n_",):
        found = [area(body, f"{first}{name}") for name in ("bottom", "top", "left")]
        assert found == pytest.approx([long, long, 1], rel=1e-5)


@pytest.mark.parametrize(
    ("cell", "order", "card", "facet"),
    [
        ("triangle", 1, "CTRIA3", "CROD"),
        ("quadrilateral", 1, "CQUAD4", "CBAR"),
        ("tetrahedron", 1, "CTETRA", "CTRIA3"),
        ("hexahedron", 1, "CHEXA", "CQUAD4"),
        ("triangle", 2, "CTRIA6", ""),
        ("quadrilateral", 2, "CQUAD8", ""),
        ("tetrahedron", 2, "CTETRA", ""),
        ("hexahedron", 2, "CHEXA", ""),
    ],
)
def test_nastran_cards(folder, cell, order, card, facet):
    block = Block(cell, order, curved=order == 2)
    body = load_body(write(folder, bdf(block, card, facet), "b.bdf"), DIMENSION[cell], COMM)
    assert volume(body) == pytest.approx(2, rel=1e-8)  # its numbers have 10 digits
    assert body.mesh.topology.cell_name() == cell
    assert of_cells(body, "7") == len(block.cells)
    if facet:
        assert [area(body, name) for name in ("21", "22", "23")] == pytest.approx([2, 2, 1])


@pytest.mark.parametrize(("cell", "order"), MESHIO)
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("b.med", {}),
        ("b.vtu", {"binary": False}),
        ("b.vtu", {"binary": True, "compression": "zlib"}),
        ("b.vtu", {"binary": True, "compression": None}),
        ("b.xdmf", {"data_format": "XML"}),
        ("b.xdmf", {"data_format": "HDF"}),
    ],
)
def test_files_of_libraries(folder, cell, order, name, options):
    block = Block(cell, order, curved=order == 2)
    if name == "b.xdmf" and order == 1 and options["data_format"] == "XML":
        pytest.skip("meshio writes no mixed cells but as HDF")
    need_med(name)
    source = with_meshio(folder, name, block, order, **options)
    body = load_body(source, block.dimension, COMM)
    assert volume(body) == pytest.approx(2, rel=1e-13)
    assert body.mesh.topology.cell_name() == cell
    names = (
        ("block", "bottom", "top", "left")
        if name == "b.med"
        else [f"part.{n}" for n in range(1, 5)]
    )
    assert of_cells(body, names[0]) == len(block.cells)
    if order == 1:
        assert [area(body, n) for n in names[1:]] == pytest.approx([2, 2, 1], rel=1e-13)
    if name == "b.med":
        along = ARC if order == 2 else 2
        across = 1 if block.dimension == 2 else along
        assert area(body, "n_back") == pytest.approx(across, rel=1e-5)


@pytest.mark.parametrize("recombine", [False, True])
@pytest.mark.parametrize("incomplete", [0, 1])
@pytest.mark.parametrize("order", [1, 2])
def test_med_of_gmsh_is_its_msh(folder, recombine, incomplete, order):
    """With the format's own library, of nodes in its own order; the cylinder's cells are curved."""
    need_med("c.med")

    def save(gmsh):
        disk = gmsh.model.occ.addDisk(0, 0, 0, 1, 1)
        gmsh.model.occ.extrude([(2, disk)], 0, 0, 1, numElements=[2], recombine=recombine)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [1], name="cylinder")
        gmsh.model.addPhysicalGroup(2, [1], name="foot")
        gmsh.model.addPhysicalGroup(2, [1, 2], name="foot and side")
        gmsh.option.setNumber("Mesh.RecombineAll", recombine)
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", int(recombine))
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.option.setNumber("Mesh.ElementOrder", order)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
        gmsh.model.mesh.generate(3)
        for suffix in ("msh", "med"):
            gmsh.write(str(folder / f"c.{suffix}"))

    with_gmsh(save)
    bodies = [
        load_body(MeshSource(str(folder / f"c.{suffix}")), 3, COMM) for suffix in ("msh", "med")
    ]
    assert [set(body.groups) - {"body"} for body in bodies] == 2 * [
        {"cylinder", "foot", "foot and side"}
    ]
    assert volume(bodies[1]) == pytest.approx(volume(bodies[0]), rel=1e-12)
    for name in ("foot", "foot and side"):
        assert area(bodies[1], name) == pytest.approx(area(bodies[0], name), rel=1e-12)
    assert volume(bodies[1]) == pytest.approx(np.pi, rel=0.15 if order == 1 else 0.005)


def as_file(folder, name, cell):
    """A block and the names of its groups at the bottom, the top and the left."""
    block = Block(cell)
    if name == "b.inp":
        kinds = {"quadrilateral": "CPE4", "tetrahedron": "C3D4", "hexahedron": "C3D8"}
        return write(folder, inp(block, kinds[cell]), name), ("bottom", "n_top", "left")
    if name == "b.bdf":
        cards = {
            "quadrilateral": ("CQUAD4", "CBAR"),
            "tetrahedron": ("CTETRA", "CTRIA3"),
            "hexahedron": ("CHEXA", "CQUAD4"),
        }
        return write(folder, bdf(block, *cards[cell]), name), ("21", "22", "23")
    names = ("bottom", "top", "left") if name == "b.med" else ("part.2", "part.3", "part.4")
    return with_meshio(folder, name, block, 1), names


@pytest.mark.parametrize("cell", ["quadrilateral", "tetrahedron", "hexahedron"])
@pytest.mark.parametrize("name", ["b.inp", "b.bdf", "b.med", "b.vtu", "b.xdmf"])
def test_uniaxial_compression_is_exact(folder, name, cell):
    """Pressed onto the floor without friction: p everywhere, and the top sinks by p h / E′."""
    need_med(name)
    source, (bottom, top, left) = as_file(folder, name, cell)
    flat = cell == "quadrilateral"
    young, poisson, pressure = 1000.0, 0.3, 10.0
    held = [Support(left, {"x": 0})]
    if not flat:  # against the one motion that is left
        held.append(Support(left, {"y": 0}))
    scene = Scene(
        kinematics="plane strain" if flat else "3D",
        mesh=source,
        material=Material(young, 0.0 if not flat else poisson),
        support=tuple(held),
        load=(Load(top, pressure=pressure),),
        contact=(Contact(bottom, contact="unilateral"),),
        point=(Point("corner", (2, 1) if flat else (2, 1, 1)),),
    )
    result = run(scene, COMM)
    assert result.passed, result.verdict
    assert result.quantities["max_contact_pressure"] == pytest.approx(pressure, rel=1e-6)
    moved = result.quantities["displacement_corner"]
    stiffness = young / (1 - poisson**2) if flat else young
    assert moved[-1] == pytest.approx(-pressure / stiffness, rel=1e-3)
