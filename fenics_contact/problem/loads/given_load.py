"""Loads of a scene with their paths, and forces that drive a body or stand for errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.problem.loads.acting_load import ActingLoad
from fenics_contact.scene.values import Repetition


@dataclass(frozen=True, eq=False)
class GivenLoad:
    """A load of a scene with its path.

    Attributes:
        name: For results.
        acting: The load where the path is 1.
        path: Its factor over pseudo-time.
    """

    name: str
    acting: ActingLoad
    path: Callable[[float], float]

    @cached_property
    def form(self) -> fem.Form:
        """Linear form of its work, compiled; collective when first asked for."""
        return _compiled(self.acting)

    def nodal(self) -> Array:
        """Return the nodal forces where the path is 1, (nodes, components); collective (force)."""
        return self.acting.spaces.assemble(self.form)

    def nodal_of_units(self, found: dict[Any, list[Array]]) -> Array:
        """Return the nodal forces, by units of its components that are assembled once; collective.

        Args:
            found: Nodal forces of units of earlier loads on the body; those of this one are added.
        """
        acting = self.acting
        if not acting.is_constant:
            return self.nodal()
        key = type(acting), acting.group
        if key not in found:
            size = range(len(acting.given))
            units = [acting.of_unit(component) for component in size]
            found[key] = [acting.spaces.assemble(_compiled(unit)) for unit in units]
        return np.tensordot(np.array(acting.given, dtype=np.float64), found[key], axes=(0, 0))


def _compiled(acting: ActingLoad) -> fem.Form:
    """The work of a load as a linear form."""
    return form_cache.form(acting.work(ufl.TestFunction(acting.spaces.displacement_space)))


@dataclass(frozen=True, eq=False)
class Drive:
    """Forces to and fro about a state.

    Attributes:
        nodal: Largest of them, (nodes, components) (force).
        rest: Pseudo-time at which all load paths of the scene rest.
        share: Factor over the pseudo-time since then.
    """

    nodal: Array
    rest: float
    share: Callable[[float], float]

    def at(self, time: float) -> Array:
        """The forces at a pseudo-time."""
        return self.nodal * self.share(time - self.rest)


@dataclass(frozen=True, eq=False)
class Disturbance:
    """Forces besides the scene's that grow from nothing, to see what they do.

    In straight lines through all that are known, and on as the last two lead.

    Attributes:
        times: Pseudo-times at which they are known, increasing, > 0; of loads that come again and
            again up to the end of the first cycle.
        nodal: The forces, each (nodes, components) (force).
        repetition: Of the loads, if they come again and again: then so do these.
    """

    times: Sequence[float]
    nodal: Sequence[Array]
    repetition: Repetition | None = None

    @classmethod
    def growing(cls, nodal: Array, time: float) -> Disturbance:
        """Evenly, to be so large at a pseudo-time."""
        return cls([time], [nodal])

    def at(self, now: float) -> Array:
        """The forces at a pseudo-time of the load steps."""
        time = now if self.repetition is None else self.repetition.first_time(now)
        place = min(int(np.searchsorted(self.times, time)), len(self.times) - 1)
        begin = self.times[place - 1] if place else 0.0
        first = self.nodal[-1] if time < now else 0.0  # a cycle begins where the last one ended
        before = self.nodal[place - 1] if place else first
        share = (time - begin) / (self.times[place] - begin)
        return np.asarray(before + share * (self.nodal[place] - before))
