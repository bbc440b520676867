"""Criteria of fatigue against what they are for tension, torsion and both out of phase."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq, nnls
from scipy.spatial.transform import Rotation

from fenics_contact.analytic import fatigue_criteria as criteria
from fenics_contact.analytic.critical_plane import StrainLife, swt
from fenics_contact.analytic.fatigue_criteria import smallest_balls
from fenics_contact.common.arrays import Array

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="no meshes; one rank will do")

E, NU = 200e3, 0.3
TIMES = 2 * np.pi * np.arange(48) / 48  # with both turns of sine and cosine
STEEL = StrainLife(900.0, -0.09, 0.4, -0.6)


def stress(tension: Array, shear: Array) -> Array:
    """A history of one place, of bars under tension and torsion."""
    found = np.zeros((1, len(tension), 3, 3))
    found[..., 0, 0] = tension
    found[..., 0, 1] = found[..., 1, 0] = shear
    return found


def strain(history: Array) -> Array:
    """By Hooke's law."""
    trace = np.trace(history, axis1=2, axis2=3)[..., None, None]
    return np.asarray(((1 + NU) * history - NU * trace * np.eye(3)) / E)


def turned(history: Array, rotation: Array) -> Array:
    return np.asarray(rotation @ history @ rotation.T)


@pytest.mark.parametrize("rotation", [np.eye(3), Rotation.from_euler("xyz", [1, 2, 3]).as_matrix()])
@pytest.mark.parametrize("mean", [0.0, 80.0, -150.0])
def test_tension(mean: float, rotation: Array) -> None:
    """√J₂a = σ_a/√3, τ of the grain σ_a/2, p the third, and the plane across the bar."""
    amplitude, largest = 120.0, mean + 120
    history = turned(stress(mean + amplitude * np.sin(TIMES), 0 * TIMES), rotation)
    assert criteria.deviator_amplitudes(history)[0] == pytest.approx(amplitude / np.sqrt(3))
    found = criteria.crossland(history, 0.3)
    assert found == pytest.approx(amplitude / np.sqrt(3) + 0.1 * largest, rel=1e-12)
    found = criteria.dang_van(history, 0.3)
    assert found == pytest.approx(amplitude / 2 + 0.1 * largest, rel=1e-12)
    parameter, normal = swt(history, strain(history))
    if largest > 0:
        assert parameter == pytest.approx(largest * amplitude / E, rel=1e-10)
        assert abs(normal[0] @ rotation[:, 0]) == pytest.approx(1, abs=1e-9)
    else:
        assert parameter[0] < 0.02 * amplitude**2 / E


def test_tension_of_nothing_but_compression() -> None:
    """No plane is pulled, so that no crack grows: an endless life."""
    history = stress(-150 + 120 * np.sin(TIMES), 0 * TIMES)
    history += -200 * np.eye(3)
    parameter, _ = swt(history, strain(history))
    assert parameter[0] == 0 and np.isinf(STEEL.cycles(parameter, E))


@pytest.mark.parametrize("mean", [0.0, 70.0])
def test_torsion(mean: float) -> None:
    """√J₂a = τ_a, p = 0; the plane at 45 degrees has σ_n = τ and ε_n = (1 + ν) τ/E."""
    amplitude = 90.0
    history = stress(0 * TIMES, mean + amplitude * np.sin(TIMES))
    assert criteria.crossland(history, 0.7) == pytest.approx(amplitude, rel=1e-12)
    assert criteria.dang_van(history, 0.7) == pytest.approx(amplitude, rel=1e-12)
    parameter, normal = swt(history, strain(history))
    assert parameter == pytest.approx((mean + amplitude) * amplitude * (1 + NU) / E, rel=1e-10)
    assert np.abs(normal[0]) == pytest.approx([np.sqrt(0.5), np.sqrt(0.5), 0], abs=1e-5)


@pytest.mark.parametrize(("tension", "shear"), [(120.0, 40.0), (60.0, 90.0), (np.sqrt(3), 1.0)])
def test_out_of_phase(tension: float, shear: float) -> None:
    """A quarter of a cycle apart the deviator runs round an ellipse: its longer half axis."""
    history = stress(tension * np.sin(TIMES), shear * np.cos(TIMES))
    amplitude, middle = criteria.deviator_amplitudes(history)
    assert amplitude == pytest.approx(max(tension / np.sqrt(3), shear), rel=1e-10)
    assert np.abs(middle).max() < 1e-10 * tension
    alpha = 0.4
    of_time = np.hypot(tension * np.sin(TIMES) / 2, shear * np.cos(TIMES))
    expected = (of_time + alpha * tension * np.sin(TIMES) / 3).max()
    assert criteria.dang_van(history, alpha) == pytest.approx(expected, rel=1e-10)


def test_alphas_put_both_limits_on_the_line() -> None:
    torsion, tension = 250.0, 400.0
    for of, alpha in (
        (criteria.crossland, criteria.crossland_alpha(torsion, tension)),
        (criteria.dang_van, criteria.dang_van_alpha(torsion, tension)),
    ):
        pulled = of(stress(tension * np.sin(TIMES), 0 * TIMES), alpha)
        assert pulled == pytest.approx(torsion, rel=1e-12)
        assert of(stress(0 * TIMES, torsion * np.sin(TIMES)), alpha) == pytest.approx(torsion)


def test_search_of_planes_on_paths_at_random() -> None:
    """No plane of very many beats the one that is found, and the body may be turned."""
    random = np.random.default_rng(7)
    history = random.normal(size=(20, 8, 3, 3))
    history = history + np.swapaxes(history, 2, 3)
    strains = strain(history)
    parameter, normal = swt(history, strains)
    many = random.normal(size=(20_000, 3))
    many /= np.linalg.norm(many, axis=1, keepdims=True)
    pull = np.einsum("ptij,ni,nj->ptn", history, many, many).max(axis=1)
    stretch = np.ptp(np.einsum("ptij,ni,nj->ptn", strains, many, many), axis=1)
    assert (parameter >= (np.maximum(pull, 0) * stretch / 2).max(axis=1) * (1 - 1e-9)).all()
    across = np.einsum("ptij,pi,pj->pt", history, normal, normal).max(axis=1)
    stretched = np.ptp(np.einsum("ptij,pi,pj->pt", strains, normal, normal), axis=1)
    assert parameter == pytest.approx(across * stretched / 2, rel=1e-12)
    rotation = Rotation.from_euler("xyz", [0.3, -1, 2]).as_matrix()
    again, _ = swt(turned(history, rotation), turned(strains, rotation))
    assert again == pytest.approx(parameter, rel=1e-9)


@pytest.mark.parametrize("components", [2, 3, 5])
@pytest.mark.parametrize("flat", [0, 1, 2])
def test_smallest_balls(components: int, flat: int) -> None:
    """All points are inside, and the centre is a mean of those on the ball: so none is smaller."""
    random = np.random.default_rng(components)
    paths = random.normal(size=(40, 25, components))
    if flat:  # all on a line, or in a plane
        paths = paths[:, :, :flat] @ random.normal(size=(flat, components))
    paths = np.concatenate([paths, paths[:, :5]], axis=1)  # some points twice
    centres, radii = smallest_balls(paths)
    distance = np.linalg.norm(paths - centres[:, None], axis=2)
    assert (distance <= radii[:, None] * (1 + 1e-12)).all()
    for path, centre, radius, away in zip(paths, centres, radii, distance, strict=True):
        on_it = path[away > radius * (1 - 1e-8)] - centre
        _, left = nnls(
            np.vstack([on_it.T, np.full(len(on_it), radius)]), [0] * components + [radius]
        )
        assert left < 1e-7 * radius


def test_smallest_balls_of_hardly_any_points() -> None:
    centres, radii = smallest_balls(np.array([[[1.0, 2.0, 3.0]] * 3, [[0.0, 0.0, 0.0]] * 3]))
    assert radii.tolist() == [0, 0] and centres.tolist() == [[1, 2, 3], [0, 0, 0]]
    assert smallest_balls(np.zeros((0, 4, 5)))[1].shape == (0,)


@pytest.mark.parametrize("amplitude", [30.0, 150.0, 400.0, 1200.0])
@pytest.mark.parametrize("kind", ["tension", "torsion"])
def test_lives(amplitude: float, kind: str) -> None:
    """Of tension σ_a²/E, and of torsion (1 + ν) τ_a²/E, on the line that the constants draw."""
    wave, rest = amplitude * np.sin(TIMES), 0 * TIMES
    history = stress(wave, rest) if kind == "tension" else stress(rest, wave)
    parameter, _ = swt(history, strain(history))
    known = amplitude**2 / E * (1 if kind == "tension" else 1 + NU)
    s, b, e, c = 900.0, -0.09, 0.4, -0.6

    def missed(log_cycles: float) -> float:
        reversals = 2 * np.exp(log_cycles)
        return float(s**2 / E * reversals ** (2 * b) + s * e * reversals ** (b + c) - known)

    expected = np.exp(brentq(missed, -20, 120, xtol=1e-12))
    assert STEEL.cycles(parameter, E) == pytest.approx(expected, rel=1e-7)
