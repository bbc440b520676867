"""A mass on a bar that lies on a rigid plane: slip creeps in from its end."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.analyses.vibration.table import Damping, Modes
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.steps import SolverSettings
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Finding
from fenics_contact.verification.vibration.driven import Joint, compared

_YOUNG, _LENGTH, _HEIGHT, _LIMIT = 1000.0, 20.0, 0.2, 0.3
# Between the plane's end and the mass, so that modes have a stiffness while all is stuck.
_SPRING = _LENGTH / 10
_PARTS = ("bar", "spring", "mass")


def bar_scene() -> Scene:
    """The bar, the piece of it beyond the plane, and the mass."""
    return Scene(
        kinematics="plane stress",
        material=(
            Material(_YOUNG, 0.0, on="bar", density=1e-9),
            Material(_YOUNG, 0.0, on="spring", density=1e-9),
            Material(100 * _YOUNG, 0.0, on="mass", density=1.0),
        ),
        support=tuple(Support(f"{name}.y0", {"y": 0}) for name in _PARTS),
        contact=(Contact("bar.y1", pressure=1.0, friction_coefficient=_LIMIT, law="incremental"),),
        modes=Modes(1),
        damping=Damping((0.01,)),
        solver=SolverSettings(errors="none"),
    )


def bar_body(cells: int) -> Body:
    """Its mesh.

    Args:
        cells: Along the plane, a multiple of 10.
    """
    cell, end = _LENGTH / cells, _LENGTH + _SPRING
    return boxes(
        (
            Box("bar", (0, 0), (_LENGTH, _HEIGHT), (cells, 1)),
            Box("spring", (_LENGTH, 0), (end, _HEIGHT), (cells // 10, 1)),
            Box("mass", (end, 0), (end + cell, _HEIGHT), (1, 1)),
        ),
        welded=(_PARTS,),
    )


def bar(cells: int = 40, shares: tuple[float, ...] = (0.2, 0.5, 0.8)) -> Iterator[Finding]:
    """Loss, damping ratio and frequency over the force, 1 %.

    Args:
        cells: Along the plane.
        shares: Forces over the largest that friction holds.
    """
    section = _YOUNG * _HEIGHT
    joint = Joint(
        moved=lambda force: force**2 / (2 * section * _LIMIT) + force * _SPRING / section,
        loss=lambda force: 2 * force**3 / (3 * section * _LIMIT),
    )
    forces = tuple(share * _LIMIT * _LENGTH for share in shares)
    yield from compared(bar_scene(), bar_body(cells), joint, forces, 1e-2, axis=0)
