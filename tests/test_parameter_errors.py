"""Estimated errors by penalty, regularisation and the solver's rest, against the true ones."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Material,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
    simulation,
)
from fenics_contact.bulk_forces import BulkForces
from fenics_contact.other_answers import OtherAnswers
from fenics_contact.parameter_errors import parameter_errors
from fenics_contact.quantities import contact_quantities, global_quantities, support_reactions
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
BODY = box_body((24, 12), (2, 1))
PARABOLA = Obstacle(
    "parabola", radius=2, position=(1, 1), indentation=0.03, displacement=(0.004, 0)
)
# Automatic ones would be about 2e-9 and 4e-8.
EPSILON, PENALTY = 1e-6, 1e-7


def solved(epsilon, penalty, law="static", **solver):
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "y1",
                obstacle=PARABOLA,
                law=law,
                friction_coefficient=0.3,
                regularisation_parameter=epsilon,
                penalty_parameter=penalty,
            ),
        ),
        solver=SolverSettings(**solver),
    )
    return Run(scene, COMM, BODY)


def estimated(monkeypatch, run):
    """Quantities and errors of a run."""
    found = {}

    def look(history):
        problem = history.problem

        def measure(solution):
            forces = BulkForces(problem, solution)
            contacts = [contact_quantities(problem, solution, 0)]
            return global_quantities(forces, support_reactions(forces)[0], contacts)

        found.update(parameter_errors(history, measure))
        return OtherAnswers()

    monkeypatch.setattr(simulation, "look_around", look)
    return run.solve().quantities, found


@pytest.mark.parametrize("source", ["penalty", "regularisation"])
@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_estimates_are_the_true_errors_at_leading_order(monkeypatch, source, solver):
    small = (EPSILON, 1e-3 * PENALTY) if source == "penalty" else (1e-3 * EPSILON, PENALTY)
    exact = solved(*small, solver=solver).solve().quantities
    quantities, errors = estimated(monkeypatch, solved(EPSILON, PENALTY, solver=solver))
    for name in ("normal_force", "friction_force", "max_contact_pressure", "strain_energy"):
        true = np.linalg.norm(np.subtract(quantities[name], exact[name]))
        assert errors[source][name] == pytest.approx(true, rel=0.1), name
    assert set(errors) == {"penalty", "regularisation", "iteration"}


def test_the_answer_is_there_again(monkeypatch):
    run = solved(EPSILON, PENALTY)
    before = run.solve()
    estimated(monkeypatch, run)
    after = run._evaluate()
    assert after.quantities == before.quantities
    assert run.contacts()[0]["parameters"] == before.contacts[0]["parameters"]
