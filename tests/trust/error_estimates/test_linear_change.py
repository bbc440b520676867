"""Error bars of large contacts, by tangents: against formulas, and against answers found anew.

All contacts count as large here.
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
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.solve.condensed import condensed_system
from fenics_contact.solve.condensed.split_solver import SplitSolver
from fenics_contact.trust.error_estimates import estimates, linear_change
from fenics_contact.trust.error_estimates.linear_change import LinearChange, LinearHistory
from fenics_contact.trust.error_estimates.measured import Measured
from fenics_contact.trust.error_estimates.mesh import edge_places
from fenics_contact.trust.error_estimates.parameters import penalty_errors
from fenics_contact.trust.error_estimates.solving_again import Again
from fenics_contact.verification.boxes import Box, boxes
from tests.contact.fits import CONFINED, FIT, RATIO, STIFFNESS, stack
from tests.preload import test_joint as diagram
from tests.preload.joints import joint
from tests.scenes import box_body, with_solver
from tests.solve.condensed.stiff_and_soft import Split
from tests.solve.load_steps.histories import shoved, two_blocks
from tests.trust.error_estimates.test_load_steps import BODY, NAMES, dragged, true_error

pytestmark = pytest.mark.errors
COMM = MPI.COMM_WORLD


@pytest.fixture(autouse=True)
def all_contacts_are_large(monkeypatch):
    monkeypatch.setattr(condensed_system, "_LARGE", -1)


def solved(scene, body=None):
    result = Run(
        dataclasses.replace(scene, solver=SolverSettings(solver="condensed")), COMM, body
    ).solve()
    assert result.passed, result.verdict
    return result


@pytest.mark.parametrize("kinematics", ["plane strain", "3D"])
@pytest.mark.parametrize("penalty", [5e-6, 1e-5])
def test_force_of_a_locked_bolt(kinematics, penalty, monkeypatch):
    """Straight bars have no error but by ε₁, which the formula has as a spring in series.

    The force that the bolt is tightened to has none.
    """
    monkeypatch.setattr(diagram, "PENALTY", penalty)
    deep = int(kinematics == "3D")

    def of_parts(of_seat, of_glue):
        bolt = diagram.BOLT[1] / (diagram.TOP / diagram.E_BOLT + of_glue)
        sleeve = diagram.HEIGHT / diagram.E_SLEEVE + of_seat + of_glue
        sleeve += (diagram.TOP - diagram.HEIGHT) / diagram.E_COLLAR
        return bolt, (diagram.SLEEVE[1] - diagram.SLEEVE[0]) / sleeve

    def force(of_seat, of_glue):
        bolt, sleeve = of_parts(of_seat, of_glue)
        return diagram.TIGHTENED + bolt / (bolt + sleeve) * pulled

    def length(of_seat, of_glue):
        return sum(diagram.TIGHTENED / one for one in of_parts(of_seat, of_glue))

    pulled = 6.0
    scene = diagram.scene(kinematics=kinematics, pulled=pulled)
    tightened = dataclasses.replace(scene, steps=Steps(times=(0.5, 1.0)))
    given = solved(tightened, joint(deep=deep)).preloads["bolt"].errors["force"]
    assert set(given.values()) == {0.0}
    found = solved(
        dataclasses.replace(scene, steps=Steps(times=(0.5, 1, 1.5, 2))), joint(deep=deep)
    )
    bolt = found.preloads["bolt"]
    true = abs(bolt.force - force(0.0, 0.0))
    assert bolt.force == pytest.approx(force(penalty, diagram.GLUE), rel=1e-6)
    assert bolt.errors["force"]["mesh"] <= 3e-5 * bolt.force
    assert true <= bolt.errors["force"]["total"] <= 1.3 * true
    assert bolt.elongation == pytest.approx(length(penalty, diagram.GLUE), rel=1e-6)
    true = abs(bolt.elongation - length(0.0, 0.0))
    assert true <= bolt.errors["elongation"]["total"] <= 1.3 * true


@pytest.mark.parametrize(("degree", "cells"), [(1, 4), (1, 12), (2, 2), (2, 4)])
@pytest.mark.parametrize("law", ["none", "incremental"])
def test_a_ring_on_a_shaft(degree, cells, law):
    """Too tight by o, held between planes: p = E o (c² − b²) / (2 (1 − ν²) b c²) (Lamé)."""
    inner, outer, height = 1.0, 2.0, 0.5
    parts = (
        Box("shaft", (0, 0), (inner, height), (cells, cells)),
        Box("ring", (inner, 0), (outer, height), (cells, cells + 1)),
    )
    planes = tuple(Support(f"{box.name}.y{end}", {"y": 0}) for box in parts for end in (0, 1))
    rough = {} if law == "none" else {"friction_coefficient": 0.3}
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(STIFFNESS, RATIO),
        discretisation=Discretisation(degree),
        support=(*planes, Support("shaft.x0", {"x": 0})),
        contact=(Contact("shaft.x1", against="ring.x0", law=law, interference=FIT, **rough),),
        steps=Steps(3),
    )
    found = solved(scene, boxes(parts))
    pressure = STIFFNESS / (1 - RATIO**2) * FIT * (outer**2 - inner**2) / (2 * inner * outer**2)
    integral = found.quantities["pressure_integral"]
    true = abs(integral - pressure * 2 * np.pi * inner * height)
    bar = found.errors["pressure_integral"]["total"]
    assert bar is not None, found.error_notes
    assert true <= bar <= max(20 * true, 1e-3 * integral)


def test_blocks_in_a_frame():
    """p = M o / 2 with the confined modulus M and the overlap o: all of its error is that by ε₁."""
    found = stack(3, law="incremental", friction_coefficient=0.3, penalty_parameter=1e-6).solve()
    pressure = CONFINED * FIT / 2
    true = abs(found.quantities["pressure_integral"] - pressure)
    bar = found.errors["pressure_integral"]["total"]
    assert bar is not None, found.error_notes
    assert true <= bar <= 5 * true


@pytest.mark.parametrize("degree", [1, 2])
def test_edges_inside_cells(degree, monkeypatch):
    """A parabola on a block: forces on coarse meshes against one of cells a twelfth as large.

    Where an edge lies in its cell moves them to and fro; without that some bars are too short.
    """

    def pressed(cells, of_degree=degree):
        obstacle = Obstacle("parabola", radius=1, position=(0.5, 1), indentation=0.02)
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, RATIO),
            discretisation=Discretisation(of_degree),
            support=(Support("y0", {"x": 0, "y": 0}),),
            contact=(Contact("y1", obstacle=obstacle, law="none"),),
            solver=SolverSettings(solver="condensed"),
        )
        return run(scene, COMM, box_body((cells, cells), (1, 1)))

    fine = pressed(96, 2).quantities

    def ratios():
        found = []
        for cells in (8, 12, 14, 16):
            one = pressed(cells)
            true = abs(one.quantities["normal_force"] - fine["normal_force"])
            found.append(one.errors["normal_force"]["total"] / true)
        return found

    found = np.array(ratios())
    assert found.min() > 0.5 and (found > 1).mean() >= 0.75, found
    assert np.median(found) < 40, found
    monkeypatch.setattr(edge_places, "_PART", 0.0)
    assert min(ratios()) < 0.5


def test_is_what_newtons_method_finds_anew():
    """Where no point changes, the answer with less penalty is the same by both ways."""
    scene = dataclasses.replace(
        shoved(Steps()), contact=(dataclasses.replace(shoved(Steps()).contact[0], law="static"),)
    )
    prepared = Run(with_solver(scene, solver="condensed", errors="auto"), COMM, two_blocks())
    found = {}

    def compare(load_steps, local):
        measure = Measured(load_steps)
        for name, again in (
            ("linear", LinearChange(load_steps, measure, 1).again),
            ("anew", Again.of_last_step(load_steps, measure)),
        ):
            found[name] = penalty_errors(load_steps, again)

    prepared.listen_at_end(compare)
    prepared.solve()
    for key in ("normal_force", "friction_force", "max_slip", "strain_energy"):
        # What is beyond the leading order counts with a quarter.
        assert 1 <= found["linear"][key] / found["anew"][key] <= 1.3, key


@pytest.mark.parametrize("steps", [Steps(number=4), Steps(number=10)], ids=["4", "10"])
def test_load_steps(steps, monkeypatch):
    """Against 64 load steps: bars hold, and are not far."""
    monkeypatch.setattr(estimates, "mesh_errors", lambda *arguments: ({}, None))
    limit = run(with_solver(dragged(Steps(number=64)), errors="none"), COMM, BODY).quantities
    found = run(with_solver(dragged(steps), errors="auto"), COMM, BODY)
    ratios = [found.errors[n]["step"] / true_error(found, limit, n) for n in NAMES]
    assert min(ratios) > 1, ratios
    assert np.median(ratios) < 10, ratios


@pytest.mark.parametrize("room", [9.0, 0.0], ids=["kept", "anew"])
def test_histories_keep_the_factors_of_tangents(room, monkeypatch):
    """Bars are those that each tangent's own factors give, which are made once a load step."""
    split = Split(monkeypatch)
    solved_again = []

    def bars():
        found = run(with_solver(dragged(Steps(number=4)), errors="auto"), COMM, BODY)
        names = ("normal_force", "friction_force")
        every = {(name, of): error for name in names for of, error in found.errors[name].items()}
        return {key: error for key, error in every.items() if error is not None}

    def counted(history, times, newton):
        before = split.factorised
        found = step(history, times, newton)
        solved_again.append(split.factorised - before)
        return found

    step = LinearHistory._step
    monkeypatch.setattr(LinearHistory, "_step", counted)
    monkeypatch.setattr(linear_change, "_KEPT", room)
    kept = bars()
    of_first = solved_again[:4]
    assert COMM.bcast(of_first == [1] * 4)
    assert COMM.bcast(set(solved_again[4:]) == {0 if room else 1})
    monkeypatch.setattr(SplitSolver, "acting_as", lambda solver, constant, added: None)
    assert kept == pytest.approx(bars(), rel=1e-2, abs=1e-9)
    assert kept["normal_force", "mesh"] > 0


def test_what_one_load_step_between_turns_does_not_tell():
    """Nothing is known of how points slip within it: no bar, and a sentence."""
    found = run(with_solver(dragged(Steps(number=2)), errors="auto"), COMM, BODY)
    assert found.errors["normal_force"]["step"] is None
    assert found.errors["normal_force"]["total"] is None
    assert any("turn at both ends of a load step" in note for note in found.error_notes)
