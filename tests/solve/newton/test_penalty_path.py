"""Contact of thin parts, of which many points change one after the other under a stiff penalty."""

from itertools import pairwise

import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Run,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.solve.globalisation import PenaltyPath
from fenics_contact.verification.boxes import Box, boxes

COMM = MPI.COMM_WORLD
LOAD = 1e-3


def leaves(cells=100, **contact):
    """Two leaves, a hundred times as long as thick, clamped at one end; the upper one is loaded."""
    parts = (
        Box("lower", (0, 0), (100, 1), (cells, 2)),
        Box("upper", (0, 1), (100, 2), (100, 2)),
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(210e3, 0.3),
        discretisation=Discretisation(2),
        support=tuple(Support(f"{part.name}.x0", {"x": 0, "y": 0}) for part in parts),
        load=(Load("upper.x1", traction=(0, -LOAD)),),
        contact=(Contact("upper.y0", against="lower.y1", **contact),),
        solver=SolverSettings(errors="none"),
    )
    return Run(scene, COMM, boxes(parts, "quadrilateral", COMM, 1))


@pytest.mark.parametrize(
    ("cells", "law"),
    [
        (100, "none"),
        (77, "none"),
        (100, "incremental"),
    ],
)
def test_two_leaves(cells, law):
    """Equal leaves bend alike, so each carries half of the load; they touch at their ends.

    Those of other cells fit each other less well than they bend: they press elsewhere, too.
    """
    rough = {} if law == "none" else {"law": law, "friction_coefficient": 0.1}
    prepared = leaves(cells, **rough)
    result = prepared.solve()
    assert result.passed, result.verdict
    assert prepared.solution.newton_iterations <= 50  # round-off decides of some
    if cells == 100:
        assert result.quantities["normal_force"] == pytest.approx(0.5 * LOAD, rel=1e-3)


def test_penalties_are_what_they_were():
    """Softened on the way, by less and less; also where they are softened already."""
    problem = leaves().problem
    (penalty,) = (contact.normal.penalty for contact in problem.contacts)
    penalty.soften(2.0)
    path = PenaltyPath(problem)
    seen = [penalty.softness for _ in path.softer()]
    assert len(seen) > 3
    assert all(later < earlier for earlier, later in pairwise(seen))
    assert min(seen) > 2.0
    path.harden()
    assert penalty.softness == 2.0
