"""Estimated errors by the piece of a half-space, against larger pieces and Hertz's formulas."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    HalfSpace,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.analytic.half_space import boussinesq, cerruti
from fenics_contact.trust.error_estimates import estimates as error_estimates
from fenics_contact.verification.published.shear import sheared_scene
from tests.scenes import ROOT

pytestmark = pytest.mark.errors

E, NU = 1000.0, 0.3
FORCE = 4 / 3 * E / (1 - NU**2) * 8**0.5  # of Hertz, on a paraboloid of radius 8, 1 deep


def scene(extent, coefficient=0.0, errors="auto", kinematics="axisymmetric", **obstacle):
    axisymmetric = kinematics == "axisymmetric"
    return Scene(
        kinematics=kinematics,
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell="quadrilateral",
            parameters={
                "fine": 4,
                "size": 0.4,
                "extent": extent,
                "cells_outside": int(4 + 4 * np.log2(extent / 4)),
            },
        ),
        material=Material(E, NU),
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(
            Contact(
                "contact",
                friction_coefficient=coefficient,
                obstacle=Obstacle(
                    "paraboloid" if axisymmetric else "parabola",
                    radius=8,
                    **(obstacle or {"indentation": 1}),
                ),
            ),
        ),
        solver=SolverSettings(errors=errors),
    )


@pytest.fixture(autouse=True)
def without_those_of_the_mesh(monkeypatch):
    monkeypatch.setattr(error_estimates, "mesh_errors", lambda *arguments: ({}, None))


@pytest.mark.parametrize("coefficient", [0.0, 0.6])
def test_estimate_is_what_a_larger_piece_changes(coefficient):
    """Friction has a moment where it has no resultant: that is of one order less."""
    found = {extent: run(scene(extent, coefficient)) for extent in (8, 16)}
    limit = run(scene(400, coefficient, "none")).quantities["normal_force"]
    estimates = []
    for extent, result in found.items():
        true = limit - result.quantities["normal_force"]
        estimates.append(result.errors["normal_force"]["domain"])
        assert estimates[-1] == pytest.approx(abs(true), rel=0.1 if extent == 8 else 0.15)
    order = np.log2(estimates[0] / estimates[1])
    assert order == pytest.approx(3 if coefficient == 0 else 2.5, abs=0.5)


def test_hertz_is_within_the_bars_on_a_small_piece(monkeypatch):
    monkeypatch.undo()
    result = run(scene(6))
    row = result.errors["normal_force"]
    true = abs(result.quantities["normal_force"] - FORCE)
    assert 0.5 * true < row["domain"] and true < row["total"] < 5 * true


def test_line_contact_and_a_force():
    """Flamant's far field; the width of the contact under a force."""
    small, large = (
        run(scene(extent, kinematics="plane strain", force=200.0)) for extent in (5, 100)
    )
    for name in ("contact_area", "max_contact_pressure"):
        assert small.errors[name]["domain"] < 0.02 * small.quantities[name]
        assert large.errors[name]["domain"] < 0.02 * small.errors[name]["domain"]


def test_sideways_in_space(monkeypatch):
    """Cerruti's field, and mirror images: half of a body is pulled across its plane, too."""
    monkeypatch.setattr(error_estimates, "_remembers", lambda problem: False)
    small, large = (
        run(sheared_scene(0.02, extent=extent, cells_outside=cells))
        for extent, cells in ((4, 2), (8, 3))
    )
    forces = [result.quantities["friction_force"] for result in (small, large)]
    true = np.linalg.norm(np.subtract(*forces))
    estimates = [result.errors["friction_force"]["domain"] for result in (small, large)]
    assert estimates[0] == pytest.approx(true, rel=0.1)
    assert estimates[1] < 0.15 * estimates[0]
    deeper = small.quantities["indentation"] - large.quantities["indentation"]
    assert small.errors["indentation"]["domain"] == pytest.approx(deeper, rel=0.1)


def test_forces_where_they_act_have_the_right_moments():
    """A few of them, with their images, are the field of these forces one by one."""
    prepared = Run(sheared_scene(0.02, size=0.5, extent=4, cells_outside=2))
    far_field = prepared.problem.far_field
    spaces = prepared.problem.spaces
    inward = np.array([0, 0, -1.0])
    top = spaces.coordinates[:, 2].max()
    places = np.array([[0.3, 0.2, top], [-0.4, 0.5, top]])
    forces = np.array([[1.0, -2.0, -5.0], [0.5, 1.0, -3.0]])
    found = far_field.left_out(0, places, forces)
    points = spaces.coordinates[far_field.dofs // 3]
    expected = np.zeros_like(points)
    young, ratio = 1000.0, 0.49
    for place, force in zip(places, forces, strict=True):
        for sign in (1, -1):  # the plane of symmetry is y = 0
            arms = points - place * [1, sign, 1]
            expected += force[2] * inward[2] * boussinesq(arms, inward, young, ratio)
            for axis, along in enumerate(np.eye(3)[:2]):
                turned = force[axis] * (sign if axis == 1 else 1)
                expected += turned * cerruti(arms, along, inward, young, ratio)
    whole = expected[np.arange(len(points)), far_field.dofs % 3]
    whole -= far_field.columns[0] * 8.0
    for along, column in far_field.sideways[0]:
        whole -= column * (forces.sum(axis=0) @ along)
    assert found == pytest.approx(whole, abs=1e-12 * np.abs(expected).max())


def test_a_body_that_is_no_piece_has_none():
    support = Support("outer", {"x": 0, "y": 0})
    held = dataclasses.replace(scene(8), half_space=None, symmetry=(), support=(support,))
    assert run(held).errors["normal_force"]["domain"] == 0
