"""The page of a sweep: its numbers are those of the files, and what is not known stays so."""

import csv
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.report.page.sweep import write_sweep_page
from tests.messages import refused
from tests.report.sweep.sweeps import (
    COEFFICIENT,
    INDENTATION,
    Answered,
    data_of,
    disc,
    hertz,
    line,
    numbers_of,
    positions_of,
    write_sweep,
)

pytestmark = [
    pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do"),
]

DEPTHS = [0.25, 0.5, 1.0, 2.0]
UNITS = {"length": "mm", "force": "N", "stress": "MPa", "energy": "mJ"}
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\u202e"


@pytest.fixture(autouse=True)
def _plotly():
    pytest.importorskip("plotly")


def column(data, label):
    """The values of a quantity, or of a component."""
    (found,) = [
        part["values"]
        for quantity in data["quantities"]
        for part in quantity["parts"]
        if part["label"] == label
    ]
    return found


def quantity(data, name, owner=""):
    (found,) = [q for q in data["quantities"] if (q["name"], q["owner"]) == (name, owner)]
    return found


class Texts(HTMLParser):
    """The tags of a page, and its text outside of scripts."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.words, self.inside = [], [], False
        self.feed(page.read_text(encoding="utf-8"))
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.inside = tag in ("script", "style")

    def handle_endtag(self, tag):
        self.inside = False

    def handle_data(self, words):
        if not self.inside:
            self.words.append(words)


def test_numbers_are_those_of_the_table(tmp_path):
    write_sweep(tmp_path, {INDENTATION: DEPTHS}, hertz)
    page = write_sweep_page(tmp_path)
    assert page == tmp_path / "sweep.html"
    data = data_of(page)
    with (tmp_path / "sweep.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    for label, name in {
        "normal force": "normal_force",
        "friction force x": "friction_force_x",
    }.items():
        assert column(data, label) == [float(row[name]) for row in rows]
    assert quantity(data, "friction force")["bars"] == [
        float(row["friction_force_error"]) for row in rows
    ]
    force = np.array(column(data, "normal force"))
    assert force[1:] / force[:-1] == pytest.approx(2**1.5)  # Hertz: F ~ d^(3/2)
    assert data["keys"][0]["values"] == DEPTHS


def test_quantities_that_matter_come_first_and_zeros_last(tmp_path):
    def answer(depth):
        found = hertz(depth)
        found.columns = {"penalty_energy": 1.0, "contact_area": 0.0} | found.columns
        return found

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer)
    names = [one["name"] for one in data_of(write_sweep_page(tmp_path))["quantities"]]
    assert names == [
        *("normal force", "friction force", "max contact pressure", "stick area", "slip area"),
        *("contact radius", "penalty energy", "undecided points", "indentation", "contact area"),
    ]


def test_bars_that_are_missing_are_not_zero(tmp_path):
    write_sweep(tmp_path, {INDENTATION: DEPTHS}, hertz)
    data = data_of(write_sweep_page(tmp_path))
    peak = quantity(data, "max contact pressure")
    assert peak["bars"] == [None] * 4
    assert all(said.endswith("± ?") for said in peak["said"])
    force = quantity(data, "normal force")
    # 4/3 E/(1 - ν²) √R d^(3/2) = 4144.2; with a bar of 1 % of it, 41.4, rounded up
    assert force["said"][2] == "4140 ± 50"
    assert quantity(data, "friction force")["said"][2] == "1040, 0 ± 90"
    assert quantity(data, "undecided points")["said"] == ["3"] * 4  # counts have none


def test_without_any_bars_none_are_asked_for(tmp_path):
    def answer(depth):
        found = hertz(depth)
        found.columns = {
            name: value for name, value in found.columns.items() if not name.endswith("_error")
        }
        return found

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer)
    page = write_sweep_page(tmp_path)
    force = quantity(data_of(page), "normal force")
    assert force["bars"] is None
    assert force["said"][2] == "4144.22"
    assert "No errors were estimated" in Texts(page).text


def test_points_that_failed_have_no_value_and_say_why(tmp_path):
    def answer(depth):
        return "Not converged: <b>30</b> steps." if depth == 1.0 else hertz(depth)

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer)
    page = write_sweep_page(tmp_path)
    data, text = data_of(page), Texts(page).text
    assert data["codes"] == [0, 0, 3, 0]
    force = quantity(data, "normal force")
    assert force["parts"][0]["values"][2] is None and force["bars"][2] is None
    assert force["said"][2] == ""
    assert data["failures"] == {"2": "Not converged: <b>30</b> steps."}
    assert "1 of 4 points have no answer that can be trusted" in text
    assert "Answered: 3 of 4 points in 2.5 s, the bulk was factorised once." in text
    assert f"{INDENTATION} = 1 Not converged: <b>30</b> steps." in text
    assert 2 not in [row for row, *_ in data["states"]]


def test_an_answer_that_failed_a_check_is_marked_though_it_has_numbers(tmp_path):
    def answer(depth):
        found = hertz(depth)
        found.code = 4 if depth == 2.0 else 0
        return found

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer)
    page = write_sweep_page(tmp_path)
    data = data_of(page)
    assert column(data, "normal force")[3] is not None
    assert data["outcomes"] == ["passed", "passed", "passed", "failed a check"]
    assert f"{INDENTATION} = 2 failed a check" in Texts(page).text


def test_no_answer_at_all(tmp_path):
    write_sweep(tmp_path, {INDENTATION: DEPTHS}, lambda depth: "It slides away.")
    for has_states in (True, False):
        if not has_states:
            (tmp_path / "states.npz").unlink()
        data = data_of(write_sweep_page(tmp_path))
        assert data["quantities"] == [] and data["states"] == []


def test_states_are_those_of_the_formula(tmp_path):
    write_sweep(tmp_path, {COEFFICIENT: [0.2, 0.4], INDENTATION: DEPTHS}, lambda m, d: hertz(d, m))
    data = data_of(write_sweep_page(tmp_path))
    assert [state[:3] for state in data["states"]] == [[row, 0, 0] for row in range(8)]
    assert len(data["shapes"]) == 1  # the same points everywhere
    position = positions_of(data, 0)
    assert position == pytest.approx(line()[:, 0][None], abs=1e-6)
    for row, (coefficient, depth) in enumerate([(m, d) for m in (0.2, 0.4) for d in DEPTHS]):
        arrays = hertz(depth, coefficient).arrays
        for name, key in {
            "contact pressure": "contact_pressure",
            "friction traction": "traction_x",
            "slip": "slip_x",
            "gap": "gap",
        }.items():
            exact = arrays[key]
            assert numbers_of(data, row, name) == pytest.approx(exact, abs=2e-5 * abs(exact).max())
    assert data["rough"] == {"0": True}


def test_states_over_a_surface_have_lengths_of_vectors(tmp_path):
    def answer(depth):
        found = hertz(depth, at=disc())
        found.arrays["traction_y"] = 0.75 * found.arrays["traction_x"]
        found.arrays["gap"] = np.where(found.arrays["gap"] > 0, np.inf, 0.0)
        return found

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer)
    data = data_of(write_sweep_page(tmp_path))
    assert data["shapes"][0]["labels"] == ["x", "y"]
    assert positions_of(data, 0) == pytest.approx(disc()[:, :2].T)
    exact = 1.25 * hertz(1.0, at=disc()).arrays["traction_x"]
    assert numbers_of(data, 2, "friction traction") == pytest.approx(exact, abs=2e-5 * exact.max())
    assert np.isnan(numbers_of(data, 2, "gap")).any()


def test_states_of_several_contacts_that_stand_in_any_order(tmp_path):
    def answer(depth):
        found, other = hertz(depth), hertz(2 * depth, at=line(11))
        other.arrays["contact"] = other.arrays["contact"] + 1
        both = {name: np.concatenate([a, other.arrays[name]]) for name, a in found.arrays.items()}
        mixed = np.random.default_rng(5).permutation(len(both["x"]))
        return Answered(found.columns, {name: array[mixed] for name, array in both.items()})

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer, contacts=["top", "side"])
    data = data_of(write_sweep_page(tmp_path))
    assert [state[:2] for state in data["states"]] == [[row, n] for row in range(4) for n in (0, 1)]
    for row, depth in enumerate(DEPTHS):
        for contact, one in enumerate([hertz(depth), hertz(2 * depth, at=line(11))]):
            exact = one.arrays["contact_pressure"]
            found = numbers_of(data, 2 * row + contact, "contact pressure")
            assert found == pytest.approx(exact, abs=1e-4 * exact.max())


def test_the_page_is_valid_html(tmp_path):
    html5lib = pytest.importorskip("html5lib")
    vary = {COEFFICIENT: [0.2, 0.4], INDENTATION: DEPTHS, "contact.0.law": ["static"]}
    write_sweep(tmp_path, vary, lambda m, d, law: HOSTILE if d > 1 else hertz(d, m))
    text = write_sweep_page(tmp_path).read_text(encoding="utf-8")
    without = re.sub("(<script[^>]*>).*?(</script>)", r"\1\2", text, flags=re.DOTALL)
    parser = html5lib.HTMLParser(strict=False)
    parser.parse(without)
    assert parser.errors == []


def test_words_and_lists_are_values_of_keys(tmp_path):
    vary = {"contact.0.law": ["none", "static"], "load.0.traction": [[1, 0], [2, 0]], "x.y": [1, 1]}
    write_sweep(tmp_path, vary, lambda law, load, y: hertz(load[0], 0.0 if law == "none" else 0.5))
    page = write_sweep_page(tmp_path)
    keys = data_of(page)["keys"]
    assert [key["said"] for key in keys] == [["none", "static"], ["[1, 0]", "[2, 0]"], ["1", "1"]]
    assert [key["values"] for key in keys] == [None, None, None]
    assert "Varied: contact.0.law = none, static." in Texts(page).text


def test_quantities_of_contacts_supports_and_preloads_by_name(tmp_path):
    def answer(depth):
        columns = {
            "normal_force": None, "upper.contact.normal_force": depth, "lower.normal_force": 2.0,
            "lower.normal_force_error": 0.125, "bolt.force": 5.0, "bolt.elongation": 0.5,
            "left.reaction_x": 1.0, "left.reaction_y": 3.0, "left.reaction_error": 0.5,
            "displacement_a.b_x": 0.1, "displacement_a.b_y": 0.2, "displacement_a.b_error": 0.01,
        }  # fmt: skip
        return Answered(columns, hertz(depth).arrays)

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer, units=UNITS, title="")
    page = write_sweep_page(tmp_path)
    data = data_of(page)
    found = {
        (q["owner"], q["label"]): (len(q["parts"]), q["bars"] and q["bars"][0])
        for q in data["quantities"]
    }
    assert found == {
        ("upper.contact", "normal force (N)"): (1, None),
        ("lower", "normal force (N)"): (1, 0.125),
        ("bolt", "force (N)"): (1, None),
        ("bolt", "elongation (mm)"): (1, None),
        ("left", "reaction (N)"): (2, 0.5),
        ("", "displacement a.b (mm)"): (2, 0.01),
    }
    assert quantity(data, "reaction", "left")["said"][0] == "1.0, 3.0 ± 0.5"
    assert quantity(data, "normal force", "upper.contact")["said"][0] == "0.25 ± ?"
    assert data["keys"][0]["label"] == f"{INDENTATION} (mm)"
    assert data["labels"]["contact pressure"] == "contact pressure (MPa)"
    assert "4 values from" not in Texts(page).text  # few values are all said
    assert f"Varied: {INDENTATION} = 0.25, 0.5, 1, 2 mm." in Texts(page).text


def test_what_is_the_whole_models_is_said_once(tmp_path):
    def answer(depth):
        found = hertz(depth)
        own = {f"top.{name}": value for name, value in found.columns.items()}
        other = {"left.reaction_x": depth, "right.reaction_x": 1.0, "reaction_x": depth + 1}
        found.columns |= own | other
        return found

    write_sweep(tmp_path, {INDENTATION: DEPTHS}, answer)
    names = [(q["owner"], q["name"]) for q in data_of(write_sweep_page(tmp_path))["quantities"]]
    assert {owner for owner, _ in names} == {"", "left", "right"}
    assert [owner for owner, name in names if name == "reaction"] == ["left", "right", ""]


def test_labels_are_text_and_never_html(tmp_path):
    def answer(law):
        if law != "a":
            return HOSTILE
        found = hertz(1.0)
        found.columns = {f"{HOSTILE}.normal_force": 1.0}
        return found

    texts = {"title": HOSTILE, "scene": HOSTILE, "contacts": [HOSTILE]}
    write_sweep(tmp_path, {f"contact.{HOSTILE}": ["a", HOSTILE]}, answer, **texts)
    page = write_sweep_page(tmp_path)
    found = Texts(page)
    assert [tag for tag, _ in found.tags].count("script") == 3
    assert "img" not in [tag for tag, _ in found.tags]
    assert "\u202e" not in page.read_text(encoding="utf-8")
    assert HOSTILE.replace("\u202e", "\\u202e") in found.text
    assert data_of(page)["contacts"] == [HOSTILE.replace("\u202e", "\\u202e")]


def test_nothing_is_fetched_and_the_link_is_to_the_table(tmp_path):
    write_sweep(tmp_path, {INDENTATION: DEPTHS}, hertz)
    tags = Texts(write_sweep_page(tmp_path)).tags
    assert [values["href"] for tag, values in tags if tag == "a"] == ["sweep.csv"]
    assert not [values for tag, values in tags if "src" in values]
    (policy,) = [v["content"] for tag, v in tags if v.get("http-equiv")]
    assert policy.startswith("default-src 'none'")


def test_a_thousand_points_take_less_than_8_mb(tmp_path):
    noise = np.random.default_rng(1).normal(size=(10, 300))

    def answer(coefficient, depth):
        found = hertz(depth, coefficient, at=line(300))
        found.arrays["contact_pressure"] *= 1 + 0.1 * noise[int(10 * depth) % 10]
        return found

    vary = {COEFFICIENT: list(np.linspace(0.1, 1, 10)), INDENTATION: list(np.linspace(0.1, 2, 100))}
    write_sweep(tmp_path, vary, answer)
    page = write_sweep_page(tmp_path)
    data = data_of(page)
    assert len(data["states"]) == 1000 and data["thinned"] == ""
    assert page.stat().st_size < 8e6


def test_what_is_larger_is_thinned_out_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr("fenics_contact.report.page.sweep_states._MOST_ENTRIES", 2000)
    write_sweep(
        tmp_path, {INDENTATION: [0.1 * n for n in range(1, 11)]}, lambda d: hertz(d, at=line(1000))
    )
    data = data_of(write_sweep_page(tmp_path))
    assert data["thinned"] == (
        "To stay small, this page has one of 2 contact points and the contact at 4 of 10 points "
        "of the sweep; states.npz has all."
    )
    assert [row for row, *_ in data["states"]] == [0, 3, 6, 9]
    exact = hertz(0.1, at=line(1000)).arrays["contact_pressure"][::2]
    assert numbers_of(data, 0, "contact pressure") == pytest.approx(exact, abs=1e-4 * exact.max())


def test_quantities_and_failures_of_very_many_points_are_left_out(tmp_path, monkeypatch):
    monkeypatch.setattr("fenics_contact.report.page.sweep._MOST_CELLS", 8)
    monkeypatch.setattr("fenics_contact.report.page.sweep._MOST_FAILURES", 1)
    write_sweep(tmp_path, {INDENTATION: DEPTHS}, lambda d: "No." if d > 0.5 else hertz(d))
    page = write_sweep_page(tmp_path)
    text = Texts(page).text
    names = [one["name"] for one in data_of(page)["quantities"]]
    assert names == ["normal force", "friction force"]
    assert "this page leaves out 6 quantities; sweep.csv has all." in text
    assert "2 of 4 points have no answer" in text
    assert text.count("No.") == 1 and "And 1 more; sweep.json has all." in text


def changed(folder, **values):
    path = folder / "sweep.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | values))


def replaced(name, before, after):
    def change(folder):
        path = folder / name
        assert before in path.read_text()
        path.write_text(path.read_text().replace(before, after, 1))

    return change


def arrays(**values):
    def change(folder):
        with np.load(folder / "states.npz") as file:
            found = dict(file)
        for name, value in values.items():
            found[name] = value(found[name])
        np.savez(folder / "states.npz", **{k: v for k, v in found.items() if v is not None})

    return change


def overwritten(path):
    content = bytearray(path.read_bytes())
    content[60:160] = bytes(100)
    path.write_bytes(content)


def cut(path):
    path.write_bytes(path.read_bytes()[:-200])


DAMAGES = [
    (lambda f: (f / "sweep.json").unlink(), "sweep_record_is_missing"),
    (lambda f: (f / "sweep.csv").unlink(), "sweep_table_is_missing"),
    (lambda f: (f / "states.npz").unlink(), "sweep_states_are_missing"),
    (lambda f: (f / "sweep.json").write_text("{"), "sweep_record_is_cut"),
    (lambda f: (f / "sweep.json").write_text("[" * 100_000), "sweep_record_is_too_deep"),
    (lambda f: (f / "sweep.json").write_bytes(b"\xff\xfe"), "sweep_record_is_no_text"),
    (lambda f: (f / "sweep.json").write_text("{}"), "sweep_record_is_empty"),
    (lambda f: changed(f, rows=5), "sweep_has_other_rows"),
    (lambda f: changed(f, vary={}, rows=1), "sweep_varies_nothing"),
    (lambda f: changed(f, vary={"other": DEPTHS}), "sweep_table_of_other_keys"),
    (lambda f: changed(f, failures={"a": "b"}), "sweep_failures_of_a_letter"),
    (lambda f: (f / "sweep.csv").write_text(""), "sweep_table_of_other_keys"),
    (replaced("sweep.csv", "\n0.25,", "\n0.3,"), "sweep_table_of_other_values"),
    (replaced("sweep.csv", ",exit_code", ",exit"), "sweep_table_of_other_keys"),
    (replaced("sweep.csv", "\n2.0,0,", "\n2.0,0\n2.0,0,"), "sweep_table_has_a_row_more"),
    (replaced("sweep.csv", "\n2.0,0,", "\n2.0,0,,"), "sweep_table_is_not_whole"),
    (replaced("sweep.csv", "\n2.0,0,", "\n2.0,0,x"), "sweep_table_has_a_letter"),
    (replaced("sweep.csv", "\n2.0,0,", "\n2.0,good,"), "sweep_code_is_a_word"),
    (lambda f: (f / "states.npz").write_bytes(b""), "sweep_states_are_empty"),
    (lambda f: (f / "states.npz").write_bytes(b"PK\x03\x04" + bytes(50)), "sweep_states_no_zip"),
    (lambda f: overwritten(f / "states.npz"), "sweep_states_are_overwritten"),
    (lambda f: cut(f / "states.npz"), "sweep_states_no_zip"),
    (arrays(gap=lambda a: None), "sweep_states_lack_gap"),
    (arrays(gap=lambda a: a[:-1]), "sweep_states_of_two_lengths"),
    (arrays(gap=lambda a: a.astype(object)), "sweep_states_of_objects"),
    (arrays(gap=lambda a: a.astype(str) + "m"), "sweep_states_of_texts"),
    (arrays(point=lambda a: a + 1), "sweep_states_of_another_point"),
    (arrays(contact=lambda a: a - 1), "sweep_states_of_another_contact"),
    (arrays(status=lambda a: a + 1), "sweep_states_of_another_status"),
    (arrays(point=lambda a: a + 0.5), "sweep_states_of_another_point"),
    (arrays(x=lambda a: a * np.nan), "sweep_states_have_nan"),
]  # fmt: skip


@pytest.mark.parametrize(("damage", "said"), DAMAGES, ids=[said for _, said in DAMAGES])
def test_files_that_are_missing_or_damaged_are_refused(damage, said, tmp_path):
    write_sweep(tmp_path, {INDENTATION: DEPTHS}, hertz)
    damage(tmp_path)
    with refused(said):
        write_sweep_page(tmp_path)
    assert not (tmp_path / "sweep.html").exists()
