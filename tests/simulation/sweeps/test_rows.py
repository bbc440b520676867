"""Rows are what separate runs give, whatever the law, the driver and the dimension."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import Path, Run, Steps, Study, run
from fenics_contact.simulation.sweeps import answers
from fenics_contact.simulation.sweeps.answers import Answers
from fenics_contact.simulation.sweeps.rows import columns_of, row_of
from tests.simulation.studies.cases import CASES, MU, ON_A_FLOOR, square
from tests.simulation.studies.test_study import kind_of

pytestmark = pytest.mark.serial
COMM = MPI.COMM_SELF


class OneMesh:
    """In place of the meshes of files."""

    def __init__(self, body):
        self._body = body

    def body(self, scene, key):
        return self._body


def answers_on(body):
    found = Answers(None, lambda memory: None)
    found._meshes = OneMesh(body)
    return found


def quantity(name):
    """Of a column, without what it is of and without the component."""
    last = name.rpartition(".")[2]
    return last[:-2] if last[-2:] in ("_x", "_y", "_z") else last


def require_same_row(found, expected, result):
    """To 1e-9 of the largest of its kind; bars to 1 %."""
    assert list(found) == list(expected)
    sizes = {"share": 1.0}
    for name, value in expected.items():
        if value is not None and not name.endswith("_error"):
            kind = kind_of(quantity(name))
            sizes[kind] = max(sizes.get(kind, 0.0), abs(value))
    # Bodies are of size 1: moments add up from forces, and some are 0.
    sizes["reaction_moment"] = max(sizes.get("reaction_moment", 0.0), sizes.get("force", 0.0))
    for name, value in expected.items():
        if value is None or found[name] is None:
            assert found[name] == value, name
        elif name.endswith("_error"):
            assert found[name] == pytest.approx(value, rel=0.01), name
        else:
            assert abs(found[name] - value) <= 1e-9 * sizes[kind_of(quantity(name))], name


@pytest.mark.parametrize("name", CASES)
def test_a_row_is_what_its_own_run_gives(name):
    """Whether it is found as a run finds it, or by the contacts alone after the first one."""
    scene, make, every = CASES[name]
    body, study = make(), Study(scene, COMM, make())
    solves = answers_on(body)
    for changes in every:
        changed = study.changed(changes)
        done, _ = solves.answer(changed, "")
        expected = run(changed, COMM, body)
        assert done.exit_code == expected.exit_code
        if changes is every[0] or scene.solver.errors != "none":
            assert done.said == expected.verdict
        assert done.row.keys() & {"normal_force", f"{scene.contact[0].label}.normal_force"}
        require_same_row(done.row, row_of(expected), expected)
    solves.close()
    assert solves._factorisations == 1
    study.close()


@pytest.mark.errors
def test_bars_are_those_of_its_own_run():
    body = square()
    solves = answers_on(body)
    solves.answer(ON_A_FLOOR, "")
    scene = Study(ON_A_FLOOR, COMM, body).changed({MU: 0.35})
    done, _ = solves.answer(scene, "")
    expected = run(scene, COMM, body)
    require_same_row(done.row, row_of(expected), expected)
    assert done.row["normal_force_error"] == pytest.approx(
        expected.errors["normal_force"]["total"], rel=0.01
    )
    names = list(done.row)
    assert names[names.index("friction_force_y") + 1] == "friction_force_error"
    assert names[names.index("y1.reaction_y") + 1] == "y1.reaction_error"


def test_columns_stand_where_each_row_has_them():
    rows = [
        {"a": 1.0, "a_error": None, "c": 2.0, "none": None, "none_error": None},
        {},
        {"a": 1.0, "b": 2.0, "b_error": 0.1, "c": 3.0, "d": 4.0},
    ]
    assert columns_of(rows) == ["a", "a_error", "b", "b_error", "c", "d"]


def test_what_a_function_of_python_raises_is_of_its_point_alone(monkeypatch):
    """And what was kept is not used any more, as it may be broken."""
    solves = answers_on(square())
    with monkeypatch.context() as patch:
        patch.setattr(answers, "row_of", lambda result: 1 / 0)
        failed, _ = solves.answer(ON_A_FLOOR, "one")
    assert failed.exit_code == 1
    assert failed.said == "ZeroDivisionError: division by zero"
    assert "Traceback" in failed.warnings[0]
    done, _ = solves.answer(ON_A_FLOOR, "two")
    assert (done.exit_code, done.factorisations) == (0, 1)


def test_of_a_bolted_joint_there_are_names_of_all_its_parts():
    from tests.preload.joints import joint
    from tests.preload.test_joint import scene

    done, _ = answers_on(joint()).answer(scene(pulled=1.0), "")
    owners = {name.rpartition(".")[0] for name in done.row}
    assert {"bolt.force", "bolt.elongation"} <= set(done.row)
    assert len(owners) > 3


def without_bars(scene):
    return dataclasses.replace(scene, solver=dataclasses.replace(scene.solver, errors="none"))


def test_without_bars_most_points_take_no_field(monkeypatch):
    """One whole run, then quick answers; a whole one again where strains might be large."""
    scene, body = without_bars(ON_A_FLOOR), square()
    whole = []
    solve = Run.solve
    monkeypatch.setattr(Run, "solve", lambda self, *a, **k: whole.append(1) or solve(self, *a, **k))
    solves = answers_on(body)
    changes = Study(scene, COMM, body)
    for coefficient in (0.3, 0.31, 0.32):
        done, _ = solves.answer(changes.changed({MU: coefficient}), "")
        assert done.exit_code == 0 and done.row
    assert len(whole) == 1
    far = {"support.0.displacement.y": -3.0}
    done, _ = solves.answer(changes.changed(far), "")
    assert len(whole) == 2
    expected = run(changes.changed(far), COMM, body)
    assert (done.exit_code, done.said) == (expected.exit_code, expected.verdict)
    assert not expected.checks["linear_range"].passed


def test_what_is_large_only_on_the_way_is_looked_at_in_full(monkeypatch):
    """A load that comes and goes: the end says nothing of strains on the way."""
    scene, body = without_bars(ON_A_FLOOR), square()
    there_and_back = Path(time=(0, 1, 2), factor=(0, 1, 0.1))
    support = dataclasses.replace(scene.support[0], path=there_and_back)
    scene = dataclasses.replace(scene, support=(support,), steps=Steps(number=2, end=2))
    whole = []
    solve = Run.solve
    monkeypatch.setattr(Run, "solve", lambda self, *a, **k: whole.append(1) or solve(self, *a, **k))
    solves = answers_on(body)
    for coefficient in (0.3, 0.31):
        done, _ = solves.answer(Study(scene, COMM, body).changed({MU: coefficient}), "")
        assert done.exit_code == 0
    assert len(whole) == 2
