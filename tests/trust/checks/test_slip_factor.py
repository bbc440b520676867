"""By how much loads that vary can grow until a part slips, against statics."""

from dataclasses import replace
from math import cos, sin, sqrt

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Steps, run
from fenics_contact.results.quantities import headlines
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.simulation.studies import slip_factor_errors
from fenics_contact.trust import slip_factor
from tests.scenes import box_body
from tests.trust.checks.test_slip_limit import SILENT, geometry, ring_in_ring  # noqa: F401

COMM = MPI.COMM_WORLD
FRICTION, PRESSURE = 0.5, 10.0
LATER = {"time": [1, 2], "factor": [0, 1]}
BY_STEPS = SolverSettings(errors="none", slip_limit="steps")


def block(varying, constant=(), solver=BY_STEPS, **changes):
    """A block of height 1 on a rough floor, pressed with 10 per area; loads act on its bottom.

    There they turn nothing, and the pressure stays even.
    """
    dimension = len(varying)
    axis, first = "xyz"[dimension - 1], {"time": [0, 1], "factor": [0, 1]}
    face = f"{axis}0"
    steady = () if not constant else (Load(face, traction=constant, path=first),)
    given = {
        "kinematics": "plane strain" if dimension == 2 else "3D",
        "material": Material(1000, 0.0),
        "load": (
            Load(f"{axis}1", pressure=PRESSURE, path=first),
            *steady,
            Load(face, traction=varying, path=LATER),
        ),
        "contact": (
            Contact(
                face,
                obstacle=Obstacle("plane"),
                law="incremental",
                friction_coefficient=FRICTION,
            ),
        ),
        "steps": Steps(times=(1, 2)),
        "solver": solver,
    }
    return Scene(**given | changes)


FLAT, SOLID = ((6, 4), (2, 1)), ((3, 3, 2), (1, 1, 1))


@pytest.mark.parametrize(
    ("varying", "constant", "right"),
    [
        ((2.0, 0.0), (), 2.5),
        ((2.0, 0.0), (1.0, 0.0), 2.0),
        ((2.0, 0.0), (-1.0, 0.0), 3.0),
        ((0.0, 2.0, 0.0), (3.0, 0.0, 0.0), 2.0),
        ((1.0, 1.0, 0.0), (3.0, 0.0, 0.0), (sqrt(41) - 3) / 2),
    ],
)
def test_constant_loads_take_their_part_of_friction(varying, constant, right):
    """|f₀ + s f₁| = μ p A: a constant pull along, against and across the one that grows."""
    size = FLAT if len(varying) == 2 else SOLID
    found = run(block(varying, constant), COMM, body=box_body(*size)).slip_limit
    assert found.factor == pytest.approx(right, rel=1e-4)
    assert found.kind == "pressures held"


@pytest.mark.parametrize("angle", [0.3, -0.3])
def test_loads_that_lift_or_press_grow_step_by_step(angle):
    """A pull that rises by θ: s f cos θ = μ (p A − s f sin θ), other than by pressures found."""
    pull = 2 * cos(angle), 2 * sin(angle)
    result = run(block(pull), COMM, body=box_body(*FLAT))
    right = FRICTION * PRESSURE / (pull[0] + FRICTION * pull[1])
    assert result.slip_limit.kind == "load steps"
    assert result.slip_limit.factor == pytest.approx(right, rel=2e-3)
    assert result.quantities["slip_factor"] == result.slip_limit.factor
    said = f"At {result.slip_limit.factor:.4g} times the loads that vary a part slips as a whole "
    assert said + "(load steps)." in headlines(result)
    auto = run(block(pull, solver=SolverSettings()), COMM, body=box_body(*FLAT))
    assert auto.slip_limit.kind == "upper bound"
    assert auto.slip_limit.factor == pytest.approx(right, rel=1e-9)  # it slides as it rises
    assert "slip_factor" not in auto.quantities
    said = f"At {auto.slip_limit.factor:.4g} times the loads that vary a part slips or tips at the "
    assert any(line.startswith(said) for line in headlines(auto))
    alone = run(block(pull, solver=SILENT), COMM, body=box_body(*FLAT))
    for name in ("strain_energy", "normal_force"):
        assert result.quantities[name] == pytest.approx(alone.quantities[name], rel=1e-9)


@pytest.mark.errors
def test_bars_of_a_factor_found_step_by_step_hold_that_of_statics():
    """A pull that rises: cells do not matter, so that the bar is the bracket of the loads."""
    pull = 2 * cos(0.3), 2 * sin(0.3)
    solver = SolverSettings(errors="all", slip_limit="steps")
    result = run(block(pull, solver=solver), COMM, body=box_body(*FLAT))
    right = FRICTION * PRESSURE / (pull[0] + FRICTION * pull[1])
    found, bars = result.slip_limit.factor, result.errors["slip_factor"]
    assert result.slip_limit.kind == "load steps"
    assert result.slip_limit.errors["factor"] == bars
    assert abs(found - right) < bars["total"] < 0.03 * right
    assert bars["step"] > 100 * bars["mesh"]


@pytest.mark.errors
def test_bars_of_a_torque_that_a_press_fit_takes(geometry):  # noqa: F811
    """Held pressures: their error is that of the mesh, whose facets are straight."""
    solver = SolverSettings(errors="all", slip_limit="steps")
    result = run(replace(ring_in_ring(geometry, 0.6, order=1), solver=solver), COMM)
    bars = result.errors["slip_factor"]
    assert result.slip_limit.kind == "pressures held"
    assert abs(result.slip_limit.factor - 1 / 0.6) < bars["total"] < 0.2
    assert bars["mesh"] > 0.9 * bars["total"]


@pytest.mark.errors
def test_bars_of_cells_that_are_not_halved_are_none(monkeypatch):
    """Curved cells: what the mesh changes is not known, so that there is no sum."""
    monkeypatch.setattr(slip_factor_errors, "is_of_order_1", lambda mesh: False)
    solver = SolverSettings(errors="all", slip_limit="steps")
    result = run(block((2.0, 0.0), solver=solver), COMM, body=box_body(*FLAT))
    bars = result.errors["slip_factor"]
    assert bars["mesh"] is None and bars["total"] is None
    assert bars["step"] is not None
    assert (
        "The error of slip_factor by mesh was not estimated: cells with curved sides are not halved"
        in result.verdict
    )


def test_friction_that_grows_with_the_loads_has_no_limit():
    """Pressed and pulled in one step: friction holds as much more as the loads ask for."""
    scene = block((2.0, 0.0), steps=Steps())
    loads = tuple(replace(load, path={"time": [0, 1], "factor": [0, 1]}) for load in scene.load)
    found = run(replace(scene, load=loads), COMM, body=box_body(*FLAT)).slip_limit
    assert found.factor is None and found.kind == ""


def test_a_ring_in_a_ring_turns_at_its_torque(geometry):  # noqa: F811
    """Without being asked: the inverse of the share, as nothing else acts."""
    scene = replace(ring_in_ring(geometry, 0.6), solver=SolverSettings())
    found = run(scene, COMM).slip_limit
    assert found.factor == pytest.approx(1 / 0.6, rel=2e-3)
    assert found.kind == "pressures held"


def test_no_answer_on_the_way_halves_it(monkeypatch):
    """Loads beyond the limit have no answer: the way there gets shorter."""
    monkeypatch.setattr(slip_factor, "_WAY", 3.0)
    found = run(block((2 * cos(0.3), 2 * sin(0.3))), COMM, body=box_body(*FLAT)).slip_limit
    right = FRICTION * PRESSURE / (2 * cos(0.3) + FRICTION * 2 * sin(0.3))
    assert found.factor == pytest.approx(right, rel=2e-3)
