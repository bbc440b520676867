"""Derivatives by the adjoint are those of whole runs, by central differences, and closed forms."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType

from fenics_contact import (
    Contact,
    InputError,
    Load,
    Material,
    Obstacle,
    Path,
    Profile,
    Scene,
    Steps,
    Study,
    Support,
)
from fenics_contact.contact.laws import friction
from fenics_contact.contact.laws.friction.static import Static
from fenics_contact.contact.laws.friction.tangent_at_points import PrimalDual
from fenics_contact.simulation.sensitivities.values import found_in
from fenics_contact.simulation.studies.changes import with_changes
from tests.scenes import box_body
from tests.simulation.studies.cases import BALL, CASES, DEPTH, FORCE, MU, ON_A_FLOOR, PAD, square
from tests.solve.condensed.stiff_and_soft import Split

EVERY = CASES | {
    "tetrahedra": (PAD, lambda: box_body((3, 3, 2), cell=CellType.tetrahedron), []),
}
AT_ONCE = Path((0, 1), (0, 1))
OBSTACLE = "contact.0.obstacle"
E, NU = "material.0.youngs_modulus", "material.0.poissons_ratio"
# Of a run's quantities: what Newton's method leaves of forces.
ROUND_OFF = 1e-11
# Case of the studies' → changes that make it one load step under several things, quantities, keys.
TABLE = {
    "prescribed": (
        {},
        "friction_force_x external_work max_slip reaction_y x0.reaction_x",
        [MU, "contact.0.pressure", "load.0.traction.0", "load.0.traction.1", NU],
    ),
    "unilateral": (
        {},
        "normal_force friction_force_x reaction_x pressure_integral max_contact_pressure "
        "strain_energy external_work friction_work max_slip penalty_energy",
        [MU, "load.0.traction.0", "support.0.displacement.y", E, NU, "contact.0.penalty_parameter"],
    ),
    "foundation": (
        {},
        "normal_force strain_energy reaction_y",
        ["contact.0.foundation_stiffness", MU, E],
    ),
    "compliance": (
        {},
        "normal_force friction_force_x external_work",
        ["contact.0.normal_law.coefficient", "contact.0.normal_law.exponent", MU],
    ),
    "incremental": (
        {"steps": Steps(times=(0.5, 0.75, 1.0))},
        "normal_force friction_force_x strain_energy max_slip reaction_x",
        [
            MU,
            DEPTH,
            f"{OBSTACLE}.displacement.0",
            f"{OBSTACLE}.radius",
            f"{OBSTACLE}.position.0",
            E,
        ],
    ),
    "half-space": (
        {},
        "normal_force strain_energy external_work max_contact_pressure reaction_y",
        [MU, DEPTH, f"{OBSTACLE}.radius", f"{OBSTACLE}.position.1", E, NU],
    ),
    "in space": (
        {
            f"{OBSTACLE}.shape": "sphere",
            f"{OBSTACLE}.radius": 4.0,
            f"{OBSTACLE}.position": (0.4, 0.45, 0),
        },
        "friction_force_x contact_force_x strain_energy indentation max_contact_pressure",
        [MU, FORCE, "load.0.traction.0", f"{OBSTACLE}.radius", f"{OBSTACLE}.position.0", E],
    ),
    "tetrahedra": (
        {
            f"{OBSTACLE}.shape": "sphere",
            f"{OBSTACLE}.radius": 4.0,
            f"{OBSTACLE}.position": (0.4, 0.45, 0),
        },
        "normal_force friction_force_x strain_energy reaction_x",
        [MU, "load.0.traction.0", f"{OBSTACLE}.radius"],
    ),
    "two bodies": (
        {
            "steps": Steps(),
            "contact.0.law": "static",
            "contact.0.interference": 1e-3,
            "support.1.path": AT_ONCE,
            "support.2.path": AT_ONCE,
            "support.2.displacement.x": 2e-4,
        },
        "normal_force friction_force_x strain_energy external_work max_contact_pressure",
        [MU, "support.1.displacement.y", "support.2.displacement.x", "contact.0.interference", NU],
    ),
    "bolt": (
        {"steps": Steps(), "preload.0.locked_from": None, f"{OBSTACLE}.path": AT_ONCE},
        "seat.normal_force bolt.elongation strain_energy external_work bottom.reaction_y",
        ["preload.0.force", FORCE],
    ),
    "nearly incompressible": (
        {},
        "normal_force strain_energy friction_force_x",
        [MU, "support.0.displacement.y", E, NU],
    ),
}


def study_of(name, changes):
    """Of a case with its automatic parameters given as they are chosen."""
    scene, make, _ = EVERY[name]
    scene = with_changes(scene, changes)
    solver = dataclasses.replace(scene.solver, errors="none", tolerance=1e-13)
    scene = dataclasses.replace(scene, solver=solver)
    body = make()
    study = Study(scene, body=body)
    given = {}
    for number, contact in enumerate(study.solve().contacts):
        for key in ("penalty_parameter", "regularisation_parameter"):
            used = contact.parameters.get(key)
            if used and found_in(scene, f"contact.{number}.{key}") == "auto":
                given[f"contact.{number}.{key}"] = used
    study.scene = with_changes(scene, given)
    return study


def value_of(result, name):
    """A quantity of a result by its name."""
    owner, _, quantity = name.rpartition(".")
    axis = "xyz".find(quantity[-1]) if quantity[-2:] in ("_x", "_y", "_z") else None
    quantity = quantity if axis is None else quantity[:-2]
    found = dict(result.quantities)
    for contact in result.contacts:
        found |= contact.quantities if contact.name == owner else {}
    for support in result.supports:
        found |= {"reaction": support.reaction} if support.name == owner else {}
    if owner in result.preloads:
        found = vars(result.preloads[owner])
    return found[quantity] if axis is None else found[quantity][axis]


def differences(study, of, key, share=3e-4):
    """Central differences of whole runs; and what their round-off may be."""
    number = found_in(study.scene, key)
    step = share * (abs(number) or 1.0)
    ends = [study.solve({key: number + sign * step}) for sign in (1, -1)]
    values = np.array([[value_of(end, name) for name in of] for end in ends])
    return (values[0] - values[1]) / (2 * step), ROUND_OFF * np.abs(values).max(axis=0) / step


def errors(study, of, by):
    """Of derivatives, over 1e-6 of them, the differences' round-off or their scatter over steps."""
    found = study.derivatives(of, by)
    worst = {}
    for key in by:
        expected, noise = differences(study, of, key)
        off = np.abs(np.array([found[name][key] for name in of]) - expected)
        allowed = np.maximum(1e-6 * np.abs(expected), noise)
        if (off > allowed).any():
            scatter = 3 * np.abs(expected - differences(study, of, key, 1e-4)[0])
            allowed = np.maximum(allowed, scatter)
        worst |= {(name, key): error for name, error in zip(of, off / allowed, strict=True)}
    return worst


@pytest.mark.parametrize("name", TABLE)
def test_derivatives_are_central_differences_of_runs(name):
    changes, of, by = TABLE[name]
    found = errors(study_of(name, changes), of.split(), by)
    assert {pair: error for pair, error in found.items() if error > 1} == {}


@pytest.mark.parametrize("name", ["in space", "two bodies"])
def test_the_same_with_stiff_and_soft_apart(name, monkeypatch):
    changes, of, by = TABLE[name]
    study = study_of(name, changes)
    expected = study.derivatives(of.split(), by)
    split = Split(monkeypatch)
    found = study.derivatives(of.split(), by)
    split.require_used()
    for quantity, slopes in expected.items():
        size = max(abs(slopes[key] * found_in(study.scene, key)) for key in by)
        for key in by:
            off = found[quantity][key] - slopes[key]
            assert abs(off * found_in(study.scene, key)) <= 1e-7 * size, (quantity, key)


def test_the_tangent_with_the_bound_held_is_not_the_true_one(monkeypatch):
    def nothing(tangent, slope):
        return np.zeros((*slope.shape, slope.shape[1]))

    monkeypatch.setattr(PrimalDual, "coupling", nothing)
    study = study_of("half-space", {})
    found = errors(study, ["normal_force"], [DEPTH, MU])
    assert min(found.values()) > 1e3  # a thousandth of the derivative


def uniform_block(**load):
    """A smooth block between a plate that is moved down and a stiff floor: stress is uniform."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        symmetry=("x0",),
        support=(Support("y1", {"y": -DELTA}),),
        contact=(Contact("y0", penalty_parameter=PENALTY),),
        **load,
    )


DELTA, PENALTY, WIDTH, HEIGHT = 1e-3, 1e-4, 2.0, 1.0


def test_derivatives_of_a_uniform_stress_are_those_of_the_formula():
    """Force W δ / c and energy W δ² h (1 − ν²) / (2 E c²), c = h (1 − ν²)/E + ε₁."""
    young, solid = 1000.0, 0.3
    soft = 1 - solid**2
    c = HEIGHT * soft / young + PENALTY
    force = WIDTH * DELTA / c
    by_c = {
        E: -HEIGHT * soft / young**2,
        NU: -2 * solid * HEIGHT / young,
        "contact.0.penalty_parameter": 1.0,
    }
    study = Study(uniform_block(), body=box_body((3, 2), (WIDTH, HEIGHT)))
    down = "support.0.displacement.y"
    of = ["normal_force", "y1.reaction_y", "strain_energy", "external_work", "max_contact_pressure"]
    found = study.derivatives(of, [*by_c, down, "contact.0.interference"])
    for key, slope in by_c.items():
        assert found["normal_force"][key] == pytest.approx(-force / c * slope, rel=1e-9)
        assert found["y1.reaction_y"][key] == pytest.approx(force / c * slope, rel=1e-9)
        assert found["external_work"][key] == pytest.approx(-DELTA * force / c * slope, rel=1e-8)
        own = WIDTH * DELTA**2 / 2 * (c - PENALTY)  # over c²
        partly = 0.0 if slope == 1.0 else WIDTH * DELTA**2 / 2 * slope / c**2
        expected = partly - 2 * own / c**3 * slope
        assert found["strain_energy"][key] == pytest.approx(expected, rel=1e-8)
    assert found["normal_force"][down] == pytest.approx(-WIDTH / c, rel=1e-9)
    assert found["max_contact_pressure"][down] == pytest.approx(-1 / c, rel=1e-9)
    assert found["normal_force"]["contact.0.interference"] == pytest.approx(WIDTH / c, rel=1e-9)
    assert found["external_work"][down] == pytest.approx(-2 * force, rel=1e-8)


def test_a_sphere_without_friction_is_that_of_hertz_but_for_the_mesh():
    """F = (4/3) E* √R d^(3/2): from cell to cell the discrete derivatives jump by some per cent."""
    ball = with_changes(BALL, {MU: 0.0, DEPTH: 0.04, "contact.0.penalty_parameter": 1e-6})
    study = Study(ball, body=box_body((14, 14), (1, 1)))
    young, ratio, radius, depth = 1000.0, 0.3, 4.0, 0.04
    force = 4 / 3 * young / (1 - ratio**2) * np.sqrt(radius) * depth**1.5
    found = study.derivatives(["normal_force"])["normal_force"]
    assert found[DEPTH] == pytest.approx(1.5 * force / depth, rel=0.05)
    assert found[f"{OBSTACLE}.radius"] == pytest.approx(force / (2 * radius), rel=0.1)
    assert found[E] == pytest.approx(force / young, rel=0.02)
    assert found[NU] == pytest.approx(force * 2 * ratio / (1 - ratio**2), rel=0.06)
    # Whatever the mesh: in units of stress, F is E f(E ε₁).
    own = study.quantities().contacts[0]["normal_force"]
    of_penalty = 1e-6 * found["contact.0.penalty_parameter"]
    assert young * found[E] - of_penalty == pytest.approx(own, rel=1e-8)
    assert found[f"{OBSTACLE}.position.1"] == pytest.approx(-found[DEPTH], rel=1e-8)


def test_all_numbers_that_have_a_derivative_are_found():
    scene = dataclasses.replace(
        ON_A_FLOOR,
        load=(Load("x1", pressure=Profile("y", (0, 1), (-1, -0.5))),),
        contact=(Contact("y0", friction_coefficient=0.3, obstacle=Obstacle("plane")),),
    )
    found = Study(scene, body=square()).derivatives(["normal_force"])["normal_force"]
    assert sorted(found) == [
        MU,
        "load.0.pressure.values.0",
        "load.0.pressure.values.1",
        NU,
        E,
        "support.0.displacement.x",
        "support.0.displacement.y",
    ]


@pytest.mark.parametrize(
    ("of", "by", "said"),
    [
        ("contact_area", MU, "of: 'contact_area' has no derivatives"),
        ("friction_force", MU, "of: 'friction_force' is a vector"),
        ("normal_fors", MU, "of: 'normal_fors': did you mean 'normal_force'"),
        ("normal_force", "contact.0.friction", "the scene has no such key"),
        ("normal_force", "contact.0.law", "it is no number"),
        ("normal_force", "contact.0.penalty_parameter", "it is chosen automatically, and held"),
        ("normal_force", "solver.tolerance", "answers do not follow it smoothly"),
        ("normal_force", "support.0.path.time.0", "it is part of a path"),
    ],
)
def test_what_has_no_derivative_is_refused_in_a_sentence(of, by, said):
    study = Study(ON_A_FLOOR, body=square())
    with pytest.raises(InputError, match=said.replace("(", r"\(")):
        study.derivatives([of], [by])


class Reversed(Static):
    """A law with forces of its own, which says nothing of their derivatives."""

    def force(self):
        return super().force()


def test_a_law_that_does_not_say_its_derivatives_is_refused(monkeypatch):
    monkeypatch.setattr(friction, "LAWS", (Reversed,))
    with pytest.raises(InputError, match="the law 'static' of 'y0' has none of its own"):
        Study(ON_A_FLOOR, body=square()).derivatives(["normal_force"], [MU])
