"""The regularisation parameter ε of friction: where it is from, and how large it has to be."""

from __future__ import annotations

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.site import LawSite


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
        given = rule.longest_elastic_slip or site.contact.regularisation_parameter
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
