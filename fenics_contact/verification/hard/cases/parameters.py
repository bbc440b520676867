"""Tiny regularisation and penalty parameters, against exact inequalities without either."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from mpi4py import MPI

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.bodies import box
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.exact import exact_answer, statuses_of
from fenics_contact.verification.hard.scenes import (
    EXACT,
    E,
    compared,
    driven_body,
    driven_scene,
    pressed_scene,
    with_contact,
)
from fenics_contact.verification.published.slab import slab_scene

THEME = "Tiny ε and ε₁"
# ε is measured by how far the block's top moves, ε₁ by h/E.
_MOVED, _COMPLIANCE = 0.05, 0.125 / E
_PENALTIES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
_SLIPS = (1e-4, 1e-6, 1e-8, 1e-10)
# A smaller ε₁ moves the forces by its share; round-off of the stiff springs limits the smallest.
_LIMIT = 1e-3
# Of the slab on 16 × 1 elements.
_SLAB_FRICTION = 209.98


def _pressed(share: float, trials: Trials) -> Iterator[Finding]:
    scene = pressed_scene(penalty_parameter=share * _COMPLIANCE)
    result = trials.solve(scene, _pressed_body())
    yield from compared(result, exact_answer(scene, _pressed_body), _LIMIT)


def _pressed_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    return box((16, 8), (2, 1), comm=comm)


def _driven(
    coefficient: float, slip: float, penalty: float | None, trials: Trials
) -> Iterator[Finding]:
    scene = driven_scene(coefficient, _MOVED, -0.01, regularisation_parameter=slip * _MOVED)
    if penalty is not None:
        scene = with_contact(scene, penalty_parameter=penalty * _COMPLIANCE)
    result = trials.solve(scene, driven_body())
    exact = exact_answer(scene, driven_body, statuses_of(result))
    yield from compared(result, exact, _LIMIT)


def _slab(epsilon: float, trials: Trials) -> Iterator[Finding]:
    scene = with_contact(slab_scene(300.0), regularisation_parameter=epsilon)
    friction = trials.solve(scene).quantities["friction_force"][0]
    yield Finding("friction_force x", friction, _SLAB_FRICTION, 0.02, absolute=True)


CASES: tuple[HardCase, ...] = (
    *(
        HardCase(
            f"penalty_{share:.0e}",
            THEME,
            f"ε₁ = {share:.0e} h/E, parabola on a block",
            EXACT,
            partial(_pressed, share),
        )
        for share in _PENALTIES
    ),
    *(
        HardCase(
            f"penalty_{share:.0e}",
            THEME,
            f"ε₁ = {share:.0e} h/E: round-off drowns the springs",
            EXACT,
            partial(_pressed, share),
            expected=("solved", "not converged"),
            reason="round-off.*a larger penalty_parameter",
        )
        for share in (1e-13, 1e-14, 1e-15)
    ),
    *(
        HardCase(
            f"slip_{share:.0e}",
            THEME,
            f"ε = {share:.0e} of the motion, driven block, μ = 0.5",
            EXACT,
            partial(_driven, 0.5, share, None),
        )
        for share in _SLIPS
    ),
    *(
        HardCase(
            f"large_mu_{coefficient:g}_slip_{slip:.0e}",
            THEME,
            f"μ = {coefficient:g} and ε = {slip:.0e} of the motion, driven block",
            EXACT,
            partial(_driven, coefficient, slip, None),
        )
        for coefficient in (5.0, 10.0)
        for slip in (1e-6, 1e-10)
    ),
    HardCase(
        "slip_and_penalty",
        THEME,
        "ε = 1e-10 and ε₁ = 1e-10 at once, driven block, μ = 3",
        EXACT,
        partial(_driven, 3.0, 1e-10, 1e-10),
    ),
    *(
        HardCase(
            f"slab_slip_{epsilon:.0e}",
            THEME,
            f"ε = {epsilon:.0e}, slab under a given pressure",
            "the paper's example 1; value of a separate prototype",
            partial(_slab, epsilon),
        )
        for epsilon in (1e-6, 1e-10)
    ),
)
