"""Two bodies, and small models in 3D."""

from __future__ import annotations

import dataclasses

import numpy as np

from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Point, Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene, Steps
from fenics_contact.verification.boxes import pair_scene, with_contact
from fenics_contact.verification.error_bars.case import (
    BarCase,
    Element,
    Model,
    Parameters,
    of_element,
)
from fenics_contact.verification.hard.scenes import box
from fenics_contact.verification.published.hertz_pair import pressed_scene

FINER = "the same on much finer meshes"


def _blocks(element: Element, cells: int, load: float) -> Model:
    """Two blocks that do not match, pressed more in the middle of the model than at its side."""
    scene = pair_scene(
        "quadrilateral", (4 * cells, 6 * cells), lambda x: 5 + 4 * np.cos(np.pi * x[0])
    )
    scene = with_contact(scene, friction_coefficient=0.1, penalty_parameter="auto", slave="against")
    scene = dataclasses.replace(scene, point=(Point("corner", (1.0, 1.0)),))
    return Model(of_element(scene, element))


def _finer_blocks(level: int, load: float) -> Model:
    return _blocks("Q2", (10, 16)[level], load)


def cylinders(element: Element, cells: int, load: float) -> Model:
    """Halves of two equal cylinders of radius 50; the contact's half-width is about 1."""
    scene = dataclasses.replace(pressed_scene("plane strain"), steps=Steps(1))
    return Model(of_element(_cushioned(scene, 4 * cells, 12 * cells), element))


def _cushioned(scene: Scene, cells: int, cells_outside: int) -> Scene:
    """Cells on the half-width of the lower body, and half as many more on the upper one."""

    def resized(mesh: MeshSource) -> MeshSource:
        along = cells if mesh.name == "lower" else 1.5 * cells
        sizes = {"size": 1 / along, "cells_outside": cells_outside}
        return dataclasses.replace(mesh, parameters=dict(mesh.parameters) | sizes)

    return dataclasses.replace(scene, mesh=tuple(resized(mesh) for mesh in scene.mesh))


def finer_cylinders(level: int, load: float) -> Model:
    """Their reference."""
    scene = dataclasses.replace(pressed_scene("plane strain"), steps=Steps(1))
    return Model(_cushioned(scene, (24, 40)[level], (36, 48)[level]))


def _pad(element: Element, cells: int, load: float) -> Model:
    """A quarter of a pad, 2 × 2 × 1, under a paraboloid that reaches over its middle."""
    scene = Scene(
        kinematics="3D",
        material=(Material(1000, 0.3),),
        discretisation=Discretisation(int(element[1])),
        symmetry=("left", "front"),
        support=(Support("bottom", {"x": 0, "y": 0, "z": 0}),),
        contact=(
            Contact(
                "top",
                obstacle=Obstacle("paraboloid", radius=4, position=(0, 0, 0.5), indentation=0.05),
                friction_coefficient=0.3,
            ),
        ),
        point=(Point("beside", (0.9, 0.9, 0.5)),),
    )
    body = box((4 * cells, 4 * cells, 2 * cells), (1, 1, 0.5), simplices=element.startswith("P"))
    return Model(scene, body)


def _finer_pad(level: int, load: float) -> Model:
    return _pad("Q2", (3, 4)[level], load)


BODIES_CASES: tuple[BarCase, ...] = (
    BarCase(
        name="blocks",
        summary="two blocks whose meshes do not match, μ = .1",
        source=FINER,
        role="tested",
        model=_blocks,
        elements=("Q2", "P2", "Q1"),
        parameters=(Parameters(), Parameters(1e-6, 1e-7), Parameters(1e-5, 1e-6)),
        finer=_finer_blocks,
    ),
    BarCase(
        name="cylinders",
        summary="two cylinders",
        source=FINER,
        role="tested",
        model=cylinders,
        elements=("Q2", "Q1"),
        parameters=(Parameters(), Parameters(None, 1e-6), Parameters(None, 1e-5)),
        cells={1: (1, 2, 4), 2: (1, 2, 4)},
        finer=finer_cylinders,
    ),
    BarCase(
        name="pad",
        summary="paraboloid on a pad in 3D, μ = .3",
        source=FINER,
        role="tested",
        model=_pad,
        elements=("Q1", "P1", "P2"),
        parameters=(Parameters(), Parameters(1e-5, 1e-6), Parameters(1e-4, 1e-5)),
        cells={1: (1, 2, 3), 2: (1, 2, 3)},
        finer=_finer_pad,
    ),
)
