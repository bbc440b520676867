"""Heat in sectors of rings, against whole rings and a formula; and beside coupled boundaries."""

import dataclasses
from math import log

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Conductance,
    Coupling,
    CyclicSymmetry,
    Discretisation,
    Film,
    Heat,
    Material,
    Run,
    Scene,
    SolverSettings,
    Support,
    Temperature,
    run,
)
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.problem.sectors import RIM, SECTORS, angle, fitted, hub_on_shaft
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
CONDUCTIVITY = 0.05
WARM = Material(1000, 0.3, thermal_expansion=2e-5, conductivity=CONDUCTIVITY)
GROWING = Conductance(pressures=(0, 1), values=(1e-3, 0.05))


def waves(x):
    """Temperature that is the same in all sectors, and in none of them symmetric."""
    return 40 + 20 * np.cos(SECTORS * angle(x) + 0.4)


def _heated(is_whole, **contact):
    scene = fitted(is_whole, twist=0.0, **contact)
    (press,) = scene.contact
    heat = (
        Heat("hub.y1", temperature=waves),
        Heat("shaft.y0", film=Film(coefficient=0.01, temperature=0)),
    )
    conducts = dataclasses.replace(press, conductance=GROWING)
    return dataclasses.replace(scene, material=WARM, heat=heat, contact=(conducts,))


def _whole_and_part(mesh=None, **contact):
    mesh = mesh or {}
    whole = Run(_heated(True, **contact), COMM, hub_on_shaft(SECTORS, **mesh)).solve()
    return whole, Run(_heated(False, **contact), COMM, hub_on_shaft(1, **mesh)).solve()


@pytest.mark.parametrize(
    "mesh",
    [{}, {"offset": 0.3}, {"cells": ((2, 2), (3, 2)), "order": 2}, {"cell": "triangle"}],
)
def test_heat_in_a_sector_is_that_of_the_whole(mesh):
    """Across a contact that ends in the cut, or faces the next sector where the hub's is skew."""
    whole, part = _whole_and_part(mesh)
    assert part.passed, part.verdict
    assert part.checks["heat_balance"].value < 1e-5
    ours, others = part.quantities, whole.quantities
    # Opposite a slave that ends in the cut, temperatures at both of its ends are found apart.
    tolerance = {"offset": 1e-5, "cells": 1e-4}.get(next(iter(mesh), ""), 1e-6)
    for name in ("heat_flow", "pressure_integral", "strain_energy"):
        assert SECTORS * ours[name] == pytest.approx(others[name], rel=tolerance), name
    assert ours["max_temperature"] == pytest.approx(others["max_temperature"], rel=tolerance)


def test_a_ring_by_its_formula():
    """J. Fourier: T = a log r + b + cos nθ (c rⁿ + d r⁻ⁿ) between given temperatures."""
    inner = 5.0
    ring = boxes([Box("ring", (0.0, inner), (2 * np.pi / SECTORS, RIM), (12, 24))], order=2)
    x = ring.mesh.geometry.x
    turned, radius = x[:, 0].copy(), x[:, 1].copy()
    x[:, 0], x[:, 1] = radius * np.cos(turned), radius * np.sin(turned)
    scene = Scene(
        kinematics="plane strain",
        material=WARM,
        support=(Support("ring.y0", {"x": 0.0, "y": 0.0}),),
        heat=(Heat("ring.y1", temperature=waves), Heat("ring.y0", temperature=10)),
        cyclic_symmetry=CyclicSymmetry("ring.x0", "ring.x1", SECTORS),
        discretisation=Discretisation(degree=2),
        solver=SolverSettings(errors="none"),
    )
    made = Run(scene, COMM, ring)
    found = made.solve()
    assert found.passed, found.verdict
    places = made.problem.spaces.coordinates
    radius, turned = np.hypot(places[:, 0], places[:, 1]), angle(places.T)
    ratio = np.array([radius**n for n in (SECTORS, -SECTORS)])
    ends = np.array([[r**n for n in (SECTORS, -SECTORS)] for r in (inner, RIM)])
    c, d = np.linalg.solve(ends, [0.0, 20.0])
    exact = 10 + 30 * np.log(radius / inner) / log(RIM / inner)
    exact += (c * ratio[0] + d * ratio[1]) * np.cos(SECTORS * turned + 0.4)
    assert made.problem.conduction.rise == pytest.approx(exact, abs=2e-3)


def test_what_is_given_on_one_cut_face_alone():
    scene = _heated(False)
    more = (*scene.heat, Heat("hub.x0", temperature=5))
    with refused("heat_on_one_cut_face"):
        Run(dataclasses.replace(scene, heat=more), COMM, hub_on_shaft(1)).solve()


@pytest.mark.parametrize("kind", ["rigid", "distributing"])
def test_a_coupled_boundary_of_a_body_that_heat_flows_through(kind):
    """T is linear, so that it expands as by a temperature that is given."""
    body = box_body((4, 2, 2), (20, 4, 2))
    made = Scene(
        kinematics="3D",
        material=WARM,
        support=(Support("x0", dict.fromkeys("xyz", 0.0)),),
        coupling=(Coupling("x1", name="end", kind=kind, force=(3.0, 0.0, 0.0)),),
        solver=SolverSettings(errors="none"),
    )
    warm = Heat("x0", temperature=0), Heat("x1", temperature=80)
    found = run(dataclasses.replace(made, heat=warm), COMM, body)
    assert found.passed, found.verdict
    linear = Temperature(value=lambda x: 4 * x[0])
    given = run(dataclasses.replace(made, temperature=(linear,)), COMM, body)
    assert found.couplings[0].displacement[0] > 0.9 * 2e-5 * 40 * 20
    for name in ("displacement", "rotation", "force", "moment"):
        ours, others = (getattr(one.couplings[0], name) for one in (found, given))
        assert ours == pytest.approx(others, rel=1e-8, abs=1e-9), name
    assert found.quantities["strain_energy"] == pytest.approx(given.quantities["strain_energy"])
