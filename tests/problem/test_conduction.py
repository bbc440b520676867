"""Stationary heat: walls, films and pipes by formulas, and across contacts that it presses."""

from dataclasses import replace

import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Cycles,
    Film,
    Heat,
    Material,
    Path,
    Point,
    Preload,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    Temperature,
    run,
)
from fenics_contact.common import mumps
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from fenics_contact.simulation.state_file import StateFile
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.thermal.heat import HEIGHT, LENGTH, flux, pressures
from fenics_contact.verification.thermal.heat import bars as conducting_bars
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
CONDUCTIVITY = 0.05
STEEL = Material(210e3, 0.3, thermal_expansion=12e-6, conductivity=CONDUCTIVITY)
ALONG = replace(STEEL, thermal_expansion=(12e-6, 0, 0))


def _wall(*heat, **more):
    """A block that expands freely along its upper side and its depth."""
    given = {"material": STEEL, "solver": SolverSettings(errors="none"), **more}
    return Scene(
        kinematics="3D",
        support=tuple(Support(f"{axis}0", {axis: 0.0}) for axis in "xyz"),
        heat=heat,
        point=(Point("middle", (LENGTH / 2, 3.0, 1.0)), Point("end", (LENGTH, 0.0, 0.0))),
        **given,
    )


def _block():
    return box_body((4, 2, 2), (LENGTH, HEIGHT, 5))


def test_between_two_walls():
    """Linear, so that what expands along it alone does so without stress, u = α ΔT L/2."""
    heat = Heat("x0", temperature=0), Heat("x1", temperature=80)
    found = run(_wall(*heat, material=ALONG), COMM, _block())
    assert found.passed, found.verdict
    assert found.quantities["temperature_middle"] == pytest.approx(40, rel=1e-9)
    assert found.quantities["max_temperature"] == pytest.approx(80, rel=1e-9)
    moved = found.quantities["displacement_end"][0]
    assert moved == pytest.approx(12e-6 * 80 * LENGTH / 2, rel=1e-6)
    assert found.checks["heat_balance"].value < 1e-9


def test_a_flux_and_a_film():
    """T = T∞ + q/h + q x/k from the film on."""
    flux, film = 0.02, Film(coefficient=0.001, temperature=15.0)
    made = _wall(Heat("x0", film=film), Heat("x1", flux=flux))
    found = run(made, COMM, _block())
    at_film = 15 + flux / 0.001
    middle = at_film + flux * LENGTH / 2 / CONDUCTIVITY
    assert found.quantities["temperature_middle"] == pytest.approx(middle, rel=1e-9)
    assert found.quantities["temperature_end"] == pytest.approx(2 * middle - at_film, rel=1e-9)


def test_a_film_to_what_is_as_warm_as_the_reference():
    """So that it takes nothing in, and lets out what comes: T₁ = T₀/(1 + h L/k)."""
    film = Film(coefficient=0.001, temperature=0.0)
    found = run(_wall(Heat("x0", temperature=80), Heat("x1", film=film)), COMM, _block())
    end = 80 / (1 + 0.001 * LENGTH / CONDUCTIVITY)
    assert found.quantities["temperature_end"] == pytest.approx(end, rel=1e-9)


def test_films_on_both_sides():
    """Resistances in series, 1/h + L/k + 1/h."""
    films = Film(coefficient=0.001, temperature=90.0), Film(coefficient=0.003, temperature=15.0)
    found = run(_wall(Heat("x0", film=films[0]), Heat("x1", film=films[1])), COMM, _block())
    resistance = 1 / 0.001 + LENGTH / CONDUCTIVITY + 1 / 0.003
    end = 15 + 75 / resistance / 0.003
    assert found.quantities["temperature_end"] == pytest.approx(end, rel=1e-9)


def test_heat_comes_again_in_every_cycle():
    path = Path(time=(0, 0.5, 1), factor=(0, 1, 0))
    made = _wall(
        Heat("x0", temperature=20, path=path),
        Heat("x1", temperature=100, path=path),
        material=replace(STEEL, reference_temperature=20),
        cycles=Cycles(end=1, number=2, increments=2, until="end"),
    )
    found = run(made, COMM, _block())
    middles = [step.quantities["temperature_middle"] for step in found.steps]
    assert middles == pytest.approx([60, 20] * 2, rel=1e-9)


def test_heat_follows_its_path():
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.25))
    made = _wall(
        Heat("x0", temperature=20, path=path),
        Heat("x1", temperature=100, path=path),
        material=replace(STEEL, reference_temperature=20),
        steps=Steps(times=(1, 2)),
    )
    found = run(made, COMM, _block())
    middles = [step.quantities["temperature_middle"] for step in found.steps]
    assert middles == pytest.approx([60, 30], rel=1e-9)


def test_energies_balance_of_a_nearly_incompressible_block_that_gets_warm():
    """Its mean stress, an unknown of its own, does work on the thermal strain as well."""
    made = Scene(
        kinematics="plane strain",
        material=replace(STEEL, poissons_ratio=0.499),
        support=(Support("x0", {"x": 0.0, "y": 0.0}), Support("x1", {"x": 0.0})),
        heat=(Heat("x0", temperature=0), Heat("x1", temperature=50)),
        steps=Steps(2),
        solver=SolverSettings(errors="none"),
    )
    found = run(made, COMM, box_body((6, 2), (LENGTH, HEIGHT)))
    assert found.passed, found.verdict
    assert found.checks["energy_balance"].value < 1e-9
    assert abs(found.quantities["external_work"]) > 0


def test_bars_that_press_the_more_the_better_they_conduct():
    made, body = conducting_bars((120, 20), 0.05)
    found = run(made, COMM, body)
    assert found.passed, found.verdict
    assert found.quantities["normal_force"] == pytest.approx(23.84157 * HEIGHT, rel=1e-6)
    assert found.quantities["heat_flow"] == pytest.approx(-0.0393400 * HEIGHT, rel=1e-5)
    assert found.checks["heat_balance"].value < 1e-6
    assert not found.branches


@pytest.mark.errors
def test_the_bars_of_bars_that_press_the_more_the_better_they_conduct():
    made, body = conducting_bars((120, 20), 0.05, solver=SolverSettings())
    found = run(made, COMM, body)
    assert not found.error_notes
    (pressure,) = pressures((120, 20), 0.05)
    flow = -flux((120, 20), 1e-3 * pressure) * HEIGHT
    for name, exact in (("normal_force", pressure * HEIGHT), ("heat_flow", flow)):
        error, bar = abs(found.quantities[name] - exact), found.errors[name]["total"]
        assert error <= bar <= 30 * error, name
    assert found.contacts[0].errors["heat_flow"] == found.errors["heat_flow"]


def test_three_answers():
    """Apart, barely touching, and pressed: the pressed one is told, all where these are asked."""
    made, body = conducting_bars((20, 120), 0.24)
    found = run(made, COMM, body)
    assert found.quantities["normal_force"] == 0
    assert len(found.branches) == 2
    assert "It is not the only answer" in found.verdict
    asked = replace(made, solver=replace(made.solver, branches=True))
    every = run(asked, COMM, body).branches
    forces = sorted(one.quantities["normal_force"] for one in every)
    assert forces == pytest.approx([0, 0.292372 * HEIGHT, 7.182628 * HEIGHT], rel=1e-5)


def test_a_conductance_that_is_a_number():
    """Glued bars, whose temperatures are those of resistances in series, in any model."""
    conductance = 0.002
    made, body = conducting_bars((120, 20), 0.0, conductance)
    (contact,) = made.contact
    glued = replace(contact, contact="bonded", penalty_parameter="auto")
    found = run(replace(made, contact=(glued,)), COMM, body)
    flow = -flux((120, 20), conductance) * HEIGHT
    assert found.quantities["heat_flow"] == pytest.approx(flow, rel=1e-9)


def test_what_opens_as_it_conducts_has_an_answer_where_the_conductance_grows():
    """Bars that heat which crosses makes shorter: a conductance of all or nothing finds none."""
    walls, gap = (120, 20), 0.11
    found = run(*_with_comm(conducting_bars(walls, gap, 0.002)))
    assert found.exit_code == 3
    assert "have not settled" in found.verdict
    assert "most at 'a.x1'" in found.verdict
    (pressure,) = pressures(walls, gap)
    growing = run(*_with_comm(conducting_bars(walls, gap)))
    assert growing.quantities["normal_force"] == pytest.approx(pressure * HEIGHT, rel=1e-6)


def _with_comm(model):
    made, body = model
    return made, COMM, body


def test_conduction_is_factorised_once(monkeypatch):
    """On the first rank, in however many solves temperatures and pressures settle."""
    made, body = conducting_bars((20, 120), 0.24)
    count, factorised = [], mumps.factorised
    monkeypatch.setattr(mumps, "factorised", lambda create: count.append(1) or factorised(create))
    run(made, COMM, body)
    with_heat = len(count)
    cold = replace(made, heat=(), contact=(replace(made.contact[0], conductance=None),))
    run(cold, COMM, body)
    assert with_heat == len(count) - with_heat + (COMM.rank == 0)


def test_a_body_between_two_others_has_its_temperature_from_them():
    """Three plates that are glued: resistances in series."""
    plates = [Box(name, (10 * n, 0), (10 * n + 10, 4), (2, 1 + n)) for n, name in enumerate("abc")]
    steel = Material(210e3, 0.3, thermal_expansion=12e-6, conductivity=CONDUCTIVITY)
    glue = Contact("a.x1", against="b.x0", contact="bonded", conductance=0.01)
    made = Scene(
        kinematics="plane stress",
        material=steel,
        support=(Support("a.x0", {"x": 0.0, "y": 0.0}),),
        contact=(glue, replace(glue, on="b.x1", against="c.x0", conductance=0.02)),
        heat=(Heat("a.x0", temperature=100), Heat("c.x1", temperature=0)),
        point=(Point("middle", (15.0, 2.0)),),
        solver=SolverSettings(errors="none"),
    )
    found = run(made, COMM, boxes(plates))
    parts = [10 / CONDUCTIVITY, 1 / 0.01, 10 / CONDUCTIVITY, 1 / 0.02, 10 / CONDUCTIVITY]
    middle = 100 * (1 - (sum(parts[:2]) + parts[2] / 2) / sum(parts))
    assert found.quantities["temperature_middle"] == pytest.approx(middle, rel=1e-9)
    flows = [one.quantities["heat_flow"] for one in found.contacts]
    assert flows == pytest.approx([-4 * 100 / sum(parts)] * 2, rel=1e-9)


def test_the_formula_of_the_bars():
    """Numbers that were worked out apart from it: one answer, or two beside that of bars apart."""
    assert pressures((120, 20), 0.05) == pytest.approx([23.84157], rel=1e-6)
    assert flux((120, 20), 23.84157e-3) == pytest.approx(0.0393400, rel=1e-5)
    assert pressures((20, 120), 0.24) == pytest.approx([0.292372, 7.182628], rel=1e-6)


def test_friction_and_load_steps_beside_heat():
    """Two bars that are heated, pressed and let go: the path's last answer is that without it."""
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.6))
    made, body = conducting_bars((120, 20), 0.05, steps=Steps(times=(1, 2)))
    rough = replace(made.contact[0], law="incremental", friction_coefficient=0.3)
    heat = tuple(replace(one, path=path) for one in made.heat)
    found = run(replace(made, contact=(rough,), heat=heat), COMM, body)
    assert found.passed, found.verdict
    colder, _ = conducting_bars((20 + 60, 20), 0.05)
    alone = run(colder, COMM, body)
    force = alone.quantities["normal_force"]
    assert found.quantities["normal_force"] == pytest.approx(force, rel=1e-6)
    assert found.steps[0].quantities["heat_flow"] == pytest.approx(-0.0393400 * HEIGHT, rel=1e-5)


def test_load_steps_stay_on_their_branch():
    """From the pressed answer, as loads go back to where the bars might stand apart as well."""
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.5))
    made, body = conducting_bars((20, 220), 0.24, steps=Steps(times=(1, 2)))
    heat = (made.heat[0], replace(made.heat[1], path=path))
    made = replace(made, heat=heat)
    whole = run(made, COMM, body)
    assert whole.quantities["normal_force"] == pytest.approx(7.182628 * HEIGHT, rel=1e-5)


def test_a_run_that_is_resumed_stays_on_its_branch(tmp_path):
    """From the pressed answer to where the bars might stand apart as well."""
    folder, times = COMM.bcast(tmp_path), (0.5, 1, 2)
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.5))
    made, body = conducting_bars((20, 220), 0.24, steps=Steps(times=times))
    made = replace(made, heat=(made.heat[0], replace(made.heat[1], path=path)))
    begun = Run(replace(made, steps=Steps(times=times[:2])), COMM, body)
    first = begun.solve(StateFile(folder, begun.problem))
    rest = Run(made, COMM, body)
    file = StateFile(folder, rest.problem)
    found, whole = rest.solve(file, file.load()), run(made, COMM, body)
    assert len(first.steps) == 2
    for name in ("normal_force", "heat_flow", "max_temperature", "external_work"):
        assert found.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-6), name
    assert found.quantities["normal_force"] == pytest.approx(7.182628 * HEIGHT, rel=1e-5)


def test_a_study_of_temperatures_keeps_its_body():
    """Its answers are those of runs of the same values, in whichever way they are asked for."""
    made, body = conducting_bars((120, 20), 0.05)
    study = Study(made, COMM, conducting_bars((120, 20), 0.05)[1])
    study.solve()
    changes = {"heat.0.temperature": 150, "material.0.conductivity": 0.1}
    asked, quick = study.solve(changes), study.quantities(changes)
    alone = run(with_changes(made, changes), COMM, body)
    assert study.factorisations == 1
    for name in ("normal_force", "heat_flow", "strain_energy", "max_temperature"):
        expected = pytest.approx(alone.quantities[name], rel=1e-9)
        assert asked.quantities[name] == expected, name
        assert quick.quantities[name] == expected, name


def test_a_bolt_that_gets_warm_by_conduction():
    """As by a temperature that is given: it is locked, and both ends become warmer by as much."""
    body = box_body((6, 2), (LENGTH, HEIGHT))
    path = Path(time=(1, 2), factor=(0, 1))
    made = Scene(
        kinematics="plane stress",
        material=STEEL,
        support=(Support("x0", {"x": 0.0, "y": 0.0}), Support("x1", {"x": 0.0})),
        preload=(Preload("body", (1, 0), 3e4, locked_from=1),),
        steps=Steps(times=(1, 2)),
        solver=SolverSettings(solver="condensed", errors="none"),
    )
    warm = tuple(Heat(side, temperature=50, path=path) for side in ("x0", "x1"))
    found = run(replace(made, heat=warm), COMM, body)
    given = run(replace(made, temperature=(Temperature(value=50, path=path),)), COMM, body)
    force = given.preloads["body"].force
    assert found.preloads["body"].force == pytest.approx(force, rel=1e-9)
    assert abs(force - 3e4) > 0.5 * 210e3 * 12e-6 * 50 * HEIGHT


def test_what_is_refused():
    made, body = conducting_bars((120, 20), 0.05)
    with refused("conductance_without_heat"):
        replace(made, heat=())
    with refused("conductivity_is_missing"):
        replace(made, material=(replace(made.material[0], conductivity=None), made.material[1]))
    with refused("heat_beside_temperatures"):
        replace(made, temperature=(Temperature(value=3),))
    with refused("heat_in_full"):
        replace(made, solver=SolverSettings(solver="full"))
    with refused("no_temperature_of_a_body"):
        run(replace(made, heat=made.heat[:1]), COMM, body)
