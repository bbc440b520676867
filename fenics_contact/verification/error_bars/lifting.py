"""A block that lifts off a rough floor at its sides: no load moves the edges of its contact.

Bars that look at how quantities scatter as the load moves edges through cells see nothing of these:
without a gap at the start the whole answer is proportional to the load (J. Dundurs, M. Stippes,
J. Appl. Mech. 37 (1970) 965-970).
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Point
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.verification.error_bars.case import BarCase, Element, Model, Parameters
from fenics_contact.verification.hard.bodies import box

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


CASES: tuple[BarCase, ...] = (
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
