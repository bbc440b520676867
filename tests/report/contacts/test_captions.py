"""What is said below pictures, of results made up for the purpose."""

import numpy as np
import pytest

from fenics_contact.analytic.contact import HertzContact
from fenics_contact.report import hysteresis
from fenics_contact.report import load_steps as history_pictures
from fenics_contact.report.contacts import section_stress
from fenics_contact.report.contacts.section_stress import draw_section
from fenics_contact.report.load_steps import draw_history
from fenics_contact.report.recognition import AnalyticContact
from tests.records import made_run
from tests.report.drawing.test_style import CONTACT, points, strip

pytestmark = pytest.mark.serial

HOSTILE = (r"$\frac$", "\u061ca\x1b[2J")


@pytest.fixture(autouse=True)
def unsaved(monkeypatch):
    """Figures are made, but no files, which take the time."""
    for module in (history_pictures, hysteresis, section_stress):
        monkeypatch.setattr(module, "save", lambda figure, path: None)


def cycled(law="incremental", other_work=0.0, turns=1.0, deeper=0.0):
    """An obstacle that is moved to and fro twice, against friction of area π."""
    t = np.linspace(0, 2, 33)
    moved, force = np.cos(2 * np.pi * t), turns * np.sin(-2 * np.pi * t)
    steps = np.diff(moved) * (force[1:] + force[:-1]) / 2
    work = np.append(0, np.cumsum(steps)) + other_work * t
    quantities = [
        {
            "external_work": w,
            "strain_energy": 0.0,
            "friction_work": w,
            "penalty_energy": 0.0,
        }
        for w in work
    ]
    contacts = [
        {
            "quantities": {
                "normal_force": 1.0,
                "indentation": 1 + deeper * s,
                "friction_force": [q, 0.0],
                "obstacle_displacement": [u, 0.0],
                "contact_area": 1.0,
                "stick_area": 0.5,
            }
        }
        for s, u, q in zip(t, moved, force, strict=True)
    ]
    return {
        "contacts": [{"name": "top", "law": law}],
        "steps": [
            {"load_factor": s, "quantities": q, "contacts": [c], "supports": []}
            for s, q, c in zip(t + 1, quantities, contacts, strict=True)
        ],
    }


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, "this drive over it, the energy that it dissipates."),
        ({"other_work": 1.0}, "this drive over it, > 0 if put in."),  # of a load that varies
        ({"deeper": 0.1}, "this drive over it, > 0 if put in."),  # another drive
    ],
)
def test_the_area_of_a_loop_is_what_dissipates_only_where_nothing_else_works(
    change, said, tmp_path
):
    loops = draw_history(tmp_path, made_run(cycled(**change)))[0]
    assert said in loops.caption


@pytest.mark.parametrize("law", ["incremental", "none"])
def test_without_friction_nothing_is_said_to_stick(law, tmp_path):
    (areas,) = (
        p for p in draw_history(tmp_path, made_run(cycled(law))) if p.path.stem == "history_areas"
    )
    assert ("stick and slip" in areas.caption) == (law != "none")
    assert areas.caption.endswith(".")


def test_a_bolt_has_its_force_over_the_load_steps(monkeypatch, tmp_path):
    """And a line at the end of the step after which its length is locked."""
    drawn = {}

    def kept(figure, path):
        figure.draw_without_rendering()
        drawn[path.stem] = figure.axes

    monkeypatch.setattr(history_pictures, "save", kept)
    result = cycled()
    forces = np.linspace(3.0, 2.0, len(result["steps"]))
    for number, (step, force) in enumerate(zip(result["steps"], forces, strict=True)):
        bolt = {"on": "shank", "elongation": 0.1, "initial_strain": -0.01, "locked": number > 1}
        step["preloads"] = {"bolt": bolt | {"force": float(force)}}
    pictures = {picture.path.stem: picture for picture in draw_history(tmp_path, made_run(result))}
    (panel,) = drawn["history_bolts"]
    curve, locked = panel.get_lines()
    assert curve.get_ydata() == pytest.approx(forces)
    assert locked.get_xdata()[0] == result["steps"][1]["load_factor"]
    assert "locked" in pictures["history_bolts"].caption
    without = draw_history(tmp_path, made_run(cycled()))
    assert "history_bolts" not in {picture.path.stem for picture in without}


def test_any_name_can_be_drawn(monkeypatch, tmp_path):
    """Dollars begin no formula, and nothing turns the direction of writing."""
    texts = []

    def drawn(figure, path):
        figure.draw_without_rendering()
        for panel in figure.axes:
            texts.extend([panel.get_title("left"), *panel.get_legend_handles_labels()[1]])

    for module in (history_pictures, hysteresis):
        monkeypatch.setattr(module, "save", drawn)
    result = cycled()
    result["contacts"] = [result["contacts"][0] | {"name": name} for name in HOSTILE]
    for step in result["steps"]:
        step["contacts"] *= 2
    draw_history(tmp_path, made_run(result))
    assert any("\\$\\frac\\$" in text for text in texts), texts
    assert any("\\u061ca\\x1b[2J" in text for text in texts), texts
    assert not any("\u061c" in text or "\x1b" in text for text in texts)


@pytest.mark.parametrize("line", [True, False])
def test_largest_shear_of_hertz(line, tmp_path):
    """Of a line contact with ν = .1 that between σ_z and σ_y = ν (σ_x + σ_z)."""
    s = np.linspace(0, 2, 2001)[1:]
    if line:  # from σ_z = −p₀/√(1 + s²) and σ_x + σ_z = −2 p₀ (√(1 + s²) − s)
        shear, where = 1 / np.sqrt(1 + s**2) - 0.2 * (np.sqrt(1 + s**2) - s), "below the middle"
    else:  # Johnson, (3.45)
        shear, where = 1.5 / (1 + s**2) - 1.1 * (1 - s * np.arctan(1 / s)), "on the axis"
    most = np.argmax(shear)
    said = f"Hertz: {50 * shear[most]:.4g} {where}, at the depth {s[most]:.4g}."
    body = strip(lambda p: 0 * p, lambda x: 0 * x)
    body["stress"] = np.outer(np.asarray(body.points)[:, 0], np.eye(3)[0].repeat(3))
    status = np.where(np.abs(np.linspace(-1, 1, 11)) < 0.5, "STICK", "OPEN")
    rows = points(np.linspace(-1, 1, 11), status=status)
    hertz = HertzContact(force=1.0, radius=1.0, peak=100.0)
    formula = AnalyticContact("Hertz", hertz, line, False, np.zeros(3), 0.1, smooth=True)
    result = made_run({})
    picture = draw_section(body, result, rows, CONTACT, tmp_path / "stress.png", formula)
    assert said in picture.caption
