"""Taylor's test of each friction law: tangents and transposed derivatives, by central differences.

The difference quotients are of the law's own tractions and state: a derivative with a factor, a
sign or a term missing is far outside of the tolerances.
"""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.contact.state import OPEN
from fenics_contact.problem.problem import Problem
from tests.contact.laws import test_friction_rules as rules
from tests.contact.laws.test_by_points import displaced
from tests.contact.laws.test_micro_slip import keys as micro_slip
from tests.contact.laws.test_nonlocal_friction import nonlocal_law
from tests.contact.laws.test_orthotropic import law as orthotropic
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
RULES = {
    "coulomb": {"friction_coefficient": 0.4},
    **rules.EVERY,
    "micro-slip": micro_slip(),
    "nonlocal": {"friction_coefficient": 0.4, "friction_law": nonlocal_law(0.6)},
    "orthotropic": orthotropic(),
}
PAIRS = [
    (name, law)
    for name in RULES
    for law in ("static", "incremental")
    if (name, law) != ("slip dependent", "static")  # refused: it follows load steps
]
EPSILON = 0.005
STEP = 1e-7


def rubbing(name, law="incremental", dimension=3):
    """A contact under a rule, most of whose points touch: some stick, some slip."""
    keys = {**RULES[name], "law": law}
    body = box_body((3, 2, 2)[:dimension])
    (contact,) = Problem.on_mesh(rules.sheared(keys, dimension), body).contacts
    contact.friction.regularisation.set(EPSILON)
    random = np.random.default_rng(7)
    if law == "incremental":
        displaced(contact, random)
        contact.accept()
    displaced(contact, random)
    if "slip_so_far" in {array.name for array in contact.friction.rule.state}:
        way = 0.0003 + 0.0005 * contact.trace.coordinates[:, 0]  # between the table's numbers
        contact.friction.rule.take({"slip_so_far": way})
    contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
    felt = np.linalg.norm(contact.friction.scaled_slip(slip_of(contact)), axis=1)
    acts, longest = contact.friction.bound > 0, contact.regularisation_parameter
    for some in (felt < longest, felt > longest):
        assert COMM.allreduce(int((acts & some).sum())) > 0
    return contact


def slip_of(contact):
    return contact.kinematics.tangential(contact.kinematics.jump_at_points())


def random_like(values, seed):
    return np.random.default_rng(seed).normal(size=np.shape(values))


def quotient(evaluate, step=STEP):
    """Central difference of a function of a step from the present state, which it leaves there."""
    found = (evaluate(step) - evaluate(-step)) / (2 * step)
    evaluate(0.0)
    return found


@pytest.mark.parametrize(("name", "law"), PAIRS)
@pytest.mark.parametrize("mode", ["law", "coupled"])
def test_the_true_tangent_is_the_derivative_of_the_traction(name, law, mode):
    """Where the bound is held, and where it follows the pressure, also that of other points."""
    contact = rubbing(name, law)
    kinematics, friction = contact.kinematics, contact.friction
    begin = (
        kinematics.jump.x.array.reshape(-1, kinematics.direction.size) + kinematics.motion_at_nodes
    )
    place = contact.trace.surface.of_owners(random_like(begin, 3))

    def traction(step):
        kinematics.move(begin + step * place)
        if mode == "coupled":
            friction.set_bound(friction.bound_of(contact.pressure()))
        return friction.traction(slip_of(contact))

    expected = quotient(traction)
    term = contact.friction_term
    if mode == "coupled":
        term.follow_pressure()
    term.tangent_state.take_true(slip_of(contact))
    way = contact.trace.at_points(place)
    found = -np.einsum("pij,pj->pi", term.tangent_at_points(), way)
    if friction.neighbours is not None:
        neighbours, blocks = friction.neighbours, term.tangent_between_points()
        others = neighbours.gathered(way)[neighbours.columns]
        np.subtract.at(found, neighbours.rows, np.einsum("pij,pj->pi", blocks, others))
    assert found == pytest.approx(expected, rel=1e-5, abs=1e-5 * np.abs(expected).max(initial=1))


def along(of, by):
    """A derivative in a direction, of all ranks."""
    return COMM.allreduce(float(np.sum(of * by)))


@pytest.mark.serial
@pytest.mark.parametrize(("name", "law"), PAIRS)
def test_the_transposed_derivative_of_the_traction(name, law):
    """In the slip, in the slip that counts as none, in the pressure of the bound, and in ε."""
    contact = rubbing(name, law)
    friction, slip, pressure = contact.friction, slip_of(contact), contact.pressure()
    of_traction, by_slip = random_like(slip, 1), contact.kinematics.tangential(random_like(slip, 2))
    by_pressure = pressure * random_like(pressure, 4)

    def quantity(slip, pressure):
        friction.set_bound(friction.bound_of(pressure))
        return np.sum(of_traction * friction.traction(slip))

    found = friction.vjp(slip, pressure, of_traction)
    expected = quotient(lambda step: quantity(slip + step * by_slip, pressure))
    assert along(found.slip, by_slip) == pytest.approx(expected, rel=1e-6)
    expected = quotient(lambda step: quantity(slip, pressure + step * by_pressure), 1e-5)
    assert along(found.pressure, by_pressure) == pytest.approx(expected, rel=1e-5)
    reference = friction.reference

    def from_another(step):
        friction.reference = reference + step * by_slip
        return quantity(slip, pressure)

    expected = quotient(from_another)
    assert along(found.reference, by_slip) == pytest.approx(expected, rel=1e-6)
    epsilon = contact.regularisation_parameter

    def with_another(step):
        friction.regularisation.set(epsilon + step)
        return quantity(slip, pressure)

    expected = quotient(with_another)
    of_epsilon = found.fields["regularisation_parameter"]
    assert along(of_epsilon, 1.0) == pytest.approx(expected, rel=1e-6)


KEPT = {"slip dependent": "slip_so_far", "micro-slip": "elastic_slip"}


@pytest.mark.serial
@pytest.mark.parametrize("name", KEPT)
def test_the_transposed_derivative_of_the_state_update(name):
    """Of what a step makes of the arrays of a rule: in its slip, and in what they were before."""
    contact = rubbing(name)
    friction, array, slip = contact.friction, KEPT[name], slip_of(contact)
    before = getattr(friction, array).copy()
    of_end, by_slip = random_like(before, 1), contact.kinematics.tangential(random_like(slip, 2))
    by_begin = random_like(before, 3)
    begin = contact.state()

    def quantity(slip, kept):
        friction.rule.take({array: kept})
        return np.sum(of_end * friction.at_step_end(replace(begin, slip=slip))[array])

    of_slip, others = friction.vjp_state_update(slip, begin.status != OPEN, {array: of_end})
    expected = quotient(lambda step: quantity(slip + step * by_slip, before))
    assert abs(expected) > 1e-3
    assert along(of_slip, by_slip) == pytest.approx(expected, rel=1e-6)
    expected = quotient(lambda step: quantity(slip, before + step * by_begin))
    of_begin = others.get(array, np.zeros_like(before))
    assert along(of_begin, by_begin) == pytest.approx(expected, rel=1e-6, abs=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize("name", ["coulomb", "slip dependent", "micro-slip"])
def test_the_transposed_derivative_of_the_slip_that_counts_as_none(name):
    """In the slip at the end of a step, and in the elastic slip that it leaves."""
    contact = rubbing(name)
    friction, slip = contact.friction, slip_of(contact)
    of_reference, by_slip = random_like(slip, 1), random_like(slip, 2)
    kept = {array.name: getattr(friction, array.name) for array in friction.rule.state}
    by_kept = {name: random_like(values, 3) for name, values in kept.items()}

    def quantity(step, of_kept):
        friction.rule.take({n: kept[n] + of_kept * step * by_kept[n] for n in kept})
        friction.accept(slip + (1 - of_kept) * step * by_slip)
        return np.sum(of_reference * friction.reference)

    of_slip, of_kept = friction.vjp_reference(of_reference)
    assert along(of_slip, by_slip) == pytest.approx(quotient(lambda h: quantity(h, 0)), rel=1e-6)
    found = sum(along(values, by_kept[name]) for name, values in of_kept.items())
    assert found == pytest.approx(quotient(lambda h: quantity(h, 1)), rel=1e-6, abs=1e-9)
    assert (name == "micro-slip") == bool(of_kept)


def test_the_static_law_counts_from_the_start():
    """Its slip that counts as none is no slip, whatever the step before left."""
    contact = rubbing("coulomb", "static")
    of_slip, of_kept = contact.friction.vjp_reference(random_like(slip_of(contact), 1))
    assert not of_slip.any()
    assert of_kept == {}
