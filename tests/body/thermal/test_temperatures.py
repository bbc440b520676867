"""Bodies that expand: bars, blocks, discs and shrink fits by formulas."""

from dataclasses import replace

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Contact,
    DerivativeRequest,
    Discretisation,
    Material,
    Path,
    Point,
    Profile,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    Temperature,
    run,
)
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.common.errors import InputError
from fenics_contact.simulation.sensitivities.scene_values import found_in, with_changes
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.thermal.temperatures import warm_joint
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
E, NU, ALPHA = 210e3, 0.3, 12e-6
STEEL = Material(E, NU, thermal_expansion=ALPHA, reference_temperature=20)
CELLS = {
    "plane strain": (mesh.CellType.triangle, mesh.CellType.quadrilateral),
    "plane stress": (mesh.CellType.triangle, mesh.CellType.quadrilateral),
    "axisymmetric": (mesh.CellType.triangle, mesh.CellType.quadrilateral),
    "3D": (mesh.CellType.tetrahedron, mesh.CellType.hexahedron),
}
SHAPES = [(model, cell) for model, cells in CELLS.items() for cell in cells]


def block(model, cell):
    return box_body((3, 2, 2) if model == "3D" else (3, 2), (3, 2, 1), cell)


def scene(model, temperature, **more):
    settings = SolverSettings(errors="none")
    given = {"material": STEEL, "solver": settings, **more}
    return Scene(kinematics=model, temperature=(temperature,), **given)


def held_as_needed(model):
    """Sides held so that a block expands freely as seen from its first corner."""
    axes = "xyz"[: 3 if model == "3D" else 2]
    held = axes[1:] if model == "axisymmetric" else axes
    return tuple(Support(f"{axis}0", {axis: 0.0}) for axis in held)


def largest_stress(found, points):
    names = [name for name in found.quantities if name.startswith("stress_")]
    assert len(names) >= 3 * len(points)
    return max(abs(found.quantities[name]) for name in names)


@pytest.mark.parametrize(
    ("model", "cell", "solver"),
    [(*shape, solver) for shape in SHAPES for solver in ("condensed", "full")]
    + [("3D", cell, "iterative") for cell in CELLS["3D"]],
)
def test_a_free_block_expands(model, cell, solver):
    """By α ΔT along every axis, in plane strain by (1 + ν) α ΔT, without stress in the plane."""
    places = (2.6, 1.7, 0.4)[: 3 if model == "3D" else 2]
    made = scene(
        model,
        Temperature(value=120),
        support=held_as_needed(model),
        point=(Point("inside", places),),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    found = run(made, COMM, block(model, cell))
    assert found.passed, found.verdict
    strain = ALPHA * 100 * (1 + NU if model == "plane strain" else 1)
    moved = found.quantities["displacement_inside"]
    tolerance = 1e-6 if solver == "iterative" else 1e-10
    seen = 1e-5 if model == "axisymmetric" else tolerance  # stress is taken beside the axis
    assert moved == pytest.approx([strain * x for x in places], rel=tolerance)
    for name in ("xx", "yy", "xy"):
        assert abs(found.quantities[f"stress_inside_{name}"]) < seen * E * ALPHA * 100
    if model == "plane strain":
        across = found.quantities["stress_inside_zz"]
        assert across == pytest.approx(-E * ALPHA * 100, rel=tolerance)


@pytest.mark.parametrize("solver", ["condensed", "full"])
@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.499])
def test_a_free_block_on_soft_springs_has_an_answer(ratio, solver):
    """All of its forces are round-off, of stresses that it would have if it were held."""
    made = scene(
        "3D",
        Temperature("body", value=120, path=Path(time=(0, 0.5, 1), factor=(0, 1, 0.6))),
        material=replace(STEEL, poissons_ratio=ratio),
        support=(Support("x0", stiffness=1e-12 * E),),
        solver=SolverSettings(solver=solver, errors="none"),
        discretisation=Discretisation(1),
    )
    found = run(made, COMM, block("3D", CELLS["3D"][1]))
    assert found.passed, found.verdict


def _linear(x):
    return 20 + 30 * x[0] - 14 * x[1] + 5 * x[2]


@pytest.mark.parametrize("cell", CELLS["3D"])
def test_a_linear_temperature_bends_a_free_block_without_stress(cell):
    """Displacements are then quadratic (B. A. Boley, J. H. Weiner, Theory of Thermal Stresses)."""
    made = scene(
        "3D",
        Temperature("body", value=_linear),
        support=(Support("x0", stiffness={"x": 1e-6, "y": 1e-6, "z": 1e-6}),),
        point=(Point("inside", (1.2, 0.7, 0.4)),),
    )
    found = run(made, COMM, block("3D", cell))
    assert largest_stress(found, ["inside"]) < 1e-10 * E * ALPHA * 100


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_the_energy_of_a_free_block_is_round_off(solver):
    """Along several load steps, whose works are none either."""
    made = scene(
        "plane stress",
        Temperature(value=230),
        support=held_as_needed("plane stress"),
        steps=Steps(3),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    for cell in CELLS["plane stress"]:
        found = run(made, COMM, block("plane stress", cell))
        assert found.passed, found.verdict
        assert abs(found.quantities["strain_energy"]) < 1e-12 * E * (ALPHA * 210) ** 2 * 6


@pytest.mark.parametrize("degree", [1, 2])
def test_a_clamped_bar_is_pressed(degree):
    """By −E α ΔT, here along a path there and back."""
    made = scene(
        "plane stress",
        Temperature(value=120, path=Path(time=(0, 1, 2), factor=(0, 1, -0.5))),
        support=(Support("x0", {"x": 0.0}), Support("x1", {"x": 0.0}), Support("y0", {"y": 0.0})),
        discretisation=Discretisation(degree),
        point=(Point("inside", (1.3, 0.8)),),
        steps=Steps(times=(1, 2)),
    )
    found = run(made, COMM, block("plane stress", CELLS["plane stress"][0]))
    assert found.passed, found.verdict
    pressed = [step.quantities["stress_inside_xx"] for step in found.steps]
    assert pressed == pytest.approx([-E * ALPHA * 100, E * ALPHA * 50], rel=1e-10)
    energies = [step.quantities["strain_energy"] for step in found.steps]
    stored = (E * ALPHA * 100) ** 2 / (2 * E) * 3 * 2
    assert energies == pytest.approx([stored, stored / 4], rel=1e-10)
    assert found.quantities["external_work"] == pytest.approx(stored / 4, rel=1e-9)


def test_a_free_block_expands_by_each_axis():
    axes = (ALPHA, -2 * ALPHA, 0.0)
    made = scene(
        "3D",
        Temperature("body", value=120),
        material=replace(STEEL, thermal_expansion=axes),
        support=held_as_needed("3D"),
        point=(Point("inside", (2.6, 1.7, 0.4)),),
    )
    found = run(made, COMM, block("3D", CELLS["3D"][0]))
    moved = [alpha * 100 * x for alpha, x in zip(axes, (2.6, 1.7, 0.4), strict=True)]
    assert found.quantities["displacement_inside"] == pytest.approx(moved, rel=1e-10, abs=1e-13)


def test_two_materials_between_walls():
    """In a row: p = Σ α ΔT l/Σ (l/E), with a reference temperature each."""
    left, right = Box("a", (0, 0), (1, 1), (2, 2)), Box("b", (1, 0), (3, 1), (4, 2))
    body = boxes([left, right])
    materials = (
        Material(E, 0.0, on="a", thermal_expansion=(ALPHA, 0, 0), reference_temperature=20),
        Material(
            E / 2, 0.0, on="b", thermal_expansion=(2 * ALPHA, 0, 0), reference_temperature=-10
        ),
    )
    made = scene(
        "plane strain",
        Temperature(value=120),
        material=materials,
        support=(
            *(Support(side, {"x": 0.0}) for side in ("a.x0", "b.x1")),
            *(Support(f"{name}.y0", {"y": 0.0}) for name in "ab"),
        ),
        contact=(Contact("a.x1", against="b.x0", contact="bonded"),),
        point=(Point("a", (0.3, 0.9)), Point("b", (1.8, 0.4))),
    )
    found = run(made, COMM, body)
    free = ALPHA * 100 + 2 * 2 * ALPHA * 130
    pressed = free / (1 / E + 2 / (E / 2))
    for name in "ab":
        assert found.quantities[f"stress_{name}_xx"] == pytest.approx(-pressed, rel=1e-3)


@pytest.mark.errors
@pytest.mark.parametrize(("ends", "pressure"), [("free", 94.5), ("held", 135.0)])
@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_a_shrink_fit(ends, pressure, solver):
    """Solid shaft, hub 100 K colder: p = E α ΔT (c² − b²)/(2 c²), over 1 − ν where ends are held.

    G. Lamé, with b = 20 where they touch and c = 40.
    """
    shaft, hub = Box("shaft", (0, 0), (20, 5), (4, 2)), Box("hub", (20, 0), (40, 5), (5, 3))
    body = boxes([shaft, hub])
    support = tuple(Support(f"{name}.y0", {"y": 0.0}) for name in ("shaft", "hub"))
    if ends == "held":
        support += tuple(Support(f"{name}.y1", {"y": 0.0}) for name in ("shaft", "hub"))
    made = scene(
        "axisymmetric",
        Temperature("hub", value=-80),
        support=support,
        contact=(Contact("shaft.x1", against="hub.x0", law="none"),),
        solver=SolverSettings(solver=solver, errors="all"),
    )
    found = run(made, COMM, body)
    assert found.passed, found.verdict
    area = 2 * np.pi * 20 * 5
    force, bar = found.quantities["pressure_integral"], found.errors["pressure_integral"]["total"]
    assert abs(force - pressure * area) < bar
    assert bar < 0.02 * force
    assert force / area == pytest.approx(pressure, rel=2e-4)


@pytest.mark.errors
def test_error_bars_are_those_of_an_interference():
    """A hub that is colder, and one that is drawn too tight by b α ΔT: the same pressure."""
    shaft, hub = Box("shaft", (0, 0), (20, 5), (4, 2)), Box("hub", (20, 0), (40, 5), (5, 3))
    colder = scene(
        "axisymmetric",
        Temperature("hub", value=-80),
        support=tuple(Support(f"{name}.y0", {"y": 0.0}) for name in ("shaft", "hub")),
        contact=(Contact("shaft.x1", against="hub.x0", law="none"),),
        solver=SolverSettings(errors="all"),
    )
    contact = replace(colder.contact[0], interference=20 * ALPHA * 100)
    tighter = replace(colder, temperature=(), contact=(contact,))
    by_temperature, by_value = (run(one, COMM, boxes([shaft, hub])) for one in (colder, tighter))
    for name in ("pressure_integral", "max_contact_pressure"):
        for source in ("mesh", "penalty", "step"):
            bar, other = (one.errors[name][source] for one in (by_temperature, by_value))
            assert bar == pytest.approx(other, rel=1e-3), (name, source)


@pytest.mark.errors
def test_bars_cover_a_hub_whose_end_no_longer_faces_the_shaft():
    """In four load steps the contact search is repeated: the hub has become shorter than the shaft.

    The node at the shaft's end then bears nothing, which is of the mesh and of the load steps.
    """
    shaft, hub = Box("shaft", (0, 0), (20, 5), (4, 2)), Box("hub", (20, 0), (40, 5), (5, 3))
    made = scene(
        "axisymmetric",
        Temperature("hub", value=-80),
        support=tuple(Support(f"{name}.y0", {"y": 0.0}) for name in ("shaft", "hub")),
        contact=(Contact("shaft.x1", against="hub.x0", law="none"),),
        steps=Steps(4),
        solver=SolverSettings(errors="all"),
    )
    found = run(made, COMM, boxes([shaft, hub]))
    force, bars = found.quantities["pressure_integral"], found.errors["pressure_integral"]
    expected = 94.5 * 2 * np.pi * 20 * 5
    assert 1e-3 * expected < abs(force - expected) < bars["mesh"] + bars["step"]
    assert bars["step"] > 1e-3 * expected
    assert found.errors["max_contact_pressure"]["step"] > 0.1 * 94.5
    assert found.errors["max_contact_pressure"]["total"] is None


@pytest.mark.parametrize("solver", ["condensed", "full"])
@pytest.mark.parametrize("ratio", [0.3, 0.499])
@pytest.mark.parametrize("locked", [1.0, None])
def test_a_bolt_that_is_warm(locked, ratio, solver):
    """Its force is what its foot holds; one that is not locked keeps it, and gives way."""
    made, body = warm_joint()
    made = replace(
        made,
        kinematics="plane strain",
        material=tuple(replace(one, poissons_ratio=ratio) for one in made.material),
        preload=tuple(replace(one, locked_from=locked) for one in made.preload),
        derivatives=None,
        solver=SolverSettings(solver=solver, errors="none"),
    )
    found = run(made, COMM, body)
    assert found.passed, found.verdict
    forces = [step.preloads["bolt"].force for step in found.steps]
    feet = [-step.supports[0].reaction[1] for step in found.steps]
    assert forces == pytest.approx(feet, rel=1e-8)
    assert (forces[1] == pytest.approx(forces[0], rel=1e-8)) == (locked is None)
    assert forces[0] == pytest.approx(20e3, rel=1e-8)


def test_a_disc_that_is_hot_inside():
    """T = 100 (1 − r²/R²): −E α 100/4 at the centre, around the rim twice as much, pulling.

    S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, article 150.
    """
    made = scene(
        "axisymmetric",
        Temperature(value=lambda x: 100 * (1 - x[0] ** 2 / 30**2)),
        material=replace(STEEL, reference_temperature=0),
        support=(Support("disc.y0", {"y": 0.0}),),
        point=(Point("centre", (0.0, 0.25)), Point("rim", (30.0, 0.25))),
    )
    body = boxes([Box("disc", (0.0, 0.0), (30.0, 0.5), (24, 1))])
    found = run(made, COMM, body)
    size = E * ALPHA * 100 / 4
    assert found.quantities["stress_centre_xx"] == pytest.approx(-size, rel=0.01)
    assert found.quantities["stress_rim_zz"] == pytest.approx(2 * size, rel=0.01)


def test_what_is_refused():
    body = block("plane strain", CELLS["plane strain"][0])
    held = held_as_needed("plane strain")
    made = scene("plane strain", Temperature(value=1), support=held)
    with refused("material_has_no_thermal_expansion"):
        run(replace(made, material=Material(E, NU)), COMM, body)
    with refused("temperatures_share_cells"):
        both = (Temperature(value=1), Temperature("body", value=2))
        run(replace(made, temperature=both), COMM, body)
    with refused("temperature_on_a_side"):
        run(replace(made, temperature=(Temperature("x1", value=1),)), COMM, body)


KEYS = (
    "temperature.0.value",
    "material.0.thermal_expansion",
    "material.1.thermal_expansion",
    "material.1.reference_temperature",
)


def _fitted(steps=(1.0,)):
    """A shaft in a cold hub with friction, which slips as it expands less along the axis."""
    shaft, hub = Box("shaft", (0, 0), (20, 5), (4, 2)), Box("hub", (20, 0), (40, 5), (5, 2))
    made = scene(
        "axisymmetric",
        Temperature(value=-80, path=Path(time=(0, 1, 2), factor=(0, 1, 0.7))),
        material=(replace(STEEL, on="shaft", thermal_expansion=5e-6), replace(STEEL, on="hub")),
        support=(Support("shaft.y0", {"y": 0.0}),),
        contact=(
            Contact("shaft.x1", against="hub.x0", law="incremental", friction_coefficient=0.2),
        ),
        steps=Steps(times=steps),
    )
    return made, boxes([shaft, hub])


@pytest.mark.parametrize("steps", [(1.0,), (1.0, 1.4)])
def test_derivatives_by_temperatures(steps):
    """Against central differences, in one load step and along several."""
    made, body = _fitted(steps)
    names = ("pressure_integral", "strain_energy", "max_slip")
    asked = replace(made, derivatives=DerivativeRequest(of=names, by=KEYS))
    found = run(asked, COMM, body)
    for key in KEYS:
        value = found_in(made, key)
        around = [
            run(with_changes(made, {key: value + sign * 1e-4 * (value or 20)}), COMM, body)
            for sign in (1, -1)
        ]
        for name in names:
            more, less = (one.quantities[name] for one in around)
            difference = (more - less) / (2e-4 * (value or 20))
            assert found.derivatives[name][key].discrete == pytest.approx(difference, rel=1e-5)


def test_mean_derivatives_are_those_of_what_is_linear():
    """Windows of expansions and temperatures are measured by these, not by a length."""
    made, body = _fitted()
    contact = (replace(made.contact[0], law="none", friction_coefficient=0.0),)
    asked = DerivativeRequest(of=("pressure_integral",), by=KEYS)
    support = (*made.support, Support("hub.y0", {"y": 0.0}))
    asked = replace(made, support=support, contact=contact, derivatives=asked)
    found = run(asked, COMM, body)
    for by in found.derivatives["pressure_integral"].values():
        assert by.value == pytest.approx(by.discrete, rel=1e-6)


def test_a_derivative_of_a_field_is_refused():
    made, body = _fitted()
    profile = Profile(along="x", at=(0, 40), values=(-80, -60))
    temperature = (replace(made.temperature[0], value=profile),)
    asked = DerivativeRequest(of=("strain_energy",), by=("temperature.0.value.values.0",))
    with refused("no_derivative_by_a_temperature_field"):
        run(replace(made, temperature=temperature, derivatives=asked), COMM, body)


def test_a_study_keeps_its_body_where_temperatures_vary_otherwise(monkeypatch, tmp_path):
    """Its answers are those of runs; a field that fails leaves nothing of it behind."""
    made, body = _fitted()
    profile = Profile(along="x", at=(0, 40), values=(-80, -60))
    made = replace(made, temperature=(replace(made.temperature[0], value=profile),))
    study = Study(made, COMM, body)
    before = study.solve().quantities["pressure_integral"]
    changes = {"temperature.0.value.values.1": -100}
    assert study.other_parts(changes) == []
    missing = str(COMM.bcast(tmp_path) / "none.csv")
    with monkeypatch.context() as patch:
        patch.setattr(ElasticBody, "__init__", None)  # nothing is to be made anew
        found, quick = study.solve(changes), study.quantities(changes)
        again = study.solve().quantities["pressure_integral"]
        with pytest.raises(InputError, match=r"none\.csv"):
            study.solve({"temperature.0.value": None, "temperature.0.file": missing})
    alone = run(with_changes(made, changes), COMM, body)
    for name in ("pressure_integral", "strain_energy", "max_contact_pressure", "max_temperature"):
        expected = pytest.approx(alone.quantities[name], rel=1e-9)
        assert found.quantities[name] == expected, name
        assert quick.quantities[name] == expected, name
    assert abs(found.quantities["pressure_integral"] - before) > 0.05 * before
    for known in (again, study.solve().quantities["pressure_integral"]):
        assert known == pytest.approx(before, rel=1e-9)
    assert study.factorisations == 1
    study.solve(changes)
    file = COMM.bcast(tmp_path) / "body.npz"
    study.save(file)
    loaded = Study.load(file, made, COMM, body).solve().quantities["pressure_integral"]
    assert loaded == pytest.approx(before, rel=1e-9)
