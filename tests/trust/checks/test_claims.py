"""Each law claims the checks that judge it, by name, and no check sees the contacts of others."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Run
from fenics_contact.contact.laws import friction, normal
from fenics_contact.contact.laws.friction.slip_laws import Static, Stick
from fenics_contact.contact.laws.normal.elastic_laws import Untouched
from fenics_contact.results.check_messages import WORDS
from fenics_contact.trust.run_checks import OF_EVERY_SOLUTION, OF_LAWS
from tests.messages import refused
from tests.scenes import slab
from tests.trust.checks.test_run_checks import two_pads

COMM = MPI.COMM_WORLD
LAWS = (*normal.LAWS, Untouched, *friction.LAWS, Stick)


class Unjudged(Static):
    """Friction that claims no check at all."""

    checks = ()


class Mistaken(Static):
    """It claims one that there is not."""

    checks = (*Static.checks, "friction_cones")


def test_laws_claim_checks_that_there_are_and_each_is_claimed():
    claimed = {name for law in LAWS for name in law.checks}
    assert claimed == set(OF_LAWS)
    assert not set(OF_LAWS) & set(OF_EVERY_SOLUTION)
    assert all(len(set(law.checks)) == len(law.checks) for law in LAWS)
    assert {*OF_EVERY_SOLUTION, *OF_LAWS} <= set(WORDS)


@pytest.mark.parametrize(
    ("contact", "checks"),
    [
        (Contact("top", pressure=1), set()),
        (Contact("top"), {"tension", "penetration", "penetration_depth", "contact_law"}),
        (Contact("top", contact="bonded"), {"penetration_depth"}),
        (Contact("top", foundation_stiffness=1), {"tension", "contact_law", "pressure_recovery"}),
    ],
)
def test_a_law_claims_what_it_is_to_be_judged_by(contact, checks):
    claimed = set(normal.law_of(contact).checks)
    assert checks <= claimed
    assert ("penetration_depth" in claimed) == normal.law_of(contact).has_penalty


def test_a_law_without_claims_is_not_judged(monkeypatch):
    monkeypatch.setattr(friction, "LAWS", (Unjudged,))
    result = Run(slab(), COMM).solve()
    assert {"equilibrium", "resultant", "boundary_stress"} <= set(result.checks)
    assert not set(OF_LAWS) & set(result.checks)


def test_checks_see_the_contacts_of_laws_that_claim_them():
    """Of two pads that pull differently, the second one's friction is not judged any more."""
    prepared = two_pads()
    both = prepared.solve().checks
    left, right = prepared.problem.contacts
    seen = set()
    for judged, other in ((left, right), (right, left)):
        judged.friction.checks, other.friction.checks = Static.checks, ()
        checks = prepared.solve().checks
        assert checks.keys() == both.keys()
        seen |= {(checks[name].contact, judged.label) for name in Static.checks if name in checks}
    assert seen == {("left", "left"), ("right", "right")}


def test_a_claim_of_no_check_is_a_fault_of_the_law(monkeypatch):
    monkeypatch.setattr(friction, "LAWS", (Mistaken,))
    with refused("law_claims_unknown_checks", ValueError):
        Run(slab(cells=(4, 1)), COMM).solve()
