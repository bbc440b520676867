"""Preloads of bars: closed formulas, several in one body, and what is refused."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Discretisation,
    Material,
    Path,
    Preload,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from tests.messages import refused
from tests.preload.joints import BOLT, TOP, joint

E = 1000.0
FORCE = 5.0


def bar(kinematics="plane strain", solver="condensed", poissons_ratio=0.0, **others):
    """The bolt of the joint between two fixed ends; the sleeve stands beside it, fixed as well."""
    axes = "xyz" if kinematics == "3D" else "xy"
    fixed = dict.fromkeys(axes, 0)
    given = {
        "kinematics": kinematics,
        "material": Material(E, poissons_ratio),
        "discretisation": Discretisation(1),
        "support": (Support("bottom", fixed), Support("ground", fixed), Support("top", {"y": 0})),
        "symmetry": () if kinematics == "axisymmetric" else ("middle",),
        "preload": (Preload("shank", (0, 1, 0)[: len(axes)], FORCE, name="bolt"),),
        "steps": Steps(times=(0.5, 1.0)),
        "solver": SolverSettings(solver=solver, errors="none"),
    }
    return Scene(**given | others)


def solved(of, body):
    result = Run(of, MPI.COMM_WORLD, body).solve()
    assert result.converged, result.verdict
    assert result.passed, result.verdict
    return result


@pytest.mark.parametrize(
    ("kinematics", "solver"),
    [
        ("plane strain", "condensed"),
        ("plane strain", "full"),
        ("plane stress", "full"),
        ("axisymmetric", "condensed"),
        ("3D", "iterative"),
    ],
)
def test_bar_between_fixed_ends(kinematics, solver):
    """Shortened by q it carries E A q / L; the work ½ F q is its energy."""
    body = joint(glued=True, deep=1 if kinematics == "3D" else 0)
    area = np.pi * BOLT[1] ** 2 if kinematics == "axisymmetric" else BOLT[1] - BOLT[0]
    result = solved(bar(kinematics, solver), body)
    elongation = FORCE * TOP / (E * area)
    for step, factor in zip(result.steps, (0.5, 1.0), strict=True):
        bolt = step.preloads["bolt"]
        assert bolt.force == pytest.approx(factor * FORCE, rel=1e-9)
        assert bolt.elongation == pytest.approx(factor * elongation, rel=1e-9)
        assert bolt.initial_strain == pytest.approx(-factor * elongation / 2, rel=1e-9)
    assert result.quantities["strain_energy"] == pytest.approx(0.5 * FORCE * elongation, rel=1e-9)
    assert result.quantities["external_work"] == pytest.approx(0.5 * FORCE * elongation, rel=1e-9)
    top = next(s for s in result.supports if s.on == "top")
    assert top.reaction[1] == pytest.approx(FORCE, rel=1e-9)  # of the bolt alone; the sleeve rests


@pytest.mark.parametrize("kinematics", ["plane strain", "plane stress"])
@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_nearly_incompressible_bar(kinematics, solver):
    """The mean stress as an unknown of its own: E' A q / L with sides that slide freely."""
    ratio = 0.499
    fixed = bar(kinematics, solver, ratio)
    slides = (Support("bottom", {"y": 0}), Support("ground", {"x": 0, "y": 0}))
    of = dataclasses.replace(fixed, support=(*slides, Support("top", {"y": 0})))
    modulus = E / (1 - ratio**2) if kinematics == "plane strain" else E
    bolt = solved(of, joint(glued=True, finer=2)).preloads["bolt"]
    # Initial strain along the axis alone: in plane strain its Poisson's contraction is none.
    assert bolt.force == pytest.approx(FORCE, rel=1e-9)
    assert bolt.elongation == pytest.approx(FORCE * TOP / modulus, rel=1e-6)


def test_solvers_agree_on_two_preloads_in_one_body():
    """Shank and sleeve, glued together at one end, tightened one after the other."""
    found = {}
    for solver in ("condensed", "full", "iterative"):
        preloads = (
            Preload("shank", (0, 1, 0), FORCE, Path(time=(0, 1), factor=(0, 1)), 1.0, "first"),
            Preload("collar", (0, 1, 0), -2.0, Path(time=(1, 2), factor=(0, 1)), name="second"),
        )
        of = bar("3D", solver, 0.3, preload=preloads, steps=Steps(times=(0.5, 1.0, 2.0)))
        result = solved(of, joint(glued=True, deep=2, finer=2))
        found[solver] = [
            [bolt.force, bolt.elongation]
            for step in result.steps
            for bolt in step.preloads.values()
        ]
        forces = [[bolt.force for bolt in step.preloads.values()] for step in result.steps]
        asked = [[0.5 * FORCE, 0.0], [FORCE, 0.0]]  # the second has none before its turn
        np.testing.assert_allclose(forces[:2], asked, rtol=1e-9, atol=1e-8)
        assert forces[2][1] == pytest.approx(-2.0, rel=1e-9)
    for solver in ("full", "iterative"):
        np.testing.assert_allclose(found[solver], found["condensed"], rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"axis": (0, 0)}, "bolt_axis_is_zero"),
        ({"axis": (0, 1, 0)}, "bolt_axis_has_3_entries"),
        ({"locked_from": 0.25}, "locked_in_first_step"),
        ({"locked_from": 0.75}, "locked_between_steps"),
        ({"locked_from": 3.0}, "locked_after_the_end"),
    ],
)
def test_refused_before_the_mesh(change, words):
    preload = {"on": "shank", "axis": (0, 1), "force": FORCE} | change
    with refused(words):
        bar(preload=(Preload(**preload),))


@pytest.mark.parametrize(
    ("preload", "words"),
    [
        (Preload("nothing", (0, 1), 1.0), "no_group_nothing"),
        (Preload("top", (0, 1), 1.0), "preload_of_a_side"),
        (Preload("shank", (1, 1), 1.0), "bolt_ends_not_normal_to_oblique_axis"),
        (Preload("shank", (0.01, 1), 1.0), "bolt_ends_not_normal_to_axis"),
    ],
)
def test_refused_with_the_mesh(preload, words):
    with refused(words):
        Run(bar(preload=(preload,)), MPI.COMM_WORLD, joint())


def test_two_preloads_share_no_cells():
    preloads = (Preload("shank", (0, 1), 1.0, name="a"), Preload("shank", (0, 1), 1.0, name="b"))
    with refused("preloads_share_cells"):
        Run(bar(preload=preloads), MPI.COMM_WORLD, joint())


def test_axis_of_axisymmetric_models():
    with refused("bolt_off_the_axis_of_revolution"):
        bar("axisymmetric", preload=(Preload("shank", (1, 1), 1.0),))
