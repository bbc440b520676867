"""Friction laws of all kinds, solved exactly at the points; and laws that are not."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import Coupling, Material, Obstacle, Steps, Study, Support, run
from fenics_contact.common.errors import SceneError
from tests.messages import refused
from tests.problem.test_coupled_springs import bars, scene
from tests.problem.test_stops import stop
from tests.scenes import with_solver
from tests.simulation.studies.cases import LAW, MU, ON_A_FLOOR, of_contact, square

# Friction coefficients fall to half between these pressures, or slips.
FALLS = (1.0, 3.0), (1.0, 0.5)
SLIPS = (0.0, 2e-4), (1.0, 0.5)
COEFFICIENT = 0.4


def exact(law, **changes):
    contact = {"law": "incremental", "friction_coefficient": COEFFICIENT, "friction_law": law}
    scene = with_solver(of_contact(ON_A_FLOOR, **contact), strategy="exact", errors="none")
    return dataclasses.replace(scene, **changes)


BY_PRESSURE = exact({"kind": "pressure dependent", "pressures": FALLS[0], "shares": FALLS[1]})
BY_SLIP = exact(
    {"kind": "slip dependent", "slips": SLIPS[0], "shares": SLIPS[1]}, steps=Steps(number=3)
)


def of_points(result):
    """Pressure and friction where points slip."""
    points = result.points
    slips = points.status == "SLIP"
    size = np.linalg.norm(points.friction_traction[slips], axis=1)
    return slips, points.contact_pressure[slips], size


def test_friction_by_pressure_is_that_of_the_table() -> None:
    """|t| = μ s(p) p at each point that slips, and no more at those that stick."""
    found = run(BY_PRESSURE, body=square())
    assert found.passed
    slips, pressure, size = of_points(found)
    assert slips.sum() > 4
    assert np.ptp(pressure) > 1  # over what the table falls in
    share = np.interp(pressure, *FALLS)
    assert size == pytest.approx(COEFFICIENT * share * pressure, rel=1e-10)


def test_friction_by_slip_is_that_of_the_table() -> None:
    """The coefficient of a step goes by how far a point had slid before; all slides one way."""
    body = square()
    before = dataclasses.replace(BY_SLIP, steps=Steps(times=(1 / 3, 2 / 3)))
    first, last = run(before, body=body), run(BY_SLIP, body=body)
    assert last.passed
    slips, pressure, size = of_points(last)
    slid = np.linalg.norm(first.points.slip[slips], axis=1)
    assert slid.max() > 1e-4
    share = np.interp(slid, *SLIPS)
    assert size == pytest.approx(COEFFICIENT * share * pressure, rel=1e-10)


def test_friction_by_a_formula_is_that_formula() -> None:
    law = {"kind": "formula", "bound": "0.3 * p / (1 + p / c)", "parameters": {"c": 4}}
    found = run(of_contact(exact(law), friction_coefficient=0), body=square())
    assert found.passed
    slips, pressure, size = of_points(found)
    assert slips.any()
    assert size == pytest.approx(0.3 * pressure / (1 + pressure / 4), rel=1e-10)


@pytest.mark.parametrize(
    ("scene", "key", "value"),
    [
        (BY_PRESSURE, MU, COEFFICIENT),
        (BY_PRESSURE, f"{LAW}.shares.1", 0.5),
        (BY_SLIP, f"{LAW}.shares.1", 0.5),
    ],
)
def test_their_derivatives_are_differences(scene, key: str, value: float) -> None:
    study, names = Study(scene, body=square()), ("normal_force", "friction_force_x")
    found = study.derivatives(names, [key])
    step = 1e-5 * value
    ahead, behind = (study.quantities({key: value + way * step}) for way in (1, -1))
    for name, of in zip(
        names,
        (lambda q: q["normal_force"], lambda q: q["friction_force"][0]),
        strict=True,
    ):
        slope = (of(ahead.quantities) - of(behind.quantities)) / (2 * step)
        assert found[name][key] == pytest.approx(slope, rel=1e-6)


MOVED = (Material(1000, 0.3, density=1.0),)
WARM = (Material(1000, 0.3, conductivity=1.0, thermal_expansion=1e-5),)
SECTOR = {"on": "x0", "against": "x1", "sectors": 8}
STILL = {"support": (Support("y1", {"x": 0, "y": 0}),)}
TURNED = Obstacle(shape="cylinder", radius=5, position=(0.5, 0), indentation=0.001, moment=0.01)


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        (
            {"friction_law": {"kind": "nonlocal", "averaging_radius": 0.3}},
            "friction law 'nonlocal' at 'y0'",
        ),
        ({"foundation_stiffness": 5.0}, "law 'winkler' at 'y0'"),
        (
            {"normal_law": {"kind": "normal compliance", "coefficient": 1e6, "exponent": 2}},
            "law 'normal compliance' at 'y0'",
        ),
        ({"wear": {"coefficient": 1e-3}}, "wear at 'y0'"),
        ({"obstacle": TURNED}, "an obstacle that a moment turns at 'y0'"),
    ],
)
def test_laws_that_are_not_solved_exactly_are_refused(changes, what: str) -> None:
    scene = of_contact(ON_A_FLOOR, law="incremental", **changes)
    with refused("not_beside_exact_contacts", what=what):
        run(with_solver(scene, strategy="exact", errors="none"), body=square())


def test_stops_are_not_solved_exactly() -> None:
    end = Coupling("a.x1", name="end", force=(1.0, 0))
    given = with_solver(scene(end, spring=(stop(),)), strategy="exact")
    with refused("not_beside_exact_contacts", what="springs with a gap"):
        run(given, body=bars())


@pytest.mark.parametrize(
    ("key", "more"),
    [
        ("motion", {"motion": {"end": 1e-3, "step": 1e-4}, "material": MOVED, "load": (), **STILL}),
        ("heat", {"heat": ({"on": "y1", "temperature": 10},), "material": WARM}),
        ("cyclic_symmetry", {"cyclic_symmetry": SECTOR, "support": ()}),
    ],
)
def test_what_scenes_have_not_beside_exact_contacts(key: str, more: dict[str, object]) -> None:
    rough = of_contact(ON_A_FLOOR, law="incremental")
    with refused("exact_contacts_beside", SceneError, key=key):
        dataclasses.replace(with_solver(rough, strategy="exact"), **more)
