"""The same numbers on any number of ranks: each rank alone against all together."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI
from scipy.spatial import cKDTree

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import (
    from_root,
    gather_rows,
    largest,
    of_every_rank,
    on_root,
    raise_together,
    smallest,
    total,
)
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import PULLED_BLOCK, ROOT, box_body, slab

COMM = MPI.COMM_WORLD


def assert_same(alone, together):
    pairs = zip(alone.contacts, together.contacts, strict=True)
    of_contacts = [(one["quantities"], other["quantities"]) for one, other in pairs]
    for one, other in [(alone.quantities, together.quantities), *of_contacts]:
        assert [key for key in one if one[key] is None] == [k for k in other if other[k] is None]
        for key in (key for key in one if one[key] is not None):
            digits = 1e-8 if key == "max_contact_pressure" else 1e-9  # see below
            assert other[key] == pytest.approx(one[key], rel=digits, abs=1e-9), key
    for name in ("coordinates", "normals", "friction_traction", "slip", "weights"):
        first, second = getattr(alone.points, name), getattr(together.points, name)
        assert np.abs(first - second).max() <= 1e-9 * max(1.0, np.abs(first).max()), name
    first, second = alone.points.contact_pressure, together.points.contact_pressure
    # Depths are small differences of displacements: some digits of them are round-off.
    assert np.abs(first - second).max() <= 1e-8 * max(1.0, first.max())
    assert (alone.points.status == together.points.status).all()
    assert set(alone.checks) == set(together.checks)
    assert together.passed


@pytest.mark.parametrize(
    "scene",
    [
        slab(300, cells=(32, 4)),
        slab(700, cells=(32, 4), cell="triangle", degree=1),
        slab(300, cells=(32, 4), cell="triangle", order=2, pressure=lambda x: 100 + 25 * x[0]),
        slab(719.99, cells=(16, 2), held=False),
    ],
    ids=["Q2", "P1", "P2 curved, varying pressure", "held by friction"],
)
def test_slab_alone_and_together(scene):
    assert_same(run(scene, MPI.COMM_SELF), run(scene, COMM))


TWO_BODIES = Scene(
    kinematics="plane strain",
    material=(Material(1000, 0.3, on="upper"), Material(300, 0.2, on="lower")),
    support=(Support("lower.y0", {"x": 0, "y": 0}),),
    load=(Load("upper.y1", traction=(0.2, -1)),),
    contact=(Contact("upper.y0", against="lower.y1", friction_coefficient=0.5),),
)
BLOCKS = (Box("lower", (0, -1), (1, 0), (6, 5)), Box("upper", (0.1, 0), (0.9, 1), (4, 3)))
SOLIDS = (
    Box("lower", (0, 0, -1), (1, 1, 0), (3, 2, 2)),
    Box("upper", (0, 0, 0.01), (1, 1, 1), (2, 3, 2)),
)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_two_bodies_alone_and_together(solver):
    """A block that only contact holds, wherever its cells and those below it are."""
    scene = dataclasses.replace(TWO_BODIES, solver=SolverSettings(solver=solver))
    alone = run(scene, MPI.COMM_SELF, boxes(BLOCKS, comm=MPI.COMM_SELF))
    assert_same(alone, run(scene, COMM, boxes(BLOCKS)))


@pytest.mark.parametrize("solver", ["condensed", "iterative"])
def test_two_solids_alone_and_together(solver):
    motion = {"x": 0.004, "y": 0.001, "z": -0.03}
    scene = dataclasses.replace(
        TWO_BODIES,
        kinematics="3D",
        support=(Support("lower.z0", {"x": 0, "y": 0, "z": 0}), Support("upper.z1", motion)),
        load=(),
        contact=(Contact("upper.z0", against="lower.z1", friction_coefficient=0.2),),
        solver=SolverSettings(solver=solver, tolerance=1e-12),
    )
    alone = run(scene, MPI.COMM_SELF, boxes(SOLIDS, "tetrahedron", MPI.COMM_SELF))
    assert_same(alone, run(scene, COMM, boxes(SOLIDS, "tetrahedron")))


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("cell", [CellType.hexahedron, CellType.tetrahedron])
def test_areas_alone_and_together(cell, degree):
    """Facets are cut into pieces the same way, however ranks number their corners."""
    obstacle = Obstacle(
        "paraboloid",
        radius=2,
        position=(0.46, 0.57, 0.5),
        indentation=0.02,
        displacement=(3e-3, 0, 0),
    )
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=obstacle, friction_coefficient=0.2),),
    )
    cells = (6, 5, 3) if cell == CellType.hexahedron else (4, 5, 2)
    alone = run(scene, MPI.COMM_SELF, box_body(cells, cell=cell, comm=MPI.COMM_SELF))
    together = run(scene, COMM, box_body(cells, cell=cell))
    for key in ("contact_area", "stick_area"):
        assert together.quantities[key] == pytest.approx(alone.quantities[key], rel=1e-9), key


def pads():
    """A strip with a rough pad at its right end only, and a second, smooth one."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("x1", traction=(20, 0)),),
        contact=(
            Contact("rough", pressure=50, friction_coefficient=0.3),
            Contact("smooth", pressure=10),
        ),
    )
    patches = {
        "rough": ("y1", lambda x: x[0] > 7.5),
        "smooth": ("y1", lambda x: x[0] < 0.5),
    }
    return scene, lambda comm: box_body((64, 4), (8, 0.5), comm=comm, patches=patches)


def test_contact_that_misses_a_rank():
    scene, body = pads()
    prepared = Run(scene, COMM, body(COMM))
    facets = prepared.problem.body.boundary("rough", "contact[0].on")
    local = len(prepared.problem.body.entities(facets))
    fewest = COMM.allreduce(local, op=MPI.MIN)
    assert COMM.size == 1 or fewest == 0, "the partition no longer leaves a rank without contact"
    together = prepared.solve()
    assert_same(run(scene, MPI.COMM_SELF, body(MPI.COMM_SELF)), together)
    assert together.quantities["slip_area"] > 0


def balls():
    """Two obstacles on one face, the first at its right end only; one driven by a force."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "right",
                obstacle=Obstacle("parabola", radius=0.5, position=(7.6, 0.5), force=5),
            ),
            Contact(
                "middle",
                obstacle=Obstacle("cylinder", radius=2, position=(4, 0.5), indentation=0.01),
            ),
        ),
    )
    patches = {
        "right": ("y1", lambda x: x[0] > 7.3),
        "middle": ("y1", lambda x: (x[0] > 3.5) & (x[0] < 4.5)),
    }
    return scene, lambda comm: box_body((128, 8), (8, 0.5), comm=comm, patches=patches)


def test_obstacle_that_misses_a_rank():
    """The force's unknown lives on a rank that has nothing of its contact, or its neighbour."""
    scene, body = balls()
    prepared = Run(scene, COMM, body(COMM))
    contact = prepared.problem.contacts[0]
    fewest = COMM.allreduce(len(contact.nodes), op=MPI.MIN)
    assert COMM.size == 1 or fewest == 0, "the partition no longer leaves a rank without contact"
    together = prepared.solve()
    assert_same(run(scene, MPI.COMM_SELF, body(MPI.COMM_SELF)), together)
    assert together.contacts[0]["quantities"]["normal_force"] == pytest.approx(5, rel=1e-9)
    assert "indentation" not in together.quantities  # two obstacles have two


@pytest.mark.parametrize(
    "obstacle",
    [
        Obstacle("paraboloid", radius=8, indentation=1),
        Obstacle("sphere", radius=8, position=(0, 3), force=2000),
        Obstacle("flat punch", radius=2, indentation=0.1),
    ],
    ids=["indentation", "force", "edge"],
)
@pytest.mark.parametrize("poissons_ratio", [0.3, 0.499])
def test_half_space_alone_and_together(obstacle, poissons_ratio):
    """Scalar unknowns beside displacements and mean stresses, on any number of ranks."""
    scene = Scene(
        kinematics="axisymmetric",
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell="quadrilateral",
            parameters={"fine": 4, "size": 0.5, "extent": 40, "cells_outside": 10},
        ),
        material=Material(1000, poissons_ratio),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", obstacle=obstacle),),
    )
    assert_same(run(scene, MPI.COMM_SELF), run(scene, COMM))


@pytest.mark.parametrize("poissons_ratio", [0.3, 0.49])
def test_sheared_half_space_alone_and_together(poissons_ratio):
    """Resultants along the surface, beside the position of an obstacle that a force drives."""
    obstacle = Obstacle(
        "paraboloid", radius=2, position=(1, 0, 1), force=6, displacement=(0.004, 0, 0)
    )
    scene = Scene(
        kinematics="3D",
        material=Material(1000, poissons_ratio),
        symmetry=("y0",),
        half_space=HalfSpace(("x0", "x1", "y1", "z0")),
        contact=(Contact("patch", obstacle=obstacle, friction_coefficient=0.4),),
    )

    def solved(comm):
        near = {"patch": ("z1", lambda x: (np.abs(x[0] - 1) < 0.5) & (x[1] < 0.5))}
        return run(scene, comm, box_body((8, 4, 4), (2, 1, 1), comm=comm, patches=near))

    alone = solved(MPI.COMM_SELF)
    assert abs(alone.quantities["friction_force"][0]) > 0.1
    assert_same(alone, solved(COMM))


def test_block_alone_and_together():
    alone = run(PULLED_BLOCK, MPI.COMM_SELF, box_body((4, 4, 2), comm=MPI.COMM_SELF))
    together = run(PULLED_BLOCK, COMM, box_body((4, 4, 2)))
    assert_same(alone, together)
    slipping = alone.points.status == "SLIP"
    assert slipping.any() and not slipping.all()
    traction, slip = alone.points.friction_traction[slipping], alone.points.slip[slipping]
    opposite = -10 * slip / np.linalg.norm(slip, axis=1)[:, None]
    assert traction == pytest.approx(opposite, abs=1e-6)


def test_one_cell_for_all_ranks(folder):
    """Ranks without any cell take part in everything, files and pictures' fields included."""
    scene = slab(300, cells=(1, 1))
    prepared = Run(scene, COMM)
    result = prepared.solve()
    assert result.passed
    files.write(prepared, result, folder)
    assert (folder / "fields.pvd").exists()
    assert_same(run(scene, MPI.COMM_SELF), result)


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
def test_one_cell_under_an_obstacle_for_all_ranks(solver, folder):
    """A cube of side 1 that is pressed by 1 %: F = E/100 without lateral strain, and its bars."""
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.0),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=Obstacle("plane", position=(0, 0, 1), indentation=0.01)),),
        solver=SolverSettings(solver=solver, errors="all"),
    )
    prepared = Run(scene, COMM, box_body((1, 1, 1), (1, 1, 1)))
    result = prepared.solve()
    files.write(prepared, result, folder)
    assert result.quantities["normal_force"] == pytest.approx(10, rel=1e-3)
    assert_same(
        run(scene, MPI.COMM_SELF, box_body((1, 1, 1), (1, 1, 1), comm=MPI.COMM_SELF)), result
    )


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("degree", [1, 2])
def test_fields_read_back_are_those_of_every_rank(cell, degree, folder):
    """Every cell once, with the solution's values at its nodes and the body's volume."""
    pytest.importorskip("pyvista")
    scene = dataclasses.replace(PULLED_BLOCK, discretisation=Discretisation(degree))
    prepared = Run(scene, COMM, box_body((3, 3, 2), cell=getattr(CellType, cell)))
    files.write(prepared, prepared.solve(), folder)
    spaces, owned = prepared.problem.spaces, slice(0, prepared.problem.spaces.owned_nodes)
    found = prepared.solution.displacement[owned]
    rows = gather_rows(COMM, np.hstack([spaces.coordinates[owned], found]))

    def read():
        import pyvista

        body = pyvista.get_reader(str(folder / "fields.pvd")).read().combine()
        nearest = cKDTree(rows[:, :3]).query(body.points)[1]
        assert np.abs(body.points - rows[nearest, :3]).max() < 1e-12
        assert np.abs(body["displacement"] - rows[nearest, 3:]).max() == 0
        assert len(np.unique(nearest)) == len(rows)
        return body.n_cells, body.compute_cell_sizes()["Volume"].sum()

    count, volume = on_root(COMM, read)
    assert count == prepared.model["cells"]
    assert volume == pytest.approx(0.5)


def test_reductions_over_ranks_that_hold_nothing():
    mine = np.array([3.0 + COMM.rank]) if COMM.rank == COMM.size - 1 else np.zeros(0)
    assert largest(COMM, mine) == 2.0 + COMM.size
    assert smallest(COMM, mine) == 2.0 + COMM.size
    assert largest(COMM, np.zeros(0), empty=-1.0) == -1.0
    assert smallest(COMM, np.zeros(0), empty=-1.0) == -1.0
    lost = np.array([np.nan]) if COMM.rank == COMM.size - 1 else np.array([1.0])
    assert np.isnan(largest(COMM, lost)) and np.isnan(smallest(COMM, lost))
    assert total(COMM, mine.sum()) == 2.0 + COMM.size
    rows = gather_rows(COMM, np.full((COMM.rank, 2), float(COMM.rank)))
    assert rows.shape == (COMM.size * (COMM.size - 1) // 2, 2)


def test_what_a_rank_gets_is_its_own():
    """Also of one rank alone, which sends nothing: to write to it changes nothing else."""
    for comm in (COMM, MPI.COMM_SELF):
        sent = np.ones(3)
        for found in (from_root(comm, sent), of_every_rank(comm, sent)[comm.rank]):
            found[0] = 2.0
        total(comm, sent)[0] = 2.0
        assert sent.tolist() == [1.0, 1.0, 1.0]


def test_errors_are_raised_on_every_rank():
    def fail():
        raise InputError("only rank 0 was asked")

    with pytest.raises(InputError, match="only rank 0"):
        on_root(COMM, fail)
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        on_root(COMM, lambda: 1 // 0)
    mine = InputError("from the last rank") if COMM.rank == COMM.size - 1 else None
    with pytest.raises(InputError, match="from the last rank"):
        raise_together(COMM, mine)
    assert on_root(COMM, lambda: 7) == 7
