"""Friction from none to far beyond what is usual, against exact inequalities."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from mpi4py import MPI

from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.bodies import box
from fenics_contact.verification.hard.case import HardCase, Trials
from fenics_contact.verification.hard.exact import exact_answer, statuses_of
from fenics_contact.verification.hard.scenes import (
    CLAMPED,
    EXACT,
    compared,
    driven_body,
    driven_scene,
    plane_scene,
)

THEME = "Coefficients of friction from 0 to 10"
_DOWN = 0.01
_LIMIT = 1e-3


def _driven(coefficient: float, over_down: float, down: float, trials: Trials) -> Iterator[Finding]:
    scene = driven_scene(coefficient, over_down * down, -down)
    result = trials.solve(scene, driven_body())
    exact = exact_answer(scene, driven_body, statuses_of(result))
    yield from compared(result, exact, _LIMIT)


def _sphere_scene(coefficient: float) -> Scene:
    obstacle = Obstacle("paraboloid", radius=2, position=(0, 1), indentation=0.1)
    return plane_scene(
        Contact("top", obstacle=obstacle, friction_coefficient=coefficient),
        (CLAMPED,),
        kinematics="axisymmetric",
        symmetry=("left",),
    )


def _sphere_body(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    return box((24, 24), (1, 1), comm=comm)


def _sphere(coefficient: float, trials: Trials) -> Iterator[Finding]:
    scene = _sphere_scene(coefficient)
    result = trials.solve(scene, _sphere_body())
    exact = exact_answer(scene, _sphere_body, statuses_of(result))
    yield from compared(result, exact, _LIMIT)


def _driven_case(coefficient: float, ratio: float) -> HardCase:
    return HardCase(
        f"driven_{ratio:g}_mu_{coefficient:g}",
        THEME,
        f"driven block, dx/dy = {ratio:g}, μ = {coefficient:g}",
        EXACT,
        partial(_driven, coefficient, ratio, _DOWN),
    )


CASES: tuple[HardCase, ...] = (
    *(_driven_case(coefficient, 5.0) for coefficient in (0.0, 0.1, 0.5, 10.0)),
    *(
        _driven_case(coefficient, ratio)
        for ratio in (0.5, 1.0, 3.0, 5.0)
        for coefficient in (1.0, 2.0, 3.0, 4.0, 5.0)
    ),
    HardCase(
        "driven_1000_mu_2",
        THEME,
        "dx/dy = 1000, μ = 2: the block stands on one corner",
        EXACT,
        partial(_driven, 2.0, 1000.0, 0.0005),
        expected=("solved", "not converged"),
        reason="coefficient brought up or down in steps",
    ),
    *(
        HardCase(
            f"sphere_mu_{coefficient:g}",
            THEME,
            f"paraboloid on a cylinder, static law, μ = {coefficient:g}",
            EXACT,
            partial(_sphere, coefficient),
        )
        for coefficient in (0.0, 0.3, 0.6, 2.0, 10.0)
    ),
)
