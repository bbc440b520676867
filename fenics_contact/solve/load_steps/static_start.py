"""The static answer at time 0 as what a motion begins from, on the same body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.contact.snapshot import recall, remember
from fenics_contact.problem.drive import Drive
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.inertia.moving import moving
from fenics_contact.problem.inertia.sliding import elastic_slip
from fenics_contact.problem.inertia.states import FirstState
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_stepper import solve
from fenics_contact.solve.newton.solution import Solution

_KEY = "motion.start = 'static'"


def begin_motion(problem: Problem, timings: Timings) -> None:
    """Bring bodies that begin from the static answer under what acts at time 0 there; collective.

    The weights of nodes in contact act where their masses are, so that nothing begins to move.

    Args:
        problem: The model; where it moves so its contacts and its ``inertia`` are brought there.
        timings: To which what it takes is counted.

    Raises:
        InputError: There is no such answer, or none was found.
    """
    motion = problem.scene.motion
    if motion is None or motion.start != "static":
        return
    rest = _at_rest(problem, timings)
    try:
        require_equilibrium(rest)
        found = solve(rest, timings)
    except (InputError, NotConvergedError) as error:
        raise InputError(f"{_KEY}: no static answer at time 0: {error}") from None
    _take(problem, rest, found)


def _at_rest(problem: Problem, timings: Timings) -> Problem:
    """The problem of the scene without masses, under what acts at time 0; collective."""
    scene = problem.scene.at_rest
    rest = Problem(scene, problem.discrete, timings, by_points=True)
    rest.take_loads(problem)
    rest.drive = Drive(np.zeros_like(problem.load), rest=0.0, share=lambda time: 0.0)
    rest.set_time(scene.load_steps.last)
    return rest


def _take(problem: Problem, rest: Problem, found: Solution) -> None:
    """Displacements, forces and what contacts remember, of the static answer; collective."""
    inertia = moving(problem.inertia)
    elastic = tuple(elastic_slip(contact) for contact in rest.contacts)
    energy = _stored(rest, found)
    pressed: Array = np.zeros_like(problem.load)
    pressures = np.zeros((len(rest.contacts), problem.spaces.components))
    for number, (contact, force) in enumerate(zip(rest.contacts, found.normal_force, strict=True)):
        pressed += contact.kinematics.on_body(contact.trace.at_all_nodes(force))
        pressures[number] = total(rest.comm, force[contact.owned_nodes].sum(axis=0))
    for contact, before in zip(problem.contacts, rest.contacts, strict=True):
        before.accept()
        recall(contact, replace(remember(before), dissipated=0.0, left_open=0.0))
    inertia.begin_deformed(
        found.displacement,
        found.internal_force,
        pressed,
        elastic,
        FirstState(
            energy=energy,
            pressures=pressures,
            overlaps=tuple(c.kinematics.interference - c.kinematics.worn for c in rest.contacts),
            scalars=tuple((state.force, state.value) for state in found.scalars),
        ),
    )
    for scalar, state in zip(problem.body_scalars, found.scalars, strict=True):
        scalar.reach(state.value)
    problem.set_time(0.0)


def _stored(rest: Problem, found: Solution) -> float:
    """In strains, springs of contacts and elastic slip (energy); collective."""
    own = slice(rest.spaces.owned_nodes)
    works = found.displacement[own] * found.internal_force[own]
    stored = 0.5 * (float(total(rest.comm, np.sum(works))) + found.work_on_scalars)
    for contact, state in zip(rest.contacts, found.states, strict=True):
        stored += float(contact.trace.integral(state.penalty_energy))
        stored += contact.work.in_elastic_slip(state) if contact.friction.stores_energy else 0.0
    return stored
