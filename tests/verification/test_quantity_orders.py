"""Observed orders of quantities: energy, force, pressure, displacement at a point.

For a smooth solution an energy, and a force or a displacement on the boundary that it measures,
converge at twice the order of the energy norm, 2p; a displacement inside at p + 1. Where the
solution behaves like r^λ at a corner, all are limited to 2λ on uniform meshes: λ = 1/2 at the edge
of a smooth flat punch.
"""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from fenics_contact.verification.error_bars import flat as flat_cases
from fenics_contact.verification.error_bars import round as round_cases
from fenics_contact.verification.error_bars.case import Parameters, size_of, with_parameters
from fenics_contact.verification.error_bars.cyclic import cylinders, finer_cylinders

COMM = MPI.COMM_WORLD
# It adds less than the finest mesh's error, and round-off over it adds less, too.
PENALTY = 1e-11


def solved(model, penalty=PENALTY):
    return Run(with_parameters(model.scene, Parameters(None, penalty)), COMM, model.body).solve()


def without_penalty(model):
    """In the limit ε₁ → 0, from two values large enough that round-off over them adds nothing."""
    once, twice = (solved(model, penalty).quantities for penalty in (1e-9, 2e-9))
    return {name: 2 * np.array(value) - twice[name] for name, value in once.items() if value}


def orders(model, exact, element, cells, found_of=lambda model: solved(model).quantities):
    """Mean order of each quantity from the coarsest mesh to the finest."""
    errors = {name: [] for name in exact}
    for number in cells:
        quantities = found_of(model(element, number))
        for name, value in exact.items():
            errors[name].append(size_of(np.subtract(quantities[name], value)) / size_of(value))
    steps = np.log2(cells[-1] / cells[0])
    return {name: np.log2(found[0] / found[-1]) / steps for name, found in errors.items()}


@pytest.mark.parametrize(("element", "pressure"), [("P1", 1), ("Q1", 2), ("P2", 2), ("Q2", None)])
def test_smooth_solution(element, pressure):
    """Lamé's cylinder, whose meshes have no corner that the solution feels."""
    names = ["strain_energy", "displacement_outside", "displacement_within", "pressure_integral"]
    exact = {name: flat_cases.lame(1)[name] for name in [*names, "max_contact_pressure"]}
    degree = int(element[1])
    cells = (4, 8, 16) if degree == 1 else (1, 2, 4)
    found = orders(
        lambda e, n: flat_cases.cylinder(e, n, 1.0), exact, element, cells, without_penalty
    )
    assert found["strain_energy"] == pytest.approx(2 * degree, abs=0.15)
    assert found["pressure_integral"] == pytest.approx(2 * degree, abs=0.15)
    assert found["displacement_within"] == pytest.approx(degree + 1, abs=0.25)
    if element != "P2":  # its error changes sign on the way
        assert found["displacement_outside"] == pytest.approx(2 * degree, abs=0.2)
    if pressure:  # at the points of Q2 it is better than its order, and changes sign
        assert found["max_contact_pressure"] == pytest.approx(pressure, abs=0.25)


@pytest.mark.parametrize("element", ["P1", "Q2"])
def test_singularity_at_the_edge_of_a_punch_limits_all(element):
    reference = flat_cases.finer_punch(0.0, 1, 1.0)
    names = ("strain_energy", "normal_force", "displacement_beside")
    quantities = solved(reference).quantities
    exact = {name: quantities[name] for name in names}
    cells = (4, 8, 16) if element == "P1" else (2, 4, 8)
    found = orders(lambda e, n: flat_cases.punch(0.0, e, n, 1.0), exact, element, cells)
    for name in names:
        assert found[name] == pytest.approx(1, abs=0.1), name


@pytest.mark.parametrize("element", ["Q1", "Q2"])
def test_friction_on_the_paper_s_slab(element):
    """Where stick turns into slip, and at the corners, the energy norm has order .9 to 1.2."""
    reference = Run(flat_cases.finer_slab(1, 300.0).scene).solve().quantities
    names = ("strain_energy", "displacement_end", "friction_force")
    exact = {name: reference[name] for name in names}
    cells = (4, 8) if element == "Q1" else (2, 4)
    found = orders(lambda e, n: flat_cases.slab(e, n, 300.0), exact, element, cells)
    assert found["strain_energy"] == pytest.approx(1.8 if element == "Q1" else 2.1, abs=0.15)
    for name in names[1:]:
        assert found[name] > 1.8


def test_contact_with_a_moving_edge():
    """Hertz: with degree 1 the force converges at order 2, apart from where the edge falls."""
    exact = {"normal_force": round_cases.hertz(1.0)["normal_force"]}
    found = orders(lambda e, n: round_cases.hertz_model(e, n, 1.0), exact, "Q1", (2, 4, 8))
    assert 1.6 < found["normal_force"] < 2.6


def test_two_bodies():
    """Cylinders: order 2 with degree 1, of force and energy."""
    reference = Run(finer_cylinders(0, 1.0).scene).solve().quantities
    exact = {name: reference[name] for name in ("normal_force", "strain_energy")}
    found = orders(lambda e, n: cylinders(e, n, 1.0), exact, "Q1", (1, 2, 4))
    for name in exact:
        assert found[name] == pytest.approx(2, abs=0.4), name
