"""Shares of friction against rigid slip, by formulas; as arrays."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.problem.existence.rigid_slip import RigidSlip

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="plain arrays; one rank will do")


def slip_of(places, normals, weights, motions, traction, allowed=1e-3):
    """Of points with normals, weights with a bound of 1, and a traction as a share of it."""
    jumps = np.stack([motion(places) for motion in motions], axis=-1)
    normal = np.einsum("qci,qc->qi", jumps, normals)
    slips = jumps - normals[:, :, None] * normal[:, None, :]
    return RigidSlip(
        across=np.einsum("q,qi,qj->ij", weights, normal, normal),
        allowed=allowed**2 * np.einsum("q,qci,qcj->ij", weights, slips, slips),
        work=np.einsum("q,qc,qci->i", weights, traction, slips),
        bounds=weights,
        slips=slips,
    )


def motions_of(dimension):
    """All rigid motions."""
    axes = np.eye(3)[:dimension, :dimension]
    found = [lambda x, axis=axis: np.broadcast_to(axis, x.shape) for axis in axes]
    if dimension == 2:
        return [*found, lambda x: np.column_stack([-x[:, 1], x[:, 0]])]
    return [*found, *(lambda x, axis=axis: np.cross(axis, x) for axis in np.eye(3))]


def disc(inner=0.0, rings=40, around=60):
    """Points on a flat disc in space, or a ring, of outer radius 1, and what they stand for."""
    edges = np.linspace(inner, 1, rings + 1)
    r, angle = np.meshgrid((edges[1:] + edges[:-1]) / 2, 2 * np.pi * np.arange(around) / around)
    places = np.column_stack([(r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel()])
    places = np.column_stack([places, np.zeros(len(places))])
    return places, np.tile([0.0, 0.0, 1.0], (len(places), 1)), r.ravel()


def test_a_disc_that_turns_about_its_rim():
    """At .95 of its limit: friction's resultant over μ ∫ p is .81 then."""
    places, normals, weights = disc()
    arms = places - [1.0, 0.0, 0.0]
    around = np.cross([0.0, 0.0, 1.0], arms)
    traction = 0.95 * around / np.linalg.norm(around, axis=1)[:, None]
    slip = slip_of(places, normals, weights, motions_of(3), traction)
    share, motion = slip.share()
    assert share == pytest.approx(0.95, rel=1e-9)
    assert np.linalg.norm(weights @ traction) / weights.sum() == pytest.approx(0.81, abs=0.01)
    turning = motion / motion[5]  # about (1, 0): as far as that moves along -y
    assert turning == pytest.approx([0, -1, 0, 0, 0, 1], abs=1e-5)


def test_a_pull_uses_what_it_is_of_the_limit():
    """Whatever the distribution: |∫ τ| / μ ∫ p."""
    places, normals, weights = disc()
    traction = np.zeros_like(places)
    traction[:, 0] = 0.4 + 0.3 * places[:, 0] ** 2  # even: without a moment
    slip = slip_of(places, normals, weights, motions_of(3), traction)
    assert slip.share()[0] == pytest.approx(weights @ traction[:, 0] / weights.sum(), rel=1e-9)


def test_a_flat_ring_turned_about_its_axis():
    places, normals, weights = disc(inner=0.6)
    around = np.cross([0.0, 0.0, 1.0], places)
    traction = 0.7 * around  # least near the hole: moments count
    found, _ = slip_of(places, normals, weights, motions_of(3), traction).share()
    radii = np.linalg.norm(places, axis=1)
    assert found == pytest.approx(0.7 * (weights @ radii**2) / (weights @ radii), rel=1e-9)


@pytest.mark.parametrize(("turn", "along"), [(0.6, 0.0), (0.0, 0.7), (0.6, 0.7)])
def test_a_cylinder_turned_and_pushed_along_its_axis(turn, along):
    """At one radius the two are at right angles: √(turn² + along²)."""
    angle, height = map(
        np.ravel, np.meshgrid(2 * np.pi * np.arange(48) / 48, np.linspace(-1, 1, 7))
    )
    normals = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    places = 2 * normals + height[:, None] * [0, 0, 1]
    traction = turn * np.cross([0, 0, 1], normals) + along * np.array([0, 0, 1])
    share, _ = slip_of(places, normals, np.ones(len(places)), motions_of(3), traction).share()
    assert share == pytest.approx(np.hypot(turn, along), rel=1e-9)


def test_less_than_the_share_holds_no_such_force_and_moment():
    """The share is the least s for which tractions within s g have the same force and moment."""
    from scipy.optimize import minimize

    dice = np.random.default_rng(5)
    places = dice.uniform(-1, 1, (12, 2))
    normals, weights = np.zeros((12, 2)), dice.uniform(0.5, 1, 12)
    traction = dice.uniform(-0.6, 0.6, (12, 2))
    share, _ = slip_of(places, normals, weights, motions_of(2), traction, allowed=1.0).share()

    def resultant(flat):
        tau = weights[:, None] * flat[:-1].reshape(-1, 2)
        turn = places[:, 0] * tau[:, 1] - places[:, 1] * tau[:, 0]
        return np.array([*tau.sum(axis=0), turn.sum()])

    wanted = resultant(np.append(traction.ravel(), 0.0))
    found = minimize(
        lambda z: z[-1],
        np.append(traction.ravel(), 1.0),
        jac=lambda z: np.append(np.zeros(24), 1.0),
        constraints=[
            {"type": "eq", "fun": lambda z: resultant(z) - wanted},
            {
                "type": "ineq",
                "fun": lambda z: z[-1] ** 2 - (z[:-1].reshape(-1, 2) ** 2).sum(axis=1),
            },
            {"type": "ineq", "fun": lambda z: z[-1]},
        ],
        method="SLSQP",
        options={"maxiter": 400, "ftol": 1e-12},
    )
    assert found.success
    assert share == pytest.approx(found.x[-1], rel=1e-5)


def test_where_nothing_slips_as_one_there_is_no_share():
    """An ellipse in a hole that fits, and a corner in the plane."""
    angle = 2 * np.pi * np.arange(60) / 60
    places = np.column_stack([2 * np.cos(angle), np.sin(angle)])
    normals = np.column_stack([np.cos(angle), 2 * np.sin(angle)])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    tangents = np.column_stack([-normals[:, 1], normals[:, 0]])
    for dilute in (0.0, 1.0):  # of an ellipse, or of the circle of the same points
        chosen = normals if dilute == 0 else np.column_stack([np.cos(angle), np.sin(angle)])
        where = places if dilute == 0 else 2 * chosen
        share, _ = slip_of(where, chosen, np.ones(60), motions_of(2), 0.5 * tangents).share()
        assert (share is None) == (dilute == 0)
    corner = np.concatenate([np.tile([1.0, 0.0], (5, 1)), np.tile([0.0, 1.0], (5, 1))])
    sides = np.concatenate([np.linspace([0, 0], [0, 1], 5), np.linspace([0, 0], [1, 0], 5)])
    assert slip_of(sides, corner, np.ones(10), motions_of(2), 0 * sides).share()[0] is None


def test_normals_of_facets_are_known_as_far_as_facets_turn():
    """Round, of 24 facets whose normals are off by .05: turning is along it, moving is not."""
    angle = 2 * np.pi * np.arange(24) / 24
    off = angle + 0.05 * np.cos(7 * angle)
    places = np.column_stack([np.cos(angle), np.sin(angle)])
    normals = np.column_stack([np.cos(off), np.sin(off)])
    tangents = np.column_stack([-normals[:, 1], normals[:, 0]])
    parts = places, normals, np.ones(24), motions_of(2), 0.8 * tangents
    assert slip_of(*parts).share()[0] is None
    assert slip_of(*parts, allowed=0.13).share()[0] == pytest.approx(0.8, rel=1e-2)


def test_without_friction_there_is_none_and_at_rest_it_is_0():
    places, normals, weights = disc()
    rest = slip_of(places, normals, weights, motions_of(3), 0 * places)
    assert rest.share()[0] == 0.0
    smooth = RigidSlip(rest.across, rest.allowed, rest.work, 0 * rest.bounds, rest.slips)
    assert smooth.share()[0] is None
