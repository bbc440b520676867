"""Error bars of preloads: not below the true errors, and '?' where there is none."""

import dataclasses

import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Material, Preload, Run, SolverSettings, Steps
from tests.preload.joints import joint
from tests.preload.test_bars import bar
from tests.preload.test_joint import scene

pytestmark = pytest.mark.errors


def _with_bars(of, **settings):
    return dataclasses.replace(of, solver=SolverSettings(errors="auto", **settings))


def _solved(of, body):
    result = Run(of, MPI.COMM_WORLD, body).solve()
    assert result.converged, result.verdict
    return result


def _of_steel(of):
    materials = tuple(Material(m.youngs_modulus, 0.3, on=m.on) for m in of.material)
    return dataclasses.replace(of, material=materials)


@pytest.mark.parametrize("pulled", [0.0, 8.0])
def test_bars_hold_the_error_by_the_mesh(pulled):
    """Against a mesh of cells an eighth as long: bending and corners make errors there."""
    of = _of_steel(scene(pulled=pulled))
    coarse = _solved(_with_bars(of), joint(finer=2))
    fine = _solved(of, joint(finer=16))
    for quantity in ("force", "elongation"):
        bar_width = coarse.preloads["bolt"].errors[quantity]["mesh"]
        error = abs(coarse.preloads["bolt"][quantity] - fine.preloads["bolt"][quantity])
        assert error <= bar_width, quantity
        assert bar_width <= 0.1 * coarse.preloads["bolt"][quantity], quantity


def test_a_given_force_has_no_error():
    of = dataclasses.replace(bar(), material=Material(1000.0, 0.3))
    of = _with_bars(of, solver="condensed")
    coarse = _solved(of, joint(glued=True))
    fine = _solved(of, joint(glued=True, finer=8))
    assert set(coarse.preloads["bolt"].errors["force"].values()) == {0.0}
    row = coarse.preloads["bolt"].errors["elongation"]
    error = abs(coarse.preloads["bolt"].elongation - fine.preloads["bolt"].elongation)
    assert 0 < error <= row["mesh"]
    assert row["penalty"] == 0  # there is none


def test_no_bars_where_none_are_asked_for():
    assert _solved(bar(), joint(glued=True)).preloads["bolt"].errors == {}


def test_stress_fields_subtract_what_is_free_of_stress():
    """A bolt between fixed ends has F/A all along, also where it was shortened."""
    run = Run(bar(steps=Steps(), preload=(Preload("shank", (0, 1), 5.0),)), body=joint(glued=True))
    run.solve()
    problem = run.problem
    stress = problem.elastic.stress()
    expected = ufl.as_tensor([[0.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 0.0]])
    for name in ("bolt", "shank"):
        part = problem.spaces.part(problem.body.group(name, ""))
        off = fem.form(ufl.inner(stress - expected, stress - expected) * part)
        assert problem.comm.allreduce(fem.assemble_scalar(off)) <= (1e-10 * 5) ** 2
