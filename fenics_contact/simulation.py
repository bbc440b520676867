"""From a scene to a result: the data's one-way path, in one place."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact import compat
from fenics_contact.body_kinematics import BodyKinematics
from fenics_contact.bulk_forces import BulkForces
from fenics_contact.checks import run_checks
from fenics_contact.contact import ContactSurface
from fenics_contact.energy_book import EnergyBook
from fenics_contact.equilibrium import FreeMotion, require_equilibrium
from fenics_contact.errors import InputError, NotConvergedError
from fenics_contact.gmsh_files import load_body
from fenics_contact.mesh import Body
from fenics_contact.parallel import largest, total
from fenics_contact.problem import Problem
from fenics_contact.quantities import (
    contact_points,
    contact_quantities,
    global_quantities,
    support_reactions,
)
from fenics_contact.result import Check, Result
from fenics_contact.scene import Scene
from fenics_contact.solution import Solution
from fenics_contact.solver_choice import SolverChoice, choose_solver
from fenics_contact.strategy import solve
from fenics_contact.timings import Timings

logger = logging.getLogger(__name__)

# Slip over the size of a contact between two pairings, from which pressures are visibly off:
# without friction a shift of .01 changes them by 1 %.
_FAR = 0.01
# Share of the work left open by load steps, from which it is said.
_OPEN = 0.1
# What pressure closes, over the height of facets' arcs, below which these decide about it.
_SAGITTAS = 10.0


class Run:
    """A scene made ready, then solved; kept for those who want the fields.

    Attributes:
        problem: The model: spaces, energies, forms.
        free_motion: Rigid motions that the supports leave to friction.
        choice: The solver, and how much memory it is to need.
        solution: Nodal values of this rank, once solved; None before, or without an answer.
        forces: Nodal forces that the bulk needs in the last step that was solved.
        steps: What came out of the load steps so far, as in ``result.json``.
        book: Work and energies along them.
        timings: Seconds so far.

    Args:
        scene: What to solve.
        comm: Communicator; collective.
        body: The mesh, if not the one the scene names.

    Raises:
        InputError: The scene or its mesh cannot be used, or has no equilibrium.
        MachineError: It will not fit into the machine's memory.
    """

    def __init__(
        self, scene: Scene, comm: MPI.Comm = MPI.COMM_WORLD, body: Body | None = None
    ) -> None:
        self.scene = scene
        self.solution: Solution | None = None
        self.steps: list[dict[str, Any]] = []
        self.timings = Timings()
        if body is None:
            if not scene.mesh:
                raise InputError("mesh: the scene names no mesh and no body was passed")
            with self.timings.phase("mesh"):
                body = load_body(scene.mesh, scene.dimension, comm)
        self.problem = Problem(scene, body, self.timings)
        with self.timings.phase("solve"):
            self.free_motion: FreeMotion = require_equilibrium(self.problem)
        self.choice: SolverChoice = choose_solver(self.problem)

    @property
    def model(self) -> dict[str, Any]:
        """``model`` of ``result.json``; collective."""
        problem = self.problem
        index_map = problem.spaces.displacement_space.dofmap.index_map
        points = sum(total(problem.comm, int(c.trace.owned.sum())) for c in problem.contacts)
        cells = problem.body.mesh.topology.index_map(problem.body.dimension)
        return {
            "kinematics": self.scene.kinematics,
            "degree": problem.spaces.degree,
            "cell": problem.body.mesh.topology.cell_name(),
            "bodies": list(problem.spaces.parts.names),
            "cells": int(cells.size_global),
            "dofs": int(index_map.size_global) * problem.spaces.components,
            "contact_points": int(points),
            "ranks": problem.comm.size,
            "solver": self.choice.name,
            "solver_reason": self.choice.reason,
            "solver_memory_mb": round(self.choice.memory / 1e6),
            "strategy": _strategy(problem, self.solution),
            "scalar_unknowns": [f"{u.kind} at {u.contact.label}" for u in problem.unknowns],
            "terms": [term.name for term in problem.terms],
            "free_rigid_motions": self.free_motion.modes,
            "used_share_of_limit_load": self.free_motion.used_share,
            "symmetry": problem.supports.symmetry,
        } | ({} if self.solution is None else {"bulk_factorisations": self.solution.factorisations})

    def solve(self, accepted: Callable[[], None] | None = None) -> Result:
        """Solve and evaluate; collective. Failure to converge is a result, too.

        Args:
            accepted: Called when a load step has been added to ``steps``.
        """
        self.steps = []
        self.book = EnergyBook(self.problem)

        def record(time: float, solution: Solution) -> None:
            self._record(time, solution)
            if accepted is not None:
                accepted()

        try:
            solution = solve(self.problem, self.timings, record, self.choice)
        except NotConvergedError as error:
            return self._unconverged(error)
        return self._evaluate(solution)

    def _record(self, time: float, solution: Solution) -> None:
        """Keep what came out of a load step, before slip is counted anew."""
        with self.timings.phase("output"):
            self.forces = BulkForces(self.problem, solution)
            self._reactions, self._supports = support_reactions(self.forces)
            self._by_contact = [
                contact_quantities(self.problem, solution, number)
                for number in range(len(self.problem.contacts))
            ]
            quantities = global_quantities(self.forces, self._reactions, self._by_contact)
            self.book.count(self.forces, self._reactions)
            quantities |= self.book.quantities(quantities)
        self.steps.append(
            {
                "load_factor": time,
                "newton_iterations": solution.newton_iterations,
                "outer_iterations": solution.outer_iterations,
                "residual_history": list(solution.residual_history),
                "quantities": quantities,
                "contacts": [
                    {"name": contact.label, "quantities": found}
                    for contact, found in zip(self.problem.contacts, self._by_contact, strict=True)
                ],
                "supports": self._supports,
            }
        )

    def contacts(self, quantities: list[dict[str, Any]] | None = None) -> list[dict[str, Any]]:
        """``contacts`` of ``result.json``, with the quantities of each once there are any."""
        quantities = quantities or [{} for _ in self.problem.contacts]
        return [
            {
                "name": contact.label,
                "contact": contact.contact.kind,
                "law": contact.law,
                **_sides(contact),
                "parameters": _parameters(contact),
                "quantities": found,
            }
            for contact, found in zip(self.problem.contacts, quantities, strict=True)
        ]

    def _evaluate(self, solution: Solution) -> Result:
        problem = self.problem
        self.solution = solution
        with self.timings.phase("output"):
            quantities = self.steps[-1]["quantities"]
            checks = run_checks(self.forces, self._reactions)
            balance = self.book.check(quantities)
            checks |= {} if balance is None else {"energy_balance": balance}
            points = contact_points(problem, solution)
        return Result(
            title=self.scene.title,
            converged=True,
            verdict=_verdict(checks)
            + _untouched(problem, solution)
            + _facets_too_straight(problem, solution)
            + self._slid_far()
            + self._coarse_path(),
            model=self.model,
            contacts=self.contacts(self._by_contact),
            supports=self._supports,
            quantities=quantities,
            steps=self.steps,
            checks=checks,
            timings=self.timings.summary(problem.comm),
            versions=compat.versions(),
            points=points,
        )

    def _slid_far(self) -> str:
        """A sentence on bodies that slid far within a load step, or nothing."""
        found: dict[str, float] = {}
        for step in self.steps:
            for contact in step["contacts"]:
                slid = contact["quantities"].get("slip_since_pairing", 0.0)
                found[contact["name"]] = max(slid, found.get(contact["name"], 0.0))
        far = [f"'{name}' by {slid:.2g}" for name, slid in found.items() if slid > _FAR]
        if not far:
            return ""
        return (
            f" Bodies slid far within a load step, over the contact's size at {' and '.join(far)}: "
            "pressures may be off by as much; take more load steps."
        )

    def _coarse_path(self) -> str:
        """A sentence on work that the load steps leave open, or nothing."""
        share = self.book.open_share
        if share < _OPEN:
            return ""
        return (
            f" The load steps leave {100 * share:.2g} % of the work open, at points that began to "
            "touch or to slip within a step: take more for sharper energies."
        )

    def _unconverged(self, error: NotConvergedError) -> Result:
        """No answer: the history, and no numbers that could be taken for one."""
        step = {
            "load_factor": self.scene.steps.all_times[len(self.steps)],
            "newton_iterations": max(len(error.residual_history) - 1, 0),
            "outer_iterations": 0,
            "residual_history": list(error.residual_history),
            "quantities": {},
        }
        return Result(
            title=self.scene.title,
            converged=False,
            verdict=f"No answer: {error}.",
            model=self.model,
            contacts=self.contacts(),
            quantities={},
            steps=[*self.steps, step],
            checks={},
            timings=self.timings.summary(self.problem.comm),
            versions=compat.versions(),
        )


def _strategy(problem: Problem, solution: Solution | None) -> str:
    if problem.coulomb:
        chosen = problem.scene.solver.strategy
        return f"Coulomb friction: {solution.strategy if solution else chosen}"
    if any(contact.is_one_sided for contact in problem.contacts):
        return "frictionless contact: one Newton solve with a line search on the energy"
    if problem.frictional:
        return "prescribed pressure: one Newton solve, no outer loop"
    return "linear: one Newton step"


def _sides(contact: ContactSurface) -> dict[str, str]:
    """Of two bodies, the surface that results are of, the one opposite, and why it is so."""
    sides = contact.sides
    if sides.opposite is None:
        return {}
    return {"slave": sides.slave, "master": sides.master, "slave_reason": sides.why}


def _parameters(contact: ContactSurface) -> dict[str, Any]:
    """A contact's parameters as used; what varies in space is said so."""
    scene = contact.contact
    given = {
        "pressure": scene.pressure,
        "foundation_stiffness": scene.foundation_stiffness,
        "friction_coefficient": scene.friction_coefficient,
    }
    is_open = contact.is_coulomb and not contact.is_scaled  # it follows from pressures to come
    used = {
        "regularisation_parameter": None if is_open else contact.regularisation_parameter,
        "penalty_parameter": contact.penalty_parameter or None,
        "force": contact.force,
        **{name: "varies" if callable(value) else value for name, value in given.items()},
    }
    return {name: value for name, value in used.items() if value is not None}


def run(scene: Scene, comm: MPI.Comm = MPI.COMM_WORLD, body: Body | None = None) -> Result:
    """Solve a scene; collective.

    Args:
        scene: What to solve.
        comm: Communicator.
        body: The mesh, if not the one the scene names.

    Returns:
        Global numbers, the same on every rank and any number of ranks.

    Raises:
        InputError: The scene or its mesh cannot be used, or has no equilibrium.
    """
    return Run(scene, comm, body).solve()


def _untouched(problem: Problem, solution: Solution) -> str:
    """A sentence on contacts at which nothing touches, or nothing; collective."""
    touched = [
        largest(problem.comm, np.abs(state.contact_pressure)) > 0 for state in solution.states
    ]
    words = ""
    for contact, touches in zip(problem.contacts, touched, strict=True):
        if not touches and contact.normal is not None:
            what = "The body does not touch the obstacle"
            if contact.sides.opposite is not None:
                what = "The two surfaces do not touch each other"
            words += f" {what} at '{contact.label}'."
    return words


def _facets_too_straight(problem: Problem, solution: Solution) -> str:
    """A sentence on curved surfaces of two bodies whose facets are coarse, or nothing; collective.

    Their chords make gaps, beside which what the pressure closes, p L/E*, must be large.
    """
    found = []
    for contact, state in zip(problem.contacts, solution.states, strict=True):
        kinematics = contact.kinematics
        if isinstance(kinematics, BodyKinematics):
            peak = largest(problem.comm, np.abs(state.contact_pressure))
            closed = peak / contact.moduli.plane_strain * contact.trace.extent()
            if 0 < closed < _SAGITTAS * kinematics.sagitta:
                found.append(f"'{contact.label}'")
    if not found:
        return ""
    return (
        f" The facets at {' and '.join(found)} are too straight for what is pressed together "
        "there, and pressures not to be trusted: use cells of order 2 (mesh.order), or finer ones."
    )


def _verdict(checks: dict[str, Check]) -> str:
    failed = [name.replace("_", " ") for name, check in checks.items() if not check.passed]
    if failed:
        return f"Converged, but do not trust it: failed {', '.join(failed)}."
    return f"Converged; all {len(checks)} checks of the physics passed."
