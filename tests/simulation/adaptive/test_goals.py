"""Meshes refined where errors matter for the quantities that are asked for."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Discretisation,
    Heat,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    Steps,
    Support,
    load_scene,
    run,
)
from fenics_contact.common.parallel import total
from fenics_contact.simulation.adaptive.goals import GoalFinder, Goals, find_goals
from tests.scenes import ROOT, box_body
from tests.simulation.studies.cases import BALL, ON_A_FLOOR, square
from tests.solve.load_steps.histories import block, dragged

pytestmark = pytest.mark.errors
COMM = MPI.COMM_WORLD
SPHERE = ROOT / "demos" / "sphere.toml"

# Held below from x = 0 to 3, bent down at x = 5, pressed from above about x = 1.
ARM = """
size = 0.5;
Point(1) = {0, 0, 0, size}; Point(2) = {3, 0, 0, size}; Point(3) = {5, 0, 0, size};
Point(4) = {5, 1, 0, size}; Point(5) = {2, 1, 0, size}; Point(6) = {0, 1, 0, size};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4};
Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6}; Plane Surface(1) = {1};
Physical Curve("bottom") = {1}; Physical Curve("end") = {3}; Physical Curve("top") = {5};
Physical Surface("body") = {1};
"""


def goals_of(scene, body, names):
    """Of a run, in the state at its end."""
    found = []

    def at_end(load_steps, local):
        found.append(find_goals(load_steps, local, {name: [name] for name in names}))
        found.append(local.squared.copy())

    prepared = Run(scene, body=body)
    prepared.listen_at_end(at_end)
    assert prepared.solve().converged
    return found


def by_energy(monkeypatch):
    """As if no quantity had an adjoint."""
    monkeypatch.setattr(Goals, "of", lambda self, ratios: self.squared)


def test_the_adjoint_of_a_reaction_is_the_displacement_itself():
    """Glued to a floor and moved at the other end alone, by Betti: ψ of the force there is −u/δ.

    So cells count as in the energy norm. Those of the strain energy do but for the share of the
    glue, whose springs have a little of the energy.
    """
    glued = dataclasses.replace(
        ON_A_FLOOR,
        load=(),
        contact=(
            dataclasses.replace(ON_A_FLOOR.contact[0], contact="bonded", friction_coefficient=0.0),
        ),
        support=(Support("y1", {"x": 0, "y": -0.002}),),
    )
    goals, squared = goals_of(glued, square(), ["reaction_y", "strain_energy"])
    whole = total(COMM, squared.sum())
    for name, close in {"reaction_y": 1e-5, "strain_energy": 2e-3}.items():
        assert goals.weighed[name] == pytest.approx(squared / whole, rel=close, abs=1e-9), name
    assert goals.squared == pytest.approx(squared / whole)
    assert not goals.by_energy


@pytest.mark.serial
def test_a_corner_far_from_contact_does_not_count_for_the_force(tmp_path, monkeypatch):
    """As true as by energy, against a fine mesh made so, with less than half the unknowns."""
    file = tmp_path / "arm.geo"
    file.write_text(ARM)
    obstacle = Obstacle("parabola", radius=2, position=(1, 1), indentation=0.02)
    scene = Scene(
        kinematics="plane strain",
        mesh=MeshSource(str(file), cell="triangle"),
        material=Material(1000, 0.3),
        discretisation=Discretisation(2),
        support=(Support("bottom", {"x": 0, "y": 0}),),
        load=(Load("end", traction=(0, -4)),),
        contact=(Contact("top", obstacle=obstacle),),
        accuracy=Accuracy(normal_force=1e-3),
    )
    found = run(scene, COMM)
    by_energy(monkeypatch)
    other = run(scene, COMM)
    fine = run(dataclasses.replace(scene, accuracy=Accuracy(normal_force=3e-4)), COMM)
    assert found.accuracy.reached and other.accuracy.reached
    assert found.model.dofs < 0.5 * other.model.dofs
    force = fine.quantities["normal_force"]
    assert found.quantities["normal_force"] == pytest.approx(force, rel=1.3e-3)
    assert not found.accuracy.by_energy


@pytest.mark.serial
def test_the_peak_below_a_sphere_takes_less_than_half_the_unknowns(monkeypatch):
    """Hertz's p₀ = 2 E*/π √(d/R); axisymmetric."""
    coarse = ["contact.0.friction_coefficient=0", "mesh.parameters.size=1"]
    scene = load_scene(SPHERE, [*coarse, "mesh.parameters.cells_outside=5"])
    scene = dataclasses.replace(scene, accuracy=Accuracy(max_contact_pressure=1e-3))
    peak = 2 * 1000 / (1 - 0.3**2) / np.pi / np.sqrt(8)
    found = run(scene, COMM)
    by_energy(monkeypatch)
    other = run(scene, COMM)
    assert found.accuracy.reached and other.accuracy.reached
    assert found.model.dofs < 0.5 * other.model.dofs
    assert found.quantities["max_contact_pressure"] == pytest.approx(peak, rel=1e-3)


def test_of_a_history_the_last_load_step_counts_and_all_is_there_again():
    scene = dragged(Steps(times=(0.5, 0.75, 1.0)), errors="all")
    finder, around = GoalFinder(["normal_force", "friction_force"]), []
    prepared = Run(scene, body=block())

    def at_end(load_steps, local):
        around.append(load_steps.newton.system.position())
        finder(load_steps, local)
        around.append(load_steps.newton.system.position())

    prepared.listen_at_end(at_end)
    assert prepared.solve().converged
    assert around[1] == pytest.approx(around[0], abs=1e-14)
    assert finder.found is not None and not finder.found.by_energy
    for weights in finder.found.weighed.values():
        assert total(COMM, weights.sum()) == pytest.approx(1.0)
        assert total(COMM, float((weights < 0).sum())) == 0


def test_what_has_no_adjoint_counts_by_energy_and_is_named():
    goals, _ = goals_of(BALL, box_body((6, 6), (1, 1)), ["contact_area", "normal_force"])
    assert goals.by_energy == {"contact_area": "'contact_area' has no derivatives"}
    assert set(goals.weighed) == {"normal_force"}
    assert goals.of({"contact_area": 3.0}) == pytest.approx(3 * goals.squared)
    mixed = goals.of({"contact_area": 2.0, "normal_force": 1.0})
    assert mixed == pytest.approx(2 * goals.squared + goals.weighed["normal_force"])
    full = dataclasses.replace(
        ON_A_FLOOR, solver=dataclasses.replace(ON_A_FLOOR.solver, solver="full", errors="all")
    )
    goals, _ = goals_of(full, square(), ["normal_force"])
    assert goals.by_energy == {"normal_force": "the full solver has no adjoint"}
    assert not goals.weighed


def test_heat_through_a_fit_to_the_accuracy_asked_for():
    """Two tubes with a constant conductance between them: resistances in series."""
    fit = load_scene(ROOT / "demos" / "warm_fit.toml")
    parameters = {**fit.mesh[0].parameters, "size": 10}
    scene = dataclasses.replace(
        fit,
        mesh=(dataclasses.replace(fit.mesh[0], parameters=parameters),),
        heat=(Heat("shaft_bore", temperature=200), Heat("hub_outside", temperature=20)),
        contact=(dataclasses.replace(fit.contact[0], conductance=2.0),),
        steps=Steps(),
        accuracy=Accuracy(of={"heat_flow": 3e-5}),
    )
    result = run(scene)
    assert result.accuracy.reached
    assert len(result.levels) > 1
    resistance = (np.log(2.0) / 50 + 1 / (2.0 * 20) + np.log(2.0) / 50) / (2 * np.pi * 20)
    flow, bar = result.quantities["heat_flow"], result.errors["heat_flow"]["total"]
    assert -flow == pytest.approx(180 / resistance, abs=bar)
    assert bar <= 3e-5 * -flow
