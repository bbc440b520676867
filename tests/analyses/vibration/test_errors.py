"""Error bars of natural frequencies and damping, against formulas."""

import dataclasses
import math

import pytest
from mpi4py import MPI

from fenics_contact import Damping, Run, SolverSettings
from fenics_contact.analyses.vibration.task import _rows
from fenics_contact.analyses.vibration.words import damping_file as rows_of_file
from fenics_contact.analyses.vibration.words import damping_rows, mode_rows
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.vibration import bar_scene

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
LENGTH, SPRING, HEIGHT, LIMIT, SECTION = 20.0, 2.0, 0.2, 0.3, 200.0


def bar_of(cell):
    """The bar of ``verify damping`` in ten cells; in triangles each is cut in two."""
    end = LENGTH + SPRING
    parts = (
        Box("bar", (0, 0), (LENGTH, HEIGHT), (10, 1)),
        Box("spring", (LENGTH, 0), (end, HEIGHT), (1, 1)),
        Box("mass", (end, 0), (end + 2, HEIGHT), (1, 1)),
    )
    return boxes(parts, cell, welded=(("bar", "spring", "mass"),))


def driven(errors, limit=LIMIT, cell="triangle"):
    scene = bar_scene()
    contact = dataclasses.replace(scene.contact[0], friction_coefficient=limit)
    scene = dataclasses.replace(
        scene,
        contact=(contact,),
        damping=Damping((0.03,), increments=16),
        solver=SolverSettings(errors=errors),
    )
    return Run(scene, COMM, bar_of(cell)).solve()


def by_formulas(found):
    """Frequency and damping ratio for the force that the mode is driven with in the end."""
    (mode,), (row,) = found.modes, found.damping
    force = (2 * math.pi * row.natural_frequency) ** 2 * row.amplitude * mode.modal_mass
    moved = force**2 / (2 * SECTION * LIMIT) + force * SPRING / SECTION
    loss = 2 * force**3 / (3 * SECTION * LIMIT)
    frequency = math.sqrt(force / (moved * mode.modal_mass)) / (2 * math.pi)
    return {
        "natural_frequency": frequency,
        "damping_ratio": loss / (2 * math.pi * force * moved),
        "loss": loss,
    }


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_bars_hold_and_a_wrong_joint_is_beyond_them(cell):
    found = driven("all", cell=cell)
    (row,), (mode,) = found.damping, found.modes
    for name, exact in by_formulas(found).items():
        bar_of_it = row.errors[name]["total"]
        assert abs(row[name] - exact) < bar_of_it < 0.12 * exact, name
        assert row.errors[name]["mesh"] > 0 and row.errors[name]["step"] > 0
    assert row.errors["bar.y1.loss"] == pytest.approx(row.errors["loss"])
    # While all sticks nothing of the bar moves but beside its end: a mass on a spring.
    exact = math.sqrt(SECTION / SPRING / mode.modal_mass) / (2 * math.pi)
    stuck = mode.errors["natural_frequency"]
    assert abs(mode.natural_frequency - exact) < stuck["total"] + 0.02 * exact
    assert stuck["step"] == 0
    wrong = driven("none", 1.3 * LIMIT, cell)
    formulas = by_formulas(wrong)
    for name in ("damping_ratio", "loss"):
        assert abs(wrong.damping[0][name] - formulas[name]) > row.errors[name]["total"], name
    assert mode_rows(found)[1][2] != "?" and mode_rows(wrong)[1][2] == "?"
    said = damping_rows(found)
    bars = [said[1][place] for place, word in enumerate(said[0]) if word == "±"]
    assert len(bars) == 3 and "?" not in bars
    header, values = rows_of_file(found.damping)
    written = dict(zip(header, values, strict=True))
    assert float(written["damping_ratio_error"]) == row.errors["damping_ratio"]["total"]
    assert dict(zip(*rows_of_file(wrong.damping), strict=True))["loss_error"] == ""


def test_what_is_not_known_of_one_source_is_not_known_in_all():
    rows = _rows({"loss": 1.0}, {"mesh": None, "step": {1: {"loss": 0.1}}}, 1)
    assert rows == {"loss": {"mesh": None, "step": 0.1, "total": None}}
    rows = _rows({"loss": 1.0}, {"mesh": {1: {"loss": 0.2}}, "step": {1: {"loss": 0.1}}}, 1)
    assert rows["loss"]["total"] == pytest.approx(0.3)
    # An amplitude to which another answer did not come.
    assert _rows({"loss": 1.0}, {"mesh": {}}, 1)["loss"] == {"mesh": None, "total": None}
