"""Two layers, clamped at one end and pressed on each other: they slip all at once."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import SolverSettings
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Finding
from fenics_contact.verification.vibration.driven import Joint, compared

_YOUNG, _LENGTH, _HEIGHT, _PRESSURE, _FRICTION = 1e5, 40.0, 1.0, 1.0, 0.3
_CELLS = 60


def _scene() -> Scene:
    heavy, light = 1.0, 1e-6
    return Scene(
        kinematics="plane stress",
        material=(
            Material(_YOUNG, 0.0, on="lower", density=light),
            Material(_YOUNG, 0.0, on="upper", density=light),
            Material(_YOUNG, 0.0, on="lower_end", density=heavy),
            Material(_YOUNG, 0.0, on="upper_end", density=heavy),
        ),
        support=(Support("lower.x0", {"x": 0, "y": 0}), Support("upper.x0", {"x": 0, "y": 0})),
        load=tuple(
            Load(f"{name}{end}.{side}", pressure=_PRESSURE)
            for name, side in (("lower", "y0"), ("upper", "y1"))
            for end in ("", "_end")
        ),
        contact=tuple(
            Contact(
                f"upper{end}.y0",
                against=f"lower{end}.y1",
                friction_coefficient=_FRICTION,
                law="incremental",
            )
            for end in ("", "_end")
        ),
        solver=SolverSettings(errors="none"),
    )


def layers() -> Iterator[Finding]:
    """Loss, damping ratio and frequency over the force, 3 %."""
    cell = _LENGTH / _CELLS
    begin = _LENGTH - 0.5 * cell  # the mass acts at its middle
    parts = [
        box
        for name, low in (("lower", -_HEIGHT), ("upper", 0.0))
        for box in (
            Box(name, (0, low), (begin, low + _HEIGHT), (_CELLS, 2)),
            Box(f"{name}_end", (begin, low), (begin + cell, low + _HEIGHT), (1, 2)),
        )
    ]
    body = boxes(parts, welded=[(name, f"{name}_end") for name in ("lower", "upper")])
    stiff = 2 * _YOUNG * _HEIGHT**3 / _LENGTH**3
    first = 4 / 3 * _FRICTION * _PRESSURE * _HEIGHT
    joint = Joint(
        moved=lambda force: first / stiff + 4 * (force - first) / stiff,
        loss=lambda force: (
            8 * _FRICTION * _PRESSURE * _LENGTH**3 * (force - first) / (_YOUNG * _HEIGHT**2)
        ),
    )
    yield from compared(_scene(), body, joint, (1.5 * first, 2 * first, 3 * first), 3e-2, axis=1)
