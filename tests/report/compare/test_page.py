"""The page of several runs: numbers of their files, curves of all of them, any text as text."""

import dataclasses
import json
import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import InputError, Run, main
from fenics_contact.cli import compare as command
from fenics_contact.report.page import compare as compare_page
from fenics_contact.report.page import compare as drawn_contacts
from fenics_contact.report.page import compared_histories as drawn_histories
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.rounding import rounded
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.verification.published.impacts import bar_on_wall
from tests.report.page.test_page import Reader
from tests.report.test_gallery import coarse  # noqa: F401
from tests.scenes import PULLED_BLOCK, box_body, slab
from tests.simulation.output.test_run_folder import block, cycled

pytestmark = pytest.mark.serial
HOSTILE = "<script>alert('1')</script>\x1b[2J $x$"


def solved(scene, folder, body=None):
    files.solve_and_write(Run(scene, MPI.COMM_SELF, body), folder)
    return folder


def compared(capsys, *arguments):
    """Exit code, what the terminal shows and what went wrong."""
    code = main(["compare", *map(str, arguments)])
    said = capsys.readouterr()
    return code, said.out, said.err


@pytest.mark.errors
def test_two_runs_of_the_slab(tmp_path, capsys, monkeypatch):
    """A table of the terminal, a page with the same numbers, and curves of both."""
    monkeypatch.setenv("COLUMNS", "160")
    scenes = [slab(), slab(coefficient=0.25)]
    scenes[1] = dataclasses.replace(
        scenes[1],
        title=HOSTILE,
        contact=tuple(dataclasses.replace(one, name=HOSTILE) for one in scenes[1].contact),
    )
    folders = [solved(s, tmp_path / f"run{n}") for n, s in enumerate(scenes)]
    page = tmp_path / "new" / "both.html"
    code, said, wrong = compared(capsys, *folders, "--out", page)
    assert (code, wrong) == (0, "")
    assert re.search(r"contact.0.friction_coefficient +0.3 +0.25", said)
    assert "is only in 'run0', not in 'run1'" in said and "\x1b[2J" not in said

    text = page.read_text(encoding="utf-8")
    reader = Reader(text)
    assert all(name.startswith("data:") for name in reader.loaded)
    assert "<script" not in text and "&lt;script&gt;alert" in text
    results = [json.loads((folder / "result.json").read_text()) for folder in folders]
    for result in results:
        work = result["quantities"]["friction_work"], result["errors"]["friction_work"]
        shown = " ± ".join(rounded(*work))
        assert f"<td>{shown}</td>" in text and shown in said
    values = [result["quantities"]["friction_work"] for result in results]
    bars = [result["errors"]["friction_work"]["total"] for result in results]
    count = (values[1] - values[0]) / sum(bars)
    assert re.search(rf"friction work.*{count:.2g} *\n", said)


def test_curves_are_those_of_contact_csv(tmp_path, monkeypatch):
    """What is drawn along a contact of both runs, looked at before it is drawn."""
    folders = [solved(slab(load), tmp_path / f"{load}") for load in (200, 300)]
    seen = {}
    kept = drawn_contacts._draw_lines

    def look(lines, path):
        seen.update({along.run.name: along.values for along in lines})
        return kept(lines, path)

    monkeypatch.setattr(drawn_contacts, "_draw_lines", look)
    assert main(["compare", *map(str, folders), "--quiet", "--out", str(tmp_path / "c.html")]) == 0
    assert list(seen) == ["200", "300"]
    for folder in folders:
        table = ContactTable.read(folder / "contact.csv")
        order = np.argsort(table.numbers["x"], kind="stable")
        for name, column in (
            ("contact pressure", "contact_pressure"),
            ("friction traction", "traction_x"),
            ("slip", "slip_x"),
        ):
            found = seen[folder.name][name].values
            assert found == pytest.approx(table.numbers[column][order]), name


def few_cells():
    return block(MPI.COMM_SELF, (4, 2))


def test_load_steps_and_hysteresis(tmp_path, monkeypatch, capsys):
    """Histories of unlike numbers of load steps, and a loop, are on each other."""
    folders = [solved(cycled(steps), tmp_path / f"s{steps}", few_cells()) for steps in (4, 8)]
    titles = []
    whole = compare_page._draw

    def look(comparison, folder):
        pictures = whole(comparison, folder)
        titles.extend(picture.title for picture in pictures)
        return pictures

    monkeypatch.setattr(compare_page, "_draw", look)
    page = tmp_path / "c.html"
    code, said, _ = compared(capsys, *folders, "--out", page, "--all")
    assert code == 0
    assert titles == [
        *("Along 'y1'", "Contact 'y1' over the load steps"),
        *("Work and energies over the load steps", "Force against displacement"),
    ]
    assert len(Reader(page.read_text(encoding="utf-8")).images) == len(titles)
    assert re.search(r"load steps +4 +8", said) and "material.poissons_ratio" in said


def test_contacts_without_friction_have_no_curve_of_it(tmp_path, monkeypatch, capsys):
    """Motions have forces of round-off along obstacles, which are next to nothing."""
    scene = cycled(4)
    (contact,) = scene.contact
    smooth = dataclasses.replace(contact, friction_coefficient=0.0)
    scene = dataclasses.replace(scene, contact=(smooth,))
    folders = [solved(scene, tmp_path / n, few_cells()) for n in ("first", "second")]
    for folder in folders:
        file = folder / "result.json"
        result = json.loads(file.read_text(encoding="utf-8"))
        for step in result["steps"]:
            step["contacts"][0]["quantities"]["friction_force"] = [1e-12, 0.0]
        file.write_text(json.dumps(result), encoding="utf-8")
    drawn = []
    whole = drawn_histories._over_time

    def look(panels, title, path):
        drawn.extend(panels)
        return whole(panels, title, path)

    monkeypatch.setattr(drawn_histories, "_over_time", look)
    assert compared(capsys, *folders, "--out", tmp_path / "c.html", "--all")[0] == 0
    assert "normal force, $P$" in drawn and "friction force, $Q_x$" not in drawn


def test_times_of_motions_are_no_pseudo_times(tmp_path, capsys):
    """Beside load steps the axis has both."""
    scene, bar = bar_on_wall(4, 1.0)
    moved = [solved(scene, tmp_path / name, bar) for name in ("first", "second")]
    steps = solved(cycled(4), tmp_path / "steps", few_cells())
    for runs, clock in ((moved, "time"), ([moved[0], steps], "pseudo-time or time")):
        page = tmp_path / "c.html"
        assert compared(capsys, *runs, "--out", page, "--all")[0] == 0
        assert f"All runs over the {clock} t." in page.read_text(encoding="utf-8")


def test_contacts_in_space_and_a_flat_one(tmp_path, capsys):
    """Maps of two runs in space side by side; the flat one is in the tables."""
    pushed = dataclasses.replace(
        PULLED_BLOCK, contact=(dataclasses.replace(PULLED_BLOCK.contact[0], pressure=22),)
    )
    folders = [
        solved(scene, tmp_path / f"run{n}", box_body((3, 3, 1), comm=MPI.COMM_SELF))
        for n, scene in enumerate((PULLED_BLOCK, pushed))
    ]
    folders.append(solved(slab(), tmp_path / "flat"))
    page = tmp_path / "c.html"
    code, said, _ = compared(capsys, *folders, "--out", page)
    assert code == 0 and "differ in their kinematics" in said and "not comparable" not in said
    assert re.search(r"bars run1 +bars flat", said)
    text = page.read_text(encoding="utf-8")
    assert len(Reader(text).images) == 1 and "not comparable" in text


def test_bad_input_ends_with_2_and_leaves_no_page(tmp_path, capsys):
    folder = solved(slab(cells=(4, 1)), tmp_path / "run")
    page = tmp_path / "c.html"
    for arguments, message in (
        ((folder, tmp_path / "no", "--out", page), "no/result.json: cannot be read"),
        ((folder, "--out", page), "two runs or more"),
        ((folder, folder, "--out", folder / "result.json"), "must be the name of a page"),
    ):
        code, said, wrong = compared(capsys, *arguments)
        assert code == 2 and message in wrong and said == "", arguments
    (folder / "contact.csv").write_text("no\n")
    other = solved(slab(cells=(5, 1)), tmp_path / "other")
    code, _, wrong = compared(capsys, folder, other, "--out", page)
    assert code == 2 and "contact.csv: damaged" in wrong
    assert not page.exists()


def test_the_tables_stand_without_libraries_for_pictures(tmp_path, capsys, monkeypatch):
    def missing(*libraries):
        raise InputError("pictures need matplotlib")

    monkeypatch.setattr(command, "require", missing)
    folders = [solved(slab(cells=(n, 1)), tmp_path / f"run{n}") for n in (4, 5)]
    code, said, wrong = compared(capsys, *folders, "--out", tmp_path / "c.html")
    assert code == 0 and re.search(r"cells +4 +5", said)
    assert "no page: pictures need matplotlib" in wrong and not (tmp_path / "c.html").exists()
