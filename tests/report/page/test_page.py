"""The page of a run: what it says and in which order, and that it is one valid file."""

import base64
import gzip
import json
import re
import shutil
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    Path,
    Run,
    Scene,
    Steps,
    Support,
    main,
)
from fenics_contact.report.bodies.view_3d import make_view
from fenics_contact.report.drawing.fields import whole_body
from fenics_contact.report.page.templates import bar, html, table
from fenics_contact.report.page.view_page import view_html
from fenics_contact.report.report import write_report
from fenics_contact.results.check_messages import title
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.quantities import idle_quantities
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output import run_folder as files
from tests.messages import refused
from tests.report.page.pages import page_of
from tests.scenes import PULLED_BLOCK, box_body, slab, with_solver
from tests.simulation.output.test_run_folder import block, cycled

pytestmark = pytest.mark.serial

ORDER = [
    *("pictures", "view-3d", "checks", "quantities", "scene", "model", "contacts", "iterations"),
    *("timings", "versions", "cite", "reproduce"),
]
VOID = ("meta", "link", "img", "br", "input")


class Reader(HTMLParser):
    """What a page is made of; an element that is not closed as it was opened is an error."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.loaded, self.images, self.headings = [], [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag not in VOID:
            self.open.append(tag)
        self.ids += [attributes["id"]] if "id" in attributes else []
        if tag == "img":
            self.images.append(attributes)
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        for name in ("src", "href"):
            if name in attributes and tag != "a":
                self.loaded.append(attributes[name])
        assert "style" not in attributes or "url" not in attributes["style"]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] == "style":
            assert "url(" not in data and "@import" not in data


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The folder of a run in space, with its report."""
    folder = tmp_path_factory.mktemp("run") / "block"
    body = box_body((4, 4, 2), comm=MPI.COMM_SELF)
    files.solve_and_write(Run(PULLED_BLOCK, MPI.COMM_SELF, body), folder)
    return folder, write_report(folder)


def text_of(folder):
    return (folder / "report.html").read_text(encoding="utf-8")


def test_the_page_holds_everything_in_order(run):
    folder, written = run
    assert all(picture.path.stat().st_size > 0 for picture in written)
    text = text_of(folder)
    reader = Reader(text)
    sections = [name for name in reader.ids if name in ORDER]
    assert sections == ORDER
    assert len(set(reader.ids)) == len(reader.ids)
    assert text.startswith("<!DOCTYPE html>") and '<html lang="en">' in text
    assert reader.headings[0] == 1
    assert all(b <= a + 1 for a, b in zip(reader.headings, reader.headings[1:], strict=False))
    assert text.index('class="verdict') < text.index('id="checks"')
    shown = {image["data-file"] for image in reader.images}
    assert shown == {picture.path.name for picture in written}
    assert all(image["alt"] for image in reader.images)
    result = read_result(folder)
    shown = result.quantities.keys() - idle_quantities(result.contacts)
    assert len(shown) > 6
    assert all(title(name) in text for name in result.checks)
    for name in (*shown, *result.versions):
        assert name.replace("_", " ") in text, name
    assert html((folder / "scene.toml").read_text()) in text
    assert "@article{CamposOdenKikuchi1982" in text
    assert "A script made this run" in text  # a mesh of Python


def test_the_page_is_one_file_that_loads_nothing(run):
    reader = Reader(text_of(run[0]))
    assert len(reader.loaded) >= 3
    assert all(address.startswith("data:") for address in reader.loaded)


def test_the_page_is_valid_html(run):
    html5lib = pytest.importorskip("html5lib")
    parser = html5lib.HTMLParser(strict=False)
    without_scripts = re.sub("(<script>).*?(</script>)", r"\1\2", text_of(run[0]), flags=re.DOTALL)
    assert len(without_scripts) > 100_000  # pictures and the view's data are in it
    parser.parse(without_scripts)
    assert parser.errors == []


def test_what_the_next_run_takes_away(run, tmp_path):
    """All that the report has written, and nothing of the user's."""
    shutil.copytree(run[0], tmp_path / "again")
    (tmp_path / "again/mine.png").write_bytes(b"")
    files.StepFiles(Run(cycled(), MPI.COMM_SELF, block(MPI.COMM_SELF)), tmp_path / "again")
    left = {path.name for path in (tmp_path / "again").iterdir()}
    assert left == {"mine.png", "scene.toml"}


def test_all_text_is_escaped():
    assert html("<a & b>") == "&lt;a &amp; b&gt;" == html(html("<a & b>"))
    assert "<script>" not in table([["<script>", "x"], ["<script>", "y"]], "<script>")
    assert "&#34;&lt;" in table([['"<', "x"], ["", ""]], "")
    assert "width:100%" in bar(7, "<") and "&lt;" in bar(7, "<")
    evil = "</title></pre><script>alert(1)</script>"
    result = found(title=evil, verdict=evil, versions={evil: evil})
    text = page_of(result, evil)
    assert "<script>" not in text and Reader(text)


@pytest.mark.parametrize("mark", ["\x1b", "\x9b", "\u061c", "\u200b", "\u202e", "\ufeff", "\udcff"])
def test_no_text_turns_the_direction_of_a_page_or_hides(mark):
    title = f"block{mark}dessap"
    result = found(title=title, verdict=title, versions={title: title})
    result["checks"] = {title: result["checks"]["equilibrium"]}
    text = page_of(result, f"{title}\nsecond line")
    assert mark not in text and "second line" in text
    assert text.count("block\\") > 5


def found(**changes):
    """A result with one check that passed."""
    checks = {"equilibrium": {"value": 1e-13, "limit": 1e-9, "passed": True}}
    model, step = {"kinematics": "3D"}, {"load_factor": 1.0, "newton_iterations": 3}
    step |= {"outer_iterations": 0, "quantities": {"normal_force": 2.0}}
    return {
        "title": "", "verdict": "Converged.", "converged": True, "passed": True, "model": model,
        "checks": checks,
        "quantities": {"normal_force": 2.0}, "contacts": [], "supports": [], "steps": [step],
        "timings": {"solve": 1.0, "total": 2.0}, "versions": {"dolfinx": "0"}, "errors": {},
    } | changes  # fmt: skip


def test_a_run_to_trust_says_so():
    text = page_of(found())
    assert "OK: converged, and all 1 checks passed" in text and 'class="verdict ok"' in text
    assert "FAILED" not in text and 'id="advice"' not in text
    assert "<title>folder</title>" in text


def test_what_failed_is_said_with_how_much_and_where():
    checks = {
        "equilibrium": {"value": 1e-13, "limit": 1e-9, "passed": True},
        "tension": {
            "value": 0.25, "limit": 1e-6, "passed": False, "contact": "top", "place": [1.0, 2.0]
        },
        "penetration_depth": {"value": 0.3, "limit": 0.01, "passed": False, "kind": "cell"},
        "dissipation": {"value": None, "limit": 1e-6, "passed": False},
    }  # fmt: skip
    text = page_of(found(checks=checks, passed=False))
    assert "Not to be trusted: 3 of 4 checks failed" in text and 'class="verdict bad"' in text
    assert "the contact pulls with 25 % of the peak pressure at" in text
    assert "near (1, 2)" in text and "penetration is 30 % of the shortest edge of a cell" in text
    assert "its value is not a number" in text
    assert text.count(">FAILED<") == 3 and text.count("bar failed") == 3
    assert "use of the limit" in text
    short = page_of(found(accuracy={"asked": {}, "reached": False}, passed=False))
    assert "Not as accurate as was asked for" in short


def test_errors_are_beside_the_quantities():
    row = {"mesh": 0.01, "penalty": None, "total": None}
    whole = {"mesh": 0.01, "penalty": 0.01, "total": 0.02}
    quantities = {"strain_energy": 2.0, "reaction": [3.0, 4.0], "external_work": 0.0}
    quantities["energy_defect"] = 3
    errors = {"strain_energy": row, "reaction": whole}
    text = page_of(found(quantities=quantities, errors=errors, error_notes=["A note."]))
    assert "strain energy</th><td>2</td><td>?</td><td>?</td>" in text
    assert "3.000, 4.000</td><td>± 0.020</td><td>0.4 %" in text
    assert "external work</th><td>0</td><td>?</td><td>?</td>" in text
    assert "energy defect</th><td>3</td><td></td><td></td>" in text  # it has no true value
    assert "or more" not in text and "A note." in text


def test_reactions_have_bars_by_name():
    row = {"mesh": 0.01, "total": 0.05}
    supports = [
        {"name": "wall", "on": "left", "reaction": [3.0, 4.0]},
        {"name": "wall", "on": "right", "reaction": [-3.0, 1.0]},
        {"name": "floor", "on": "floor", "reaction": [0.0, 1.0]},
    ]
    reactions = {
        "wall": {"reaction": [0.0, 5.0], "errors": {"reaction": row}},
        "floor": {"reaction": [0.0, 1.0]},
    }
    text = page_of(found(supports=supports, reactions=reactions))
    assert "wall</th><td>0, 5.00</td><td>± 0.05</td><td>1 %</td>" in text
    assert "floor</th><td>0, 1</td><td>?</td><td>?</td>" in text
    without = {name: {"reaction": of["reaction"]} for name, of in reactions.items()}
    text = page_of(found(supports=supports, reactions=without))
    assert "± 0.05" not in text and "wall</th><td>0, 5" in text


def test_what_says_nothing_without_friction_is_not_shown():
    """Neither of the whole, nor of the contact, nor among the errors."""
    quantities = {"normal_force": 2.0, "slip_area": 3.0, "max_slip": 0.1, "friction_work": 0.0}
    errors = {name: {"mesh": 0.01, "total": 0.01} for name in quantities}
    contact = {
        "name": "top", "contact": "unilateral", "law": "none", "parameters": {},
        "quantities": quantities, "errors": errors,
    }  # fmt: skip
    text = page_of(found(quantities=quantities, errors=errors, contacts=[contact]))
    assert text.count("normal force") == 3
    for words in ("slip area", "max slip", "friction work"):
        assert words not in text
    rough = found(quantities=quantities, errors=errors, contacts=[contact | {"law": "static"}])
    assert page_of(rough).count("slip area") == 3


@pytest.mark.parametrize(
    "coefficient, names", [(0.0, ["open", "in contact"]), (0.3, ["open", "stick", "slip"])]
)
def test_without_friction_the_view_tells_contact_alone(coefficient, names, tmp_path):
    scene = slab(100, coefficient=coefficient)
    files.solve_and_write(Run(scene, MPI.COMM_SELF), tmp_path)
    points = ContactTable.read(tmp_path / "contact.csv")
    view = make_view(whole_body(tmp_path), read_result(tmp_path), points)
    text = re.search('id="view-data">(.*?)</script>', view_html(view), re.DOTALL)[1]
    data = json.loads(gzip.decompress(base64.b64decode(text)))
    assert data["statusNames"] == names and len(data["statusColours"]) == len(names)
    status = np.frombuffer(base64.b64decode(data["status"][-1]), "<f4")
    assert status.min() == -1 and 1 <= status.max() < len(names)


def test_a_run_without_an_answer_says_what_to_try(tmp_path):
    scene = with_solver(slab(600), max_iterations=1)
    result = files.solve_and_write(Run(scene, MPI.COMM_SELF), tmp_path)
    assert not result.converged
    pictures = write_report(tmp_path)
    assert {picture.path.name for picture in pictures} == {"convergence.png"}
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    reader = Reader(text)
    assert "Not converged" in text and html(result.verdict) in text
    assert reader.ids[0] == "advice" and "solver.max_iterations" in text
    assert "pictures" not in reader.ids and "view-3d" not in reader.ids
    assert f"{result.steps[-1]['residual_history'][0]:.3e}" in text
    assert main(["report", str(tmp_path)]) == 0


def test_a_history_that_ended_early_shows_its_last_step(tmp_path):
    scene = unanswered()
    result = files.solve_and_write(Run(scene, MPI.COMM_SELF, block(MPI.COMM_SELF)), tmp_path)
    assert not result.converged and len(result.steps) == 3
    write_report(tmp_path)
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    reader = Reader(text)
    assert reader.ids[:3] == ["view-step", "steps-data", "advice"]
    assert {"pictures", "view-3d"} <= set(reader.ids)
    assert "of the last load step that was done" in text
    assert "deformed.png" in {image["data-file"] for image in reader.images}
    assert text.count('<th scope="row">3</th>') >= 1  # the step without an answer


def unanswered() -> Scene:
    """A block between rough pads, pulled on the way harder than these can hold it."""
    pulled = Load("x1", traction=(3, 0), path=Path(time=(0, 0.5, 1), factor=(0, 1, 0.1)).__call__)
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(pulled,),
        contact=(Contact("y1", pressure=20, friction_coefficient=0.05, law="incremental"),),
        steps=Steps(8),
    )


def cut_off(name):
    def damage(folder):
        (path,) = folder.glob(name)
        path.write_bytes(path.read_bytes()[:-300])

    return damage


def garbled(folder):
    (path,) = folder.glob("fields_p0_*.vtu")
    path.write_bytes(path.read_bytes().replace(b"displacement", b"something", 1))


def cut_to_lines(path, number):
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(lines[:number]))


def replaced(path, text, other):
    before = path.read_text(encoding="utf-8")
    assert text in before
    path.write_text(before.replace(text, other, 1), encoding="utf-8")


DAMAGES = {
    "a piece is cut off": (cut_off("fields_p0_*.vtu"), "fields_are_cut"),
    "a grid is cut off": (cut_off("*.pvtu"), "fields_grid_is_cut"),
    "a field is missing": (garbled, "fields_lack_displacement"),
    "a piece is gone": (
        lambda folder: next(folder.glob("*.vtu")).unlink(),
        "fields_piece_missing",
    ),
    "the series is empty": (
        lambda folder: (folder / "fields.pvd").write_text("<VTKFile></VTKFile>"),
        "fields_series_is_empty",
    ),
    "points are gone": (
        lambda folder: (folder / "contact.csv").unlink(),
        "contact_table_missing",
    ),
    "points are cut off": (cut_off("contact.csv"), "contact_table_is_cut"),
    "a line of the points is gone": (
        lambda folder: cut_to_lines(folder / "contact.csv", -1),
        "contact_table_lacks_a_point",
    ),
    "points are empty": (
        lambda folder: (folder / "contact.csv").write_text(""),
        "other_columns",
    ),
    "points have a column less": (
        lambda folder: replaced(folder / "contact.csv", ",gap,", ","),
        "other_columns",
    ),
    "a point is no number": (
        lambda folder: replaced(folder / "contact.csv", "\nz0,", "\nz0,x"),
        "contact_table_has_a_letter",
    ),
    "the result is cut off": (cut_off("result.json"), "result_is_cut"),
    "the result is a word": (
        lambda folder: (folder / "result.json").write_text('{"converged": true}'),
        "result_lacks_title",
    ),
    "the result is a list": (
        lambda folder: (folder / "result.json").write_text("[]"),
        "result_a_list",
    ),
    "a part of the result is gone": (
        lambda folder: replaced(folder / "result.json", '"newton_iterations"', '"newton"'),
        "result_lacks_newton_iterations",
    ),
    "a part of the result is another": (
        lambda folder: replaced(folder / "result.json", '"passed": true', '"passed": [2]'),
        "result_passed_is_a_list",
    ),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_files_are_named(damage, run, tmp_path):
    shutil.copytree(run[0], tmp_path / "damaged")
    (tmp_path / "damaged/report.html").unlink()
    action, words = DAMAGES[damage]
    action(tmp_path / "damaged")
    with refused(words):
        write_report(tmp_path / "damaged")
    assert main(["report", str(tmp_path / "damaged")]) == 2
    assert not (tmp_path / "damaged/report.html").exists()


def test_a_library_that_is_missing_is_named(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly", None)
    with refused("pictures_need_plotly"):
        write_report(run[0])


def test_a_scene_of_a_file_says_how_to_make_it_again():
    text = page_of(found(model={"ranks": 2}), 'kinematics = "3D"\n')
    assert "mpirun -n 2 fenics-contact run scene.toml --out again" in text
    text = page_of(found(), 'kinematics = "3D"\n', keeps_scene=False)
    assert "Save the scene above as solved.toml" in text
    assert "fenics-contact run solved.toml --out again" in text
