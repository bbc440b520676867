"""The joint diagram: a bolt tightened to F_V, locked, and pulled at its head by F_A.

References: F = F_V + Φ F_A with Φ = k_b/(k_b + k_p) until the parts separate at F_V/(1 − Φ), then
F_A. With ν = 0 and a rigid head, a plane glued to bolt and collar, the bars' stiffnesses k_b, k_p
are exact; penalties of glue and contact are springs in series with them.
"""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Obstacle,
    Path,
    Preload,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from tests.preload.joints import BOLT, HEIGHT, SLEEVE, TOP, joint

E_BOLT, E_SLEEVE, E_COLLAR = 1000.0, 400.0, 700.0
PENALTY, GLUE = 5e-6, 1e-6  # ε₁ of the seat and of the head (length/stress)
TIGHTENED = 6.0
BOLT_STIFFNESS = (BOLT[1] - BOLT[0]) / (TOP / E_BOLT + GLUE)


def sleeve_stiffness(penalty=PENALTY):
    """Of sleeve, seat, collar and glue in series."""
    compliance = HEIGHT / E_SLEEVE + (TOP - HEIGHT) / E_COLLAR + penalty + GLUE
    return (SLEEVE[1] - SLEEVE[0]) / compliance


def scene(glued=False, kinematics="plane strain", solver="condensed", pulled=0.0, **preload):
    """Tightened in the first step, then pulled with growing force."""
    deep = kinematics == "3D"
    axes = "xyz" if deep else "xy"
    fixed = dict.fromkeys(axes, 0)
    given = {"on": "shank", "axis": (0, 2, 0)[: len(axes)], "force": TIGHTENED, "name": "bolt"}
    head = Obstacle(force=pulled, path=Path(time=(1, 2), factor=(0, -1)))
    contacts = (Contact("top", contact="bonded", obstacle=head, penalty_parameter=GLUE),)
    if not glued:
        contacts += (Contact("seat", against="under_collar", penalty_parameter=PENALTY),)
    return Scene(
        kinematics=kinematics,
        material=(
            Material(E_BOLT, 0.0, on="bolt"),
            Material(E_BOLT, 0.0, on="shank"),
            Material(E_COLLAR, 0.0, on="collar"),
            Material(E_SLEEVE, 0.0, on="sleeve"),
        ),
        discretisation=Discretisation(1),
        support=(Support("bottom", fixed), Support("ground", fixed)),
        symmetry=("middle", "front") if deep else ("middle",),
        preload=(Preload(**given | {"locked_from": 1.0} | preload),),
        contact=contacts,
        steps=Steps(times=(1.0, 1.5, 2.0)),
        solver=SolverSettings(solver=solver, errors="none"),
    )


def solved(of, body):
    result = Run(of, MPI.COMM_WORLD, body).solve()
    assert result.converged, result.verdict
    assert result.passed, result.verdict
    return result


@pytest.mark.parametrize(
    ("kinematics", "solver"),
    [
        ("plane strain", "condensed"),
        ("plane strain", "full"),
        ("plane stress", "condensed"),
        ("3D", "condensed"),
        ("3D", "full"),
        ("3D", "iterative"),
    ],
)
@pytest.mark.parametrize("glued", [False, True])
def test_bolt_force_below_separation(glued, kinematics, solver):
    body = joint(glued, deep=1 if kinematics == "3D" else 0)
    held = sleeve_stiffness(0.0 if glued else PENALTY)
    share = BOLT_STIFFNESS / (BOLT_STIFFNESS + held)
    pulled = 0.9 * TIGHTENED / (1 - share)
    result = solved(scene(glued, kinematics, solver, pulled), body)
    forces = [step.preloads["bolt"].force for step in result.steps]
    expected = [TIGHTENED + share * pulled * part for part in (0, 0.5, 1)]
    np.testing.assert_allclose(forces, expected, rtol=1e-6)
    assert [step.preloads["bolt"].locked for step in result.steps] == [False, True, True]
    elongations = [step.preloads["bolt"].elongation for step in result.steps]
    np.testing.assert_allclose(
        elongations, TIGHTENED / BOLT_STIFFNESS + TIGHTENED / held, rtol=1e-6
    )
    assert elongations[1] == elongations[0]  # to the last digit: it is kept
    bolt = result.preloads["bolt"]
    assert bolt.initial_strain == pytest.approx(-bolt.elongation / 2)  # the shank is 2 long


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
def test_bolt_carries_all_after_separation(solver):
    share = BOLT_STIFFNESS / (BOLT_STIFFNESS + sleeve_stiffness())
    pulled = 1.5 * TIGHTENED / (1 - share)
    result = solved(scene(False, "3D", solver, pulled), joint(deep=1))
    assert result.preloads["bolt"].force == pytest.approx(pulled, rel=1e-6)
    assert result.contacts[1].quantities["contact_area"] == 0


def test_solvers_agree_where_stress_is_not_uniform():
    """With ν = .3; all solvers to 1e-8, on the way and at the end."""
    found = {}
    for solver in ("condensed", "full", "iterative"):
        of = scene(False, "3D", solver, 8.0)
        materials = tuple(dataclasses.replace(m, poissons_ratio=0.3) for m in of.material)
        result = solved(dataclasses.replace(of, material=materials), joint(deep=2, finer=2))
        found[solver] = np.array(
            [
                [
                    step.preloads["bolt"].force,
                    step.preloads["bolt"].elongation,
                    step.contacts[1].quantities["normal_force"],
                    step.quantities["strain_energy"],
                ]
                for step in result.steps
            ]
        )
    for solver in ("full", "iterative"):
        np.testing.assert_allclose(found[solver], found["condensed"], rtol=1e-8)


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
def test_released(solver):
    """Tightened, then released: parts touch without force and stay where they were left."""
    of = scene(False, "3D", solver, path=Path(time=(0, 1, 2), factor=(0, 1, 0)), locked_from=None)
    result = solved(of, joint(deep=1))
    bolt = result.preloads["bolt"]
    assert abs(bolt.force) < 1e-8 * TIGHTENED
    assert abs(bolt.elongation) < 1e-8 * result.steps[0].preloads["bolt"].elongation
    assert result.quantities["max_contact_pressure"] < 1e-8 * TIGHTENED
    assert result.quantities["strain_energy"] < 1e-12 * result.steps[0].quantities["strain_energy"]
    assert (
        abs(result.quantities["energy_defect"]) < 1e-9 * result.steps[0].quantities["external_work"]
    )


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
def test_not_yet_tightened_then_released_with_friction(solver):
    """No force in the first step; and friction under the head that remembers its slip."""
    path = Path(time=(0, 0.5, 1, 2), factor=(0, 0, 1, 0))
    of = scene(False, "3D", solver, path=path, locked_from=None)
    seat = dataclasses.replace(of.contact[1], friction_coefficient=0.2, law="incremental")
    materials = tuple(dataclasses.replace(m, poissons_ratio=0.3) for m in of.material)
    of = dataclasses.replace(
        of,
        material=materials,
        contact=(of.contact[0], seat),
        steps=Steps(times=(0.5, 1.0, 1.5, 2.0)),
    )
    result = solved(of, joint(deep=1, finer=2))
    forces = [step.preloads["bolt"].force for step in result.steps]
    asked = [0, TIGHTENED, TIGHTENED / 2, 0]
    np.testing.assert_allclose(forces, asked, rtol=1e-9, atol=1e-8 * TIGHTENED)
    assert abs(result.preloads["bolt"].elongation) < 1e-8


def test_energy_balance_of_tightening_and_pulling():
    """The work of the preload ∫ F dq and of the load, against closed formulas."""
    share = BOLT_STIFFNESS / (BOLT_STIFFNESS + sleeve_stiffness())
    pulled = 0.9 * TIGHTENED / (1 - share)
    result = solved(scene(pulled=pulled), joint())
    compliance = 1 / BOLT_STIFFNESS + 1 / sleeve_stiffness()
    tightening = 0.5 * TIGHTENED**2 * compliance
    pulling = 0.5 * pulled**2 / (BOLT_STIFFNESS + sleeve_stiffness())
    assert result.steps[0].quantities["external_work"] == pytest.approx(tightening, rel=1e-6)
    assert result.quantities["external_work"] == pytest.approx(tightening + pulling, rel=1e-6)
    bolt, sleeve = TIGHTENED + share * pulled, TIGHTENED - (1 - share) * pulled
    stored = 0.5 * bolt**2 / BOLT_STIFFNESS + 0.5 * sleeve**2 / sleeve_stiffness()
    energies = result.quantities["strain_energy"] + result.quantities["penalty_energy"]
    assert energies == pytest.approx(stored, rel=1e-6)
    assert result.checks["energy_balance"].value < 1e-9
