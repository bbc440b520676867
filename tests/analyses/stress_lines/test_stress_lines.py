"""Stress along lines: that of pure bending, which elements of degree 2 have exactly."""

import csv
import dataclasses
import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Line,
    Load,
    Material,
    MeshSource,
    Point,
    Profile,
    Run,
    Scene,
    Support,
    load_scene,
    main,
    run,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.results.quantities import idle_quantities
from fenics_contact.results.result import read_result
from fenics_contact.scene.writing import scene_text
from tests.messages import refused
from tests.scenes import SLAB

COMM = MPI.COMM_WORLD
LENGTH, STEEPNESS = 8.0, 20.0
MIDDLE = 0.5


def bent(*lines, **changes) -> Scene:
    """A beam, 8 long and 1 high, bent by tractions on its right end: σ_xx = 20 (y − 1/2)."""
    ends = STEEPNESS * MIDDLE
    traction = (Profile(along="y", at=(0, 1), values=(-ends, ends)), 0)
    scene = Scene(
        kinematics="plane stress",
        thickness=1.0,
        mesh=MeshSource(SLAB, parameters={"cells_along": 4, "cells_across": 1}),
        material=Material(1000, 0.0),
        support=(Support("left", {"x": 0}), Support("left", {"y": 0})),
        load=(Load("right", traction=traction),),
        line=lines,
    )
    return dataclasses.replace(scene, **changes)


def test_bending_is_linear_across_the_beam_and_constant_along_it():
    across = Line("across", from_=(3.3, 0), to=(3.3, 1), points=7)
    along = Line("along", from_=(0.5, 0.75), to=(8.5, 0.75), points=9)
    found = run(bent(across, along))
    first, second = found.lines
    height = np.linspace(0, 1, 7)
    np.testing.assert_allclose(first.distances, height, atol=1e-14)
    np.testing.assert_allclose(first.stress["xx"], STEEPNESS * (height - MIDDLE), atol=1e-9)
    for name in ("yy", "zz", "xy"):
        np.testing.assert_allclose(first.stress[name], 0, atol=1e-9)
    np.testing.assert_allclose(first.von_mises, STEEPNESS * abs(height - MIDDLE), atol=1e-9)
    np.testing.assert_allclose(second.stress["xx"][:8], STEEPNESS / 4, atol=1e-9)
    strain = STEEPNESS * (height - MIDDLE) / 1000  # ν is 0
    np.testing.assert_allclose(first.strain["xx"], strain, atol=1e-12)
    assert second.strain["xx"][8] is None
    assert second.is_inside == [True] * 8 + [False] and second.stress["xx"][8] is None
    assert "On the line 'along' 1 point is outside the body" in found.verdict


def test_points_of_a_line_have_the_stress_of_points():
    """Where the stress is that of a cantilever, which no element has exactly."""
    scene = bent(Line("line", (1, 0.2), (5, 0.9), 3), point=(Point("end", (5, 0.9)),))
    scene = dataclasses.replace(scene, load=(Load("right", traction=(1, 2)),))
    found = run(scene)
    for name, values in found.lines[0].stress.items():
        assert values[2] == pytest.approx(found.quantities[f"stress_end_{name}"], abs=1e-12)
    for name, values in found.lines[0].strain.items():
        assert values[2] == pytest.approx(found.quantities[f"strain_end_{name}"], abs=1e-15)


def test_a_run_writes_and_draws_it(folder):
    if COMM.size > 1:
        pytest.skip("the files of one rank will do")
    path = folder / "bent.toml"
    path.write_text(scene_text(bent(Line("across", (3, 0), (3, 1), 5))), encoding="utf-8")
    assert load_scene(path).line == (Line("across", (3, 0), (3, 1), 5),)
    out = folder / "out"
    assert main(["run", str(path), "--out", str(out), "--quiet"]) == 0
    with (out / "lines.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [
        *("line", "s", "x", "y", "z", "stress_xx", "stress_yy", "stress_zz"),
        *("stress_yz", "stress_xz", "stress_xy", "temperature"),
        *("strain_xx", "strain_yy", "strain_zz", "strain_yz", "strain_xz", "strain_xy"),
    ]
    strains = [float(row["strain_xx"]) for row in rows]
    assert strains == pytest.approx([-0.01, -0.005, 0, 0.005, 0.01], abs=1e-9)
    assert rows[0]["strain_yz"] == ""
    assert [row["line"] for row in rows] == ["across"] * 5 and rows[0]["stress_yz"] == ""
    assert [float(row["stress_xx"]) for row in rows] == pytest.approx([-10, -5, 0, 5, 10], abs=1e-6)
    assert json.loads((out / "result.json").read_text())["lines"][0]["name"] == "across"
    assert read_result(out).lines[0].distances == [0, 0.25, 0.5, 0.75, 1]
    assert main(["report", str(out)]) == 0
    assert (out / "line_0.png").exists() and "lines.csv" in (out / "report.html").read_text()


def test_what_is_no_line_is_refused():
    with refused("line_unknown_key", SceneError):
        Line("a", start=(0, 0), to=(1, 0))
    with refused("line_text_in_place", SceneError):
        Line("a", from_=(0, "b"), to=(1, 0))
    with refused("line_no_length", SceneError):
        Line("a", from_=(0, 0), to=(0, 0))
    with refused("line_entries", SceneError):
        bent(Line("a", from_=(0, 0, 0), to=(1, 0)))
    with refused("line_twice", SceneError):
        bent(Line("a", from_=(0, 0), to=(1, 0)), Line("a", from_=(0, 0), to=(2, 0)))
    with refused("line_outside"):
        Run(bent(Line("a", from_=(9, 0), to=(10, 0))))


def test_quantities_of_contacts_are_not_shown_without_any():
    idle = idle_quantities([])
    assert {"normal_force", "contact_area", "friction_work"} <= idle
    assert not {"reaction", "strain_energy", "external_work"} & idle
