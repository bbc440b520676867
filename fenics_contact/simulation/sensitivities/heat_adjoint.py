"""The adjoint of temperatures that conduction finds together with the contact pressures.

Temperatures T expand the body, whose contacts then press by p(T), and so they conduct: T = S(p).
With the gradient j of a quantity in temperatures that are given, its gradient in heat that flows
into the nodes is η = K⁻¹ g, g = j + (∂p/∂T)ᵀ (∂S/∂p)ᵀ g, K that of bodies and contacts. At a point
(∂S/∂p)ᵀ g is −h' s s(η): the conductance grows by h', and heat flows by the step s of temperature.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from dolfinx import fem
from scipy.sparse.linalg import LinearOperator, gmres

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import gather_rows
from fenics_contact.contact.point_gradients import AnswerGradient, GivenGradient
from fenics_contact.problem.conduction.conduction import Conduction
from fenics_contact.problem.loads.temperatures import ThermalStrain
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.sensitivities.quantity_gradients import StateGradient
from fenics_contact.solve.condensed.adjoint import Multipliers
from fenics_contact.solve.systems.solution import Solution

# Gives multipliers of a quantity, and its gradient in what each contact is given.
Adjoint = Callable[[StateGradient], tuple[Multipliers, list[GivenGradient]]]

# Of the gradient in temperatures: what its linear solve may leave.
_LEFT, _MOST = 1e-12, 200


@dataclass(frozen=True, eq=False)
class HeatGradient:
    """Gradient of a quantity in what conduction is given.

    Attributes:
        conduction: The conduction.
        by_heat: In heat that flows into each node of all ranks, (nodes,).
        by_rise: In rises that are given there, (nodes,); at other nodes without meaning.
        by_conductance: Of each contact that conducts in its conductance at this rank's points,
            over area, (points,).
    """

    conduction: Conduction
    by_heat: Array
    by_rise: Array
    by_conductance: list[Array]

    def along_conductance(self, number: int, shares: Callable[[Array], Array]) -> float:
        """Derivative in a number of a contact's conductance; collective.

        Args:
            number: Of the contact, among those that conduct.
            shares: Slope of the conductance in the number by the pressure at the points.
        """
        one = self.conduction.contacts[number]
        pressure = one.contact.state().contact_pressure
        return float(one.contact.trace.integral(self.by_conductance[number] * shares(pressure)))


class HeatAdjoint:
    """Derivatives of quantities of an answer whose temperatures follow its pressures; collective.

    Args:
        problem: In the state of the answer.
        solution: The answer.

    Raises:
        InputError: The body has other scalars than thermal strains.
    """

    def __init__(self, problem: Problem, solution: Solution) -> None:
        assert problem.conduction is not None
        elastic = problem.elastic
        if elastic.mixed is not None:
            raise InputError(
                "derivatives: where temperatures are found, nearly incompressible materials have "
                "none yet"
            )
        if not all(isinstance(one, ThermalStrain) for one in problem.body_scalars):
            raise InputError(
                "derivatives: where temperatures are found, preloads and couplings have none yet"
            )
        self._problem, self._conduction = problem, problem.conduction
        self._states = solution.states
        self._virtual = fem.Function(problem.spaces.displacement_space)
        self._energy = fem.Constant(problem.spaces.body.mesh, 0.0)
        problem.displacement.x.array[:] = solution.displacement.reshape(-1)
        stress = elastic.displacement_stress(self._virtual) - self._energy * elastic.stress()
        self._parts = [part for part in elastic.heated if part.described.is_found]
        self._forms = [form_cache.form(part.work_on_rise(stress)) for part in self._parts]
        self._steps = self._conduction.steps()

    def settled(self, state: StateGradient, adjoint: Adjoint) -> tuple[StateGradient, HeatGradient]:
        """The quantity with what temperatures that follow add to it, and its gradient in heat.

        Args:
            state: Derivatives in what happens, temperatures being held.
            adjoint: Of the body at held temperatures.

        Raises:
            NotConvergedError: The answer is at a limit.
        """

        def returned(gradient: Array) -> Array:
            """(∂p/∂T)ᵀ (∂S/∂p)ᵀ g."""
            pressed = self._by_pressure(self._by_heat(gradient))
            return self._in_temperatures(pressed, adjoint)

        start = self._in_temperatures(state, adjoint)
        size = len(start)
        operator = LinearOperator((size, size), lambda g: g - returned(g), dtype=np.float64)
        found, failed = gmres(operator, start, rtol=_LEFT, restart=_MOST, maxiter=1)
        if failed or not np.isfinite(found).all():
            raise NotConvergedError(
                "derivatives: the answer is at a limit, where temperatures do not follow what is "
                "given"
            )
        by_heat = self._by_heat(found)
        every = state.plus(self._by_pressure(by_heat))
        steps = self._conduction.steps_of(by_heat)
        back = self._conduction.over(self._states, steps)
        by_rise = found - self._conduction.bodies.matrix @ by_heat + sum(back.values())
        by_conductance = [-own * other for own, other in zip(self._steps, steps, strict=True)]
        folded = self._conduction.bodies.following.T @ by_rise
        gradient = HeatGradient(self._conduction, by_heat, folded, by_conductance)
        return replace(every, resultant=state.resultant), gradient

    def _by_heat(self, gradient: Array) -> Array:
        """Gradient in heat that flows into the nodes of all ranks, by that in temperatures."""
        return self._conduction.answer_to(gradient, self._states)

    def _by_pressure(self, by_heat: Array) -> StateGradient:
        """Gradient in the contact pressures, as far as these change what contacts conduct."""
        found, problem = StateGradient.none(self._problem), self._problem
        contacts: list[AnswerGradient] = [*found.contacts]
        rows = zip(
            self._conduction.contacts,
            self._steps,
            self._conduction.steps_of(by_heat),
            strict=True,
        )
        for one, own, other in rows:
            number = self._conduction.number_of(one)
            slope = one.conductance_slopes(self._states[number].contact_pressure)
            by_pressure = -problem.contacts[number].trace.weights * slope * own * other
            contacts[number] = contacts[number].adding(pressure=by_pressure)
        return replace(found, contacts=contacts)

    def _in_temperatures(self, state: StateGradient, adjoint: Adjoint) -> Array:
        """Gradient in the temperatures of all nodes of all ranks, these being held otherwise."""
        multipliers, _ = adjoint(state)
        self._virtual.x.array[:] = multipliers.displacement.reshape(-1)
        self._energy.value = state.energy
        found = np.zeros(len(self._problem.spaces.coordinates))
        for part, form in zip(self._parts, self._forms, strict=True):
            found += part.onto_nodes(np.array(fem.assemble_vector(form).array))
        bodies = self._conduction.bodies
        numbers, shares = gather_rows(
            self._problem.comm, np.column_stack([bodies.numbers, found])
        ).T
        return np.bincount(numbers.astype(np.int64), shares, bodies.count)
