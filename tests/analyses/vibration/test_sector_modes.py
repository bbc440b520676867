"""Modes of a sector: those in which all sectors move alike, by formula and of the ring."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq
from scipy.special import jv, yv

from fenics_contact import Damping, Discretisation, Material, Modes, Run, Scene, Support
from tests.problem.sectors import SECTORS, fitted, hub_on_shaft
from tests.problem.test_sector import CUT, NU, E, graded

COMM = MPI.COMM_WORLD
DENSITY, INNER, OUTER = 2e-3, 10.0, 30.0


def first(function):
    """Lowest root of a function of the wave number."""
    numbers = np.linspace(0.01, 0.3, 300)
    values = [function(k) for k in numbers]
    place = next(i for i in range(len(values) - 1) if values[i] * values[i + 1] < 0)
    return brentq(function, numbers[place], numbers[place + 1])


def of_ring():
    """Lowest frequencies in which a ring held inside twists, and breathes, in plane strain.

    u = J₁(kr) Y₁(ka) − Y₁(kr) J₁(ka) around, without shear at the rim: k² = ρω²/G; along the
    radius, without (λ + 2G) u' + λ u/r there: k² = ρω²/(λ + 2G).
    """
    shear = E / (2 * (1 + NU))
    lame = E * NU / (1 + NU) / (1 - 2 * NU)
    wave = lame + 2 * shear

    def moved(k, order, radius):
        return jv(order, k * radius) * yv(1, k * INNER) - yv(order, k * radius) * jv(1, k * INNER)

    twist = first(lambda k: moved(k, 2, OUTER))
    breath = first(
        lambda k: (
            wave * (k * moved(k, 0, OUTER) - moved(k, 1, OUTER) / OUTER)
            + lame * moved(k, 1, OUTER) / OUTER
        )
    )
    return np.sqrt([shear / DENSITY, wave / DENSITY]) * [twist, breath] / (2 * np.pi)


@pytest.mark.parametrize("amount", [0.0, 0.3])
def test_modes_of_a_ring_by_a_sector(amount):
    """Also where the meshes of the cut faces do not match."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, NU, density=DENSITY),
        discretisation=Discretisation(2),
        support=(Support("ring.y0", {"x": 0, "y": 0}),),
        modes=Modes(2),
        cyclic_symmetry=CUT,
    )
    result = Run(scene, COMM, graded(2, amount=amount)).solve()
    found = [mode.natural_frequency for mode in result.modes]
    # Straight facets: a bore of 20 of them lies inside of the circle by 4e-3.
    assert found == pytest.approx(of_ring(), rel=5e-3)
    assert "harmonic 0" in result.verdict


def vibrating(whole, **scene):
    """A hub on a shaft, cut elsewhere than this."""
    pressed = dataclasses.replace(
        fitted(whole, twist=0.0, law="incremental"),
        material=Material(E, NU, density=1e-3),
        **scene,
    )
    return Run(pressed, COMM, hub_on_shaft(SECTORS if whole else 1, offset=0.4)).solve()


def test_modes_of_a_fit_are_among_those_of_the_ring():
    """The first and the tenth of the ring: contacts stick across the cut, too."""
    whole, part = (vibrating(w, modes=Modes(10 if w else 2)) for w in (True, False))
    frequencies = [mode.natural_frequency for mode in whole.modes]
    assert part.modes[0].natural_frequency == pytest.approx(frequencies[0], rel=1e-9)
    assert part.modes[1].natural_frequency == pytest.approx(frequencies[9], rel=1e-9)
    assert SECTORS * part.modes[0].modal_mass == pytest.approx(whole.modes[0].modal_mass, rel=1e-9)


def test_a_fit_damps_a_sector_as_the_ring():
    """Twelfth of the loss in each, but for what a loop that has closed may still change."""
    damping = Damping(amplitudes=(0.05,), modes=(1,), increments=8, cycles=2)
    whole, part = (vibrating(w, modes=Modes(1), damping=damping).damping[0] for w in (True, False))
    assert part.loss * SECTORS == pytest.approx(whole.loss, rel=1e-2)
    assert part.natural_frequency == pytest.approx(whole.natural_frequency, rel=1e-3)
    assert part.damping_ratio > 0.01
