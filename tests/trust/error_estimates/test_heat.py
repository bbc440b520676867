"""Error bars where conduction finds the temperatures: by formulas, and beside finer meshes."""

from dataclasses import replace
from math import log, pi

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Conductance,
    Contact,
    Discretisation,
    Film,
    Heat,
    Load,
    Material,
    Point,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.verification.boxes import Box, boxes

COMM = MPI.COMM_WORLD
NO_ERRORS = SolverSettings(errors="none")
STEEL = Material(210e3, 0.3, thermal_expansion=12e-6, conductivity=0.05, on="a")
OTHER = Material(70e3, 0.33, thermal_expansion=23e-6, conductivity=0.2, on="b")


def _blocks(cells, degree, **more):
    """Two blocks between plates, of which the left sides and one film get heat."""
    parts = [
        Box("a", (0, 0), (40, 20), (4 * cells, 2 * cells)),
        Box("b", (0, 20), (40, 40), (3 * cells, 2 * cells)),
    ]
    growing = Conductance(pressures=(0, 100, 1000), values=(2e-4, 0.02, 0.05))
    given = {
        "support": (Support("a.x0", {"x": 0.0}), Support("b.x0", {"x": 0.0})),
        "contact": (Contact("a.y1", against="b.y0", conductance=growing),),
        "point": (Point("inside", (13.7, 8.9)),),
        "heat": (
            Heat("a.y0", temperature=100),
            Heat("b.x1", film=Film(coefficient=0.005, temperature=0)),
        ),
        **more,
    }
    given["support"] += (Support("a.y0", {"y": 0.0}),)
    made = Scene(
        kinematics="plane strain",
        material=(STEEL, OTHER),
        discretisation=Discretisation(degree=degree),
        **given,
    )
    return made, boxes(parts)


LOADED = {"load": (Load("b.y1", pressure=20.0),)}
CLAMPED = {
    "support": (
        Support("a.x0", {"x": 0.0}),
        Support("b.x0", {"x": 0.0}),
        Support("b.y1", {"y": 0.0}),
    )
}
FLUX = {
    "heat": (Heat("a.y0", temperature=0), Heat("b.y1", flux=lambda x: 0.02 * (x[0] / 40) ** 2)),
    **LOADED,
}


@pytest.mark.errors
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("more", [LOADED, CLAMPED, FLUX])
def test_bars_beside_a_finer_mesh(degree, more):
    """Temperatures that are not linear, and corners where they are not smooth."""
    fine, body = _blocks(8, 2, **more)
    exact = run(replace(fine, solver=NO_ERRORS), COMM, body).quantities
    found = run(*(lambda made, own: (made, COMM, own))(*_blocks(2, degree, **more)))
    assert not found.error_notes
    names = ["heat_flow", "strain_energy", "temperature_inside"]
    names += ["normal_force"] * (more is CLAMPED)
    for name in names:
        error, bar = abs(found.quantities[name] - exact[name]), found.errors[name]["total"]
        is_exact = error <= 1e-8 * abs(exact[name])
        assert error <= bar and (is_exact or bar <= 30 * error), name
    flow = found.contacts[0].errors["heat_flow"]
    assert flow["mesh"] > 0 and flow["iteration"] < 1e-3 * abs(exact["heat_flow"])


def _pipes(cells, degree):
    """A quarter of two pipes, one in the other, whose straight sides miss the circles."""
    parts = [
        Box("a", (20, 0), (40, pi / 2), (cells, 2 * cells)),
        Box("b", (40, 0), (60, pi / 2), (cells, 2 * cells)),
    ]
    body = boxes(parts)
    radius, angle = body.mesh.geometry.x[:, :2].T.copy()
    body.mesh.geometry.x[:, 0] = radius * np.cos(angle)
    body.mesh.geometry.x[:, 1] = radius * np.sin(angle)
    sides = [Support(f"{name}.{side}", {axis: 0.0}) for name in "ab" for side, axis in CUTS]
    glue = Contact("a.x1", against="b.x0", contact="bonded", conductance=0.004)
    made = Scene(
        kinematics="plane strain",
        material=(STEEL, OTHER),
        support=tuple(sides),
        contact=(glue,),
        heat=(Heat("a.x0", temperature=100), Heat("b.x1", temperature=0)),
        discretisation=Discretisation(degree=degree),
    )
    return made, body


CUTS = (("y0", "y"), ("y1", "x"))


@pytest.mark.errors
@pytest.mark.parametrize("degree", [1, 2])
def test_the_bar_of_heat_through_pipes_whose_sides_miss_circles(degree):
    """Resistances in series, log(b/a)/k and 1/(h b) over the angle."""
    made, body = _pipes(3, degree)
    found = run(made, COMM, body)
    resistance = log(2) / 0.05 + 1 / (0.004 * 40) + log(60 / 40) / 0.2
    error = abs(found.quantities["heat_flow"] + 100 * (pi / 2) / resistance)
    assert error <= found.errors["heat_flow"]["total"] <= 30 * error


@pytest.mark.errors
def test_what_is_not_estimated_where_heat_meets_nearly_incompressible_material():
    made, body = _blocks(1, 2, **LOADED)
    soft = replace(STEEL, poissons_ratio=0.4999)
    found = run(replace(made, material=(soft, OTHER)), COMM, body)
    assert found.errors["heat_flow"]["mesh"] is None
    assert found.errors["heat_flow"]["penalty"] is not None
    assert "nearly incompressible" in " ".join(found.error_notes)


def _tube(cells, degree, conductivity=0.05):
    """A tube that takes in a flux inside and has a film outside, and its temperatures by r."""
    inner, outer, flux, film, around = 10.0, 40.0, 0.05, 0.002, 20.0
    made = Scene(
        kinematics="axisymmetric",
        material=replace(STEEL, on="", conductivity=conductivity),
        support=(Support("a.y0", {"y": 0.0}),),
        heat=(Heat("a.x0", flux=flux), Heat("a.x1", film=Film(film, around))),
        point=(Point("inside", (17.3, 7.1)),),
        discretisation=Discretisation(degree=degree),
    )

    def at(radius):
        return around + flux * inner * (1 / (film * outer) + log(outer / radius) / conductivity)

    body = boxes([Box("a", (inner, 0), (outer, 20), (cells, cells // 2))])
    return (made, COMM, body), {"max_temperature": at(inner), "temperature_inside": at(17.3)}


def _heated_block(cells, degree):
    """T = 100 sin(π x/L) cosh(π y/L)/cosh π, by a flux at y = L, between cold sides."""
    size, point, top = 20.0, (7.3, 13.1), 100 / np.cosh(pi)

    def flux(x):
        wave = np.sin(pi * x[0] / size) * np.sinh(pi * x[1] / size)
        return STEEL.conductivity * pi / size * top * wave

    cold = Heat("a.x0", temperature=0), Heat("a.x1", temperature=0)
    made = Scene(
        kinematics="plane strain",
        material=STEEL,
        support=(Support("a.y0", {"x": 0.0, "y": 0.0}),),
        heat=(*cold, Heat("a.y1", flux=flux)),
        point=(Point("inside", point),),
        discretisation=Discretisation(degree=degree),
    )
    at_point = top * np.sin(pi * point[0] / size) * np.cosh(pi * point[1] / size)
    body = boxes([Box("a", (0, 0), (size, size), (cells, cells))])
    return (made, COMM, body), {"max_temperature": 100.0, "temperature_inside": at_point}


@pytest.mark.errors
@pytest.mark.parametrize(
    ("model", "cells", "degree"),
    [
        (_tube, 6, 1),
        (_tube, 6, 2),
        (_heated_block, 3, 1),
        (_heated_block, 3, 2),
        (_heated_block, 6, 2),
    ],
)
def test_bars_of_temperatures_by_formulas(model, cells, degree):
    """The highest one lies at a node, or between nodes, where nodes are too cold."""
    model, exact = model(cells, degree)
    found = run(*model)
    for name, value in exact.items():
        error, bar = abs(found.quantities[name] - value), found.errors[name]["total"]
        assert error <= bar <= 12 * error, name


@pytest.mark.errors
def test_a_wrong_temperature_is_beyond_its_bar():
    """A conductivity that is off by one per cent."""
    _, exact = _tube(6, 2)
    model, _ = _tube(6, 2, conductivity=1.01 * 0.05)
    found = run(*model)
    for name, value in exact.items():
        assert abs(found.quantities[name] - value) > found.errors[name]["total"], name
