"""Axes, bars of colours, legends and captions bear the units of a run, if it has some."""

import numpy as np
import pytest

from fenics_contact.report import hysteresis, load_steps
from fenics_contact.report.contacts import curves, maps
from fenics_contact.report.contacts.curves import draw_curves
from fenics_contact.report.contacts.maps import draw_maps
from fenics_contact.report.drawing.figures import surface_of
from fenics_contact.report.drawing.style import in_units, labelled, with_unit
from fenics_contact.report.load_steps import draw_history
from fenics_contact.results.records.record import UnitsRecord
from tests.records import made_contact, made_run
from tests.report.contacts.test_captions import cycled
from tests.report.drawing.test_style import CONTACT, points, sheet, strip

pytestmark = pytest.mark.serial
MM_N = UnitsRecord(length="mm", force="N", stress="MPa", energy="mJ")


@pytest.fixture
def labels(monkeypatch):
    """All words on axes, and on bars of colours, which are axes, of what is drawn."""
    found = []

    def collect(figure, path, tight=False):
        for panel in figure.axes:
            found.extend([panel.get_xlabel(), panel.get_ylabel()])
            found.extend(panel.get_legend_handles_labels()[1])

    for module in (curves, maps, load_steps, hysteresis):
        monkeypatch.setattr(module, "save", collect)
    return found


def draw_all(folder, units):
    with in_units(units):
        line = strip(lambda p: 0 * p, lambda x: 0 * x, 41)
        draw_curves(line, points(np.linspace(-1, 1, 41)), CONTACT, "xy", folder / "line.png")
        x, y = (grid.ravel() for grid in np.meshgrid(*2 * [np.linspace(-1, 1, 15)]))
        draw_maps(sheet(15), points(x, y, normal=(0, 0, 1)), CONTACT, folder / "map.png")
        draw_history(folder, made_run(cycled()))


def test_every_axis_that_measures_something_names_its_unit(labels, tmp_path):
    draw_all(tmp_path, MM_N)
    said = {label for label in labels if label}
    assert {
        *("contact pressure, $p$ (MPa)", r"friction traction, $\sigma_T$ (MPa)"),
        *("position along the surface, $x$ (mm)", r"friction traction, $|\sigma_T|$ (MPa)"),
        *("$x$ (mm)", "$y$ (mm)", "normal force, $P$ (N)", "area, $A$ (mm²)", "energy (mJ)"),
        *("displacement, $u_x$ (mm)", "friction force, $Q_x$ (N)"),
    } <= said
    assert any(label.startswith(r"$\Delta W = ") and label.endswith("$ mJ") for label in said)
    axes = {label for label in said if label[0] != "_" and ", " in label}  # none of a legend
    assert {label for label in axes if "(" not in label} == {
        *("pseudo-time, $t$", r"friction bound, $\pm\mu p$", "work done, $W$", "dissipated, $D$"),
        "'top', $Q_x$",
    }


def test_without_units_there_are_no_brackets(labels, tmp_path):
    draw_all(tmp_path, None)
    assert labels and not any("(" in label or "MPa" in label for label in labels)


def test_units_end_with_the_run_that_has_them():
    with in_units(MM_N), pytest.raises(ZeroDivisionError):
        assert (
            labelled("gap", "length") == "gap (mm)" and with_unit(1.23456, "stress") == "1.235 MPa"
        )
        raise ZeroDivisionError
    assert labelled("gap", "length") == "gap" and with_unit("1", "stress") == "1"
    with in_units(MM_N):
        assert labelled("share", "") == "share"


@pytest.mark.parametrize(
    ("name", "slave", "said"),
    [
        ("seat of the head", "seat", "'seat of the head'"),
        ("seat", "seat", "'seat' against 'head'"),
        ("head", "seat", "'head' against 'seat'"),
    ],
)
def test_pictures_call_a_contact_by_its_name(name, slave, said):
    assert surface_of(made_contact(name=name, slave=slave, master="head")) == said
    assert surface_of(made_contact(name=name)) == f"'{name}'"
