"""What every law along a contact answers: the interface that all other rooms go through."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.contact.laws.friction.gradient import FrictionGradient
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.law import ContactLaw
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.state import OPEN, SLIP
from fenics_contact.results.point_arrays import PointArray
from fenics_contact.scene.values import Value

Mode = Literal["law", "coupled", "status", "held", "off"]


class FrictionLaw(ContactLaw):
    """The law along a contact; this one exerts nothing, and others say what they do instead.

    Attributes:
        has_friction: Whether it has a bound, up to which points stick and beyond which they slip.
        carries_shear: Whether it can exert a force along the surface.
        follows_path: Whether slip counts from the last accepted load step, so that answers depend
            on the way there.
        mode: What it does in a solve: ``law`` follows the friction law; ``coupled`` does so
            and lets the tangent know that the bound follows the pressure; ``status`` has
            springs g/ε on points that stick and held tractions on those that slip (paper,
            Step 3); ``held`` keeps tractions on all points (Step 4); ``off`` does nothing.
        bound: g that it is solved with, at the points (stress).
        reference: The slip that counts as none, at the points, (points, components) (length).
        is_scaled: Whether ε is known: the scene gives it, or a pressure was found for it.

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
        self.mode: Mode = "law"
        self.bound = np.zeros(len(site.trace.weights))
        self.reference = np.zeros_like(site.trace.normals)
        self.is_scaled = False

    @property
    def parameters(self) -> dict[str, Any]:
        """What the scene gives of it, by its names, for results."""
        coefficient, law = self.site.contact.friction_coefficient, self.site.contact.friction_law
        shown = {} if law is None or law.is_proportional else {"friction_law": law.shown}
        return {"friction_coefficient": coefficient, **shown}

    @property
    def left_out(self) -> str:
        """Kind of the friction law that the scene names though it exerts nothing; mostly none."""
        return ""

    @property
    def follows_speed(self) -> bool:
        """Whether its bound depends on how fast points slide."""
        return self.has_friction and self.rule.follows_speed

    @property
    def depends_on_pressure(self) -> bool:
        """Whether its bound follows a pressure that is not known (Coulomb's friction)."""
        return self.has_friction and not self.normal.pressure_is_known

    @property
    def has_regularisation(self) -> bool:
        """Whether ε stands for no slip at all; the elastic slip of surfaces is what it is."""
        return False

    @property
    def stores_energy(self) -> bool:
        """Whether a part of the slip is elastic, and goes back."""
        return False

    @property
    def finds_scale(self) -> bool:
        """Whether ε follows the pressures that are found."""
        return self.depends_on_pressure and self.site.contact.regularisation_parameter == "auto"

    @property
    def regularisation_parameter(self) -> float:
        """ε as used (length), 0 without friction."""
        return 0.0

    @property
    def chosen_parameter(self) -> float:
        """The ε that was set, of which a part may be used (length)."""
        return 1.0

    def set_scale(self, epsilon: float) -> None:
        """Use an ε from now on, unless it is 0: under no pressure it does not matter (length)."""

    def scale_regularisation(self, left: float) -> None:
        """Use this part of every ε that is set, from now on."""

    def scale_coefficient(self, factor: float) -> None:
        """Use so many times the friction coefficient, from now on."""

    def set_bound(self, bound: Array) -> None:
        """Set g at the points (stress)."""

    def set_share(self, share: float) -> None:
        """Use this share of the coefficient, from below or above 1, on the way to all of it."""

    def follow_given(self, pressure: Array) -> None:
        """Take the bound, and the ε that it needs, from a pressure that is given (stress)."""

    def bound_of(self, pressure: Array) -> Array:
        """The bound that a pressure gives friction, at the points (stress)."""
        return np.zeros(len(pressure))

    @property
    def largest_coefficient(self) -> Array:
        """Largest ratio of the bound to a pressure, over all pressures, at the points."""
        return np.zeros(len(self.site.trace.weights))

    def present_bound(self, pressure: Array) -> Array:
        """The bound at a pressure of its normal law (stress)."""
        return np.zeros(len(pressure))

    def bound_slope(self, pressure: Array) -> Array:
        """Derivative of ``bound_of`` in the pressure at the points, (points,)."""
        return np.zeros(len(pressure))

    def stick_all(self) -> None:
        """Set the tangent to the adhesive start: u_T = 0 and no friction yet."""

    def slip_all(self, slip: Array) -> None:
        """Set the tangent to points that have slipped.

        Args:
            slip: As the law counts it, nowhere 0, (points, components) (length).
        """

    @property
    def tangent_state(self) -> tuple[Array, Array]:
        """Slip and direction that the tangent is at, to take again; (points, components) each."""
        nothing = np.zeros_like(self.reference)
        return nothing, nothing

    def take_tangent_state(self, state: tuple[Array, Array]) -> None:
        """Set the tangent as it was after another solve."""

    def follow(self, slip: Array) -> None:
        """Move the tangent to a new state.

        Args:
            slip: w_T since the start at the points, (points, components) (length).
        """

    def take_true_tangent(self, slip: Array) -> None:
        """Set the tangent to the law's own derivative at a state that is an answer.

        Args:
            slip: As of ``follow``.
        """

    def accept(self, slip: Array) -> None:
        """A load step is done at a slip since the start."""

    def recall_scale(self, epsilon: float, is_scaled: bool) -> None:
        """Use an ε that was used before.

        Args:
            epsilon: As ``chosen_parameter`` (length).
            is_scaled: As it was then.
        """

    def remember(self, pressure: Array) -> dict[str, Array]:
        """The arrays of ``state`` by name.

        Args:
            pressure: Of the normal law at the points (stress).
        """
        return self.kept() | {"bound": self.present_bound(pressure).copy()}

    def hold(self, traction: Array) -> None:
        """Set the tractions of the modes ``held`` and ``status``, (points, components)."""

    def set_status(self, sticks: Flags, directions: Array, bound: Array) -> None:
        """Springs g/ε on points that stick, friction against directions on those that slip.

        Args:
            sticks: Which points stick.
            directions: Of the scaled slip, (points, components).
            bound: g at the points (stress).
        """

    def glue(self, stiffness: float, points: Flags) -> None:
        """Springs along the surface at some points (stress/length), whatever the pressure."""

    def effective_slip(self, slip: Array) -> Array:
        """The slip that the law sees: since the start, or since the last accepted step."""
        return slip

    def sliding(self, slip: Array) -> Array:
        """The part of the slip since the start, or since the last step, that does not go back.

        Args:
            slip: Since the start, (points, components) (length).
        """
        return self.effective_slip(slip)

    def stored(self, traction: Array, slip: Array) -> Array:
        """Energy of the slip that goes back, (points,) (energy/area).

        Args:
            traction: On the body, (points, components) (stress).
            slip: Since the start, likewise (length).
        """
        return np.zeros(len(slip))

    def scaled_slip(self, slip: Array) -> Array:
        """The effective slip as friction feels it: it sticks where this is no longer than ε.

        Args:
            slip: Since the start, (points, components) (length).
        """
        return self.rule.metric.at(self.effective_slip(slip))

    def traction_from_bound(self, bound: Array, directions: Array) -> Array:
        """Traction on the body by friction of a size, (points, components) (stress).

        Args:
            bound: g, or what is used of it, at the points (stress).
            directions: Of the scaled slip, (points, components).
        """
        return 0.0 - bound[:, None] * self.rule.metric.at(directions)

    def bound_for_regularisation(self, bound: Array) -> Array:
        """The friction whose sticking ε must not be seen beside: the least of all directions.

        A point sticks until it has slipped by ε as friction feels it; along a direction in which
        it feels less that is longer, while there is less friction.

        Args:
            bound: g at the points (stress).
        """
        return bound * self.rule.metric.least**2

    def traction(self, slip: Array) -> Array:
        """Traction on the body for a slip since the start, (points, components) (stress)."""
        return np.zeros_like(slip)

    def vjp(self, slip: Array, pressure: Array, of_traction: Array) -> FrictionGradient:
        """What a quantity's derivatives in its tractions are in what it works on.

        Args:
            slip: Since the start, (points, components) (length).
            pressure: At the points (stress).
            of_traction: Derivatives of the quantity in ``traction``, (points, components).
        """
        nothing = np.zeros_like(slip)
        return FrictionGradient(nothing, nothing, np.zeros(len(slip)), {})

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """What a quantity's derivatives in arrays of its state are in what makes them in a step.

        Args:
            slip: At its end, since the start, (points, components) (length).
            closed: Points in contact at its end.
            of_end: Derivatives of the quantity in arrays at its end, by name; none of others.

        Returns:
            Derivatives in the slip that counts, (points, components), and by name in the arrays as
            they were at its begin and in parameters, as of ``FrictionGradient.fields``.
        """
        return np.zeros_like(slip), {}

    def vjp_reference(self, of_reference: Array) -> tuple[Array, Mapping[str, Array]]:
        """What a quantity's derivatives in ``reference`` are in what the step before left.

        Args:
            of_reference: Derivatives of the quantity, (points, components).

        Returns:
            Derivatives in the slip since the start, likewise, and in arrays of the state, by name.
        """
        return np.zeros_like(of_reference), {}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Derivatives of its parameters at the points in a key of the contact; collective.

        Args:
            key: Such as ``friction_coefficient``.
            unit: Derivative of what the scene gives under it, itself a value of a scene.

        Returns:
            Name as of ``FrictionGradient.fields`` → (points,); nothing for other keys.
        """
        return {}

    def work(self, given: Array, before: Array, traction: Array, slip: Array) -> Array:
        """Dissipated since the start, or in the present step where slip counts from the last one.

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
        """OPEN, STICK or SLIP.

        Args:
            closed: Points in contact.
            slip: The scaled one (length).
            bound: g at the points (stress).
        """
        return np.where(closed, SLIP, OPEN)

    def status_at_rest(self, closed: Flags) -> Words:
        """The same before there are any loads."""
        return np.where(closed, SLIP, OPEN)
