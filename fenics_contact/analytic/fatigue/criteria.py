"""Fatigue criteria of a history of stress: Smith, Watson and Topper, Crossland, Dang Van.

A history is an array (places, times, 3, 3) of stresses, or of the strains with them, over one
cycle of loads. All numbers are exact but for round-off, and for the planes that are searched.

Sources: K. N. Smith, P. Watson, T. H. Topper, J. Materials 5 (1970) 767-778; of the plane on which
their parameter is largest: A. Fatemi, D. F. Socie, Fatigue Fract. Eng. Mater. Struct. 11 (1988)
149-165. B. Crossland, Int. Conf. on Fatigue of Metals, London (1956) 138-149. K. Dang Van, ASTM
STP 1191 (1993) 120-130.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.analytic.fatigue.enclosing_ball import smallest_balls
from fenics_contact.common.arrays import Array

# An orthonormal basis of the symmetric tensors without a trace.
_DEVIATORS = np.array(
    [
        np.diag([2.0, -1.0, -1.0]) / np.sqrt(6),
        np.diag([0.0, 1.0, -1.0]) / np.sqrt(2),
        np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]) / np.sqrt(2),
        np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) / np.sqrt(2),
        np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]) / np.sqrt(2),
    ]
)


def mean_stress(history: Array) -> Array:
    """A third of the trace, > 0 in tension, (places, times) (stress)."""
    return np.asarray(np.trace(history, axis1=2, axis2=3) / 3)


def deviator_paths(history: Array) -> Array:
    """The deviators in an orthonormal basis, (places, times, 5) (stress)."""
    return np.asarray(np.einsum("ptij,kij->ptk", history, _DEVIATORS))


def deviator_amplitudes(history: Array) -> tuple[Array, Array]:
    """√J₂ of the smallest ball around the path of the deviator, (places,), and its middle.

    Args:
        history: Stresses.

    Returns:
        Radii over √2 (stress), and the balls' centres, (places, 3, 3) (stress).
    """
    centres, radii = smallest_balls(deviator_paths(history))
    return radii / np.sqrt(2), np.asarray(np.einsum("pk,kij->pij", centres, _DEVIATORS))


def crossland(history: Array, alpha: float) -> Array:
    """√J₂a + α p_max, which is at most the fatigue limit in torsion, (places,) (stress).

    Args:
        history: Stresses.
        alpha: Factor of the largest mean stress.
    """
    return deviator_amplitudes(history)[0] + alpha * mean_stress(history).max(axis=1)


def dang_van(history: Array, alpha: float) -> Array:
    """The largest τ(t) + α p(t), which is at most the fatigue limit in torsion, (places,) (stress).

    τ is half the difference of the largest and the least principal stress of what is left of the
    deviator once the middle of the smallest ball around its path is taken away, as the residual
    stress that a grain settles at does.

    Args:
        history: Stresses.
        alpha: Factor of the mean stress.
    """
    settled = history - deviator_amplitudes(history)[1][:, None]
    principal = np.linalg.eigvalsh(settled)
    shear = (principal[..., 2] - principal[..., 0]) / 2
    return np.asarray((shear + alpha * mean_stress(history)).max(axis=1))


def crossland_alpha(torsion: float, tension: float) -> float:
    """The α with which both fatigue limits, each to and fro, are on the criterion's line.

    Args:
        torsion: Amplitude of the shear stress that is endured (stress).
        tension: That of tension and compression (stress).
    """
    return 3 * torsion / tension - float(np.sqrt(3))


def dang_van_alpha(torsion: float, tension: float) -> float:
    """Return the α with which both limits (stress) are on the line of Dang Van's criterion."""
    return 3 * torsion / tension - 1.5
