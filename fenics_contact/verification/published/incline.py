"""A deformable block on a deformable slope, meshes that do not match: statics gives the forces.

The slope rises by tan α towards +x and the block, of weight G, rests on it: on rough ground it
stays with N = G cos α and T = G sin α; a horizontal push F that moves it up is
G (μ + tan α) / (1 − μ tan α).
"""

from __future__ import annotations

from collections.abc import Iterator
from math import atan, cos, hypot, sin

from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.simulation.runs import run
from fenics_contact.verification.block_pair import LOWER, UPPER, block
from fenics_contact.verification.case import Case, Finding, solved

_SLOPE, _COEFFICIENT, _TOO_SMOOTH = 0.1, 0.3, 0.099
_WEIGHT = 2.0
_LENGTH, _HEIGHT = 2.0, 1.0
_MODULI = {LOWER: 1000.0, UPPER: 3000.0}
# More than the parts' deformations, and little of their size.
_PUSHED = 0.01


def incline_scene(coefficient: float, pushed: float | None = None) -> Scene:
    """A block on a slope.

    Args:
        coefficient: Of friction.
        pushed: How far the block's rear is moved, horizontally (length); None leaves it free.
    """
    rear = () if pushed is None else (Support("upper.left", {"x": pushed}),)
    weight = _WEIGHT / (_LENGTH * _HEIGHT)
    return Scene(
        kinematics="plane strain",
        mesh=(
            block(LOWER, 14, slope=_SLOPE, left=-2, length=6, cells_across=3),
            block(UPPER, 9, slope=_SLOPE, length=_LENGTH, height=_HEIGHT, cells_across=4),
        ),
        material=tuple(Material(modulus, 0.3, on=name) for name, modulus in _MODULI.items()),
        support=(Support("lower.bottom", {"x": 0, "y": 0}), *rear),
        load=(Load(UPPER, body_force=(0, -weight)),),
        contact=(Contact("upper.bottom", against="lower.top", friction_coefficient=coefficient),),
        solver=SolverSettings(tolerance=1e-12, outer_tolerance=1e-10),
    )


def _pushed(quick: bool) -> Iterator[Finding]:
    result = solved(incline_scene(_COEFFICIENT, _PUSHED))
    (rear,) = (row["reaction"] for row in result.supports if row["on"] == "upper.left")
    expected = (_COEFFICIENT + _SLOPE) / (1 - _COEFFICIENT * _SLOPE)
    yield Finding("F / G", rear[0] / _WEIGHT, expected, 1e-8, absolute=True)


def _resting(quick: bool) -> Iterator[Finding]:
    angle = atan(_SLOPE)
    quantities = solved(incline_scene(_COEFFICIENT)).quantities
    normal = quantities["normal_force"]
    yield Finding("normal_force", normal, _WEIGHT * cos(angle), 1e-9)
    friction = hypot(*quantities["friction_force"])
    yield Finding("|friction_force|", friction, _WEIGHT * sin(angle), 1e-9)
    yield Finding("answers with friction too small", _answers(), 0, 0, absolute=True)


def _answers() -> float:
    """Number of answers to a block that slides down: it is to be refused."""
    try:
        return float(run(incline_scene(_TOO_SMOOTH)).converged)
    except NoEquilibriumError:
        return 0.0


CASES: tuple[Case, ...] = (
    Case(
        "incline", "block pushed up a slope, both deformable", "statics of a rigid block", _pushed
    ),
    Case(
        "resting", "block at rest on a slope, both deformable", "statics of a rigid block", _resting
    ),
)
