"""What is told by contacts and supports alone is what the fields of the same state tell.

In balance or not: states are made by displacements of the contacts that nobody solved for.
"""

import dataclasses
from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Study
from fenics_contact.common.parallel import largest
from fenics_contact.evaluate.condensed_forces import CondensedForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.rows_of_body import prescribed
from fenics_contact.solve.condensed import kept_rows
from fenics_contact.solve.systems.solution import BodyAnswer
from fenics_contact.trust.run_checks import all_checks
from tests.simulation.studies.cases import CASES

COMM = MPI.COMM_WORLD
CHANGES = {"bolt": {"preload.0.locked_from": None}}
SCENES = ["corners", "half-space", "in space", "two bodies", "bolt", "nearly incompressible"]


@cache
def solved(name):
    """The study of a case, and the unknowns of its answer."""
    scene, make, _ = CASES[name]
    study = Study(scene, COMM, make())
    assert study.solve({"solver.errors": "none", **CHANGES.get(name, {})}).converged
    dofs = study._body.kept.condensed.dofs
    displacement = study.run.solution.displacement
    position = dofs.gathered(displacement.reshape(-1))[dofs.is_free]
    return study, position, study.run.end.last.scalars


def inside(study, position, scalars):
    """The fields of the body where contact dofs and scalars are given."""
    problem, body = study.run.problem, study._body.kept.condensed
    supported, load = prescribed(problem), 0.0
    motions = [u.prescribes for u in problem.unknowns if u.prescribes is not None]
    for value, motion in zip(scalars, motions, strict=False):
        supported += value * motion.of_all(supported.size).reshape(supported.shape)
    own = list(zip(problem.of_body_scalars(scalars), problem.body_scalars, strict=True))
    load += body.stiffness.load(problem.load, supported, body.held)
    for (value, scalar), one in zip(own, body.scalars.loads, strict=True):
        load += value * one
        scalar.take(float(value))
    values = body.bulk.expand(load, position)
    body.stiffness.set_functions(values)
    internal = body.stiffness.forces(values)
    for value, scalar in own:
        internal += value * scalar.forces_on_body.nodal
    displacement = problem.displacement.x.array.reshape(-1, problem.spaces.components)
    return BodyAnswer(displacement.copy(), internal, body.stiffness.round_off(values))


def both(study, solution, position, scalars):
    """What is needed in a state, from its fields and without them."""
    problem = study.run.problem
    found = inside(study, position, scalars)
    states = problem.scalar_states(found.displacement) if problem.body_scalars else ()
    whole = dataclasses.replace(solution, find_body=lambda: found, scalars=states)
    given = dataclasses.replace(solution, find_body=None, scalars=states)
    body = study._body.kept.condensed
    return BulkForces(problem, whole), CondensedForces(problem, given, body, position, scalars)


def moved(position, share=0.05):
    """Other displacements of the contacts, not far, the same on all ranks and in any order."""
    waves = 1 + share * np.sin(1e6 * position / np.abs(position).max())
    return position * waves


def close(ours, theirs, size):
    assert np.abs(np.subtract(ours, theirs)).max(initial=0.0) <= 1e-9 * size


@pytest.mark.parametrize("name", SCENES)
def test_numbers_of_any_state(name, monkeypatch):
    study, position, scalars = solved(name)
    solution = study.run.solution
    pairs = [both(study, solution, position, scalars)]
    theirs, ours = both(study, solution, moved(position), 1.1 * scalars)
    force = largest(COMM, np.abs(theirs.unbalanced)) + np.abs(theirs.of_supports).max()
    energy = abs(theirs.strain_energy) + abs(theirs.given_work)
    close(ours.of_supports, theirs.of_supports, force)
    close(ours.of_all_supports, theirs.of_all_supports, force)
    close(ours.strain_energy, theirs.strain_energy, energy)
    close(ours.given_work, theirs.given_work, energy)
    for one, other in zip(ours.scalar_states(), theirs.scalar_states(), strict=True):
        close(one.force, other.force, force)
    for name_, value in theirs.at_points().items():
        close(ours.at_points()[name_], value, largest(COMM, np.abs(theirs.displacement)))
    for number in range(len(study.run.problem.contacts)):
        close(ours.of_stress(number), theirs.of_stress(number), force)
        is_free = study.run.problem.free[study.run.problem.contacts[number].nodes]
        close(ours.at_contact(number)[is_free], theirs.at_contact(number)[is_free], force)
        pressure = theirs.pressure(number)
        close(ours.pressure(number), pressure, 10 * largest(COMM, np.abs(pressure)))
    one, other = ours.balances(), theirs.balances()
    close(one.resultants[:, 1], other.resultants[:, 1], force)
    if study.scene.kinematics != "axisymmetric":
        close(one.resultants, other.resultants, force)
        close(one.moments, other.moments, 10 * force)
    for ours_before, theirs_before in [(None, None), pairs[0][::-1]]:
        close(ours.works_since(ours_before), theirs.works_since(theirs_before), energy)
    theirs_before, ours_before = pairs[0]
    monkeypatch.setattr(kept_rows, "_MOST_GIVEN", 0)  # rows are forgotten each time
    close(ours.works_since(ours_before), theirs.works_since(theirs_before), energy)


def wrong_states(study, position, scalars):
    """Solutions and unknowns with one thing wrong each."""
    solution = study.run.solution
    yield "none", solution, position, scalars
    yield "moved", solution, moved(position, 0.01), scalars
    more = [1.2 * force for force in solution.friction_force]
    yield "friction", dataclasses.replace(solution, friction_force=more), position, scalars
    less = [0.98 * force for force in solution.normal_force]
    yield "pressure", dataclasses.replace(solution, normal_force=less), position, scalars
    turned = [dataclasses.replace(one, slip=-one.slip) for one in solution.states]
    yield "slip", dataclasses.replace(solution, states=turned), position, scalars
    open_ = [dataclasses.replace(one, gap=np.abs(one.gap) + 1e-3) for one in solution.states]
    yield "gap", dataclasses.replace(solution, states=open_), position, scalars
    if len(scalars):
        yield "scalars", solution, position, 1.05 * scalars


@pytest.mark.parametrize("name", SCENES)
def test_a_wrong_answer_fails_the_checks_that_its_fields_fail(name):
    study, position, scalars = solved(name)
    failed = {}
    for wrong, *state in wrong_states(study, position, scalars):
        theirs, ours = (all_checks(one, len(study.run.steps)) for one in both(study, *state))
        found = {n for n, check in ours.items() if check is not None and not check.passed}
        expected = {n for n, check in theirs.items() if check is not None and not check.passed}
        assert found == expected, (wrong, found ^ expected)
        assert [n for n, c in ours.items() if c] == [n for n, c in theirs.items() if c]
        failed[wrong] = found
    assert not failed["none"]
    assert {"equilibrium", "contact_law"} <= failed["moved"]
    assert {"equilibrium", "contact_law"} <= failed["pressure"]
    assert "complementarity" in failed["gap"]
    if name == "bolt":
        assert "preload" in failed["scalars"]
    else:
        assert "friction_law" in failed["friction"]
        assert "dissipation" in failed["slip"]
