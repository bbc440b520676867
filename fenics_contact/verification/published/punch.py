"""A flat annular punch on a half-space, the paper's example 4 without sliding friction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.published.point import MATERIAL, MODULUS

_INNER, _OUTER, _INDENTATION = 0.5, 1.0, 0.01
# Bonded over frictionless: a separate FEniCSx prototype of example 4, domain of 1000 radii.
_BONDED_OVER_FRICTIONLESS = 1.0276


def _annulus(quick: bool) -> Iterator[Finding]:
    """Forces over that of a flat circular punch of the outer radius."""
    punch = formulas.flat_punch_force(MODULUS, _OUTER, _INDENTATION)
    exact = formulas.annular_punch_force(MODULUS, _INNER, _OUTER, _INDENTATION)
    frictionless, bonded = _force("unilateral"), _force("bonded")
    yield Finding("F / (2 E* a d)", frictionless / punch, exact / punch, 1e-3, absolute=True)
    yield Finding(
        "bonded / frictionless force",
        bonded / frictionless,
        _BONDED_OVER_FRICTIONLESS,
        1e-3,
        absolute=True,
    )


def annulus_scene(kind: Literal["unilateral", "bonded"] = "unilateral") -> Scene:
    """A flat annular punch driven into a half-space."""
    return Scene(
        kinematics="axisymmetric",
        mesh=(
            MeshSource(
                mesh_file("annular_punch.geo"),
                cell="quadrilateral",
                parameters={"inner_radius": _INNER, "outer_radius": _OUTER, "extent": 1000},
            ),
        ),
        material=MATERIAL,
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(Contact("contact", contact=kind, obstacle=Obstacle(indentation=_INDENTATION)),),
    )


def _force(kind: Literal["unilateral", "bonded"]) -> float:
    return float(solved(annulus_scene(kind)).quantities["normal_force"])


CASES: tuple[Case, ...] = (
    Case(
        "annulus",
        "flat annular punch, frictionless and bonded",
        "integral equation of ring loads (Johnson 1985, section 3.8); the bonded ratio: a separate "
        "prototype of example 4 of Campos, Oden & Kikuchi 1982",
        _annulus,
    ),
)
