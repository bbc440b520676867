"""Energy terms of a contact: that of its normal pressure, and that of its friction.

Pressure as a term of the balance: how a solver uses the law across a contact. The law says what
its forces are; here is what a solver makes of them on its way: whether they follow the jump, or
given pressures act in their place (paper, Step 3).

Friction as a term of the balance: how a solver uses the law along a contact. The law says how
large friction may be and what its traction is; here is what a solver makes of that on its way:
whether the bound follows the pressure within a solve, which points are taken to stick, which
tractions are held, and where the tangent is taken.
"""

from __future__ import annotations

from functools import cached_property
from typing import ClassVar, Literal

import numpy as np
import ufl
from dolfinx.fem import Form as CompiledForm

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.energies import prescribed_pressure_energy
from fenics_contact.contact.laws.friction.friction_forms import FrictionForms
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.friction.tangent import PrimalDual, TangentState
from fenics_contact.contact.laws.law import ContactForce
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.surface.averaging import SurfaceAverage
from fenics_contact.contact.surface.point_rule import TraceFunction


class NormalTerm(ContactForce):
    """Forces of the law across a contact, or pressures that are held in their place.

    Attributes:
        law: The law across the contact.

    Args:
        law: The law across the contact.
    """

    def __init__(self, law: NormalLaw) -> None:
        self.law, self.site = law, law.site
        self.follow_law()

    @property
    def name(self) -> str:
        """Name of the law and of its contact, for results."""
        return self.law.name

    def follow_law(self) -> None:
        """Follow the jump as the law has it."""
        self._held: Array | None = None
        self._held_force: Array | None = None

    def hold(self, pressure: Array) -> None:
        """Press with a given pressure from now on, whatever the jump.

        Args:
            pressure: At the points, (points,) (stress).
        """
        self._held, self._held_force = pressure, None

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """The law's compiled forms."""
        return self.law.forms

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent at present."""
        return self.law.tangents if self._held is None else ()

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        if self._held is None:
            return self.law.force()
        if self._held_force is None:
            function, work = self._pressures
            function.set(self._held)
            self._held_force = self.site.trace.surface.assemble(work)
        return self._held_force

    @cached_property
    def _pressures(self) -> tuple[TraceFunction, CompiledForm]:
        """Pressures at the points and −∫ p v_n, compiled when asked."""
        trace = self.site.trace
        function = trace.function(np.zeros(len(trace.weights)))
        test = ufl.TestFunction(trace.surface.space)
        work = prescribed_pressure_energy(
            test, trace.normal, function.ufl, trace.weight, trace.measure
        )
        return function, form_cache.form(-work)

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress)."""
        if self._held is None:
            return self.law.at_points()
        return -self._held[:, None] * self.site.trace.normals

    def tangent_at_points(self) -> Array:
        """Minus its derivative in the jump, (points, components, components) (stress/length)."""
        return self.law.tangent_at_points() if self._held is None else super().tangent_at_points()


Mode = Literal["law", "coupled", "status", "held", "off"]


class FrictionTerm(ContactForce):
    """Forces along a contact, and their primal-dual tangent, in one of several uses of its law.

    Without friction there are none.

    - ``follow_law``: by the law, under the bound that it has;
    - ``follow_pressure``: the same, and the tangent knows that the bound follows the pressure;
    - ``set_status``: springs g/ε on points that stick, given tractions on those that slip
      (paper, Step 3), and ``glue`` likewise;
    - ``hold``: given tractions on all points (Step 4);
    - ``exert_nothing``.

    Attributes:
        law: The law along the contact.
        tangent_state: The slip and the direction that its tangent is at.
        mode: Which of these uses it is in.
        share: Of the coefficient that is used, on the way to all of it.
    """

    follows_jump: ClassVar[bool] = True

    def __init__(self, law: FrictionLaw) -> None:
        self.law, self.site = law, law.site
        self.tangent_state = TangentState(law)
        self.follow_law()
        self._held = np.zeros_like(law.reference)

    @property
    def name(self) -> str:
        """Name of the friction law and of its contact, for results."""
        return self.law.name

    def follow_law(self) -> None:
        """Follow the law under its present bound, with all of the coefficient."""
        self.mode: Mode = "law" if self.law.has_friction else "off"
        self.share = 1.0

    def follow_pressure(self) -> None:
        """Follow the law, whose bound follows the pressure from one iteration to the next."""
        self.mode = "coupled"

    @property
    def follows_pressure(self) -> bool:
        """Whether the bound follows the pressure from one iteration to the next."""
        return self.mode == "coupled"

    def exert_nothing(self) -> None:
        """Have no forces."""
        self.mode = "off"

    def hold(self, traction: Array) -> None:
        """Exert given tractions, whatever the slip.

        Args:
            traction: On the body, (points, components) (stress).
        """
        self.mode = "held"
        self._held = traction

    def set_status(self, sticks: Flags, directions: Array, bound: Array) -> None:
        """Springs g/ε on points that stick, friction against directions on those that slip.

        Args:
            sticks: Which points stick.
            directions: Of the scaled slip, (points, components).
            bound: g at the points (stress).
        """
        self.hold(self.law.traction_from_bound(np.where(sticks, 0.0, bound), directions))
        self.mode = "status"
        self.law.set_bound(np.where(sticks, bound, 0.0))
        self.tangent_state.stick_all()

    def glue(self, stiffness: float, points: Flags) -> None:
        """Springs along the surface at some points, whatever the pressure.

        Args:
            stiffness: Of the springs (stress/length).
            points: Which points have one.
        """
        bound = np.where(points, stiffness * self.law.regularisation.parameter, 0.0)
        everywhere = np.ones(len(bound), dtype=bool)
        self.set_status(everywhere, np.zeros_like(self._held), bound)

    def use_share(self, share: float) -> None:
        """Use a share of the coefficient, from below or above 1, on the way to all of it."""
        self.share = share

    def bound_of(self, pressure: Array) -> Array:
        """Bound g under a pressure, by the share of the coefficient that is used (stress).

        Collective.

        Args:
            pressure: Contact pressure at the points (stress).
        """
        return self.share * self.law.bound_of(pressure)

    def linearise_at(self, slip: Array) -> None:
        """Move the tangent to a new state, where it follows the law.

        Args:
            slip: Since the start, (points, components) (length).
        """
        if self.mode in ("law", "coupled"):
            self.tangent_state.follow(slip)

    @cached_property
    def compiled_forms(self) -> FrictionForms:
        """Compiled forms of friction; each is compiled when it is first asked for."""
        return FrictionForms(self.law, self.tangent_state)

    def _present_forms(self) -> FrictionForms:
        """The forms, with the law's present numbers."""
        forms = self.compiled_forms
        forms.update(self.share)
        return forms

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """The compiled forms that every solve needs."""
        return (self.compiled_forms.residual, self.compiled_forms.tangent)

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent in the present use, with the law's present numbers."""
        if self.mode in ("held", "off"):
            return ()
        forms = self._present_forms()
        if self.follows_pressure and self.neighbours is None:
            return (forms.tangent, forms.coupling)
        return (forms.tangent,)

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        assemble = self.site.trace.surface.assemble
        if self.mode == "off":
            return super().force()
        if self.mode == "held":
            return self._held_force()
        forms = self._present_forms()
        if self.mode == "status":
            return self._held_force() - assemble(forms.springs)
        return -assemble(forms.residual)

    def _held_force(self) -> Array:
        """Forces of the tractions that are held, at all nodes of the surface; collective."""
        function, work = self.compiled_forms.tractions
        function.set(self._held)
        return self.site.trace.surface.assemble(work)

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress)."""
        kinematics = self.site.kinematics
        if self.mode == "off":
            return super().at_points()
        if self.mode == "held":
            return kinematics.tangential(self._held)
        if self.mode == "status":
            return kinematics.tangential(self._held) - self._primal_dual.springs
        return self.law.traction(kinematics.tangential(kinematics.jump_at_points()))

    def tangent_at_points(self) -> Array:
        """The primal-dual tangent in the present use, (points, components, components)."""
        if self.mode in ("held", "off"):
            return super().tangent_at_points()
        state = self._primal_dual
        found = state.tangent
        if self.follows_pressure and self.neighbours is None:
            jump = self.site.kinematics.jump_at_points()
            slope = self._bound_slope(jump)[:, None] * self.law.normal.pressure_slope(jump)
            found += state.coupling(slope)
        return found

    @property
    def neighbours(self) -> SurfaceAverage | None:
        """Points whose pressures the bound averages."""
        return self.law.neighbours

    def tangent_between_points(self) -> Array:
        """Tangent between points, of a bound that averages pressures of neighbours; collective."""
        neighbours = self.neighbours
        if neighbours is None:
            return super().tangent_between_points()
        if not self.follows_pressure:
            size = self._held.shape[1]
            return np.zeros((len(neighbours.rows), size, size))
        jump = self.site.kinematics.jump_at_points()
        slopes = neighbours.gathered(self.law.normal.pressure_slope(jump))
        along = self._primal_dual.along * self._bound_slope(jump)[:, None, None]
        weighted = neighbours.weights[:, None] * slopes[neighbours.columns]
        return np.asarray(along[neighbours.rows] * weighted[:, None, :])

    def _bound_slope(self, jump: Array) -> Array:
        """Derivative of ``bound_of`` in the pressure at a jump, (points,); collective."""
        return self.share * self.law.bound_slope(self.law.normal.pressure(jump))

    @property
    def _primal_dual(self) -> PrimalDual:
        """The primal-dual tangent in the present state."""
        law, state = self.law, self.tangent_state
        return PrimalDual(
            jump=self.site.kinematics.jump_at_points() - law.reference,
            normal=self.site.trace.normals,
            bound=law.bound,
            epsilon=law.regularisation.parameter,
            direction=state.direction_at_points,
            length=state.length_at_points,
            metric=law.rule.metric,
        )
