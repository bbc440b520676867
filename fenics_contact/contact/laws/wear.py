"""Wear by slip under pressure, which widens the gap of the load steps that follow."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.law import ContactLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import STICK, ContactState, LastStep
from fenics_contact.quantities.names import MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.results.contact_points import PointArray


class Unworn(ContactLaw):
    """Nothing is worn.

    Attributes:
        wears: Whether anything can be.

    Args:
        site: Where it acts.
        friction: The law along the contact, which counts slip.
        last_step: What is kept of the last load step.
    """

    kind: ClassVar[str] = "none"
    model: ClassVar[str] = "no wear"
    wears: ClassVar[bool] = False

    def __init__(self, site: LawSite, friction: FrictionLaw, last_step: LastStep) -> None:
        super().__init__(site)
        self._friction, self._last = friction, last_step

    @property
    def depth(self) -> Array:
        """Depth worn off both surfaces together, before the present step (length)."""
        return np.zeros(len(self.site.trace.weights))

    def quantities(self, state: ContactState) -> dict[str, float]:
        """Worn volume and depth at the end of the present step, by name; collective."""
        return {}


class Archard(Unworn):
    """Archard's law, k ⟨p − p₀⟩ |ds|: the depth that a slip ds under a pressure p wears off.

    Over a load step p is the mean of its pressures at both ends, as in the work of friction: where
    all points slip, the worn volume is k/μ times that work. Points that stick wear nothing: their
    creep is the regularisation's. The gap is that of the end of the step before.
    """

    kind: ClassVar[str] = "archard"
    model: ClassVar[str] = "wear by Archard's law"
    wears: ClassVar[bool] = True
    state: tuple[PointArray, ...] = (PointArray("worn_depth", "length"),)

    def __init__(self, site: LawSite, friction: FrictionLaw, last_step: LastStep) -> None:
        super().__init__(site, friction, last_step)
        said = site.contact.wear
        assert said is not None
        self._coefficient = site.given(said.coefficient, "wear.coefficient")
        self._threshold = said.threshold
        on = said.share
        self._shares = {} if on is None else {"on": on, "against": 1.0 - on}
        self.worn_depth = np.zeros(len(site.trace.weights))

    @property
    def depth(self) -> Array:
        """Depth worn off both surfaces together, before the present step (length)."""
        return self.worn_depth

    def at_step_end(self, state: ContactState) -> dict[str, Array]:
        """Depth worn so far, with that of the step, by name."""
        pressure = np.maximum(self._last.mean_pressure(state) - self._threshold, 0.0)
        way = np.linalg.norm(self._slip_in_step(state), axis=1)
        worn = np.where(state.status == STICK, 0.0, self._coefficient * pressure * way)
        return {"worn_depth": self.worn_depth + worn}

    def _slip_in_step(self, state: ContactState) -> Array:
        if self._friction.follows_path:
            return self._friction.sliding(state.slip)
        return state.slip - self._last.state.slip

    def quantities(self, state: ContactState) -> dict[str, float]:
        """Worn volume, and the deepest wear, at the end of the present step; collective."""
        depth, trace = state.own["worn_depth"], self.site.trace
        volume, deepest = float(trace.integral(depth)), largest(trace.spaces.comm, depth)
        found = {WORN_VOLUME: volume, MAX_WEAR_DEPTH: deepest}
        for side, share in self._shares.items():
            found |= {f"worn_volume_{side}": share * volume}
            found |= {f"max_wear_depth_{side}": share * deepest}
        return found


def wear_of(site: LawSite, friction: FrictionLaw, last_step: LastStep) -> Unworn:
    """The wear of a contact that the scene asks for; ``Unworn`` without.

    Args:
        site: Of the contact.
        friction: The law along it.
        last_step: What is kept of its last load step.

    Raises:
        InputError: A coefficient is negative; on every rank.
    """
    return (Unworn if site.contact.wear is None else Archard)(site, friction, last_step)
