"""Two bodies and small models in 3D, and loads that go to and fro.

Loads that go to and fro: what a cycle loses, beside all else. A block that lifts off a rough floor
at its sides: no load moves the edges of its contact. Bars that look at how quantities scatter as
the load moves edges through cells see nothing of these: without a gap at the start the whole
answer is proportional to the load (J. Dundurs, M. Stippes, J. Appl. Mech. 37 (1970) 965-970).
"""

from __future__ import annotations

import dataclasses

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.results.records.record import Quantities
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Point
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene
from fenics_contact.scene.settings import SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.boxes import Box, boxes, pair_scene, with_contact
from fenics_contact.verification.error_bars.case import (
    BarCase,
    Element,
    Model,
    Parameters,
    of_element,
)
from fenics_contact.verification.error_bars.round import strip_scene
from fenics_contact.verification.error_bars.runs import CYCLE_LOSS
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
    """Cylinders on a finer mesh, the reference of the losses."""
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


_LARGEST_PRESSURE = 10.0


def floor(element: Element, cells: int, load: float) -> Model:
    """Right half of a block 4 × 1, pressed in its middle.

    Args:
        element: Of its cells.
        cells: Over its height, of which all are squares, or halves of these.
        load: Over what length the pressure falls to 1/e, which sets where the edges are.
    """

    def pressure(x: Array) -> Array:
        return np.asarray(_LARGEST_PRESSURE * np.exp(-((x[0] / load) ** 2)))

    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000.0, 0.3),),
        discretisation=Discretisation(int(element[1])),
        symmetry=("left",),
        load=(Load("top", pressure=pressure),),
        contact=(Contact("bottom", obstacle=Obstacle(), friction_coefficient=0.3),),
        point=(
            Point("corner", (2.0, 1.0)),
            Point("foot", (2.0, 0.0)),
            Point("inside", (0.25, 0.5)),
        ),
    )
    return Model(scene, box((2 * cells, cells), (2, 1), simplices=element.startswith("P")))


def finer_floor(level: int, load: float) -> Model:
    """Its reference."""
    return floor("Q2", (56, 84)[level], load)


LIFTING_CASES: tuple[BarCase, ...] = (
    BarCase(
        name="floor",
        summary="block pressed on a rough floor, free to lift, μ = .3",
        source="the same on much finer meshes",
        role="tested",
        model=floor,
        elements=("Q2", "P2", "Q1"),
        parameters=(Parameters(), Parameters(1e-6, 1e-7), Parameters(1e-5, 1e-6)),
        cells={1: (8, 16, 32), 2: (4, 8, 16)},
        loads=(0.3, 0.33, 0.37),
        finer=finer_floor,
    ),
)


_HELD = Path(time=(0.0, 1.0), factor=(0.0, 1.0))
_TO_AND_FRO = Path(time=(1.0, 2.0, 4.0, 6.0), factor=(0.0, 1.0, -1.0, 1.0))
_CYCLES = 2
_INCREMENTS, _FINE_INCREMENTS = 8, (48, 96)
_PARAMETERS = (Parameters(), Parameters(1e-6, 1e-7), Parameters(1e-5, 1e-6))


def _cycled(scene: Scene, increments: int) -> Scene:
    """Pressed in a load step, moved in another, then to and fro."""
    return dataclasses.replace(
        scene,
        steps=Steps(times=(1.0, 2.0)),
        cycles=Cycles(begin=2.0, end=6.0, increments=increments, number=_CYCLES, until="end"),
        solver=SolverSettings(strategy="monolithic"),
    )


# ---------------------------------------------------------------- a bar that slips on a plane

_YOUNG, _LENGTH, _HEIGHT, _LIMIT = 1000.0, 20.0, 0.2, 0.3


def _bar(element: Element, cells: int, load: float) -> Model:
    """Pulled and pushed at its end, from where slip comes, with a given pressure."""
    section = _LIMIT * _LENGTH / _HEIGHT
    scene = Scene(
        kinematics="plane stress",
        material=(Material(_YOUNG, 0.0),),
        discretisation=Discretisation(int(element[1])),
        support=(Support("bar.y0", {"y": 0}),),
        load=(Load("bar.x1", traction=(load * section, 0), path=_TO_AND_FRO),),
        contact=(Contact("bar.y1", pressure=1.0, friction_coefficient=_LIMIT, law="incremental"),),
    )
    kind = "triangle" if element.startswith("P") else "quadrilateral"
    body = boxes((Box("bar", (0, 0), (_LENGTH, _HEIGHT), (10 * cells, 1)),), kind)
    return Model(_cycled(scene, _INCREMENTS), body)


def _of_bar(load: float) -> Quantities:
    """2 F³/(3 EA q), with q the friction on a length."""
    force = load * _LIMIT * _LENGTH
    return {CYCLE_LOSS: 2 * force**3 / (3 * _YOUNG * _HEIGHT * _LIMIT)}


# ---------------------------------------------------------------- a cylinder that is rocked


def _strip(size: float, cells_outside: int, increments: int, load: float) -> Scene:
    """A parabola pressed on a strip, then pushed sideways, to and fro."""
    scene = strip_scene(size, cells_outside, 0.00336 * load, _TO_AND_FRO)
    return _cycled(scene, increments)


def _parabola(element: Element, cells: int, load: float) -> Model:
    return Model(of_element(_strip(0.3 / cells, 6 * cells, _INCREMENTS, load), element))


def _finer_parabola(level: int, load: float) -> Model:
    size, outside = ((1 / 40, 32), (1 / 60, 48))[level]
    return Model(_strip(size, outside, _FINE_INCREMENTS[level], load))


# ---------------------------------------------------------------- a block that is sheared


def _block_scene(increments: int, degree: int, load: float) -> Scene:
    """A block that lies on a plane under a pressure, its top pushed to and fro until it slides."""
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000, 0.3),),
        discretisation=Discretisation(degree),
        support=(Support("top", {"x": 0.0175 * load}, path=_TO_AND_FRO),),
        load=(Load("top", pressure=10, path=_HELD),),
        contact=(Contact("bottom", friction_coefficient=0.3, law="incremental"),),
    )
    return _cycled(scene, increments)


def _block(element: Element, cells: int, load: float) -> Model:
    body = box((8 * cells, 4 * cells), (2, 1), simplices=element.startswith("P"))
    return Model(_block_scene(_INCREMENTS, int(element[1]), load), body)


def _towards_the_corners(points: Array) -> Array:
    """Cells that shrink towards the ends of the foot."""
    moved = points.copy()
    across = points[:, 0] - 1
    moved[:, 0] = 1 + 0.5 * across * (3 - across**2)
    moved[:, 1] = points[:, 1] ** 2
    return moved


def _finer_block(level: int, load: float) -> Model:
    cells = (40, 56)[level]
    body = box((2 * cells, cells), (2, 1), move=_towards_the_corners)
    return Model(_block_scene(_FINE_INCREMENTS[level], 2, load), body)


CYCLIC_CASES: tuple[BarCase, ...] = (
    BarCase(
        name="bar_to_and_fro",
        summary="bar on a plane, pulled and pushed at its end, three forces",
        source="statics: slip creeps in from the end; 2 F³/(3 EA q) a cycle",
        role="tested",
        model=_bar,
        elements=("Q1", "Q2", "P1"),
        parameters=(Parameters(), Parameters(1e-5), Parameters(1e-4)),
        loads=(0.3, 0.5, 0.8),
        exact=_of_bar,
    ),
    BarCase(
        name="parabola_to_and_fro",
        summary="parabola pressed on a strip, then pushed sideways, to and fro",
        source="the same on much finer meshes, with 96 increments",
        role="tested",
        model=_parabola,
        elements=("Q2", "P2"),
        parameters=(Parameters(1e-8, None), Parameters(1e-7, 1e-8), Parameters(1e-6, 1e-7)),
        finer=_finer_parabola,
    ),
    BarCase(
        name="block_to_and_fro",
        summary="block on a plane under pressure, sheared to and fro until it slides",
        source="the same on much finer meshes, with 96 increments",
        role="tested",
        model=_block,
        elements=("Q2", "P2", "Q1"),
        parameters=_PARAMETERS,
        finer=_finer_block,
    ),
)
