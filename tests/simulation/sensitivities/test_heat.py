"""Derivatives where conduction finds temperatures: against a formula, and differences."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Conductance,
    Contact,
    DerivativeRequest,
    Heat,
    Load,
    Material,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.thermal.heat import HEIGHT, bars, pressures
from tests.messages import refused
from tests.problem.sectors import hub_on_shaft
from tests.problem.test_heat_of_sectors import _heated

COMM = MPI.COMM_WORLD


def test_the_force_of_bars_by_their_walls():
    """Against the roots of the quadratic equation of the pressure."""
    walls, gap, step = np.array([120.0, 20.0]), 0.05, 1e-3
    found = Study(*_on(bars(walls.tolist(), gap))).derivatives(
        ["normal_force"], ["heat.0.temperature", "heat.1.temperature", "contact.0.interference"]
    )["normal_force"]
    for number in range(2):
        other = step * np.eye(2)[number]
        above, below = (pressures(walls + sign * other, gap)[0] for sign in (1, -1))
        slope = HEIGHT * (above - below) / (2 * step)
        assert found[f"heat.{number}.temperature"] == pytest.approx(slope, rel=1e-6)
    above, below = (pressures(walls, gap - sign * 1e-6)[0] for sign in (1, -1))
    slope = HEIGHT * (above - below) / 2e-6
    assert found["contact.0.interference"] == pytest.approx(slope, rel=1e-6)


def _on(made):
    scene, body = made
    return scene, COMM, body


def stack(**more):
    """A block on a wider one, pressed, hot above; both bulge, so that pressures differ."""
    upper, lower = Box("upper", (0.3, 1), (2.1, 2), (5, 3)), Box("lower", (0, 0), (3, 1), (6, 3))
    material = Material(1000, 0.3, thermal_expansion=1e-4, conductivity=1.0)
    given = {
        "contact": (
            Contact(
                "upper.y0",
                against="lower.y1",
                friction_coefficient=0.2,
                conductance=Conductance(pressures=(0, 20), values=(0.1, 8)),
                penalty_parameter=1e-6,
                regularisation_parameter=1e-5,
            ),
        ),
        **more,
    }
    scene = Scene(
        kinematics="plane strain",
        material=(material,),
        support=(Support("lower.y0", {"x": 0.0, "y": 0.0}),),
        load=(Load("upper.y1", pressure=3.0),),
        heat=(
            Heat("lower.y0", temperature=5),
            Heat("upper.y1", temperature=60),
            Heat("upper.x1", flux=12.0),
        ),
        solver=SolverSettings(errors="none", tolerance=1e-12),
        **given,
    )
    return scene, boxes([upper, lower])


KEYS = {
    "heat.1.temperature": 1.0,
    "heat.0.temperature": 1.0,
    "heat.2.flux": 0.5,
    "contact.0.conductance.values.1": 0.1,
    "contact.0.friction_coefficient": 1e-3,
    "load.0.pressure": 0.02,
    "material.0.thermal_expansion": 1e-6,
}
QUANTITIES = ["max_contact_pressure", "strain_energy", "upper.y0.friction_work"]


def test_derivatives_are_those_of_answers_near_by():
    """By central differences of two sizes, whose errors go with the square of the size."""
    scene, body = stack()
    study = Study(scene, COMM, body)
    exact = study.derivatives(QUANTITIES, list(KEYS))
    for key, step in KEYS.items():
        value = {"heat.0.temperature": 5, "heat.1.temperature": 60, "heat.2.flux": 12.0}.get(key)
        known = {"contact.0.conductance.values.1": 8, "contact.0.friction_coefficient": 0.2}
        known |= {"load.0.pressure": 3.0, "material.0.thermal_expansion": 1e-4}
        value = known.get(key) if value is None else value
        rows = [
            study.quantities({key: value + times * step}).quantities for times in (-2, -1, 1, 2)
        ]
        for name in QUANTITIES:
            short = name.rsplit(".", maxsplit=1)[-1]
            a, b, c, d = (row[short] for row in rows)
            slope = (8 * (c - b) - (d - a)) / (12 * step)
            assert exact[name][key] == pytest.approx(slope, rel=2e-5), (name, key)


def test_a_scene_asks_for_them():
    scene, body = stack()
    asked = DerivativeRequest(of=("strain_energy",), by=("heat.1.temperature",))
    found = run(replace(scene, derivatives=asked), COMM, body)
    exact = Study(scene, COMM, body).derivatives(["strain_energy"], ["heat.1.temperature"])
    slope = found.derivatives["strain_energy"]["heat.1.temperature"].discrete
    assert slope == pytest.approx(exact["strain_energy"]["heat.1.temperature"], rel=1e-8)


def test_in_a_sector():
    """Temperatures of its cut faces are the same; the contact ends there."""
    scene, body = _heated(False), hub_on_shaft(1)
    scene = replace(scene, solver=replace(scene.solver, tolerance=1e-12))
    study, key, step = Study(scene, COMM, body), "contact.0.conductance.values.1", 1e-3
    slope = study.derivatives(["strain_energy"], [key])["strain_energy"][key]
    above, below = (
        study.quantities({key: 0.05 + sign * step}).quantities["strain_energy"] for sign in (1, -1)
    )
    assert slope == pytest.approx((above - below) / (2 * step), rel=1e-3)


def test_what_has_none():
    scene, body = stack(steps=Steps(2))
    (rub,) = scene.contact
    remembers = replace(scene, contact=(replace(rub, law="incremental"),))
    with refused("derivatives_over_steps_of_found_temperatures"):
        Study(remembers, COMM, body).derivatives(["strain_energy"], ["load.0.pressure"])
    with refused("derivative_by_a_path_of_heat"):
        Study(scene, COMM, body).derivatives(["strain_energy"], ["material.0.conductivity"])
