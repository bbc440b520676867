"""A kind of load that is not the program's, whose value is a table: what spins is pulled outwards.

The load goes with the square of the speed, and varies over the body with each number of its table.
"""

from functools import partial
from typing import Annotated

import numpy as np
from pydantic import Field

from fenics_contact.problem import loads
from fenics_contact.problem.loads import BodyForce
from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE
from fenics_contact.scene.loading.load_kinds import LoadKind
from fenics_contact.scene.units.dimensions import DENSITY, PLACE, RATE
from fenics_contact.scene.values import PER_AXIS, Number, Positive, scene_class


@scene_class
class Spin:
    """How a body spins in its plane."""

    speed: Annotated[Number, RATE, Field(description="angular velocity; radian over time")]
    density: Annotated[Positive, DENSITY, Field(description="of the body")]
    at: Annotated[
        tuple[Annotated[Number, PLACE], ...], PER_AXIS, Field(description="a point of the axis")
    ]


def away(axis, at, factor, points):
    """A multiple of the distance along an axis from a place."""
    return factor * (points[axis] - at)


class SpinKind(LoadKind):
    """ρ ω² (x − at)."""

    def components(self, value):
        """One function of the place for each axis."""
        factor = value.density * value.speed**2
        return tuple(partial(away, axis, at, factor) for axis, at in enumerate(value.at))

    def vectors(self, value, key):
        """The place has an entry for each axis."""
        return {f"{key}.at": value.at}

    def times(self, value, factor):
        """Of the load, not of the speed."""
        return Spin(value.speed, factor * value.density, value.at)

    def slopes(self, value, names):
        """By the speed, the density, or a coordinate of the axis."""
        by = {
            "speed": 2 * value.density * value.speed,
            "density": value.speed**2,
        }
        if names[0] in by:
            return tuple(partial(away, axis, at, by[names[0]]) for axis, at in enumerate(value.at))
        slope = np.zeros(len(value.at))
        slope[int(names[1])] = -value.density * value.speed**2
        return tuple(slope.tolist())


KIND = SpinKind("spin", MAX_CONTACT_PRESSURE)
SPIN = Annotated[Spin | None, KIND, Field(description="spins about an axis across its plane")]


class Spinning(BodyForce):
    """A force over the volume of a part that spins."""

    kind = "spin"


def register():
    """Make it known."""
    loads.register(Spinning, SPIN)


def unregister():
    """Make it unknown again."""
    loads.unregister(Spinning.kind)
