"""Motions of an answer that nothing resists: told, and so they leave all forces as they are."""

from math import pi

import numpy as np
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Run, SolverSettings
from fenics_contact.common.parallel import gather_rows, largest
from fenics_contact.problem.existence.undetermined import undetermined, untouched_parts
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton_failure import GIVEN_UP, Chatter, not_converged
from fenics_contact.verification.boxes import Box
from tests.random.kinds.common import Elements, held, made
from tests.random.kinds.joints import Around

COMM = MPI.COMM_WORLD
CLEARANCE = 6e-4
FLAT = Elements("plane stress", "quadrilateral", 1)


def pin(clearance, weight, around=10, friction=0.05, **keys):
    """A pin of facets in a lug, lowered by its clearance and pressed against x."""
    parts = (
        Box("pin", (0.0, 0.5), (2 * pi, 1.0), (around, 1)),
        Box("lug", (0.0, 1.0 + clearance), (2 * pi, 1.5), (around + 3, 1)),
    )
    friction = {"friction_coefficient": friction, "law": "incremental"}
    contact = Contact("lug.y0", against="pin.y1", slave="on", **friction)
    load = Load("pin" if weight else "lug", body_force=(-(weight or 1.0), 0.0))
    return made(
        "pin", FLAT, parts, Around(clearance), closed=("pin", "lug"),
        material=Material(1000.0, 0.3), support=(held("lug.y1", 2),), contact=(contact,),
        load=(load,), solver=SolverSettings(errors="none"), **keys,
    )  # fmt: skip


def solved(random):
    run = Run(random.scene, COMM, random.body(COMM))
    return run, run.solve()


def found(run):
    solution = run.solution
    return undetermined(run.problem, solution.states, solution.imbalance_limit)


def test_a_part_that_nothing_touches_is_named():
    run, result = solved(pin(0.05, 0.0))
    told = found(run)
    assert (told.floating, told.moving) == (("pin",), ())
    assert told.words in result.verdict


def _opening(contact, field):
    """Normal jumps of a field at the points."""
    jump = contact.trace.at_points(contact.kinematics.relative(field))
    return np.einsum("qc,qc->q", jump, contact.trace.normals)


def turned(run, angle):
    """Pressures and tractions of the contact with the pin turned so that no gap changes."""
    spaces, (contact,) = run.problem.spaces, run.problem.contacts
    (state,) = run.solution.states
    x, y = spaces.coordinates[:, :2].T
    of_pin = 1.0 * (spaces.parts.of_node == spaces.parts.names.index("pin"))
    turn = np.stack([-y, x], axis=1) * of_pin[:, None]
    along = [np.outer(of_pin, axis) for axis in np.eye(2)]
    pressed = contact.trace.owned & (state.contact_pressure > 0)
    opening = [_opening(contact, field)[pressed] for field in (*along, turn)]
    opening = gather_rows(COMM, np.column_stack(opening))
    shift = -np.linalg.solve(opening[:, :2], opening[:, 2])
    moved = run.solution.displacement + angle * (turn + np.tensordot(shift, along, 1))
    contact.kinematics.move(contact.kinematics.relative(moved))
    state = contact.state()
    return state.contact_pressure, state.friction_traction


def test_a_motion_that_is_told_changes_no_force():
    run, result = solved(pin(CLEARANCE, 0.02))
    told = found(run)
    assert (told.floating, told.moving) == ((), ("pin",))
    assert told.motion == "rotation about z of 'pin'"
    assert told.words in result.verdict
    (state,) = run.solution.states
    slips = np.linalg.norm(state.slip, axis=1)[state.contact_pressure > 0]
    least = -largest(COMM, -slips)
    peak = largest(COMM, state.contact_pressure)
    for angle in (0.3 * least, -0.3 * least):
        for now, before in zip(
            turned(run, angle), (state.contact_pressure, state.friction_traction), strict=True
        ):
            assert largest(COMM, np.abs(now - before)) < 0.02 * peak
    # A turn that takes slip back turns friction round.
    _, traction = turned(run, -3.0 * largest(COMM, slips))
    assert largest(COMM, np.abs(traction - state.friction_traction)) > 0.05 * peak


def test_a_pin_that_sticks_is_told_nothing_of():
    run, _ = solved(pin(-1e-3, 0.02, around=24, friction=0.5))
    assert found(run) is None


def test_a_part_that_floats_is_named_where_a_solve_fails():
    random = pin(0.05, 0.02)
    body = random.body(COMM)
    problem = Problem.on_mesh(random.scene, body)
    problem.set_time(1.0)
    assert untouched_parts(problem) == ["pin"]
    words = not_converged(problem, [1.0, 2.0], 1.0, GIVEN_UP, Chatter(problem.contacts, COMM))
    assert "Nothing touches 'pin' here, and no support holds it" in words
