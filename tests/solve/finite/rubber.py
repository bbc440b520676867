"""Scenes in finite strains that several tests use: a pressed block, and a dragged cylinder."""

import dataclasses

from fenics_contact import (
    Contact,
    Group,
    Material,
    Obstacle,
    Path,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.verification.finite.rubber import rubber
from tests.scenes import box_body

NO_ERRORS = SolverSettings(errors="none")
RUBBER = Material(1.0, 0.3, law="neo-Hookean")
FLOOR = Obstacle(shape="plane", position=(0, 0), normal=(0, 1))


def pressed(depth, friction=0.0, steps=1, on="y0", law="neo-Hookean", **more):
    """A quarter of a block between plates: on a floor, its top pressed down and free along.

    Of ``foot`` the side may fold onto the floor.
    """
    return Scene(
        kinematics="plane strain",
        strains="finite",
        material=rubber(law),
        symmetry=("x0",),
        support=(Support("y1", {"y": -depth}),),
        contact=(
            Contact(
                on,
                obstacle=FLOOR,
                friction_coefficient=friction,
                law="incremental" if friction else "static",
            ),
        ),
        steps=Steps(number=steps),
        **{"solver": NO_ERRORS, **more},
    )


def square(cells=4):
    """The block, with ``foot`` of its lower and its right side."""
    body = box_body((cells, cells))
    tags = (*body.groups["y0"].tags, *body.groups["x1"].tags)
    return dataclasses.replace(body, groups={**body.groups, "foot": Group(1, tags)})


def dragged(times, friction=0.3, **more):
    """A cylinder of radius 1 pressed by .5 into a block 8 wide and 3 high, then dragged by 3.

    Cells are .25 large, so that it passes twelve of them.
    """
    roller = Obstacle(
        shape="cylinder",
        radius=1.0,
        position=(2.5, 3.0),
        normal=(0, -1),
        indentation=0.5,
        path=Path(time=(0, 1), factor=(0, 1)),
        displacement=(3.0, 0.0),
        displacement_path=Path(time=(1, 2), factor=(0, 1)),
    )
    contact = Contact("y1", obstacle=roller, friction_coefficient=friction, law="incremental")
    return Scene(
        kinematics="plane strain",
        strains="finite",
        material=RUBBER,
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(contact,),
        steps=Steps(times=tuple(times)),
        **{"solver": NO_ERRORS, **more},
    )


def long_block():
    """Its mesh."""
    return box_body((32, 12), (8, 3))
