"""A friction coefficient that falls with the slip so far, where slip and pressure are known."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import SlipDependentFriction
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import Steps
from fenics_contact.scene.values import CONSTANT, Path
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.laws.stiff_block import LENGTH, block_of

_COEFFICIENT, _PRESSURE = 0.5, 60.0
_CRITICAL, _SHARE = 0.02, 0.4
_SHIFT = 0.005
# The last step is so short that the slip before it is that at its end.
_LAST = 1e-4
_LAW = SlipDependentFriction(kind="slip dependent", slips=(0.0, _CRITICAL), shares=(1.0, _SHARE))


def _scene(times: tuple[float, ...], factors: tuple[float, ...]) -> Scene:
    """A stiff block under a pressure that is given, moved along by a path; no step is too long."""
    path = Path(time=times, factor=factors)
    steps = Steps(times=(*times[1:-1], times[-1] - _LAST, times[-1]))
    return Scene(
        kinematics="plane strain",
        material=(Material(1e8, 0.0),),
        support=(
            Support("block.y1", {"y": 0}, path=CONSTANT),
            Support("block.y1", {"x": _SHIFT}, path=path),
        ),
        contact=(
            Contact(
                "block.y0",
                pressure=_PRESSURE,
                friction_coefficient=_COEFFICIENT,
                friction_law=_LAW,
                law="incremental",
            ),
        ),
        steps=steps,
    )


def _bound(slid: float) -> float:
    share = 1 - (1 - _SHARE) * min(slid / _CRITICAL, 1.0)
    return LENGTH * _COEFFICIENT * share * _PRESSURE


def _cases(quick: bool) -> Iterator[Finding]:
    body = block_of(4)
    once = solved(_scene((0.0, 1.0), (0.0, 1.0)), body)
    yield of_quantity(once, "friction_force", _bound(_SHIFT), 1e-3, ", there")
    back = solved(_scene((0.0, 1.0, 2.0), (0.0, 1.0, 0.0)), body)
    yield of_quantity(back, "friction_force", _bound(2 * _SHIFT), 1e-3, ", there and back")
    often = solved(_scene((0.0, 1.0, 2.0, 3.0), (0.0, 2.0, -1.0, 1.0)), body)
    yield of_quantity(often, "friction_force", _bound(7 * _SHIFT), 1e-3, ", beyond the table")


CASES: tuple[Case, ...] = (
    Case(
        "slip_weakening",
        "a friction coefficient that falls with the slip so far",
        "the bound at the length of a path that is known",
        _cases,
    ),
)
