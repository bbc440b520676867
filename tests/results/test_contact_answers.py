"""Pages and pictures ask a result what its laws answered, whatever they are called."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, run
from fenics_contact.contact.laws.normal import LAWS
from tests.contact.laws.test_normal_compliance import block, law
from tests.records import made_contact
from tests.scenes import box_body

# Of the laws across a contact: whether pressure is given, and whether it is drawn as a solid.
ANSWERS = {
    "prescribed": (True, False),
    "unilateral": (False, True),
    "winkler": (False, False),
    "bonded": (False, True),
}


def answers(contact):
    return contact.pressure_is_given, contact.is_rigid, contact.carries_shear


@pytest.mark.parametrize(("kind", "expected"), ANSWERS.items())
def test_laws_answer(kind, expected):
    law = next(law for law in LAWS if law.kind == kind)
    assert (law.pressure_is_known, law.has_penalty) == expected
    assert answers(made_contact(contact=kind, law="static")) == (*expected, True)


def test_a_law_that_they_do_not_know_answers_for_itself():
    result = run(block(normal_law=law(2)), MPI.COMM_WORLD, box_body((2, 2)))
    assert answers(result.contacts[0]) == (False, False, False)


def test_every_kind_of_a_scene_has_its_law():
    kinds = {law.kind for law in LAWS}
    contacts = ({}, {"pressure": 1}, {"foundation_stiffness": 1}, {"contact": "bonded"})
    formula = {"kind": "formula", "pressure": "d"}
    contacts += ({"normal_law": law(2)}, {"normal_law": formula})
    assert kinds == {Contact("top", **keys).kind for keys in contacts}
