"""A block that hardly deforms beside what it touches: statics alone gives its forces."""

from __future__ import annotations

from typing import Any

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import AXES
from fenics_contact.verification.boxes import Box, boxes

LENGTH, HEIGHT = 1.0, 0.2
_MODULUS = 1e8


def stiff_block(
    depth: float, shift: tuple[float, ...], contact: dict[str, Any], **scene: Any
) -> Scene:
    """A block on the ground, pressed into it and moved along it.

    Args:
        depth: How far it is pressed down (length).
        shift: How far it is moved, one entry an axis along the ground (length).
        contact: Keys of the contact at its lower side.
        scene: Other keys of the scene.
    """
    axes = AXES[: len(shift) + 1]
    moved = dict(zip(axes, (*shift, -depth), strict=True))
    return Scene(
        kinematics="3D" if len(shift) == 2 else "plane strain",
        material=(Material(_MODULUS, 0.0),),
        support=(Support(f"block.{axes[-1]}1", moved),),
        contact=(Contact(f"block.{axes[-1]}0", **contact),),
        **scene,
    )


def stiff_pad(contact: dict[str, Any], **scene: Any) -> Scene:
    """A block in the plane that stands fixed, with a contact at its upper side.

    Args:
        contact: Keys of the contact.
        scene: Other keys of the scene.
    """
    return Scene(
        kinematics="plane strain",
        material=(Material(_MODULUS, 0.0),),
        support=(Support("block.y0", {"x": 0, "y": 0}),),
        contact=(Contact("block.y1", **contact),),
        **scene,
    )


def block_of(cells: int, dimension: int = 2) -> Body:
    """Its mesh, from −LENGTH/2 to LENGTH/2 along the ground and upwards from 0.

    Args:
        cells: Along each axis of the ground; one across.
        dimension: 2 or 3.
    """
    half = LENGTH / 2
    low, high = (-half,) * (dimension - 1), (half,) * (dimension - 1)
    box = Box("block", (*low, 0.0), (*high, HEIGHT), (cells,) * (dimension - 1) + (1,))
    return boxes((box,), "quadrilateral" if dimension == 2 else "hexahedron")
