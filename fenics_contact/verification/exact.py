"""Contact and friction without penalty and smoothing, against statics and the limit of both."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

_MODULUS, _DEPTH, _PRESSURE, _PULL = 1000.0, 0.01, 10.0, 3.0
_EXACT = SolverSettings(errors="none", strategy="exact")


def _scene(contact: Contact, ratio: float, **more: Any) -> Scene:
    """A block that meets something below.

    Args:
        contact: Of its lower side.
        ratio: Poisson's.
        **more: Further keys of the scene.
    """
    material = (Material(_MODULUS, ratio),)
    given: dict[str, Any] = {"solver": _EXACT} | more
    return Scene(kinematics="plane strain", material=material, contact=(contact,), **given)


def _block(cells: int) -> Body:
    """A square of side 1."""
    return boxes([Box("block", (0, 0), (1, 1), (cells, cells))])


def _bar(cells: int) -> Iterator[Finding]:
    contact = Contact("block.y0", obstacle=Obstacle(indentation=_DEPTH))
    scene = _scene(contact, 0.0, support=(Support("block.y1", {"x": 0, "y": 0}),))
    found = solved(scene, _block(cells)).quantities
    pressure = _MODULUS * _DEPTH
    yield Finding("pressure of a bar", found["max_contact_pressure"], pressure, 1e-11)


def _held_by_friction(cells: int) -> Iterator[Finding]:
    contact = Contact("block.y0", friction_coefficient=0.5)
    loads = (Load("block.y1", pressure=_PRESSURE), Load("block.y1", traction=(_PULL, 0)))
    result = solved(_scene(contact, 0.3, load=loads), _block(cells))
    found, points = result.quantities, result.points
    yield Finding("force on a block at rest", found["normal_force"], _PRESSURE, 1e-11)
    yield Finding("friction that holds it", found["friction_force"][0], -_PULL, 1e-11)
    if points is not None:
        sticks = np.array(points.status) == "STICK"
        creep = float(np.abs(points.slip[sticks]).max())
        yield Finding("slip of points that stick", creep, 0.0, 1e-13, absolute=True)


def _limits(cells: int) -> Iterator[Finding]:
    """A tenth of ε₁, or of ε, alone leaves a tenth of the difference."""
    body = _block(cells)
    contact = Contact(
        "block.y0", friction_coefficient=0.35, penalty_parameter=0, regularisation_parameter=0
    )
    support = Support("block.y1", {"x": 0.4 * _DEPTH, "y": -0.4 * _DEPTH})
    scene = _scene(contact, 0.3, support=(support,), solver=SolverSettings(errors="none"))

    def force(other: Contact) -> float:
        result = solved(dataclasses.replace(scene, contact=(other,)), body)
        return float(result.quantities["contact_force"][0])

    exact = force(contact)
    ways: tuple[tuple[str, Callable[[float], Contact]], ...] = (
        ("penalty", lambda value: dataclasses.replace(contact, penalty_parameter=value)),
        ("smoothing", lambda value: dataclasses.replace(contact, regularisation_parameter=value)),
    )
    for words, with_value in ways:
        first, second = (force(with_value(value)) - exact for value in (1e-6, 1e-7))
        yield Finding(f"error of a {words} over that of a tenth of it", first / second, 10.0, 0.02)


def _exact(quick: bool) -> Iterator[Finding]:
    cells = 4 if quick else 16
    yield from _bar(cells)
    yield from _held_by_friction(cells)
    yield from _limits(cells)


EXACT_CASES: tuple[Case, ...] = (
    Case(
        "exact",
        "contact and friction without penalty and smoothing: a bar, a block at rest, the limit",
        "E d/L; statics; convergence of order one in ε₁ and in ε",
        _exact,
    ),
)
