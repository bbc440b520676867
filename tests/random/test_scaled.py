"""Scenes at random in other units, or of a thickness: nothing but factors changes.

``benchmarks/random_units.py`` solves as many as one likes.
"""

import dataclasses

import pytest
from mpi4py import MPI

from tests.random.kinds import draw_any
from tests.random.outcomes import outcome_of
from tests.random.scaled import SYSTEMS, Factors, differences, plane_stress, scaled, smaller

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
SEED = 1


def require_same(random, *every):
    one = outcome_of(random).result
    assert one is not None
    for factors in every:
        other = outcome_of(scaled(random, factors))
        assert other.result is not None, other.words
        assert not differences(random.scene, one, other.result, factors), repr(random)
    return one


def drawn(number, most=4):
    return COMM.bcast(smaller(draw_any(SEED, number), most) if COMM.rank == 0 else None)


@pytest.mark.parametrize("number", [2, 5, 13])
def test_of_a_thickness_all_is_in_proportion(number):
    """Forces that are given are in total."""
    one = require_same(plane_stress(drawn(number)), Factors(thickness=0.002), Factors(thickness=20))
    assert one.errors["strain_energy"]["mesh"] is not None


@pytest.mark.parametrize(
    ("number", "system"), list(zip([2, 5, 8, 9, 13, 22], SYSTEMS, strict=True))
)
def test_units_change_nothing(number, system):
    require_same(drawn(number), Factors(*SYSTEMS[system]))


def test_a_number_that_hides_a_unit_is_seen():
    """Such as an indentation that stays what it is while all else is in other units."""
    random = drawn(13)
    one, factors = outcome_of(random).result, Factors(*SYSTEMS["mm, N"])
    other = scaled(random, factors)
    (contact, *others) = other.scene.contact
    contact = dataclasses.replace(contact, friction_coefficient=1.01 * contact.friction_coefficient)
    scene = dataclasses.replace(other.scene, contact=(contact, *others))
    found = outcome_of(dataclasses.replace(other, scene=scene)).result
    assert differences(random.scene, one, found, factors)
