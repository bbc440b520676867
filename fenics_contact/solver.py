"""The room for PETSc: Newton's method (SNES) on the full space (paper, Section 4).

The bulk is linear, so its stiffness is assembled once; a Newton step adds only
the tangents of the contacts' terms to a copy of it.
"""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray
from petsc4py import PETSc

from fenics_contact.errors import NotConvergedError
from fenics_contact.linear_system import LinearSystem
from fenics_contact.parallel import largest, smallest, total
from fenics_contact.problem import Problem
from fenics_contact.solution import Solution
from fenics_contact.start import starting_point
from fenics_contact.timings import Timings

logger = logging.getLogger(__name__)

OPTIONS_PREFIX = "fenics_contact_"
# What the user sets (PETSC_OPTIONS, or petsc4py's Options) wins over these.
DEFAULT_OPTIONS = {
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
    "mat_mumps_icntl_14": 50,
}

# Full steps are best from the adhesive start with the primal-dual tangent, where searches only
# cost steps or stall in round-off. One-sided contact needs a search on the energy: for a point
# along the step where its derivative vanishes, which takes no difference of nearly equal energies.
FULL_STEPS = {"snes_linesearch_type": "basic"}
# Its absolute tolerance would be in the user's units, and end a solve behind our back.
ENERGY_SEARCH = {
    "snes_linesearch_type": "cp",
    "snes_linesearch_max_it": 3,
    "snes_linesearch_atol": 1e-300,
}

# Share of the applied forces above which a round-off floor is not believed: the
# floor grows with |u|, and a body that runs away must not pass for an answer.
_LARGEST_FLOOR = 1e-6

_RUNAWAY = 1e3  # of the body's size

_NOT_A_NUMBER = -4  # the reason's name differs between PETSc's versions
_REASONS = {
    -3: "the linear system could not be solved (a singular matrix: is the body held?)",
    _NOT_A_NUMBER: "the forces became infinite or not a number",
    -5: "the Newton steps allowed were used up",
    -6: "the line search found no step",
    -9: "the force imbalance grows",
}


class Newton:
    """SNES on the displacements, mean stresses and scalar unknowns of a problem.

    The bulk's matrix is assembled once; solves follow each other from where the last ended.

    Attributes:
        history: Force imbalance before every Newton step and at the end, of all solves (force).
        steps: Newton steps of all solves.
    """

    def __init__(self, problem: Problem, timings: Timings) -> None:
        self.problem = problem
        self.timings = timings
        self.comm = problem.comm
        self.history: list[float] = []
        self.steps = 0
        self.own_options: list[str] = []
        spaces = problem.spaces
        self.owned_size = spaces.owned_nodes * spaces.components
        constrained = problem.constrained
        self.owned_constrained = constrained[constrained < self.owned_size]
        with timings.phase("assemble"):
            self.system = LinearSystem(problem)
        self.tangent = self.system.stiffness.duplicate(copy=True)
        self.state, self.residual = self.tangent.createVecs()
        self.work = self.state.duplicate()
        self.held_norm = 0.0
        self.limit = 0.0
        self.refuses_runaway = any(contact.is_one_sided for contact in problem.contacts)
        self.tiny = 0.0
        self._before = 0

    def destroy(self) -> None:
        """Free PETSc's objects: factors hold communicators, of which there are few."""
        self.system.destroy()
        for thing in (self.tangent, self.state, self.residual, self.work):
            thing.destroy()

    def run(self, search_energy: bool = True) -> None:
        """Solve from the present state, with the modes that the contacts' terms have.

        Args:
            search_energy: Search along the steps where a contact is one-sided; else full steps.

        Raises:
            NotConvergedError: In words, with the history of the force imbalance.
        """
        self._before = len(self.history)
        self.limit = 0.0
        with self.timings.phase("solve"):
            log = _FactorisationLog()
            snes = self._create_snes(search_energy)
            snes.solve(None, self.state)
            reason = snes.getConvergedReason()
            self._take(self.state)
            snes.destroy()
            for name in self.own_options:  # the database is global: the next may want others
                PETSc.Options().delValue(name)
            self.own_options.clear()
            self.timings.move("solve", "factorise", log.seconds())
        self.steps += max(len(self.history) - self._before - 1, 0)
        accepted = len(self.history) > self._before and self.history[-1] <= self.limit
        if reason < 0 or not accepted:
            raise NotConvergedError(self._failure(reason), tuple(self.history))
        self._refuse_runaway()

    def _refuse_runaway(self) -> None:
        """No answer of linear elasticity is a thousand times the body away from its start."""
        moved = np.abs(self.problem.displacement.x.array - self._started)
        columns = self.problem.spaces.coordinates.T
        size = max(largest(self.comm, x) - smallest(self.comm, x) for x in columns)
        if self.refuses_runaway and largest(self.comm, moved) > _RUNAWAY * size:
            raise NotConvergedError(
                "the body runs away: displacements are more than a thousand times its size; is it "
                "held, and are loads and stiffness in the same units?",
                tuple(self.history),
            )

    @property
    def forces(self) -> float:
        """1-norm of the forces on the body at the last residual: loads, reactions, contacts."""
        load = np.abs(self.problem.load.reshape(-1)[: self.owned_size]).sum()
        return float(total(self.comm, load)) + self.held_norm

    def save(self) -> NDArray[np.float64]:
        """The state of this rank, to go back to."""
        return np.array(self.state.array_r)

    def restore(self, saved: NDArray[np.float64]) -> None:
        """Go back to a saved state; collective."""
        with self.state as array:
            array[:] = saved
        self._take(self.state)

    def _create_snes(self, search_energy: bool) -> Any:
        settings = self.problem.scene.solver
        snes = PETSc.SNES().create(self.comm)
        snes.setOptionsPrefix(OPTIONS_PREFIX)
        snes.setFunction(self._set_residual, self.residual)
        snes.setJacobian(self._set_tangent, self.tangent)
        options = PETSc.Options()
        one_sided = any(contact.is_one_sided for contact in self.problem.contacts)
        search = ENERGY_SEARCH if one_sided and search_energy else FULL_STEPS
        defaults = DEFAULT_OPTIONS | search
        for name, value in defaults.items():
            if not options.hasName(OPTIONS_PREFIX + name):
                options.setValue(OPTIONS_PREFIX + name, value)
                self.own_options.append(OPTIONS_PREFIX + name)
        snes.setTolerances(rtol=0.0, atol=0.0, stol=0.0, max_it=settings.max_iterations)
        snes.setFromOptions()
        snes.setConvergenceTest(self._converged)
        return snes

    def forget(self) -> None:
        """Count steps and keep the history anew, for another load step."""
        self.history.clear()
        self.steps = 0

    def start(self) -> None:
        """Nothing has slipped, supports stand at their values, loose parts touch."""
        displacement, indentations = starting_point(self.problem)
        owned = self.problem.constrained < self.owned_size
        for contact, indentation in zip(self.problem.contacts, indentations, strict=True):
            contact.kinematics.move(displacement[contact.trace.all_nodes], indentation)
            if contact.friction is not None:
                contact.friction.stick_all()
        self._started = displacement.reshape(-1).copy()
        self.state.set(0.0)
        with self.state as array:
            array[: self.owned_size] = displacement.reshape(-1)[: self.owned_size]
            array[self.owned_constrained] = self.problem.prescribed[owned]
            for number, unknown in enumerate(self.problem.unknowns):
                if self.comm.rank == 0 and unknown.kind == "indentation":
                    array[self._scalar(number)] = unknown.contact.kinematics.indentation

    def continue_start(self) -> None:
        """From the state of the last load step, supports at their new values; collective."""
        owned = self.problem.constrained < self.owned_size
        scalars = self._scalars(self.state)
        values = self.problem.prescribed.copy()
        far_field = self.problem.far_field
        for unknown, value in zip(self.problem.unknowns, scalars, strict=True):
            if unknown.column is not None and far_field is not None:
                values[np.isin(self.problem.constrained, far_field.dofs)] += value * unknown.column
        with self.state as array:
            array[self.owned_constrained] = values[owned]
        self._take(self.state)
        for contact in self.problem.contacts:
            if contact.friction is not None:
                contact.friction.stick_all()

    def _scalar(self, number: int) -> int:
        """Position of a scalar in the arrays of rank 0."""
        return number - self.system.scalars

    def _take(self, state: Any) -> None:
        """A global vector into the displacement function and the contacts' jumps."""
        self.problem.displacement.x.array[: self.owned_size] = state.array_r[: self.owned_size]
        self.problem.displacement.x.scatter_forward()
        displacement = self._nodal_displacement()
        scalars = self._scalars(state)
        for contact in self.problem.contacts:
            contact.kinematics.move(displacement[contact.trace.all_nodes])
        for unknown, value in zip(self.problem.unknowns, scalars, strict=True):
            if unknown.kind == "indentation":
                at_surface = displacement[unknown.contact.trace.all_nodes]
                unknown.contact.kinematics.move(at_surface, value)
        for contact in self.problem.contacts:
            contact.follow_pressure()

    def _scalars(self, state: Any) -> list[float]:
        """Values of the scalar unknowns, on every rank."""
        if not self.system.scalars:
            return []
        last = state.array_r[-self.system.scalars :].tolist() if self.comm.rank == 0 else None
        return list(self.comm.bcast(last))

    def _nodal_displacement(self) -> NDArray[np.float64]:
        """The present displacement, shape (nodes, components), ghosts included."""
        array = self.problem.displacement.x.array
        return array.reshape(-1, self.problem.spaces.components)

    def _contact_forces(self, terms: str) -> list[NDArray[np.float64]]:
        """Forces on the body at the nodes of each surface, by a kind of term."""
        found = []
        for contact in self.problem.contacts:
            term = getattr(contact, terms)
            none = np.zeros((len(contact.trace.all_nodes), self.problem.spaces.components))
            found.append(none if term is None else term.force())
        return found

    def _set_residual(self, snes: Any, state: Any, residual: Any) -> None:
        with self.timings.phase("assemble"):
            self._take(state)
            self.system.stiffness.mult(state, residual)
            normal, friction = self._contact_forces("normal"), self._contact_forces("friction")
            by_contact = [a + b for a, b in zip(normal, friction, strict=True)]
            surfaces = [contact.trace.surface for contact in self.problem.contacts]
            pushed = [s.on_body(f).reshape(-1) for s, f in zip(surfaces, by_contact, strict=True)]
            with residual as array:
                for force in pushed:
                    array[: self.owned_size] -= force[: self.owned_size]
                array[: self.owned_size] -= self.problem.load.reshape(-1)[: self.owned_size]
                held = np.abs(array[self.owned_constrained]).sum()
                array[self.owned_constrained] = 0.0  # they hold their values exactly
                self._set_scalar_residuals(state, array, by_contact)
            for surface, force in zip(surfaces, by_contact, strict=True):
                held += np.abs(force[: surface.owned_nodes]).sum()
            self.held_norm = total(self.comm, held)

    def _set_scalar_residuals(
        self, state: Any, array: Any, by_contact: list[NDArray[np.float64]]
    ) -> None:
        """N − F for an obstacle that a force F drives, R − N for a resultant R."""
        values = self._scalars(state)
        for number, unknown in enumerate(self.problem.unknowns):
            contact = unknown.contact
            force = by_contact[self.problem.contacts.index(contact)]
            force = force[: contact.trace.surface.owned_nodes]
            pushed = total(self.comm, force.sum(axis=0)) @ contact.kinematics.direction
            if self.comm.rank == 0:
                driven = unknown.kind == "indentation"
                imbalance = pushed - (contact.force or 0.0) if driven else values[number] - pushed
                array[self._scalar(number)] = imbalance

    def _set_tangent(self, snes: Any, state: Any, tangent: Any, preconditioner: Any) -> None:
        with self.timings.phase("assemble"):
            self._take(state)
            self.system.stiffness.copy(tangent, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            for contact in self.problem.contacts:
                contact.follow()
            self.system.add_contacts(tangent)
            self.system.add_far_field(tangent)
            tangent.assemble()
            first, _ = tangent.getOwnershipRange()
            rows = (first + self.owned_constrained).astype(PETSc.IntType)
            tangent.zeroRowsColumns(rows, diag=1.0)
            self.system.tie_far_field(tangent)

    def _converged(self, snes: Any, iteration: int, norms: tuple[float, float, float]) -> Any:
        """Stop when the force imbalance is small against the forces, or is round-off.

        The 1-norm bounds the error of any resultant. PETSc's relative tolerance is
        not used: its reference, the first residual, is no physical force.
        """
        forces_left = np.abs(self.residual.array_r[: self.owned_size]).sum()
        if self.system.scalars and self.comm.rank == 0:
            forces_left += np.abs(self.residual.array_r[-self.system.scalars :]).sum()
        imbalance = total(self.comm, forces_left)
        self.history.append(imbalance)
        forces = self.forces
        if iteration == 0:
            self.tiny = _LARGEST_FLOOR * imbalance if self.refuses_runaway else 0.0
        logger.debug("  Newton step %d: force imbalance %.2e of %.3g", iteration, imbalance, forces)
        if not np.isfinite(imbalance):
            return _NOT_A_NUMBER
        self.limit = self.problem.scene.solver.tolerance * forces
        # A body that a motion of its supports takes along has no forces to compare with; that
        # it does not run away is then tested at the end.
        cap = np.inf if self.refuses_runaway else _LARGEST_FLOOR * forces
        # The floor costs a matrix copy, so it is asked for only where it may decide.
        if iteration > 0 and self.limit < imbalance <= max(_LARGEST_FLOOR * forces, self.tiny):
            self.limit = max(self.limit, min(self._floor(), cap))
        if imbalance <= self.limit and not self._mean_stress_is_missing(iteration):
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_ABS
        return PETSc.SNES.ConvergedReason.CONVERGED_ITERATING

    def _mean_stress_is_missing(self, iteration: int) -> bool:
        """Whether a mean stress is yet to be found, be there no free displacement at all."""
        return iteration == 0 and self.problem.elastic.mixed is not None

    def _floor(self) -> float:
        """20 × machine epsilon × ‖|J| |u|‖₁: what round-off leaves of a residual."""
        first, columns, values = self.tangent.getValuesCSR()
        magnitude = PETSc.Mat().createAIJ(
            self.tangent.getSizes(), csr=(first, columns, np.abs(values)), comm=self.comm
        )
        lengths = self.state.duplicate()
        self.state.copy(lengths)
        lengths.abs()
        magnitude.mult(lengths, self.work)
        left = total(self.comm, self.work.array_r[: self.owned_size].sum())
        floor = 20 * np.finfo(float).eps * left
        magnitude.destroy()
        lengths.destroy()
        return floor

    def _failure(self, reason: int) -> str:
        words = _REASONS.get(reason, f"PETSc's reason {reason}")
        known = len(self.history) > self._before
        left = f"{self.history[-1]:.2e}" if known else "unknown"
        forces = self.forces
        advice = "Try a larger solver.max_iterations, or a finer mesh at the contact"
        if self.problem.frictional:
            advice = "Try a larger solver.max_iterations, or a larger regularisation_parameter"
        if known and self.history[-1] <= 1e3 * _LARGEST_FLOOR * forces:
            advice = (
                "So small a rest may be round-off: is a penalty_parameter too small, or the "
                "contrast of stiffnesses extreme?"
            )
        steps = max(len(self.history) - self._before - 1, 0)
        return (
            f"not converged after {steps} Newton steps: {words}; the force imbalance is {left} of "
            f"{forces:.3g}. {advice}"
        )

    def solution(self, outer_iterations: int = 0, strategy: str = "") -> Solution:
        """What was found; collective."""
        spaces = self.problem.spaces
        self.system.stiffness.mult(self.state, self.work)
        self.system.take_mean_stress(self.state)
        internal = fem.Function(spaces.displacement_space)
        internal.x.array[: self.owned_size] = self.work.array_r[: self.owned_size]
        internal.x.scatter_forward()
        for contact in self.problem.contacts:
            if contact.force == 0 and contact.normal is None:
                contact.kinematics.touch()
        nodes = [contact.trace.numbers for contact in self.problem.contacts]
        normal, friction = self._contact_forces("normal"), self._contact_forces("friction")
        return Solution(
            displacement=self._nodal_displacement().copy(),
            internal_force=internal.x.array.reshape(-1, spaces.components).copy(),
            normal_force=[force[n] for force, n in zip(normal, nodes, strict=True)],
            friction_force=[force[n] for force, n in zip(friction, nodes, strict=True)],
            states=[contact.state() for contact in self.problem.contacts],
            residual_history=tuple(self.history),
            newton_iterations=self.steps,
            outer_iterations=outer_iterations,
            strategy=strategy,
            imbalance_limit=self.limit,
        )


class _FactorisationLog:
    """Seconds that PETSc spends on factorisations from now on."""

    _EVENTS = ("MatLUFactorSym", "MatLUFactorNum")

    def __init__(self) -> None:
        PETSc.Log.begin()
        self._before = self._read()

    def _read(self) -> float:
        return sum(PETSc.Log.Event(name).getPerfInfo()["time"] for name in self._EVENTS)

    def seconds(self) -> float:
        return self._read() - self._before
