"""Full Newton steps that go round in circles."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Run, Scene, Support
from fenics_contact.solve.globalisation import StepDamping
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import with_solver

COMM = MPI.COMM_WORLD
# A block in a seat, pressed into its corner and pulled along it: at two contacts that share an
# edge, points go round in circles. Not on every mesh; on this one, a small one, they do.
CORNER = (
    Box("block", (0, 0, 0), (1, 1, 1), (5, 5, 5)),
    Box("floor", (0, -0.5, 0), (1.25, 0, 1), (5, 1, 4)),
    Box("wall", (-0.5, -0.5, 0), (0, 1.25, 1), (1, 5, 4)),
)
HELD = dict.fromkeys("xyz", 0)
SEAT = Scene(
    kinematics="3D",
    material=Material(1000, 0.3),
    support=(
        Support("floor.y0", HELD),
        Support("wall.x0", HELD),
        Support("block.y1", {"x": -0.005, "y": -0.005, "z": 0.01}),
    ),
    contact=(
        Contact("block.y0", against="floor.y1", friction_coefficient=1.0),
        Contact("block.x0", against="wall.x1", friction_coefficient=1.0),
    ),
)


def seated(strategy):
    """The seat by one strategy; the check of stresses is not for so coarse a mesh."""
    scene = with_solver(SEAT, solver="condensed", strategy=strategy, errors="none")
    return Run(scene, COMM, boxes(CORNER, "hexahedron")).solve()


def test_a_seat_whose_points_go_round_in_circles(monkeypatch):
    """As by the loop that solves contact and friction in turns."""
    found, expected = seated("monolithic"), seated("lagged")
    assert found.converged and expected.converged
    for mine, other in zip(found.contacts, expected.contacts, strict=True):
        mine, other = mine.quantities, other.quantities
        size = other["normal_force"]
        for name in ("normal_force", "friction_force"):
            assert mine[name] == pytest.approx(other[name], rel=1e-6, abs=1e-6 * size)
    monkeypatch.setattr(StepDamping, "share", lambda damping, imbalances: 1.0)
    without = seated("monolithic")
    assert not without.converged
    assert "again and again" in without.verdict


def shares(imbalances):
    damping = StepDamping()
    return [damping.share(imbalances[: number + 1]) for number in range(len(imbalances))]


def test_steps_that_bring_something_are_taken_in_full():
    falling = [1e4, 1e6, 1e3] + [0.9**number for number in range(60)]
    assert set(shares(falling)) == {1.0}


def test_steps_that_bring_nothing_are_halved_for_longer_and_longer():
    circle = [1e4, 1e6, 1e3] + [5.0, 0.1] * 50
    found = shares(circle)
    assert set(found[:11]) == {1.0}
    text = "".join("." if share == 1 else "h" for share in found)
    assert [len(part) for part in text.split(".") if part][:5] == [2, 4, 8, 16, 16]
