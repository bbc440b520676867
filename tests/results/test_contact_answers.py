"""Pages and pictures ask a result what its laws answered, whatever they are called."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, run
from fenics_contact.contact.laws.normal import LAWS
from tests.contact.laws.test_normal_compliance import block, law
from tests.records import made_contact
from tests.scenes import box_body

# Of a result that was written before the answers were: pressure given, drawn as a solid, shear.
EARLIER = {
    ("prescribed", "static"): (True, False, True),
    ("unilateral", "none"): (False, True, False),
    ("winkler", "incremental"): (False, False, True),
    ("bonded", "stick"): (False, True, True),
}


def answers(contact):
    return contact.pressure_is_given, contact.is_rigid, contact.carries_shear


@pytest.mark.parametrize(("names", "expected"), EARLIER.items())
def test_results_without_answers_have_those_of_their_laws(names, expected):
    contact, friction = names
    assert answers(made_contact(contact=contact, law=friction)) == expected
    kind = next(law for law in LAWS if law.kind == contact)
    assert (kind.pressure_is_known, kind.has_penalty) == expected[:2]  # and laws say the same


def test_a_law_that_they_do_not_know_answers_for_itself():
    result = run(block(normal_law=law(2)), MPI.COMM_WORLD, box_body((2, 2)))
    assert answers(result.contacts[0]) == (False, False, False)


def test_every_kind_of_a_scene_has_its_law():
    kinds = {law.kind for law in LAWS}
    contacts = ({}, {"pressure": 1}, {"foundation_stiffness": 1}, {"contact": "bonded"})
    formula = {"kind": "formula", "pressure": "d"}
    contacts += ({"normal_law": law(2)}, {"normal_law": formula})
    assert kinds == {Contact("top", **keys).kind for keys in contacts}
