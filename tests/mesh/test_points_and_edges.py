"""Points, and edges in space, as groups by name: supports that hold rigid motions by them."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Load,
    Material,
    MeshSource,
    Point,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.spaces import Spaces
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.refinement import halved
from tests.cad import write_shapes
from tests.mesh.readers.test_formats import need_med
from tests.mesh.test_loading import with_gmsh, write
from tests.messages import refused

COMM = MPI.COMM_WORLD
BLOCK = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 2, 1, 1};
MeshSize{:} = 0.7;
Physical Volume("block") = {1};
Physical Surface("left") = {1};
Physical Surface("right") = {2};
Physical Point("origin") = {1};
Physical Point("along_y") = {3};
Physical Point("along_x") = {5};
Physical Curve("upright") = {1};
"""
# Gmsh's numbers of corners: 1 is (0, 0, 1), 3 is (0, 1, 1) and 5 is (2, 0, 1); edge 1 is along z.
THREE_TWO_ONE = (
    Support("origin", {"x": 0, "y": 0, "z": 0}),
    Support("along_x", {"y": 0, "z": 0}),
    Support("along_y", {"z": 0}),
)
PULL = (Load("left", pressure=-10.0), Load("right", pressure=-10.0))


def scene(source, support=THREE_TWO_ONE, load=PULL, solver="auto", **more):
    given = {
        "kinematics": "3D",
        "mesh": source,
        "material": Material(1000, 0.3),
        "support": support,
        "load": load,
        "solver": SolverSettings(solver=solver, errors="none"),
    }
    return Scene(**given | more)


@pytest.fixture
def block(folder):
    return write(folder, BLOCK)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_three_points_hold_a_block_and_take_no_force(block, solver):
    """It is stretched evenly, by p V p/2E; the far corner moves by p L/E along the pull."""
    found = run(scene(block, solver=solver))
    assert found.passed, found.verdict
    assert found.quantities["strain_energy"] == pytest.approx(10**2 * 2 / 2000, rel=1e-9)
    moved = {one.name: one.displacement for one in found.supports}
    assert moved["along_x"][1:] == pytest.approx([0, 0], abs=1e-14)
    for one in found.supports:
        assert one.reaction == pytest.approx(np.zeros(3), abs=1e-7)


def test_points_beyond_what_holds_take_forces_and_fail_their_check(block):
    both = Support("along_x", {"x": 0, "y": 0, "z": 0})
    found = run(scene(block, (THREE_TWO_ONE[0], both, THREE_TWO_ONE[2])))
    assert found.exit_code == 4
    failed = [name for name, check in found.checks.items() if not check.passed]
    assert failed == ["point_support"]


def test_an_edge_in_space_holds_what_turns_about_it(block):
    """The block may turn about the edge alone, which a point holds."""
    along = Support("along_x", {"y": 0})
    found = run(scene(block, (Support("upright", {"x": 0, "y": 0}), along, THREE_TWO_ONE[2])))
    assert found.passed, found.verdict
    assert found.quantities["strain_energy"] == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize("order", [1, 2])
def test_nodes_are_those_at_the_places(block, order):
    """Of the edge, the middles of its cells' edges, too; also once these are halved."""
    body = load_body(replace(block, order=order), 3, COMM)
    for one in [body, halved(body)] if order == 1 else [body]:
        spaces = Spaces(BodyDescription.of(scene(block)), one)
        places = spaces.coordinates
        at = {"origin": (0, 0, 1), "along_x": (2, 0, 1), "along_y": (0, 1, 1)}
        for name, place in at.items():
            here = np.flatnonzero(np.linalg.norm(places - place, axis=1) < 1e-9)
            assert np.array_equal(spaces.nodes(one.group(name, "on")), here)
        upright = np.flatnonzero(np.linalg.norm(places[:, :2], axis=1) < 1e-9)
        assert np.array_equal(spaces.nodes(one.group("upright", "on")), upright)
        own = COMM.allreduce(int((upright < spaces.owned_nodes).sum()))
        assert own >= 5


def test_a_saved_mesh_has_its_points(block, folder):
    """In both versions of Gmsh's files; the points of one of several meshes have its name first."""
    for version in (2.2, 4.1):
        path = folder / f"block{version}.msh"

        def save(gmsh, path=path, version=version):
            gmsh.open(block.file)
            gmsh.model.mesh.generate(3)
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.write(str(path))

        with_gmsh(save)
        assert run(scene(MeshSource(str(path)))).passed
    aside = write(folder, BLOCK.replace("{0, 0, 0,", "{5, 0, 0,"), "aside.geo")
    two = (MeshSource(str(path), name="a"), replace(aside, name="b"))
    assert load_body(two, 3, COMM).group("b.origin", "on").places == (((5, 0, 1), (5, 0, 1)),)


def test_points_of_a_plane_model(folder):
    flat = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 2, 1};
Physical Surface("plate") = {1};
Physical Curve("left") = {4};
Physical Curve("right") = {2};
Physical Point("foot") = {1};
Physical Point("slide") = {2};
"""
    held = (Support("foot", {"x": 0, "y": 0}), Support("slide", {"y": 0}))
    made = scene(write(folder, flat), held, kinematics="plane stress", thickness=2.0)
    found = run(made)
    assert found.passed, found.verdict
    assert found.quantities["strain_energy"] == pytest.approx(10**2 * 2 * 2 / 2000, rel=1e-9)


@pytest.mark.errors
def test_finer_meshes_have_them_too(block):
    ends = tuple(Load(on, pressure=lambda x: -10 * x[2] ** 2) for on in ("left", "right"))
    asked = scene(block, load=ends, accuracy=Accuracy(strain_energy=0.01, max_levels=3))
    found = run(replace(asked, solver=SolverSettings()))
    assert found.passed, found.verdict
    assert found.errors["strain_energy"]["total"] < 0.02 * found.quantities["strain_energy"]


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"load": (Load("origin", force=(1.0, 0, 0)),)}, "load_on_a_point"),
        ({"support": (Support("upright", {}, stiffness=10.0),)}, "springs_on_an_edge"),
    ],
)
def test_what_needs_an_area_is_refused(block, change, name):
    with refused(name):
        run(replace(scene(block), **change))


def test_points_and_edges_of_geometries_have_numbers(block):
    """Those that Gmsh shows; the same as by name."""
    body = load_body((block,), 3, COMM)
    for name, number in (("origin", "point 1"), ("along_x", "point 5"), ("upright", "edge 1")):
        assert set(body.group(number, "on").places) == set(body.group(name, "on").places)
    held = (
        Support("point 1", {"x": 0, "y": 0, "z": 0}),
        Support("point 5", {"y": 0, "z": 0}),
        Support("point 3", {"z": 0}),
    )
    points = Point("end", on="along_x"), Point("start", on="point 1"), Point("up", (0, 0, 1))
    found = run(scene(block, held, point=points))
    assert found.passed, found.verdict
    assert found.quantities["displacement_end"] == pytest.approx([0.02, 0, 0], abs=1e-12)
    assert found.quantities["displacement_start"] == found.quantities["displacement_up"]
    with refused("point_on_an_edge"):
        run(scene(block, held, point=(Point("end", on="upright"),)))
    with refused("no_such_point"):
        body.group("point 9", "support[0].on")
    with refused("no_such_edge_or_group"):
        body.group("nothing", "support[0].on")


def test_a_point_is_by_its_place_or_by_its_name():
    for given in ({}, {"at": (0, 0), "on": "origin"}):
        with refused("point_by_place_or_name"):
            Point("end", **given)


def test_a_name_of_points_and_of_a_face(folder):
    source = write(folder, BLOCK.replace('"origin"', '"left"'))
    body = load_body((source,), 3, COMM)
    assert body.group("left", "on").dimension == 2
    assert body.group("left.points", "on").places == (((0, 0, 1), (0, 0, 1)),)


NODES = """*NODE
1, 0, 0, 0
2, 2, 0, 0
3, 2, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 2, 0, 1
7, 2, 1, 1
8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=block
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=T3D2, ELSET=wire
7, 4, 8
*SURFACE, NAME=left
1, S6
*SURFACE, NAME=right
1, S4
*NSET, NSET=origin
1
*NSET, NSET=along_x
2
*NSET, NSET=along_y
4
*NSET, NSET=upright
1, 5
*NSET, NSET=left
1
*NSET, NSET=apart
2, 4
"""


@pytest.fixture
def deck(folder):
    if COMM.rank == 0:
        (folder / "block.inp").write_text(NODES)
    COMM.barrier()
    return MeshSource(str(folder / "block.inp"))


def places(body, name):
    return {place for piece in body.group(name, "on").places for place in piece}


def test_sets_of_few_nodes_are_points_or_edges(deck):
    """On several ranks most have none of the only cell."""
    found = run(scene(deck))
    assert found.passed, found.verdict
    assert found.quantities["strain_energy"] == pytest.approx(10**2 * 2 / 2000, rel=1e-9)
    body = load_body((deck,), 3, COMM)
    assert places(body, "upright") == {(0, 0, 0), (0, 0, 1)}
    assert places(body, "apart") == {(2, 0, 0), (0, 1, 0)}
    assert places(body, "wire") == {(0, 1, 0), (0, 1, 1)}
    dimensions = {"origin": 0, "apart": 0, "upright": 1, "wire": 1, "left": 2, "left.nodes": 0}
    for name, dimension in dimensions.items():
        assert body.group(name, "on").dimension == dimension, name
    space = Spaces(BodyDescription.of(scene(deck)), body)
    owned = COMM.allreduce(
        int((space.nodes(body.group("upright", "on")) < space.owned_nodes).sum())
    )
    assert owned == 3  # of degree 2: the middle of the edge, too
    with refused("no_set_of_that_name"):
        body.group("uprights", "support[0].on")


def test_points_and_edges_of_med(block, folder):
    need_med("block.med")

    def save(gmsh):
        gmsh.open(block.file)
        gmsh.model.mesh.generate(3)
        gmsh.write(str(folder / "block.med"))

    with_gmsh(save)
    source = MeshSource(str(folder / "block.med"))
    found = run(scene(source))
    assert found.passed, found.verdict
    body, drawn = (load_body((one,), 3, COMM) for one in (source, block))
    assert body.group("upright", "on").dimension == 1
    for name in ("origin", "along_x", "along_y", "upright"):
        ours, theirs = (np.array(sorted(places(one, name))) for one in (body, drawn))
        assert ours == pytest.approx(theirs, abs=1e-9), name


def test_points_and_edges_of_step_have_numbers(folder):
    """Three corners hold the part, one of which is on an edge that turns about itself."""

    source = MeshSource(
        write_shapes(folder / "block.step", lambda occ: occ.addBox(0, 0, 0, 2, 1, 1)), size=0.7
    )
    body = load_body((source,), 3, COMM)
    corners = {number: group for number, group in body.numbers.items() if "point" in number}
    assert len(corners) == 8
    at = {tuple(np.round(group.places[0][0], 9)): number for number, group in corners.items()}
    held = (
        Support(at[0, 0, 0], {"x": 0, "y": 0, "z": 0}),
        Support(at[2, 0, 0], {"y": 0, "z": 0}),
        Support(at[0, 1, 0], {"z": 0}),
    )
    sides = {
        tuple(np.round(group.centre, 6)): number
        for number, group in body.numbers.items()
        if number.isdigit()
    }
    pull = tuple(Load(sides[x, 0.5, 0.5], pressure=-10.0) for x in (0, 2))
    found = run(scene(source, held, pull))
    assert found.passed, found.verdict
    assert found.quantities["strain_energy"] == pytest.approx(0.1, rel=1e-9)
    edges = [group for number, group in body.numbers.items() if "edge" in number]
    assert len(edges) == 12
