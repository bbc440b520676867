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
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.spaces import Spaces
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.refinement import halved
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
