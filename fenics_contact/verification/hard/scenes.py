"""Scenes that several hard cases use."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.bodies import box
from fenics_contact.verification.hard.exact import ExactAnswer, turned

SPECIFICATION = "the project's specification, Section 5, values of a separate prototype"
EXACT = "active-set solution of the exact inequalities, no penalty, no regularisation"
STATICS = "statics of a rigid body"

E, NU = 1000.0, 0.3
CLAMPED = Support("bottom", {"x": 0, "y": 0})
ROLLER = Support("bottom", {"y": 0})
ASIDE = Support("left", {"x": 0})


def plane_scene(
    contact: Contact | Sequence[Contact],
    support: Sequence[Support] = (),
    load: Sequence[Load] = (),
    **keys: Any,
) -> Scene:
    """A body in plane strain, E = 1000 and ν = .3 unless said otherwise."""
    return Scene(
        kinematics=keys.pop("kinematics", "plane strain"),
        material=keys.pop("material", (Material(E, NU),)),
        support=tuple(support),
        load=tuple(load),
        contact=(contact,) if isinstance(contact, Contact) else tuple(contact),
        **keys,
    )


def driven_scene(coefficient: float, aside: float, down: float, **contact: Any) -> Scene:
    """The specification's block on a rough floor, its top moved by (aside, down)."""
    return plane_scene(
        Contact("bottom", friction_coefficient=coefficient, **contact),
        (Support("top", {"x": aside, "y": down}),),
    )


def driven_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    """Its mesh, 2 × 1, of 16 × 8 cells."""
    return box((16, 8), (2, 1), comm=comm)


def pressed_scene(depth: float = 0.02, coefficient: float = 0.0, **contact: Any) -> Scene:
    """A clamped block 2 × 1 with a parabola, off its middle, pressed into its top."""
    obstacle = Obstacle("parabola", radius=2, position=(0.9, 1), indentation=depth)
    return plane_scene(
        Contact("top", obstacle=obstacle, friction_coefficient=coefficient, **contact), (CLAMPED,)
    )


def with_contact(scene: Scene, **changes: Any) -> Scene:
    """The scene with changes of its first contact."""
    contact = dataclasses.replace(scene.contact[0], **changes)
    return dataclasses.replace(scene, contact=(contact, *scene.contact[1:]))


def friction_along(result: Result) -> Array:
    """Friction at the points of a plane model, along the normal turned by a right angle."""
    points = result.points
    assert points is not None
    along = np.einsum("ij,ij->i", points.friction_traction, turned(points.normals))
    return np.asarray(along)


def compared(result: Result, exact: ExactAnswer, limit: float) -> list[Finding]:
    """Forces, and pressure and friction at all points, against those of the inequalities.

    Args:
        result: Of the program.
        exact: Of the same mesh.
        limit: Of the forces over the larger of both, and ten times that at points over the peak.
    """
    points = result.points
    assert points is not None
    pressure, friction = points.contact_pressure, friction_along(result)
    size = max(abs(exact.normal_force), abs(exact.friction_force)) or 1.0
    peak = max(np.abs(exact.pressure).max(), np.abs(exact.friction).max()) or 1.0
    normal, along = (float(points.weights @ values) for values in (pressure, friction))
    largest = max(
        float(np.abs(pressure - exact.pressure).max()),
        float(np.abs(friction - exact.friction).max()),
    )
    return [
        Finding("normal force / larger", normal / size, exact.normal_force / size, limit, True),
        Finding("friction force / larger", along / size, exact.friction_force / size, limit, True),
        Finding("error at points / peak", largest / peak, 0.0, 10 * limit, absolute=True),
    ]
