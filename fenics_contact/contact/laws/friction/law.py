"""The law along a contact: its bound and traction with their slopes, what it keeps, and its ε.

A law knows no solver: how its forces enter a solve is up to ``term.FrictionTerm``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.friction.rule import FrictionRule
from fenics_contact.contact.laws.law import ContactLaw
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import OPEN, SLIP
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.values import Value


class FrictionLaw(ContactLaw):
    """The law along a contact; this one is that of no friction, and others derive from it.

    Attributes:
        has_friction: Whether it has a bound, up to which points stick and beyond which they slip.
        carries_shear: Whether it can exert a force along the surface.
        follows_path: Whether slip counts from the last accepted load step, so that answers depend
            on the way there.
        follows_speed: Whether its bound depends on how fast points slide.
        stores_energy: Whether a part of the slip is elastic, and goes back.
        left_out: Kind of the friction law that the scene names though nothing rubs; mostly empty.
        normal: The law across the contact.
        rule: How large friction may be.
        neighbours: How its bound averages the pressure; None where each point goes by its own.
        regularisation: Its ε.
        factor: How often the friction coefficient is used.
        bound: g that it is solved with, at the points (stress).
        reference: The slip that counts as none, at the points, (points, components) (length).

    Args:
        site: Where it acts.
        normal: The law across the contact.
        rule: How large friction may be.
    """

    kind: ClassVar[str] = "none"
    model: ClassVar[str] = "no friction"
    has_friction: ClassVar[bool] = False
    carries_shear: ClassVar[bool] = False
    follows_path: ClassVar[bool] = False
    state: tuple[PointArray, ...] = (
        PointArray("reference", "length", is_vector=True, is_written=False),
        PointArray("bound", "stress", is_written=False),
    )

    def __init__(self, site: LawSite, normal: NormalLaw, rule: FrictionRule) -> None:
        super().__init__(site)
        self.normal, self.rule = normal, rule
        self.follows_speed = self.has_friction and rule.follows_speed
        self.stores_energy = self.has_friction and rule.longest_elastic_slip is not None
        self.left_out = ""
        self.neighbours: SurfaceAverage | None = rule.neighbours if self.has_friction else None
        self.regularisation = Regularisation(
            site, rule, self.has_friction, normal.pressure_is_known
        )
        self.factor = 1.0
        self.bound = np.zeros(len(site.trace.weights))
        self.reference = np.zeros_like(site.trace.normals)

    def set_bound(self, bound: Array) -> None:
        """Set g at the points, by which tractions go from now on.

        Args:
            bound: As a solver found it, or a share of it, (points,) (stress).
        """
        self.bound = bound

    def scale_coefficient(self, factor: float) -> None:
        """Use so many times the friction coefficient, from now on."""
        self.factor = factor

    def bound_of(self, pressure: Array) -> Array:
        """Bound g of friction under a pressure, at the points, (points,) (stress); collective.

        Args:
            pressure: Contact pressure at the points (stress).
        """
        return np.zeros(len(pressure))

    def bound_slope(self, pressure: Array) -> Array:
        """Derivative of ``bound_of`` in the pressure at the points, (points,); collective.

        Args:
            pressure: Contact pressure at the points (stress).
        """
        return np.zeros(len(pressure))

    @property
    def largest_coefficient(self) -> Array:
        """Largest ratio of the bound to a pressure, over all pressures, at the points."""
        return np.zeros(len(self.site.trace.weights))

    def effective_slip(self, slip: Array) -> Array:
        """The slip that friction acts on: since the start, or since the last accepted step.

        Args:
            slip: Since the start, (points, components) (length).
        """
        return slip

    def scaled_slip(self, slip: Array) -> Array:
        """The effective slip as friction feels it: points stick where this is no longer than ε.

        Args:
            slip: Since the start, (points, components) (length).
        """
        return self.rule.metric.at(self.effective_slip(slip))

    def sliding(self, slip: Array) -> Array:
        """The part of the effective slip that does not go back, (points, components) (length).

        Args:
            slip: Since the start, (points, components) (length).
        """
        return self.effective_slip(slip)

    def traction_from_bound(self, bound: Array, directions: Array) -> Array:
        """Traction on the body by friction of a size, (points, components) (stress).

        Args:
            bound: g, or what is used of it, at the points (stress).
            directions: Of the scaled slip, (points, components).
        """
        return 0.0 - bound[:, None] * self.rule.metric.at(directions)

    def traction(self, slip: Array) -> Array:
        """Traction on the body under the present bound, (points, components) (stress).

        Args:
            slip: Since the start, (points, components) (length).
        """
        return np.zeros_like(slip)

    def vjp(self, slip: Array, pressure: Array, of_traction: Array) -> FrictionGradient:
        """From a quantity's gradient in tractions to that in slip, pressure and parameters.

        Args:
            slip: Since the start, (points, components) (length).
            pressure: At the points (stress).
            of_traction: Gradient of the quantity in ``traction``, (points, components).
        """
        nothing = np.zeros_like(slip)
        return FrictionGradient(nothing, nothing, np.zeros(len(slip)), {})

    def accept(self, slip: Array) -> None:
        """Count slip from the end of a load step, where the law follows the path.

        Args:
            slip: Then, since the start, (points, components) (length).
        """

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """From a quantity's gradient in the state at a step's end to those in what makes it.

        Args:
            slip: At its end, since the start, (points, components) (length).
            closed: Points in contact at its end.
            of_end: Gradient of the quantity in arrays at its end, by name; none of others.

        Returns:
            Gradient in the effective slip, (points, components), and by name in the arrays as
            they were at its begin and in parameters, as of ``FrictionGradient.fields``.
        """
        return np.zeros_like(slip), {}

    def vjp_reference(self, of_reference: Array) -> tuple[Array, Mapping[str, Array]]:
        """From a quantity's gradient in ``reference`` to those in what the step before left.

        Args:
            of_reference: Gradient of the quantity, (points, components).

        Returns:
            Gradient in the slip since the start, likewise, and in arrays of the state, by name.
        """
        return np.zeros_like(of_reference), {}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of its parameters at the points in a key of the contact; collective.

        Args:
            key: Such as ``friction_coefficient``.
            unit: Derivative of what the scene gives under it, itself a value of a scene.

        Returns:
            Name as of ``FrictionGradient.fields`` → (points,); nothing for other keys.
        """
        return {}

    def work(self, given: Array, before: Array, traction: Array, slip: Array) -> Array:
        """Dissipated since the start, or in the present step where the law follows the path.

        Args:
            given: What friction did by its path along ``sliding``, (points,) (energy/area).
            before: Traction when the step began, (points, components) (stress).
            traction: At the end, likewise.
            slip: Since the start, likewise (length).

        Returns:
            (points,) (energy/area).
        """
        return np.zeros(len(slip))

    def status(self, closed: Flags, slip: Array, bound: Array) -> Words:
        """OPEN, STICK or SLIP at the points.

        Args:
            closed: Points in contact.
            slip: The scaled one, (points, components) (length).
            bound: g, or before any loads its ratio to a pressure: points without one slip.
        """
        return np.where(closed, SLIP, OPEN)


@dataclass(frozen=True, eq=False)
class FrictionGradient:
    """Gradient of a quantity in what a law along a contact works on, at the points.

    Attributes:
        slip: In the slip since the start, (points, components).
        reference: In the slip that counts as none, likewise.
        pressure: In the pressure that the bound follows, (points,).
        fields: In each parameter of the law by name, the arrays of its rule's state among them,
            (points,), or (points, components) of vectors.
    """

    slip: Array
    reference: Array
    pressure: Array
    fields: Mapping[str, Array]


class Regularisation:
    """ε of a contact, the slip up to which its points stick; 0 without friction.

    Attributes:
        is_numerical: Whether ε stands for no slip at all, and not for the elastic slip of surfaces.
        is_automatic: Whether ε is to follow from the pressure.
        follows_pressure: Whether it is automatic, and that pressure is found by the solver.
        chosen: The ε that was set, of which a part may be used (length).
        is_known: Whether ε is known: the scene gives it, or a pressure was found for it.

    Args:
        site: Where friction acts.
        rule: How large it may be.
        has_friction: Whether there is any.
        pressure_is_known: Whether the contact pressure is given.
    """

    def __init__(
        self, site: LawSite, rule: FrictionRule, has_friction: bool, pressure_is_known: bool
    ) -> None:
        self._site, self._rule, self._acts = site, rule, has_friction
        self.is_numerical = has_friction and rule.longest_elastic_slip is None
        given = rule.longest_elastic_slip or site.contact.regularisation_parameter or "auto"
        self.is_automatic = self.is_numerical and given == "auto"
        self.follows_pressure = self.is_automatic and not pressure_is_known
        self.chosen, self._share = 1.0, 1.0
        self.is_known = False
        if given != "auto":
            self.set(float(given))

    @property
    def parameter(self) -> float:
        """ε as used (length), 0 without friction."""
        return self.chosen * self._share if self._acts else 0.0

    def set(self, epsilon: float) -> None:
        """Use an ε from now on, unless it is 0: under no pressure it does not matter.

        Args:
            epsilon: The parameter (length).
        """
        if self._acts and epsilon > 0:
            self.recall(epsilon, True)

    def recall(self, epsilon: float, is_known: bool) -> None:
        """Use an ε that was used before.

        Args:
            epsilon: As ``chosen`` was (length).
            is_known: As it was then.
        """
        if self._acts:
            self.chosen, self.is_known = epsilon, is_known

    def scale(self, share: float) -> None:
        """Use a share of every ε that is set, from now on, unless it is the surfaces' own."""
        self._share = share if self.is_numerical else 1.0

    def needed(self, bound: Array) -> float:
        """The ε whose bias is below 0.1 % under a friction bound, 0 without one; collective.

        A point sticks until it has slipped by ε as friction feels it. Along a direction in which it
        feels less, that is a longer slip, while there is less friction.

        Args:
            bound: g at the points, (points,) (stress).
        """
        weakest = bound * self._rule.metric.least**2
        comm = self._site.trace.spaces.comm
        return self._site.scales.regularisation_parameter(largest(comm, weakest))
