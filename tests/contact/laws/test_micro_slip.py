"""Friction with micro-slip: the elastic part of slip, what it remembers, stores and loses."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Path, Run, Scene, Steps, Study, Support, run
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import CONSTANT
from fenics_contact.solve.load_steps.accepted_step import recall, remember
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.trust.run_checks import run_checks
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.friction_bounds import MICRO_SLIP_CASES
from tests.contact.laws.test_by_points import both, displaced, matrix_of, use_friction
from tests.contact.laws.test_friction_rules import rubbed, sheared
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD
# Of bodies that are stiff, and of others: some of their points slip.
LONGEST, SHORT = 0.004, 3e-5


def keys(elastic_slip=LONGEST, law="incremental"):
    return {
        "friction_coefficient": 0.4,
        "law": law,
        "friction_law": {"kind": "micro-slip", "elastic_slip": elastic_slip},
    }


def moved(factors, increments, along=(0.01,), pressures=(1.0,), **contact):
    """A block under a pressure that is given, 30 times a factor, moved along by a path."""
    knots = len(factors) - 1
    path = Path(time=range(knots + 1), factor=factors)
    axes = "xyz"[: len(along) + 1]
    level = np.broadcast_to(np.asarray(pressures, float), knots + 1)
    return Scene(
        kinematics="plane strain" if len(axes) == 2 else "3D",
        material=Material(1e8, 0.0),
        support=(
            Support(f"{axes[-1]}1", {axes[-1]: 0}, path=CONSTANT),
            Support(f"{axes[-1]}1", dict(zip(axes, along, strict=False)), path=path),
        ),
        contact=(
            Contact(
                f"{axes[-1]}0",
                pressure=30.0,
                pressure_path=Path(time=range(knots + 1), factor=tuple(level)),
                **{**keys(), **contact},
            ),
        ),
        steps=Steps(times=tuple(np.arange(1, knots * increments + 1) / increments)),
    )


def carried(path, longest=LONGEST):
    """The elastic slip at the end of a path, by returning to |s_e| ≤ l after every step."""
    elastic = np.zeros(path.shape[1])
    for step in np.diff(path, axis=0):
        elastic = elastic + step
        elastic *= min(1.0, longest / max(np.linalg.norm(elastic), 1e-300))
    return elastic


@pytest.mark.parametrize("case", MICRO_SLIP_CASES, ids=lambda case: case.name)
def test_a_bar_and_a_block_are_as_their_formulas_say(case):
    for finding in case.run(True):
        assert finding.passed, finding


def test_in_space_the_traction_is_along_the_elastic_slip():
    """Out and around a corner: against the same return to the bound in NumPy."""
    scene = moved((0.0, 1.0, 1.0), 4)
    turns = (
        Support("z1", {"z": 0}, path=CONSTANT),
        Support("z1", {"x": 0.01}, path=Path(time=(0, 1, 2), factor=(0, 1, 1))),
        Support("z1", {"y": 0.006}, path=Path(time=(0, 1, 2), factor=(0, 0, 1))),
    )
    contact = dataclasses.replace(scene.contact[0], on="z0")
    scene = dataclasses.replace(scene, kinematics="3D", support=turns, contact=(contact,))
    result = run(scene, COMM, box_body((2, 2, 1)))
    assert result.passed, result.verdict
    times = np.array([0.0, *scene.steps.times])
    path = np.stack([0.01 * np.minimum(times, 1), 0.006 * np.maximum(times - 1, 0)], axis=1)
    expected = carried(path)
    assert 0.2 < expected[1] / expected[0] < 20
    for name, values in (
        ("elastic slip", result.points.own["elastic_slip"]),
        ("traction", -result.points.friction_traction * LONGEST / (0.4 * 30)),
    ):
        assert values[:, :2] == pytest.approx(np.tile(expected, (len(values), 1)), rel=1e-4), name


@pytest.mark.parametrize("law", ["static", "incremental"])
@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
def test_every_strategy_finds_the_law(law, strategy):
    """Where pressures are found: t = μ p |s|/l up to l, and μ p beyond."""
    scene = sheared(keys(SHORT, law), solver={"strategy": strategy})
    result = run(scene, COMM, box_body((6, 3)))
    assert result.passed, result.verdict
    points = result.points
    slip = np.linalg.norm(points.slip, axis=1)
    expected = 0.4 * points.contact_pressure * np.minimum(slip / SHORT, 1.0)
    assert np.linalg.norm(points.friction_traction, axis=1) == pytest.approx(expected, abs=2e-5)
    assert {*points.status} >= {"STICK", "SLIP"}
    assert np.all((points.status == "STICK") == ((slip <= SHORT) & (points.contact_pressure > 0)))


@pytest.mark.parametrize("dimension", [2, 3])
def test_forms_and_points_have_one_tangent(dimension):
    """Also with a slip that steps before have left."""
    problem = Problem.on_mesh(sheared(keys(), dimension), box_body((3, 2, 2)[:dimension]))
    (contact,) = problem.contacts
    surface, random = SurfaceMatrix(contact), np.random.default_rng(3)
    displaced(contact, random)
    contact.accept()
    left = np.abs(contact.friction.elastic_slip).max(initial=0.0)
    assert COMM.allreduce(left, MPI.MAX) > 0.1 * LONGEST
    for mode in ("law", "coupled", "status"):
        slip = displaced(contact, random)
        contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
        use_friction(contact, mode, slip)
        for law in (contact.normal, contact.friction_term):
            expected, found = both(contact, lambda law=law: contact.forces.of(law))
            assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
        expected, found = both(contact, lambda: matrix_of(surface))
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_an_answer_does_not_depend_on_the_steps():
    """Pressures that grow with the load, which then turns: 2 steps between turns, or 8.

    The work of friction does: how pressures grew within a step is not known.
    """
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.4))

    def answer(number):
        scene = sheared(keys(SHORT), steps=Steps(number=2 * number, end=2.0))
        load = dataclasses.replace(scene.load[0], path=path)
        return run(dataclasses.replace(scene, load=(load,)), COMM, box_body((6, 3)))

    few, many = answer(2), answer(8)
    assert few.passed, few.verdict
    assert many.passed, many.verdict
    assert few.steps[1].quantities["slip_area"] > 0
    for name in ("strain_energy", "max_slip", "friction_force", "elastic_slip_energy"):
        assert few.quantities[name] == pytest.approx(many.quantities[name], rel=1e-7), name


def test_a_run_goes_on_from_a_slip_that_is_kept(folder):
    scene = rubbed(keys(2e-3), steps=Steps(number=4))
    whole = run(scene, COMM, box_body((12, 6)))
    assert whole.passed, whole.verdict
    if COMM.rank == 0:
        stopped_after(scene, box_body((12, 6), comm=MPI.COMM_SELF), folder, 2)
    COMM.barrier()
    found = resumed(scene, box_body((12, 6)), folder)
    for name in ("normal_force", "friction_work", "elastic_slip_energy"):
        assert found.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-7), name
    assert found.points.own["elastic_slip"] == pytest.approx(
        whole.points.own["elastic_slip"], abs=1e-9
    )


def test_a_step_that_is_rejected_leaves_no_trace():
    prepared = Run(moved((0.0, 1.0), 3), COMM, box_body((2, 1)))
    prepared.solve()
    contact = prepared.problem.contacts[0]
    kept, force = remember(contact), contact.forces.of(contact.friction_term)
    contact.accept()
    assert np.abs(contact.forces.of(contact.friction_term) - force).max(initial=0.0) < 1e-9
    recall(contact, kept)
    np.testing.assert_array_equal(contact.friction.elastic_slip, kept.at_points["elastic_slip"])
    assert np.abs(contact.forces.of(contact.friction_term) - force).max(initial=0.0) < 1e-9


def test_what_goes_back_is_stored_and_not_dissipated():
    """Out, and back until friction vanishes; then, pressed less, what springs stored is lost."""
    area, bound = 2.0, 0.4 * 30
    out = 0.01
    back = 1 - LONGEST / out
    body = box_body((2, 1), (2, 1))
    result = run(moved((0.0, 1.0, back), 2), COMM, body)
    assert result.passed, result.verdict
    steps = [step.quantities for step in result.steps]
    stored = area * bound * LONGEST / 2
    assert steps[1]["elastic_slip_energy"] == pytest.approx(stored, rel=1e-4)
    lost = area * bound * (out - LONGEST)
    assert [step["friction_work"] for step in steps[1:]] == pytest.approx([lost] * 3, rel=1e-4)
    assert abs(steps[3]["elastic_slip_energy"]) < 1e-3 * stored
    assert abs(steps[3]["energy_defect"]) < 1e-3 * lost + abs(steps[1]["energy_defect"])
    eased = run(moved((0.0, 1.0, 1.0), 2, pressures=(1.0, 1.0, 0.5)), COMM, body)
    assert eased.passed, eased.verdict
    assert eased.quantities["elastic_slip_energy"] == pytest.approx(stored / 2, rel=1e-4)
    assert eased.quantities["friction_work"] == pytest.approx(lost + stored / 2, rel=1e-4)


def test_points_that_open_lose_their_elastic_slip():
    """Pressed, sheared, lifted off and pressed again at the same place: nothing is left."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=(
            Support("y1", {"x": 0.003}, path=Path(time=(0, 1, 4), factor=(0, 1, 1))),
            Support("y1", {"y": -0.01}, path=Path(time=range(5), factor=(0, 1, 1, -1, 1))),
        ),
        contact=(Contact("y0", **keys()),),
        steps=Steps(times=(1.0, 2.0, 3.0, 4.0)),
    )
    result = run(scene, COMM, box_body((2, 1)))
    assert result.passed, result.verdict
    forces = [step.quantities["friction_force"][0] for step in result.steps]
    assert forces[1] < -0.5
    assert forces[2:] == pytest.approx([0, 0], abs=1e-9)
    assert result.steps[2].quantities["elastic_slip_energy"] == 0


@pytest.mark.parametrize("share", [1e-6, 1e-3, 0.1, 1.0])
def test_lengths_far_from_the_slip(share):
    """Of the slip of Coulomb's law; as the elastic slip goes to 0, the answer goes to that."""
    steps, body = Steps(number=3), box_body((12, 6))
    coulomb = {"friction_coefficient": 0.4, "law": "incremental"}
    plain = run(rubbed(coulomb, steps=steps), COMM, body)
    typical = plain.quantities["max_slip"]
    found = run(rubbed(keys(share * typical), steps=steps), COMM, body)
    assert found.passed, found.verdict
    force, other = (one.quantities["friction_force"][0] for one in (plain, found))
    assert abs(other / force - 1) < 1e-4 + share


@pytest.mark.errors
def test_results_do_not_call_it_a_regularisation():
    result = run(rubbed(keys(2e-3), solver={"errors": "all"}), COMM, box_body((12, 6)))
    assert result.passed, result.verdict
    contact = result.contacts[0]
    assert contact.parameters["friction_law"] == "micro-slip: elastic_slip 0.002"
    assert "regularisation_parameter" not in contact.parameters
    for errors in (result.errors["elastic_slip_energy"], contact.errors["friction_force"]):
        assert errors["regularisation"] == 0
        assert errors["total"] > 0
    assert "undecided_points" not in contact.quantities
    assert "stick_creep" not in result.checks
    with refused("micro_slip_with_regularisation", ValueError):
        rubbed(keys() | {"regularisation_parameter": 1e-6})


def test_a_law_without_a_coefficient_says_that_nothing_rubs():
    """By its quick answers, too; Coulomb's coefficient of 0 is how a scene has no friction."""
    scene = rubbed(keys() | {"friction_coefficient": 0}, solver={"errors": "none"})
    study = Study(scene, COMM, box_body((8, 4)))
    said = "There is no friction at 'y1' (micro-slip): the bound of its law is 0 everywhere."
    assert said in study.solve().verdict
    assert said in study.quantities().verdict
    rough = {"contact.0.friction_coefficient": 0.4}
    assert "no friction" not in study.solve(rough).verdict
    plain = {"contact.0.friction_law": None, "contact.0.friction_coefficient": 0}
    assert "no friction" not in study.solve(plain).verdict


def test_wrong_tractions_fail_its_checks():
    """Those that push on, those that are not of the elastic slip, and those beyond the bound."""
    prepared = Run(sheared(keys(SHORT)), COMM, box_body((6, 3)))
    prepared.solve()
    problem, solution = prepared.problem, prepared.solution
    assert all(check.passed for check in run_checks(BulkForces(problem, solution)).values())
    for factor, expected in ((-1.0, "dissipation"), (0.5, "friction_law"), (3.0, "friction_cone")):
        internal = solution.internal_force.copy()
        internal[problem.contacts[0].nodes] += (factor - 1) * solution.friction_force[0]
        wrong = BulkForces(problem, with_body(solution, internal_force=internal))
        assert not run_checks(wrong)[expected].passed, expected


@pytest.mark.parametrize("law", ["static", "incremental"])
def test_derivatives_go_through_what_is_remembered(law):
    """Against differences of answers: some points slide, and after a turn of the load, back."""
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.2))
    scene = sheared(keys(SHORT, law) | {"penalty_parameter": 1e-6}, steps=Steps(number=4, end=2.0))
    loads = (dataclasses.replace(scene.load[0], path=path),)
    scene = dataclasses.replace(scene, load=loads)
    study = Study(scene, body=box_body((6, 3)))
    of = ["strain_energy", "max_slip"]
    at = {
        "contact.0.friction_coefficient": 0.4,
        "contact.0.friction_law.elastic_slip": SHORT,
        "load.0.traction.0": 3.0,
    }
    found = study.derivatives(of, list(at))
    for key, value in at.items():
        step = 1e-4 * value
        up, down = (study.solve({key: value + sign * step}).quantities for sign in (1, -1))
        for name in of:
            quotient = (up[name] - down[name]) / (2 * step)
            assert abs(quotient) > 0
            assert found[name][key] == pytest.approx(quotient, rel=1e-4), (name, key)


def test_pressure_that_grows_with_the_slip_adds_a_third():
    """t = μ p s/l with p and s in proportion: stored μ p s²/(2l), of which two thirds are work."""
    scene = moved((0.0, 1.0), 20, along=(LONGEST / 2,), pressures=(0.0, 1.0))
    found = run(scene, COMM, box_body((2, 1), (2, 1))).quantities
    stored = 2.0 * 0.4 * 30 * LONGEST / 8
    assert found["elastic_slip_energy"] == pytest.approx(stored, rel=1e-2)
    assert found["friction_work"] == pytest.approx(-stored / 3, rel=1e-2)


def test_what_goes_back_wears_nothing():
    """k p (s − l), in one step or in four."""
    wear = {"coefficient": 1e-6}
    for steps in (1, 4):
        scene = moved((0.0, 1.0), steps)
        contact = Contact("y0", foundation_stiffness=1e3, wear=wear, **keys())
        down = Support("y1", {"y": -0.03}, path=CONSTANT)
        support = (down, scene.support[1])
        scene = dataclasses.replace(scene, contact=(contact,), support=support)
        found = run(scene, COMM, box_body((2, 1), (2, 1))).quantities
        worn = 1e-6 * 30 * (0.01 - LONGEST)
        assert found["worn_volume"] == pytest.approx(2.0 * worn, rel=1e-3)


def test_bodies_that_are_paired_anew_keep_their_elastic_slip():
    """A block that slides over another by its own length, and a little back."""
    boxes_ = (Box("lower", (0, -1), (6, 0), (12, 2)), Box("upper", (1, 0), (2, 1), (3, 2)))
    there = Path(time=(0, 1, 2), factor=(0, 1, 1.46 / 1.5))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e5, 0.0),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", {"y": -3e-4}, path=CONSTANT),
            Support("upper.y1", {"x": 1.5}, path=there),
        ),
        contact=(Contact("upper.y0", against="lower.y1", **keys(0.05)),),
        steps=Steps(number=12, end=2.0),
    )
    result = run(scene, COMM, boxes(boxes_))
    assert result.passed, result.verdict
    assert result.contacts[0].quantities["slip_since_pairing"] < 0.5
    forces = [
        -step.quantities["friction_force"][0] / step.quantities["pressure_integral"]
        for step in result.steps
    ]
    # Of the elastic slip of .05, .04 went back; the blocks shear by some 3e-4.
    assert forces[5] == pytest.approx(0.4, rel=1e-6)
    assert forces[-1] == pytest.approx(0.4 * 0.2, rel=0.05)
