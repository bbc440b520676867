"""What is said below the curves over the load steps, of results made up for the purpose."""

import numpy as np
import pytest

from fenics_contact import history_pictures
from fenics_contact.history_pictures import draw_history

pytestmark = pytest.mark.serial


@pytest.fixture(autouse=True)
def unsaved(monkeypatch):
    """Figures are made, but no files, which take the time."""
    monkeypatch.setattr(history_pictures, "save", lambda figure, path: None)


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
    loops = draw_history(tmp_path, cycled(**change))[0]
    assert said in loops.caption


@pytest.mark.parametrize("law", ["incremental", "none"])
def test_without_friction_nothing_is_said_to_stick(law, tmp_path):
    (areas,) = (p for p in draw_history(tmp_path, cycled(law)) if p.path.stem == "history_areas")
    assert ("stick and slip" in areas.caption) == (law != "none")
    assert areas.caption.endswith(".")
