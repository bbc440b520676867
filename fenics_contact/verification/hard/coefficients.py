"""Hard cases of friction: large coefficients, and several answers.

Several answers to one scene: the lifted block at large friction. The block's top is moved by (.02,
+.001), so that it may hang free. At μ = 1 that is the only answer; at μ = 2 the front corner may
also touch, and stick or slip. What the program returns must be one of them, and `solver.branches`
finds them all. The inequalities are solved from different statuses to know them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.case import HardCase, ReferenceFailedError, Trials
from fenics_contact.verification.hard.exact import (
    ALONG,
    BACK,
    OPEN,
    STICK,
    ExactAnswer,
    Start,
    exact_answer,
    exact_answers,
    statuses_of,
)
from fenics_contact.verification.hard.scenes import (
    CLAMPED,
    EXACT,
    SPECIFICATION,
    box,
    compared,
    driven_body,
    driven_scene,
    plane_scene,
)

_THEME = "Coefficients of friction from 0 to 10"
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
        _THEME,
        f"driven block, dx/dy = {ratio:g}, μ = {coefficient:g}",
        EXACT,
        partial(_driven, coefficient, ratio, _DOWN),
    )


COEFFICIENTS_CASES: tuple[HardCase, ...] = (
    *(_driven_case(coefficient, 5.0) for coefficient in (0.0, 0.1, 0.5, 10.0)),
    *(
        _driven_case(coefficient, ratio)
        for ratio in (0.5, 1.0, 3.0, 5.0)
        for coefficient in (1.0, 2.0, 3.0, 4.0, 5.0)
    ),
    HardCase(
        "driven_1000_mu_2",
        _THEME,
        "dx/dy = 1000, μ = 2: the block stands on one corner, whose cells turn inside out",
        EXACT,
        partial(_driven, 2.0, 1000.0, 0.0005),
        expected=("untrusted", "not converged"),
        reason="turned inside out|solved at the points|coefficient brought up or down in steps",
    ),
    *(
        HardCase(
            f"sphere_mu_{coefficient:g}",
            _THEME,
            f"paraboloid on a cylinder, static law, μ = {coefficient:g}",
            EXACT,
            partial(_sphere, coefficient),
        )
        for coefficient in (0.0, 0.3, 0.6, 2.0, 10.0)
    ),
)


_THEME_BRANCHES = "Non-unique answers"
_LIMIT_BRANCHES = 1e-3
_AMONG = f"the branches by statuses: {EXACT}; {SPECIFICATION}"


def lifted_scene(coefficient: float, **contact: Any) -> Scene:
    """The driven block with its top moved up."""
    scene = driven_scene(coefficient, 0.02, 0.001, **contact)
    return dataclasses.replace(scene, solver=SolverSettings(branches=True))


def branches(coefficient: float) -> list[ExactAnswer]:
    """All answers that were found from different statuses, none twice; collective."""
    return exact_answers(lifted_scene(coefficient), driven_body, _starts())


def _starts() -> Iterator[Start]:
    """All points alike, or the corner at one of the ends alone."""
    for status in (OPEN, STICK, BACK, ALONG):
        yield partial(_alike, status)
        for end in (0, -1):
            yield partial(_alone, status, end)


def _alike(status: int, coordinates: Array) -> Integers:
    return np.full(len(coordinates), status)


def _alone(status: int, end: int, coordinates: Array) -> Integers:
    statuses = _alike(OPEN, coordinates)
    statuses[end] = status
    return statuses


def _lifted(coefficient: float, number: int, trials: Trials) -> Iterator[Finding]:
    """What the program returns is one of them, and its search from other starts finds all."""
    scene = lifted_scene(coefficient, regularisation_parameter=1e-6)
    result, known = trials.solve(scene, driven_body()), _known(coefficient, number)
    yield from _nearest(result, known)
    yield Finding("answers found", len(result.branches), number, 0, absolute=True)
    found = sorted(branch["quantities"]["normal_force"] for branch in result.branches)
    for branch, force in zip(sorted(known, key=lambda one: one.normal_force), found, strict=False):
        label = f"normal_force of the branch of {branch.normal_force:.3g}"
        yield Finding(label, force, branch.normal_force, _LIMIT_BRANCHES, absolute=True)


def _warned(trials: Trials) -> Iterator[Finding]:
    """Where nothing touches at first, ε follows from no pressure, and the search may miss some."""
    result = trials.solve(lifted_scene(2), driven_body())
    yield from _nearest(result, _known(2, 3))
    told = len(result.branches) == 3 or "there may be others" in result.verdict
    yield Finding("all found, or said that there may be more", told, 1, 0, absolute=True)


def _known(coefficient: float, number: int) -> list[ExactAnswer]:
    known = branches(coefficient)
    if len(known) != number:
        raise ReferenceFailedError(f"{len(known)} branches were found, not {number}")
    return known


def _nearest(result: Result, known: list[ExactAnswer]) -> list[Finding]:
    """The result against that of the branches which it is nearest to."""

    def far(branch: ExactAnswer) -> float:
        return max(finding.error for finding in compared(result, branch, _LIMIT_BRANCHES))

    return compared(result, min(known, key=far), _LIMIT_BRANCHES)


BRANCHES_CASES: tuple[HardCase, ...] = (
    HardCase(
        "lifted_mu_1",
        _THEME_BRANCHES,
        "lifted block, μ = 1: one answer",
        _AMONG,
        partial(_lifted, 1, 1),
    ),
    HardCase(
        "lifted_mu_2",
        _THEME_BRANCHES,
        "lifted block, μ = 2: three answers",
        _AMONG,
        partial(_lifted, 2, 3),
    ),
    HardCase("lifted_mu_2_auto", _THEME_BRANCHES, "the same with the automatic ε", _AMONG, _warned),
)
