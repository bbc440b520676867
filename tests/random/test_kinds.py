"""Each kind of ``tests.random.kinds``, on few cells: what statics know of it is found."""

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import SolverSettings
from tests.random.kinds import KINDS, draw_any, draw_kind
from tests.random.outcomes import outcome_of

COMM = MPI.COMM_WORLD
SEED = 5
COSTLY = ("bearing of 6", "bearing of 8")
# Forms that other tests compile as well.
_COMPILED = {
    ("plane strain", "quadrilateral", 2, 1),
    ("plane stress", "triangle", 2, 2),
    ("3D", "hexahedron", 1, 1),
}


def tiny(name, wanted=lambda random: True):
    """The first scene of a kind that is wanted and has such forms, on few cells; on all ranks."""
    return COMM.bcast(_tiny(name, wanted) if COMM.rank == 0 else None)


def _tiny(name, wanted):
    for number in range(500):
        random = draw_kind(name, SEED, number)
        scene = random.scene
        forms = (scene.kinematics, random.cell, scene.discretisation.degree, random.order)
        if forms in _COMPILED and wanted(random):
            break
    else:
        raise AssertionError(f"no {name} with forms that are compiled")
    # Straight cells of a ring or roller leave gaps, which its interference closes from 14 cells on.
    parts = tuple(
        dataclasses.replace(part, cells=_fewer(part.cells, 24 if part.name in random.closed else 4))
        for part in random.parts
    )
    scene = dataclasses.replace(scene, solver=SolverSettings(errors="none"))
    return dataclasses.replace(random, scene=scene, parts=parts)


def _fewer(cells, along):
    return (min(cells[0], along), *(min(count, 4) for count in cells[1:]))


@pytest.mark.parametrize("name", KINDS)
def test_each_kind_ends_as_it_must(name):
    random = tiny(name, lambda random: random.kind not in COSTLY)
    outcome = outcome_of(random)
    expected = {"answered": (0, 4), "refused": (2, 3, 4)}.get(random.must_be, (0, 2, 3, 4))
    assert outcome.code in expected, f"{outcome.words}\n{random!r}"
    assert outcome.finite


@pytest.mark.parametrize(("must", "code"), [("answered", 0), ("refused", 2)])
def test_inclines_on_both_sides_of_their_limit(must, code):
    random = tiny("incline", lambda random: random.must_be == must)
    outcome = outcome_of(random)
    assert outcome.code == code, f"{outcome.words}\n{random!r}"
    for known in random.known:
        found = outcome.result.quantities[known.name]
        size = max(np.linalg.norm(known.value), known.size)
        assert np.linalg.norm(np.subtract(found, known.value)) < 1e-6 * size


def test_confined_layers_are_springs_in_series():
    random = tiny("layers", lambda random: random.known)
    (known,) = random.known
    top = outcome_of(random).result.contacts[-1]["quantities"]
    assert top["normal_force"] == pytest.approx(known.value, rel=2e-3)  # two biases of .1 %


@pytest.mark.parametrize("name", ["symmetry", "anisotropy"])
def test_twins_have_the_same_force(name):
    random = tiny(name, lambda random: random.twin is not None)
    twin = random.twin
    other = dataclasses.replace(twin.scene, parts=_like(random, twin.scene.parts))
    ours, theirs = outcome_of(random).result, outcome_of(other).result
    factor = twin.factors["normal_force"]
    expected = factor * theirs.quantities["normal_force"]
    assert ours.quantities["normal_force"] == pytest.approx(expected, rel=1e-3)


def _like(random, parts):
    """With cells of the size of those of the tiny scene."""
    found = []
    for part, own in zip(parts, random.parts, strict=True):
        sizes = np.subtract(own.high, own.low) / own.cells
        cells = np.rint(np.subtract(part.high, part.low) / sizes).astype(int)
        found.append(dataclasses.replace(part, cells=tuple(cells.tolist())))
    return tuple(found)


def test_all_kinds_come_in_turn():
    found = [draw_any(SEED, number) for number in range(32)]
    assert found == [draw_any(SEED, number) for number in range(32)]
    assert len({random.kind for random in found}) >= len(KINDS)
    finer = found[0].refined()
    assert finer.parts[0].cells == tuple(2 * count for count in found[0].parts[0].cells)


def test_flat_cells_stay_where_they_are_when_they_are_halved():
    random = tiny("arch", lambda random: random.order == 1)
    volumes = [_volume(each.body()) for each in (random, random.refined())]
    assert volumes[1] == pytest.approx(volumes[0], rel=1e-12)
    curved = dataclasses.replace(random, order=2)
    assert _volume(curved.refined().body()) > 1.0001 * volumes[0]


def _volume(body):
    return COMM.allreduce(fem.assemble_scalar(fem.form(1.0 * ufl.dx(body.mesh))))


@pytest.mark.parametrize("number", [6, 7])
def test_rollers_that_contact_alone_holds_take_few_steps(number):
    # The tangent is nearly singular: a roller that touches at two points can roll.
    random = draw_kind("bearing", SEED, number)
    free = dataclasses.replace(random.scene.solver, solver="condensed", errors="none")
    scene = dataclasses.replace(random.scene, solver=free)
    outcome = outcome_of(dataclasses.replace(random, scene=scene))
    assert outcome.code == 0, outcome.words
    # Number 7 may have a second try, by round-off, whose springs are at other displacements.
    assert outcome.result.steps[-1].newton_iterations <= 80
    inner = random.parts[0]
    area = np.pi * (inner.high[1] ** 2 - inner.low[1] ** 2) * random.shape.length**2
    weight = area * -scene.load[0].body_force[1]
    # Straight cells of a ring have less area than the ring.
    assert outcome.result.quantities["reaction"][1] == pytest.approx(weight, rel=0.02)
