"""Answers of a study are those of separate runs, from one factorisation."""

import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import InputError, Material, Study, run
from tests.scenes import slab
from tests.simulation.studies.cases import CASES, MU, ON_A_FLOOR, square

COMM = MPI.COMM_WORLD
# Quantities of one kind: what each is small against is the largest of them.
KINDS = {
    "force": ("force", "reaction", "pressure_integral"),
    "area": ("area",),
    "energy": ("energy", "work", "defect"),
    "length": ("slip", "penetration", "indentation", "gap", "displacement", "radius"),
}


def kind_of(name):
    return next((kind for kind, ends in KINDS.items() if name.endswith(ends)), name)


def require_same(found, expected, tolerance=1e-9):
    assert found.converged == expected.converged
    assert found.verdict == expected.verdict
    assert list(found.checks) == list(expected.checks)
    for name, check in expected.checks.items():
        assert found.checks[name].passed == check.passed, name
    assert len(found.steps) == len(expected.steps)
    pairs = [(found.quantities, expected.quantities)]
    for ours, theirs in zip(found.contacts, expected.contacts, strict=True):
        pairs.append((ours.quantities, theirs.quantities))
    sizes = {}
    for _, theirs in pairs:
        for name, value in theirs.items():
            if value is not None:
                size = np.abs(value).max()
                sizes[kind_of(name)] = max(sizes.get(kind_of(name), 0.0), size)
    for support in expected.supports:
        sizes["force"] = max(sizes["force"], np.abs(support.reaction).max())
    for ours, theirs in pairs:
        assert ours.keys() == theirs.keys()
        for name, value in theirs.items():
            if value is None:
                assert ours[name] is None
                continue
            off = np.abs(np.array(ours[name]) - np.array(value)).max()
            assert off <= tolerance * sizes[kind_of(name)], (name, off, value)


@pytest.mark.parametrize("name", CASES)
def test_each_answer_is_that_of_its_own_run(name):
    scene, make, every = CASES[name]
    body = make()
    study = Study(scene, COMM, body)
    for changes in [{}, *every, {}]:
        found = study.solve(changes)
        require_same(found, run(study.changed(changes), COMM, body))
        assert not study.other_parts(changes)
    assert study.factorisations == 1


@pytest.mark.parametrize(
    ("load", "sticks_from"),
    [(100, 8), (200, 7.75), (300, 6.25), (400, 5.25), (600, 3), (700, 1.75)],
)
def test_the_papers_slab_from_one_body(load, sticks_from, slab_study):
    """Where it sticks last, along a slab of 8: example 1 of Campos, Oden and Kikuchi (1982)."""
    points = slab_study.solve({"load.0.traction.0": -load}).points
    sticking = points.coordinates[points.status == "STICK", 0]
    assert sticking.max(initial=0.0) == pytest.approx(sticks_from, abs=1e-9)
    assert slab_study.factorisations == 1


@pytest.fixture(scope="module")
def slab_study():
    study = Study(slab())
    yield study
    study.close()


def test_the_body_is_made_anew_only_where_it_is_another(caplog):
    study = Study(ON_A_FLOOR, COMM, square())
    softer = {"material.0": Material(500, 0.3)}
    assert study.other_parts(softer) == ["material"]
    before, after = study.solve(), study.solve(softer)
    assert study.factorisations == 2
    assert after.quantities["normal_force"] < 0.6 * before.quantities["normal_force"]
    assert study.solve({"material.0": Material(500, 0.3), MU: 0.1}).converged
    assert study.factorisations == 2


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"contact.0.friction": 1}, "change of contact.0.friction: there is no such key"),
        ({"contact.1.pressure": 1}, "contact.1: '1' must be a number from 0 to 0"),
        ({"contact.x.pressure": 1}, "contact.x: 'x' must be a number from 0 to 0"),
        ({MU: -1}, "change of contact.0.friction_coefficient: Contact: "),
        ({"title.0": 1}, "change of title.0: 'title' is not a table"),
        ({"contact.0": ON_A_FLOOR.contact[0], MU: 1}, "another change is of a part of it"),
        ({"accuracy": 0.01}, "a study keeps one mesh"),
    ],
)
def test_a_change_that_cannot_be_is_refused_in_one_sentence(changes, said):
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        Study(ON_A_FLOOR, COMM, square()).solve(changes)
    assert "\n" not in str(caught.value)
