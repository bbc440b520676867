"""Assemblies at random: what cannot touch left out, unknowns eliminated, and the same answer."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import SolverSettings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed import elimination
from fenics_contact.solve.systems import near_nodes
from tests.random.kinds import draw_kind
from tests.random.outcomes import outcome_of
from tests.solve.same_answer import require_same

COMM = MPI.COMM_WORLD
SEED = 9
WITHOUT_ERRORS = SolverSettings(errors="none")


@pytest.fixture
def of_few(monkeypatch):
    """Leave out nodes, and eliminate unknowns, of however few there are."""
    monkeypatch.setattr(near_nodes, "_FEW", 0)
    monkeypatch.setattr(elimination, "_MANY", 0)
    monkeypatch.setattr(elimination, "_ENOUGH", 0)


def drawn(kind, number):
    """The scene of a number of those of an assembly of linear hexahedra."""
    return COMM.bcast(_drawn(kind, number) if COMM.rank == 0 else None)


def _drawn(kind, number):
    for drawn_as in range(400):
        random = draw_kind("assembly", SEED, drawn_as)
        forms = random.cell, random.scene.discretisation.degree
        if forms != ("hexahedron", 1) or random.kind != f"assembly: {kind}":
            continue
        if number == 0:
            scene = dataclasses.replace(random.scene, solver=WITHOUT_ERRORS, point=())
            return dataclasses.replace(random, scene=scene)
        number -= 1
    raise AssertionError(f"so many scenes of {kind} are not drawn")


@pytest.mark.parametrize("number", [1, 2, 7])
def test_plates_are_pressed_together_by_the_bolt(of_few, number):
    random = drawn("bolt", number)
    near = near_nodes.near_nodes(Problem.on_mesh(random.scene, random.body(COMM)))
    assert any(not each.slaves.all() for each in near)
    outcome = outcome_of(random)
    assert outcome.code == 0, outcome.words
    pressed = {c.name: c.quantities["normal_force"] for c in outcome.result.contacts}
    for known in random.known:
        name, _ = known.name.split(".")
        assert pressed[name] == pytest.approx(known.value, rel=1e-6)


@pytest.mark.parametrize(
    ("kind", "number"),
    [("bolt", 4), ("pin", 0), ("pin", 1), ("pin", 3), ("clevis", 1), ("tower", 2)],
)
def test_all_nodes_give_the_same_answer(of_few, kind, number):
    random = drawn(kind, number)
    require_same(random.scene, random.body(COMM), tolerance=1e-6)


def test_a_pin_that_glue_holds_at_first_is_pressed_into_its_lug():
    """Glue carries all of the load while the clearance is open; no way may end there."""
    random = COMM.bcast(draw_kind("assembly", 10, 80) if COMM.rank == 0 else None)
    found = []
    for strategy in ("monolithic", "lagged"):
        settings = dataclasses.replace(WITHOUT_ERRORS, strategy=strategy)
        scene = dataclasses.replace(random.scene, solver=settings)
        outcome = outcome_of(dataclasses.replace(random, scene=scene))
        assert outcome.code == 0, outcome.words
        found.append(outcome.result.contacts[0].quantities)
    assert found[0]["pressure_integral"] > 0
    for name in ("pressure_integral", "max_contact_pressure", "contact_area"):
        assert found[1][name] == pytest.approx(found[0][name], rel=1e-6), name
