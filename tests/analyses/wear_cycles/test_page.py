"""The page of cycles that wear says what their tables say; tables that are damaged are refused."""

import csv

import numpy as np
import pytest
from mpi4py import MPI
from PIL import Image

from fenics_contact import main
from fenics_contact.analyses.wear_cycles.page import write_wear_page
from fenics_contact.analyses.wear_cycles.pictures import kinds_of
from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle, WornFiles
from fenics_contact.analyses.wear_cycles.worn_history import read_worn
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.simulation.output import run_folder
from tests.messages import refused

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")

POINTS = 9
CYCLES = (1, 2, 5, 11)


def cycle(number, passed_over, in_space=False, contacts=1, slope=0.01):
    """The middle of a line or of a square sticks, what is beside it wears, the ends are open."""
    line = np.linspace(-1, 1, POINTS)
    x, y = (one.ravel() for one in np.meshgrid(line, line)) if in_space else (line, 0 * line)
    away = np.maximum(np.abs(x), np.abs(y))
    count = len(x)
    normals = np.tile((0.0, 0, 1) if in_space else (0.0, 1, 0), (contacts * count, 1))
    depth = 1e-3 * number * ((away > 0.4) & (away < 0.8))
    wears = [depth, *(np.full(count, np.nan) for _ in range(contacts - 1))]
    status = np.where(away > 0.8, "OPEN", "STICK")
    points = ContactPoints(
        contact=np.repeat(np.arange(contacts), count),
        coordinates=np.tile(np.column_stack([x, y, 0 * x]), (contacts, 1)),
        normals=normals,
        gap=np.zeros(contacts * count),
        contact_pressure=np.tile(np.maximum(1 - away**2, 0), contacts),
        friction_traction=0 * normals,
        slip=0 * normals,
        status=np.tile(status, contacts),
        weights=np.ones(contacts * count),
        own={"worn_depth": np.concatenate(wears)},
    )
    found = {
        "worn_volume": 0.002 * number,
        "max_wear_depth": 1e-3 * number,
        "normal_force": 1.0,
        "max_contact_pressure": 1.0,
        "contact_area": 1.6,
        "stick_area": 0.8,
    }
    smooth = {**found, "worn_volume": 0.0, "max_wear_depth": 0.0}
    errors = {"worn_volume": 1e-5 * passed_over, "max_wear_depth": 5e-6 * passed_over}
    every = [found, *(smooth for _ in range(contacts - 1))]
    return WearCycle(
        number=number,
        passed_over=passed_over,
        pressure_change=0.1,
        errors=errors,
        losses=[0.5] * contacts,
        friction_work=7.25,
        stick_areas=[0.3125] * contacts,
        depth_over_width=slope,
        contacts=every,
        points=points,
    )


def write(folder, **said):
    files, before = WornFiles(MPI.COMM_SELF, folder), 0
    for number in CYCLES:
        files.add(cycle(number, number - before - 1, **said))
        before = number


@pytest.mark.pdf
@pytest.mark.serial  # the command line waits for all ranks
def test_the_page_has_what_is_worn_and_pictures(tmp_path, capsys):
    write(tmp_path)
    assert main(["report", str(tmp_path)]) == 0
    assert "wear.html" in capsys.readouterr().out
    text = (tmp_path / "wear.html").read_text(encoding="utf-8")
    for said in (
        "After 11 cycles a volume of 0.02200 ± 0.00005 is worn, at the deepest 0.011000 ±",
        "Cycles: 4 computed, 7 passed over",
        "Work of friction: 7.25.",
        "Deepest wear over half its width: 0.01. At 0.1",
    ):
        assert said in text, said
    assert 'class="verdict ok"' in text
    assert text.count("data:image/png;base64,") == 2
    for name in ("wear.png", "wear_0.png", "wear_0.pdf"):
        assert (tmp_path / name).stat().st_size > 1000


def test_five_cycles_are_a_film(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{__name__}.CYCLES", (*CYCLES, 20))
    write(tmp_path)
    text = write_wear_page(tmp_path).read_text(encoding="utf-8")
    assert text.count("data:image/gif;base64,") == 1
    with Image.open(tmp_path / "wear_0.gif") as film:
        assert film.n_frames == 5


def test_a_run_has_names_and_units(tmp_path):
    write(tmp_path, contacts=2)
    history = read_worn(tmp_path, ["upper", "lower"])
    assert [history.title(number) for number in (0, 1)] == ["'upper'", "'lower'"]
    assert history.is_flat(0)


def test_what_is_steep_is_said(tmp_path):
    write(tmp_path, slope=0.12)
    text = write_wear_page(tmp_path).read_text(encoding="utf-8")
    assert 'class="verdict bad"' in text and "not to be relied on" in text


@pytest.mark.parametrize(("said", "pictures"), [({"in_space": True}, 2), ({"contacts": 2}, 2)])
def test_of_surfaces_and_of_several_contacts(tmp_path, said, pictures):
    """A contact that does not wear has no profile, but its pressure and areas are there."""
    write(tmp_path, **said)
    text = write_wear_page(tmp_path).read_text(encoding="utf-8")
    assert text.count("data:image/png;base64,") == pictures
    assert ("area that never slips, contact 1" in text) == ("contacts" in said)


def test_parts_that_wear_are_told_from_those_that_stick(tmp_path):
    write(tmp_path)
    history = read_worn(tmp_path)
    np.testing.assert_array_equal(history.cycles, CYCLES)
    kinds = kinds_of(history.worn[0])
    np.testing.assert_array_equal(kinds, np.tile([0, 1, 1, 2, 2, 2, 1, 1, 0], (len(CYCLES), 1)))


def change(path, do):
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    do(rows)
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)


@pytest.mark.parametrize(
    ("name", "do", "said"),
    [
        ("wear.csv", lambda rows: rows[0].__setitem__(0, "n"), "wear_table_lacks_cycle"),
        (
            "wear.csv",
            lambda rows: rows[0].__setitem__(rows[0].index("stick_area"), "n"),
            "no_stick_area",
        ),
        ("wear.csv", lambda rows: rows.__delitem__(slice(1, None)), "wear_table_is_empty"),
        ("wear.csv", lambda rows: rows[2].pop(), "wear_table_is_not_whole"),
        (
            "wear.csv",
            lambda rows: rows.reverse() or rows.insert(0, rows.pop()),
            "wear_table_turned",
        ),
        ("wear_profiles.csv", lambda rows: rows.pop(), "wear_profiles_lack_a_point"),
        ("wear_profiles.csv", lambda rows: rows[1].__setitem__(-1, "x"), "wear_status_is_none"),
    ],
)
def test_damaged_tables_are_refused(tmp_path, name, do, said):
    write(tmp_path)
    change(tmp_path / name, do)
    with refused(said):
        write_wear_page(tmp_path)
    assert not (tmp_path / "wear.html").exists()


def test_a_folder_without_profiles(tmp_path):
    write(tmp_path)
    (tmp_path / "wear_profiles.csv").unlink()
    with refused("wear_profiles_cannot_be_read"):
        write_wear_page(tmp_path)


def test_no_file_of_an_earlier_report_outlives_its_run(tmp_path):
    """What the page of cycles that wear has drawn; not what somebody else has put there."""
    names = ("wear.html", "wear.png", "wear_0.png", "wear_0.gif", "animation_0.gif", "own.gif")
    for name in names:
        (tmp_path / name).touch()
    run_folder._clear(tmp_path, run_folder._of_the_end())
    assert [path.name for path in tmp_path.iterdir()] == ["own.gif"]
