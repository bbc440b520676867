"""Two equal bodies that touch at their apexes: Hertz' contact, and Cattaneo's with friction.

The bodies are rectangles of which one side bulges as a circle does, wide against the contact; their
meshes are fine around it and do not match. Half-widths a are prescribed by the force of theory,
p₀ and a are compared with those of the force that the run found.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi, sqrt
from typing import Literal

import numpy as np

from fenics_contact.result import Result
from fenics_contact.scene import Discretisation, Load, MeshSource, Scene, Support
from fenics_contact.scene_contact import Contact
from fenics_contact.verification import formulas
from fenics_contact.verification.case import Case, Finding, mesh_file, solved
from fenics_contact.verification.point_cases import JOHNSON, MATERIAL, MODULUS

_HALF_WIDTH = 1.0
_RADIUS = 50.0
_EXTENT = 25.0
# Of two equal bodies (Johnson, (4.18), (4.20)).
_COMPOSED_MODULUS, _COMPOSED_RADIUS = MODULUS / 2, _RADIUS / 2
# Cells of the lower and the upper body across the contact.
_CELLS = {"lower": 16, "upper": 24}


def cushions(half: bool, order: int = 2) -> tuple[MeshSource, ...]:
    """The two bodies, or their halves right of x = 0."""
    return tuple(
        MeshSource(
            mesh_file("cushion.geo"),
            cell="quadrilateral",
            order=order,
            name=name,
            parameters={
                "side": 1 if name == "upper" else -1,
                "half": int(half),
                "radius": _RADIUS,
                "extent": _EXTENT,
                "size": 2 * _HALF_WIDTH / count,
                "cells_outside": 20,
            },
        )
        for name, count in _CELLS.items()
    )


def pair_scene(
    kinematics: Literal["plane strain", "axisymmetric"], degree: int, order: int, pressed: float
) -> Scene:
    """Half of two cylinders, or two spheres, pressed on each other.

    Args:
        pressed: How far (length).
    """
    return Scene(
        kinematics=kinematics,
        mesh=cushions(half=True, order=order),
        material=MATERIAL,
        discretisation=Discretisation(degree),
        symmetry=("lower.axis", "upper.axis"),
        support=(
            Support("lower.foot", {"y": 0}),
            Support("upper.foot", {"y": -pressed}),
        ),
        contact=(Contact("lower.contact", against="upper.contact", slave="on"),),
    )
