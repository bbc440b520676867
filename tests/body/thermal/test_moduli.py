"""Moduli that follow the temperature: bars, a thick tube and a locked bolt by formulas."""

from dataclasses import replace
from math import log

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact import (
    Coupling,
    Discretisation,
    Heat,
    Load,
    Material,
    ModulusTable,
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
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from fenics_contact.simulation.state_file import StateFile
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.thermal.heat import HEIGHT, LENGTH, flux
from fenics_contact.verification.thermal.heat import bars as conducting_bars
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
TRACTION, ALPHA = 100.0, 12e-6
SOFTENS = ModulusTable(temperature=(0, 100), values=(210e3, 110e3))
SOFT = Material(SOFTENS, 0.0, thermal_expansion=(ALPHA, 0, 0), conductivity=0.05)
QUIET = SolverSettings(errors="none")
RISES = Temperature(value=lambda x: x[0])  # from 0 to 100 along the bar
BOTH_ENDS = (Heat("x0", temperature=0), Heat("x1", temperature=100))


def bar(**more):
    """One that is pulled and warm at its end, and its mesh."""
    given = {"material": SOFT, "solver": QUIET, "discretisation": Discretisation(degree=2), **more}
    scene = Scene(
        kinematics="plane stress",
        support=(Support("x0", {"x": 0.0}), Support("y0", {"y": 0.0})),
        load=(Load("x1", traction=(TRACTION, 0.0)),),
        point=(Point("end", (LENGTH, 0.0)),),
        **given,
    )
    return scene, box_body((20, 2), (LENGTH, HEIGHT))


def softness(low, high):
    """∫ dx/E of a bar whose modulus is linear between its ends (length/stress)."""
    return LENGTH * (1 / low if low == high else log(high / low) / (high - low))


def stretch(factor):
    """How far the end of the bar goes, once the temperature is so many times that of ``RISES``."""
    low, high = SOFTENS.at(np.array([0.0, 100.0 * factor]))
    return factor * (TRACTION * softness(low, high) + ALPHA * 100 * LENGTH / 2)


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_a_bar_that_is_softer_where_it_is_warm(solver):
    scene, body = bar(temperature=(RISES,), solver=SolverSettings(solver=solver, errors="none"))
    found = run(scene, COMM, body)
    assert found.quantities["displacement_end"][0] == pytest.approx(stretch(1.0), rel=1e-8)
    energy = TRACTION**2 * HEIGHT * softness(210e3, 110e3) / 2
    assert found.quantities["strain_energy"] == pytest.approx(energy, rel=1e-8)


@pytest.mark.parametrize("heated", ["given", "found"])
def test_load_steps_have_the_moduli_of_their_temperatures(heated):
    """Of which each is linear in x, so that it is the same by conduction; energies balance."""
    given = {"temperature": (RISES,)} if heated == "given" else {"heat": BOTH_ENDS}
    scene, body = bar(**given, steps=Steps(2))
    found = run(scene, COMM, body)
    assert found.passed, found.verdict
    ends = [step.quantities["displacement_end"][0] for step in found.steps]
    assert ends == pytest.approx([stretch(0.5), stretch(1.0)], rel=1e-8)
    assert found.checks["energy_balance"].value < 1e-9


def test_a_tube_that_softens_outwards():
    """E = E₀ (r/a)^β in plane strain: C. O. Horgan and A. M. Chan, J. Elasticity 55 (1999) 43-59.

    u = A r^m + B r^n with m, n the roots of x² + β x + β ν/(1 − ν) − 1.
    """
    inner, outer, power, poisson, modulus, pressure = 10.0, 20.0, -1.0, 0.3, 1000.0, 7.0
    table = ModulusTable(temperature=(0, 2000), values=(1e-9, 2000))
    warm = Temperature(value=lambda x: modulus * (x[0] / inner) ** power)
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(table, poisson, thermal_expansion=0.0),
        temperature=(warm,),
        support=(Support("tube.y0", {"y": 0.0}), Support("tube.y1", {"y": 0.0})),
        load=(Load("tube.x0", pressure=pressure),),
        point=(Point("bore", (inner, 1.0)), Point("rim", (outer, 1.0))),
        discretisation=Discretisation(degree=2),
        solver=QUIET,
    )
    found = run(scene, COMM, boxes([Box("tube", (inner, 0), (outer, 2), (24, 1))]))
    roots = np.roots([1, power, power * poisson / (1 - poisson) - 1])

    def radial(r):
        """σ_r of u = r^m, one for each root."""
        stiffness = modulus * (r / inner) ** power / ((1 + poisson) * (1 - 2 * poisson))
        return stiffness * ((1 - poisson) * roots + poisson) * r ** (roots - 1)

    shares = np.linalg.solve([radial(inner), radial(outer)], [-pressure, 0.0])
    for name, r in (("bore", inner), ("rim", outer)):
        moved = found.quantities[f"displacement_{name}"][0]
        assert moved == pytest.approx(shares @ r**roots, rel=1e-6), name


def joined_bars(**more):
    """Bars that conduct by their pressure and are softer where they are warm; and their mesh."""
    scene, body = conducting_bars((120, 20), 0.05, **more)
    materials = tuple(
        replace(one, youngs_modulus=ModulusTable((20, 120), (high, high / 2)))
        for one, high in zip(scene.material, (210e3, 70e3), strict=True)
    )
    degree = Discretisation(degree=2)
    return replace(scene, material=materials, discretisation=degree), body


def pressed_by(hot):
    """Pressure of the bars by a wall of this temperature beside one of 20 (stress)."""

    def left(pressure):
        flow = flux((hot, 20), 1e-3 * pressure)
        middle = [hot - flow * LENGTH / 0.05, 20 + flow * LENGTH / 0.2]
        free, soft = -0.05, 0.0
        for wall, end, alpha, cold in zip(
            (hot, 20), middle, (12e-6, 23e-6), (210e3, 70e3), strict=True
        ):
            free += alpha * LENGTH * ((wall + end) / 2 - 20)
            table = ModulusTable((20, 120), (cold, cold / 2))
            soft += softness(*table.at(np.array([wall, end])))
        return free - pressure * soft

    return brentq(left, 1e-6, 100.0, xtol=1e-13)


def test_bars_that_press_on_each_other_are_softer_by_the_heat_that_crosses():
    scene, body = joined_bars()
    found = run(scene, COMM, body)
    assert found.passed, found.verdict
    assert found.quantities["normal_force"] == pytest.approx(HEIGHT * pressed_by(120), rel=1e-6)


@pytest.mark.errors
def test_the_bars_of_such_bars_hold():
    scene, body = joined_bars(solver=SolverSettings())
    found = run(replace(scene, discretisation=Discretisation(degree=1)), COMM, body)
    error = abs(found.quantities["normal_force"] - HEIGHT * pressed_by(120))
    assert error <= found.errors["normal_force"]["total"] <= 50 * error


def test_a_locked_bolt_that_softens():
    """N = A E(T) (N₀/(A E(0)) − α T), tightened cold and warmed."""
    tight, warm = 3e3, 50.0
    late = Path(time=(1, 2), factor=(0, 1))
    scene = Scene(
        kinematics="plane stress",
        material=SOFT,
        support=(Support("x0", {"x": 0.0, "y": 0.0}), Support("x1", {"x": 0.0})),
        preload=(Preload("body", (1, 0), tight, locked_from=1),),
        temperature=(Temperature(value=warm, path=late),),
        steps=Steps(times=(1, 2)),
        solver=QUIET,
    )
    found = run(scene, COMM, box_body((6, 2), (LENGTH, HEIGHT)))
    cold, soft = SOFTENS.at(np.array([0.0, warm]))
    force = HEIGHT * soft * (tight / (HEIGHT * cold) - ALPHA * warm)
    assert found.preloads["body"].force == pytest.approx(force, rel=1e-8)


def test_a_study_has_the_moduli_of_each_temperature():
    """By one factorisation each where it is given, and as runs of their own where it is found."""
    scene, body = bar(temperature=(Temperature(value=30.0),))
    study = Study(scene, COMM, body)
    for count, warm in enumerate((30.0, 80.0), 1):
        found = study.quantities({"temperature.0.value": warm}).quantities
        modulus = SOFTENS.at(np.array([warm]))[0]
        exact = LENGTH * (TRACTION / modulus + ALPHA * warm)
        assert found["displacement_end"][0] == pytest.approx(exact, rel=1e-9)
        assert study.factorisations == count
    scene, body = joined_bars()
    study = Study(scene, COMM, body)
    for hot in (120.0, 90.0, 120.0):
        change = {"heat.0.temperature": hot}
        exact = pytest.approx(HEIGHT * pressed_by(hot), rel=1e-6)
        assert study.quantities(change).quantities["normal_force"] == exact
        assert study.solve(change).quantities["normal_force"] == exact


def test_a_run_that_is_resumed_has_the_moduli_of_its_temperatures(tmp_path):
    folder, times = COMM.bcast(tmp_path), (0.5, 0.8, 1)
    scene, body = joined_bars(steps=Steps(times=times))
    begun = Run(replace(scene, steps=Steps(times=times[:2])), COMM, body)
    begun.solve(StateFile(folder, begun.problem))
    rest = Run(scene, COMM, body)
    file = StateFile(folder, rest.problem)
    found, whole = rest.solve(file, file.load()), run(scene, COMM, body)
    assert found.passed, found.verdict
    for name in ("normal_force", "heat_flow", "strain_energy", "external_work"):
        assert found.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-6), name
    assert found.quantities["normal_force"] == pytest.approx(HEIGHT * pressed_by(120), rel=1e-6)


def test_what_is_refused():
    with refused("modulus_table_of_two_lengths"):
        ModulusTable((0, 100, 200), (1.0, 2.0))
    with refused("modulus_table_that_falls_back"):
        ModulusTable((100, 0), (1.0, 2.0))
    with refused("modulus_of_a_table_below_zero"):
        replace(SOFT, youngs_modulus=ModulusTable((0, 100), (1.0, 0.0)))
    with refused("moduli_that_change_beside_couplings"):
        bar(heat=BOTH_ENDS, coupling=(Coupling("y1", name="end"),))
    with refused("moduli_that_change_in_full"):
        bar(temperature=(RISES,), steps=Steps(2), solver=SolverSettings(solver="full"))
    with refused("moduli_of_temperature_and_of_direction"):
        stiff = Material(stiffness=np.eye(6).tolist(), on="other")
        bar(material=(replace(SOFT, on="body"), stiff))
    scene, body = bar(temperature=(Temperature(value=30.0),))
    with refused("derivative_by_a_temperature_that_moduli_follow"):
        Study(scene, COMM, body).derivatives(["strain_energy"], ["temperature.0.value"])
    with refused("derivative_by_a_modulus_that_follows_temperatures"):
        Study(scene, COMM, body).derivatives(["strain_energy"], ["material.poissons_ratio"])
    with refused("derivatives_where_moduli_change"):
        Study(with_changes(scene, {"steps.number": 2}), COMM, body).derivatives(["strain_energy"])
    with refused("derivatives_where_moduli_change"):
        heated, bodies = joined_bars()
        Study(heated, COMM, bodies).derivatives(["normal_force"])
