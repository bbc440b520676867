"""The error budget of a run: what is in it, and what it leaves as it is."""

import dataclasses
import json
import pathlib

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Support,
    run,
)
from fenics_contact.cli.program import main
from fenics_contact.cli.summary import print_result
from fenics_contact.results.rounding import UNKNOWN, rounded
from fenics_contact.solve.newton_failure import StepBudget
from fenics_contact.trust.error_estimates import estimates
from fenics_contact.trust.error_estimates.estimates import SOURCES
from tests.report.page.pages import page_of
from tests.scenes import PULLED_BLOCK, ROOT, box_body, with_solver
from tests.solve.load_steps.histories import block, dragged, shoved, two_blocks

pytestmark = pytest.mark.errors

COMM = MPI.COMM_WORLD
COLUMNS = {*SOURCES, "total"}
SEVERAL = dragged(Steps(number=6))


def solved(scene, body, errors):
    return run(with_solver(scene, errors=errors, exact_check=False), COMM, body)


def without_errors(result):
    """What a run found, but for its errors, times and the memory that errors need, too."""
    found = result.as_dict()
    del found["model"]["solver_memory_mb"]
    parts = [*found["contacts"], *found["supports"], *found["reactions"].values()]
    for part in parts:
        part.pop("errors", None)
    return {k: v for k, v in found.items() if k not in ("errors", "error_notes", "timings")}


def test_an_estimate_takes_a_bounded_number_of_newton_steps(monkeypatch):
    """What has no bar then says why; the answer is left as it is."""
    scene, body = dragged(Steps(number=1)), block()
    expected = solved(scene, body, "none")
    taken, count = [], StepBudget.count
    monkeypatch.setattr(StepBudget, "count", lambda *a: (taken.append(a[1] > 0), count(*a)))
    whole = solved(scene, body, "auto")
    own = whole.steps[0].newton_iterations
    assert whole.error_notes == [] and sum(taken) > 3 * own
    taken.clear()
    monkeypatch.setattr(estimates, "_AT_MOST", 1)
    monkeypatch.setattr(estimates, "_FEW", 2)
    result = solved(scene, body, "auto")
    most, without = max(own, 2), ["mesh", "step"]
    assert sum(taken) <= own + len(SOURCES) * most
    row = result.errors["normal_force"]
    assert [source for source in SOURCES if row[source] is None] == without
    assert row["total"] is None and result.passed
    for source, note in zip(("mesh", "load steps"), result.error_notes, strict=True):
        assert note == (
            f"The error by the {source} was not estimated: it takes more than {most} Newton steps, "
            f"and the answer took {own}."
        )
    assert without_errors(result) == without_errors(expected)


def test_every_quantity_has_a_row_and_a_sum():
    result = run(dragged(Steps(number=1)), COMM, block())
    rows = [*result.errors.values(), *result.contacts[0]["errors"].values()]
    rows += [support["errors"]["reaction"] for support in result.supports]
    rows += [found["errors"]["reaction"] for found in result.reactions.values()]
    assert len(rows) > 20
    for row in rows:
        assert set(row) == COLUMNS
        known = [row[source] for source in SOURCES]
        assert all(value >= 0 for value in known)
        assert row["total"] == pytest.approx(sum(known))
    assert {"normal_force", "max_contact_pressure", "stick_area"} <= set(result.errors)
    assert result.errors["normal_force"]["domain"] == 0
    assert result.errors["normal_force"]["step"] > 0  # of a single step of the incremental law
    assert result.timings["errors"] > 0
    assert result.error_notes == []


def test_sources_that_a_scene_lacks_make_no_error():
    body = box_body((4, 4, 2))
    row = solved(PULLED_BLOCK, body, "auto").errors["friction_force"]
    assert row["penalty"] == row["step"] == row["domain"] == 0
    assert row["regularisation"] > 0
    forgetful = dragged(Steps(number=6), law="static")
    row = solved(forgetful, block(), "auto").errors["friction_force"]
    assert row["step"] == 0 and row["total"] > 0


def test_a_history_has_all_its_bars_without_being_asked_for():
    result = solved(SEVERAL, block(), "auto")
    row = result.errors["friction_force"]
    assert all(row[source] > 0 for source in ("mesh", "penalty", "regularisation", "step"))
    assert row["total"] > 0 and not result.error_notes


def test_a_history_of_which_no_step_can_be_left_out_waits_to_be_asked_for():
    """Its loads turn after every step."""
    up_and_down = Path(time=(0, 0.2, 0.4, 0.6, 0.8, 1), factor=(0, 1, 0.5, 1, 0.5, 1))
    result = solved(dragged(Steps(number=5), path=up_and_down), block(), "auto")
    row = result.errors["friction_force"]
    for source in ("penalty", "regularisation", "step", "total"):
        assert row[source] is None
    assert row["mesh"] > 0 and row["iteration"] >= 0
    assert len(result.error_notes) == 1 and "friction remembers" in result.error_notes[0]
    assert rounded(1.0, row)[1] == UNKNOWN  # what is known of it is no bar
    short = solved(dragged(Steps(number=2)), block(), "auto")
    assert short.errors["friction_force"]["total"] > 0 and not short.error_notes


@pytest.mark.parametrize(
    ("law", "number", "known"),
    [
        ("static", 1, {"penalty", "regularisation", "iteration", "step"}),
        ("incremental", 1, {"penalty", "regularisation", "iteration"}),
        ("incremental", 2, {"iteration"}),
    ],
)
def test_of_other_solvers_what_one_answer_more_tells_is_known(law, number, known):
    scene = with_solver(dragged(Steps(number=number), law=law), solver="full")
    result = solved(scene, block(), "auto")
    row = result.errors["friction_force"]
    assert {name for name in row if row[name] is not None} == {*known, "domain"}
    assert row["penalty"] is None or row["penalty"] > 0
    assert "The error by the mesh was not estimated" in result.error_notes[0]
    assert len(result.error_notes) == (1 if "step" in known else 2)


def test_the_mesh_waits_to_be_asked_for_with_other_solvers(capsys):
    scene = with_solver(dragged(Steps(number=1)), solver="full")
    result = solved(scene, block(), "auto")
    row = result.errors["normal_force"]
    assert row["mesh"] is None and row["total"] is None and row["domain"] == 0
    assert "with the full solver" in result.error_notes[0]
    assert result.supports[0]["errors"]["reaction"]["total"] is None
    if COMM.rank == 0:
        print_result(result, pathlib.Path("folder"))
        shown = [line.split() for line in capsys.readouterr().out.splitlines()]
        of_quantities = [line for line in shown if line[:2] == ["normal", "force"]]
        assert [line[-1] for line in of_quantities] == ["?"]
        page = page_of(json.loads(json.dumps(result.as_dict())))
        assert page.count("<td>?</td>") > 5
        assert "or more" not in page and "± 0" not in page and ">0 %<" not in page
    assert solved(scene, block(), "all").errors["normal_force"]["total"] > 0


@pytest.mark.parametrize(
    ("scene", "body"),
    [
        (SEVERAL, block),
        (dragged(Steps(number=2, automatic=True), driven={"force": 5.0}), block),
        (dragged(Steps(number=3), solid=0.499), block),
        (shoved(Steps(number=3)), two_blocks),
    ],
    ids=["obstacle", "force, automatic", "nearly incompressible", "bodies that slide"],
)
def test_results_are_those_of_a_run_without_them(scene, body):
    made = body()
    with_all, without = (solved(scene, made, errors) for errors in ("all", "none"))
    assert without.errors == {}
    assert without.timings["errors"] < 0.1 * with_all.timings["errors"]
    assert "errors" not in without.contacts[0]
    assert with_all.errors["normal_force"]["step"] >= 0
    assert without_errors(with_all) == without_errors(without)
    for name in ("gap", "contact_pressure", "friction_traction", "slip", "status"):
        assert np.array_equal(getattr(with_all.points, name), getattr(without.points, name)), name


def test_fields_of_a_run_are_there_again():
    """Whatever writes or draws after a run finds its answer, not the last one tried."""
    runs = []
    for errors in ("all", "none"):
        prepared = Run(with_solver(dragged(Steps(number=2)), errors=errors), COMM, block())
        prepared.solve()
        runs.append(prepared)
    one, other = (prepared.problem.displacement.x.array for prepared in runs)
    assert np.array_equal(one, other)
    ours, theirs = (prepared.problem.contacts[0].state() for prepared in runs)
    assert np.array_equal(ours.contact_pressure, theirs.contact_pressure)
    assert np.array_equal(ours.friction_traction, theirs.friction_traction)


def test_errors_do_not_depend_on_the_number_of_ranks():
    scene = with_solver(dragged(Steps(number=2)), errors="all")
    together = run(scene, COMM, block())
    alone = run(scene, MPI.COMM_SELF, block(MPI.COMM_SELF))
    for name, row in together.errors.items():
        size = np.linalg.norm(alone.quantities[name])
        for source, value in row.items():
            expected = alone.errors[name][source]
            assert value == pytest.approx(expected, rel=1e-5, abs=1e-8 * size), (name, source)


def test_work_along_a_path_is_as_wrong_as_where_it_went():
    result = solved(SEVERAL, block(), "all")
    work = result.errors["external_work"]
    parts = [result.errors[k] for k in ("strain_energy", "friction_work", "penalty_energy")]
    assert work["mesh"] == pytest.approx(sum(part["mesh"] for part in parts))
    assert work["step"] >= abs(result.quantities["energy_defect"])
    static = solved(dragged(Steps(number=3), law="static"), block(), "auto")
    assert static.errors["external_work"]["mesh"] is None
    assert static.errors["external_work"]["total"] is None
    assert static.errors["external_work"]["step"] == 0  # there is no memory of steps


def test_a_linear_body_has_errors_by_its_mesh_alone():
    scene = dataclasses.replace(
        PULLED_BLOCK, contact=(), load=(Load("x0", traction=(30, 10, 0)),), solver=SEVERAL.solver
    )
    row = solved(scene, box_body((2, 2, 2)), "all").errors["reaction"]
    assert row["total"] == pytest.approx(row["mesh"] + row["iteration"])


def test_files_page_and_terminal_have_them(tmp_path_factory, capsys):
    folder = COMM.bcast(tmp_path_factory.mktemp("errors") if COMM.rank == 0 else None)
    scene, mesh = folder / "scene.toml", ROOT / "meshes" / "half_space.geo"
    if COMM.rank == 0:
        scene.write_text(
            'kinematics = "axisymmetric"\nsymmetry = ["axis"]\n'
            f'mesh = {{ file = "{mesh}", parameters = {{ fine = 4, size = 1, extent = 20 }} }}\n'
            "material = { youngs_modulus = 1000, poissons_ratio = 0.3 }\n"
            'half_space = { on = ["outer"] }\n'
            '[[contact]]\non = "contact"\n'
            'obstacle = { shape = "paraboloid", radius = 8, indentation = 1 }\n'
        )
    COMM.barrier()
    assert main(["run", str(scene), "--out", str(folder / "out")]) == 0
    shown = capsys.readouterr().out
    if COMM.rank > 0:
        return
    result = json.loads((folder / "out" / "result.json").read_text(encoding="utf-8"))
    row = result["errors"]["normal_force"]
    assert set(row) == COLUMNS and row["domain"] > 0
    assert result["contacts"][0]["errors"]["normal_force"] == pytest.approx(row)
    value = result["quantities"]["normal_force"]
    said, bar = rounded(value, row)
    assert f"presses with {said} ± {bar}" in shown
    assert result["errors"]["friction_work"]["total"] == 0  # there is no friction
    assert result["contacts"][0]["errors"]["friction_work"]["total"] == 0
    named = result["reactions"]["axis"]["errors"]["reaction"]
    assert named == result["supports"][0]["errors"]["reaction"]
    page = page_of(result)
    assert "Estimated errors" in page and f"<td>{said}</td><td>± {bar}</td>" in page


@pytest.mark.parametrize(("cell", "degree"), [(CellType.triangle, 2), (CellType.quadrilateral, 1)])
def test_bars_hold_of_a_nearly_incompressible_block_under_a_cylinder(cell, degree):
    """Against the same on much finer cells."""
    obstacle = Obstacle("parabola", radius=0.6, position=(1, 1), indentation=0.05)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.499),
        discretisation=Discretisation(degree),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=0.2),),
    )
    count = 16 // degree
    found = solved(scene, box_body((count, count // 2), (2, 1), cell), "auto")
    finer = dataclasses.replace(scene, discretisation=Discretisation(2))
    expected = solved(finer, box_body((48, 24), (2, 1), CellType.quadrilateral), "none").quantities
    ratios = []
    for name in ("normal_force", "strain_energy", "contact_area", "max_contact_pressure"):
        true = abs(found.quantities[name] - expected[name])
        assert true < found.errors[name]["total"], name
        ratios.append(found.errors[name]["total"] / true)
    assert np.median(ratios) < 12
