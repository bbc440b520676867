"""The trust report: every check, and each of its comparisons, fails on a wrong solution.

What each solution is made wrong by is told by ``BROKEN``, which a test holds complete.
"""

import dataclasses
from functools import cache
from html import unescape

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Check,
    Contact,
    Coupling,
    Group,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.cli.summary import print_result
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.results.check_messages import WORDS, compares
from fenics_contact.results.records.run import RigidMotion
from fenics_contact.results.records.steps import BranchRecord
from fenics_contact.simulation import verdict
from fenics_contact.trust.comparison import balance, worst_of
from fenics_contact.trust.run_checks import all_checks
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.finite.rubber import BUCKLES_AT, compressed_strip
from fenics_contact.verification.thermal.heat import bars as conducting_bars
from tests.contact.shuffled import Shuffled
from tests.preload.joints import joint
from tests.preload.test_joint import scene as bolted_joint
from tests.problem.sectors import fitted, hub_on_shaft, sector
from tests.problem.test_couplings import block as divided
from tests.problem.test_couplings import punch
from tests.report.page.pages import page_of
from tests.scenes import box_body
from tests.solve.finite.rubber import pressed, square
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD
BASE = Support("y0", {"x": 0, "y": 0})
MATERIAL = Material(1000, 0.3)
PARABOLA = Obstacle("parabola", radius=2, position=(0.5, 1), indentation=0.03)


def strip(epsilon="auto"):
    """A strip on its bottom, pulled along under a rough pad: slips in front, sticks behind."""
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        support=(Support("y0", {"y": 0}),),
        load=(Load("x1", traction=(20, 0)),),
        contact=(
            Contact("y1", pressure=30, friction_coefficient=0.5, regularisation_parameter=epsilon),
        ),
    )
    return Run(scene, COMM, box_body((32, 4), (4, 0.5)))


def pressed_flat(penalty_parameter, pressure):
    """A block, finely divided along, pressed evenly onto a rigid plane."""
    plane = Obstacle("plane", position=(0, 0), normal=(0, 1), indentation=0.0)
    scene = Scene(
        kinematics="plane stress",
        material=MATERIAL,
        support=(Support("x0", {"x": 0}),),
        load=(Load("y1", traction=(0, -pressure)),),
        contact=(Contact("y0", obstacle=plane, penalty_parameter=penalty_parameter),),
    )
    return Run(scene, COMM, box_body((64, 2), (1, 0.25)))


def indented(**contact):
    """A parabola pressed into a block on its base."""
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        support=(BASE,),
        contact=(Contact("y1", **({"obstacle": PARABOLA} | contact)),),
    )
    return Run(scene, COMM, box_body((24, 16), (1, 1)))


def between_points():
    """The same with a sharper parabola, that stands between two nodes, and meets none."""
    sharp = Obstacle("parabola", radius=0.005, position=(0.5 + 1 / 96, 1), indentation=3e-4)
    return indented(obstacle=sharp)


def rubbed():
    """The same, moved sideways under Coulomb's friction."""
    obstacle = dataclasses.replace(PARABOLA, displacement=(0.004, 0))
    return indented(obstacle=obstacle, friction_coefficient=0.3)


def loose():
    """A block on a smooth floor, along which nothing holds or pushes it."""
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        load=(Load("y1", pressure=10),),
        contact=(Contact("y0"),),
        solver=SolverSettings(stabilisation=True),
    )
    return Run(scene, COMM, box_body((8, 4), (2, 1)))


def held_at_a_point():
    """The same, held by one of its corners."""
    top = Group(0, (), places=(((0.0, 1.0), (0.0, 1.0)),))
    body = box_body((8, 4), (2, 1))
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        support=(Support("corner", {"x": 0}),),
        load=(Load("y1", pressure=10),),
        contact=(Contact("y0"),),
    )
    return Run(scene, COMM, dataclasses.replace(body, groups=dict(body.groups) | {"corner": top}))


def tightened():
    """A bolt that pulls its head onto a sleeve."""
    return Run(bolted_joint(locked_from=None), COMM, joint())


def punched():
    """A block on a rough plane, whose upper side is rigid, pressed and turned."""
    return Run(punch(), COMM, divided(6))


def led():
    """The same block, whose upper side is moved as it is given."""
    given = Coupling("y1", name="punch", displacement={"x": 0.001, "y": -0.01}, rotation={"z": 0})
    return Run(punch(coupling=(given,)), COMM, divided(6))


def ringed():
    """One sector of a hub on a shaft."""
    return sector()


def rimmed(**given):
    """The same sector, whose hub is twisted by a rigid rim."""
    rim = Coupling("hub.y1", at=(0, 0), name="rim", **given)
    scene = dataclasses.replace(fitted(False), load=(), coupling=(rim,))
    return Run(scene, COMM, hub_on_shaft(1))


def twisted():
    return rimmed(moment=2.0)


def turned():
    return rimmed(rotation={"z": 1e-3})


def heated():
    """Two bars that press on each other as they are warm, and conduct by that."""
    scene, body = conducting_bars((120, 20), 0.05)
    return Run(scene, COMM, body)


def driven():
    return indented(obstacle=dataclasses.replace(PARABOLA, indentation=None, force=10.0))


def held_by_contacts(**contact):
    """A block on another one, by nothing but their contact."""
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        support=(Support("lower.y0", {"x": 0, "y": 0}),),
        load=(Load("upper.y1", traction=(1, -10)),),
        contact=(Contact("upper.y0", against="lower.y1", **contact),),
        solver=SolverSettings(solver="full"),
    )
    lower = Box("lower", (0, -1), (1, 0), (6, 5))
    return Run(scene, COMM, boxes((lower, Box("upper", (0, 0), (1, 1), (4, 3)))))


def dragged():
    """A parabola pressed in, then dragged along in load steps."""
    obstacle = dataclasses.replace(
        PARABOLA,
        path=Path(time=(0, 0.3), factor=(0, 1)),
        displacement=(0.01, 0),
        displacement_path=Path(time=(0.3, 1), factor=(0, 1)),
    )
    contact = Contact("y1", obstacle=obstacle, friction_coefficient=0.3, law="incremental")
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        support=(BASE,),
        contact=(contact,),
        steps=Steps(5),
    )
    return Run(scene, COMM, box_body((16, 8), (1, 1)))


def glued():
    return held_by_contacts(contact="bonded")


def stacked():
    return held_by_contacts(friction_coefficient=0.5)


def rubber():
    """A rubber block pressed by a fifth onto a rough floor."""
    return Run(pressed(0.2, 0.3), COMM, square())


def collapsed(prepared, monkeypatch):
    """A corner moved through its cell, as on a wrong branch."""
    spaces = prepared.problem.spaces
    moved = prepared.solution.displacement.copy()
    moved[np.isclose(spaces.coordinates[:, :2], [1, 0]).all(axis=1)] += [-0.2, 0.2]
    return with_body(prepared.solution, displacement=moved)


def buckled():
    """A strip that is pressed by half as much again as it bears, and stays straight."""
    scene, body = compressed_strip(1.5 * BUCKLES_AT)
    return Run(scene, COMM, body)


RIGHT = (
    rubber,
    *(strip, indented, rubbed, loose, driven, glued, stacked, dragged),
    *(punched, ringed, twisted, turned),
)


@pytest.fixture(autouse=True, scope="module")
def forget_the_runs():
    yield
    solved.cache_clear()


@cache
def solved(make):
    prepared = make()
    assert prepared.solve().converged
    return prepared


def checks_of(prepared, solution=None):
    """All checks, also those that find nothing to compare."""
    problem, solution = prepared.problem, solution or prepared.solution
    problem.displacement.x.array[:] = solution.displacement.ravel()
    forces = BulkForces(problem, solution)
    steps = len(prepared.steps)
    found = all_checks(forces, steps)
    return found | {
        "energy_balance": prepared.energy_balance.check(prepared.steps[-1]["quantities"])
    }


def failing(checks):
    return {name: check for name, check in checks.items() if check and not check.passed}


# What a solution is made wrong by.


def bulk(factor):
    """Another displacement than the solution's, as its forces show it."""

    def broken(prepared, monkeypatch):
        wrong = factor * prepared.solution.internal_force
        return with_body(prepared.solution, internal_force=wrong)

    return broken


def stress(factor):
    """Another displacement, as its stresses show it."""

    def broken(prepared, monkeypatch):
        wrong = factor * prepared.solution.displacement
        return with_body(prepared.solution, displacement=wrong)

    return broken


def at_points(**factors):
    """Something else at the points of the contact."""

    def broken(prepared, monkeypatch):
        state = prepared.solution.states[0]
        wrong = {name: factor * getattr(state, name) for name, factor in factors.items()}
        state = dataclasses.replace(state, **wrong)
        return dataclasses.replace(prepared.solution, states=[state])

    return broken


def friction(factor):
    """The bulk needs more or less friction at points that slip."""

    def broken(prepared, monkeypatch):
        solution, problem = prepared.solution, prepared.problem
        nodes = problem.contacts[0].nodes[solution.states[0].status == "SLIP"]
        internal = solution.internal_force.copy()
        internal[nodes] = problem.load[nodes] + factor * (internal - problem.load)[nodes]
        return with_body(solution, internal_force=internal)

    return broken


def pressure(share, where):
    """The bulk needs other pressures where the contact is OPEN, or not."""

    def broken(prepared, monkeypatch):
        solution, contact = prepared.solution, prepared.problem.contacts[0]
        state = solution.states[0]
        peak = COMM.allreduce(state.contact_pressure.max(initial=0.0), op=MPI.MAX)
        points = (state.status == "OPEN") == (where == "OPEN")
        internal = solution.internal_force.copy()
        internal[contact.nodes[points], 1] -= share * peak * contact.trace.weights[points]
        return with_body(solution, internal_force=internal)

    return broken


def half_of_the_points(prepared, monkeypatch):
    """The same force, as pressures on half of the points."""
    state = prepared.solution.states[0]
    left = prepared.problem.contacts[0].trace.coordinates[:, 0] < 0.5
    wrong = np.where(left, 2.0, 0.0) * state.contact_pressure
    state = dataclasses.replace(state, contact_pressure=wrong)
    return dataclasses.replace(prepared.solution, states=[state])


def force_not_reached(prepared, monkeypatch):
    """The body is in equilibrium, but under less than the obstacle is to be driven by."""
    contact = prepared.problem.contacts[0]
    monkeypatch.setattr(contact, "force", 1.001 * contact.force)
    return prepared.solution


def pushed_where_held(prepared, monkeypatch):
    """What is held against sliding gets a force, 1e-5 of those that press the block."""
    internal = prepared.solution.internal_force.copy()
    internal.reshape(-1)[prepared.problem.stabilisation[0].dofs] += 1e-5 * 20
    return with_body(prepared.solution, internal_force=internal)


def pushed_at_a_point(prepared, monkeypatch):
    """The corner that is held gets a force, 1e-5 of those that press the block."""
    internal = prepared.solution.internal_force.copy()
    internal.reshape(-1)[prepared.problem.applied_supports[0].dofs] += 1e-5 * 20
    return with_body(prepared.solution, internal_force=internal)


def stretched(prepared, monkeypatch):
    """Displacements a thousandth too large."""
    moved = 1.001 * prepared.solution.displacement
    return with_body(prepared.solution, displacement=moved)


def let_go(prepared, monkeypatch):
    """A coupling that is a millionth off where it is to be, as if it were free."""
    moved = prepared.problem.body_scalars[0]
    monkeypatch.setattr(type(moved), "value", property(lambda own: (1 + 1e-6) * own.held))
    return prepared.solution


def moved_apart(prepared, monkeypatch):
    """One cut face moves by 1e-6 more than the other."""
    cut = prepared.problem.discrete.cut
    moved = prepared.solution.displacement.copy()
    moved.reshape(-1)[cut.slaves.local] *= 1 + 1e-6
    return with_body(prepared.solution, displacement=moved)


def pulled_at_the_cut(prepared, monkeypatch):
    """One cut face gets a little more than the other gives."""
    cut = prepared.problem.discrete.cut
    internal = prepared.solution.internal_force.copy()
    internal.reshape(-1)[cut.slaves.local] *= 1 + 1e-5
    return with_body(prepared.solution, internal_force=internal)


def handed_over_elsewhere(prepared, monkeypatch):
    """A projection with shuffled columns: resultants balance, moments do not."""
    pairing = prepared.problem.contacts[0].kinematics.pairing
    monkeypatch.setattr(pairing, "_present", pairing._present)  # other tests have it, too
    Shuffled(pairing).take_over()
    return prepared.solution


def stale_bound(prepared, monkeypatch):
    """Friction as the pressure of a pass before would have it."""
    wrong = [0.999 * bound for bound in prepared.solution.friction_bound]
    return dataclasses.replace(prepared.solution, friction_bound=wrong)


def work_lost(prepared, monkeypatch):
    quantities = prepared.steps[-1]["quantities"]
    monkeypatch.setitem(quantities, "energy_defect", 0.2 * prepared.energy_balance.done)
    return prepared.solution


def too_soft(epsilon):
    """Solved as it should be, but with so large an ε that nothing slips."""
    return lambda: strip(epsilon)


BROKEN = {
    ("equilibrium", ""): (strip, bulk(1.001)),
    ("resultant", "obstacle"): (driven, force_not_reached),
    ("resultant", "pressure"): (strip, at_points(contact_pressure=1.001)),
    ("resultant", "part"): (glued, bulk(1.001)),
    ("stabilisation", ""): (loose, pushed_where_held),
    ("point_support", ""): (held_at_a_point, pushed_at_a_point),
    ("preload", ""): (tightened, stretched),
    ("coupling", "force"): (punched, stretched),
    ("coupling", "motion"): (led, let_go),
    ("cyclic_symmetry", "motion"): (ringed, moved_apart),
    ("cyclic_symmetry", "forces"): (ringed, pulled_at_the_cut),
    ("action_and_reaction", ""): (stacked, handed_over_elsewhere),
    ("boundary_stress", ""): (strip, stress(0.5)),
    ("heat_balance", ""): (heated, at_points(contact_pressure=1.001)),
    ("unseen_contact", ""): (between_points, lambda prepared, _: prepared.solution),
    # Of the pad's friction, 60, a sixth holds the strip.
    ("slip_limit", ""): (strip, at_points(friction_traction=6.001)),
    ("friction_cone", ""): (strip, friction(1.01)),
    ("friction_law", ""): (strip, friction(0.99)),
    ("outer_loop", ""): (rubbed, stale_bound),
    ("dissipation", ""): (strip, at_points(slip=-1.0)),
    ("stick_creep", "law"): (strip, at_points(slip=0.99)),
    ("stick_creep", "share"): (cache(too_soft(0.2)), lambda prepared, _: prepared.solution),
    ("contact_law", ""): (indented, pressure(1e-3, "closed")),
    ("complementarity", ""): (indented, pressure(0.01, "OPEN")),
    ("tension", ""): (indented, pressure(-0.01, "OPEN")),
    ("penetration", ""): (indented, at_points(penalty_energy=1e4)),
    ("penetration_depth", "closing"): (indented, at_points(gap=1e4)),
    ("penetration_depth", "cell"): (
        cache(lambda: pressed_flat(8e-6, 300)),
        lambda prepared, _: prepared.solution,
    ),
    ("penetration_depth", "glue"): (
        cache(lambda: held_by_contacts(contact="bonded", penalty_parameter=1e-4)),
        lambda prepared, _: prepared.solution,
    ),
    ("pressure_recovery", ""): (indented, half_of_the_points),
    ("energy_balance", ""): (dragged, work_lost),
    ("volume_ratio", ""): (rubber, collapsed),
    ("stable_equilibrium", ""): (buckled, lambda prepared, _: prepared.solution),
}
# Couplings in a sector are compared with what is given there, and the cut beside them with itself.
IN_SECTORS = {
    ("coupling", "force"): (twisted, stretched),
    ("coupling", "motion"): (turned, let_go),
    ("cyclic_symmetry", "motion"): (twisted, moved_apart),
    ("cyclic_symmetry", "forces"): (turned, pulled_at_the_cut),
}


def test_every_check_and_kind_has_words_and_a_wrong_solution():
    # These have tests of their own.
    elsewhere = {"linear_range", "momentum_balance", "cycle_loss", "free_modes", "regularisation"}
    here = {name: words for name, words in WORDS.items() if name not in elsewhere}
    assert set(checks_of(solved(strip))) == set(here)
    kinds = {(name, kind) for name, words in here.items() for kind in words.kinds or ("",)}
    assert kinds == set(BROKEN)


@pytest.mark.parametrize("make", RIGHT, ids=lambda make: make.__name__)
def test_the_right_solution_passes(make):
    assert not failing(checks_of(solved(make)))


@pytest.mark.parametrize(
    ("name", "kind", "made"),
    [(*key, made) for made in (BROKEN, IN_SECTORS) for key in made],
    ids=lambda one: "in sectors" * (one is IN_SECTORS) if isinstance(one, dict) else one,
)
def test_a_wrong_solution_fails(name, kind, made, monkeypatch):
    make, broken = made[name, kind]
    prepared = solved(make)
    wrong = broken(prepared, monkeypatch)
    check = failing(checks_of(prepared, wrong))[name]
    assert check.kind == kind
    words = verdict.of_checks({name: check})
    assert words.startswith(f"Converged, but do not trust it: failed {name.replace('_', ' ')}: ")
    assert "{" not in words
    label = prepared.problem.contacts[0].label
    assert (f"at '{label}'" in words) == bool(check.contact)


def test_the_verdict_says_what_is_wrong_by_how_much_and_where():
    place = (0.5, 1.0, -0.0)
    checks = {
        "friction_cone": Check(0.03, 1e-6, "pad", place),
        "tension": Check(float("nan"), 1e-6, "pad"),
        "equilibrium": Check(0.5, 1e-9, part="lid"),
        "dissipation": Check(0.0, 1e-6, "pad", place),
    }
    assert verdict.of_checks(checks) == (
        "Converged, but do not trust it: failed friction cone: traction exceeds its bound by 3 % "
        "of the largest bound at 'pad' near (0.5, 1, 0); tension: its value is not a number at "
        "'pad'; equilibrium: 50 % of the forces are out of balance in 'lid'."
    )
    assert checks["friction_cone"].as_dict() == {
        "value": 0.03,
        "limit": 1e-6,
        "passed": False,
        "contact": "pad",
        "place": [0.5, 1.0, 0.0],
    }
    assert set(checks["dissipation"].as_dict()) == {"value", "limit", "passed"}


@pytest.mark.parametrize("wrong", ["lower", "upper"])
def test_equilibrium_tells_the_part(wrong, monkeypatch):
    """Forces on one of two bodies that balance no more."""
    prepared = solved(stacked)
    problem = prepared.problem
    parts = problem.spaces.parts
    load = problem.load.copy()
    load[parts.of_node == parts.names.index(wrong), 0] += 1e-3
    monkeypatch.setattr(problem, "load", load)
    check = checks_of(prepared)["equilibrium"]
    assert check.part == wrong
    # What supports hold takes up what is put on there, so only forces on the other are lost.
    assert {part.part: part.passed for part in check.parts}[wrong] is False
    assert set(check.as_dict()["parts"]) == {"lower", "upper"}


def test_the_obstacle_is_short_of_its_force_and_the_body_in_equilibrium(monkeypatch):
    prepared = solved(driven)
    wrong = force_not_reached(prepared, monkeypatch)
    found = failing(checks_of(prepared, wrong))
    assert set(found) == {"resultant"}
    assert found["resultant"].value == pytest.approx(1e-3, rel=1e-2)


def test_a_body_on_glue_alone_shows_a_wrong_displacement_by_its_resultant(monkeypatch):
    """Without a support, equilibrium says nothing of the bulk; glue has no law to ask."""
    prepared = solved(glued)
    check = checks_of(prepared, bulk(1.001)(prepared, monkeypatch))["resultant"]
    assert (check.kind, check.part) == ("part", "upper")
    assert check.value == pytest.approx(5e-4, rel=0.1)  # over forces and loads, about twice either


def test_penetration_is_that_of_a_penalty_in_series():
    """Under an even pressure p it is ε₁ p, and p L/E closes L: ε₁ E/L, whatever p."""
    check = pressed_flat(1e-7, 10).solve().checks["penetration_depth"]
    assert check.kind == "closing"
    assert check.value == pytest.approx(1e-7 * 1000 / 1.0, rel=1e-6)


@pytest.mark.parametrize("unit", [1.0, 1e6])
def test_creep_is_that_of_springs_in_series(unit):
    """A layer sheared evenly below its threshold: ε E/(g L), in any unit of stress."""
    epsilon, bound = 1e-5, 8.0 * unit
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000 * unit, 0.25),
        support=(Support("body", {"y": 0}), Support("y0", {"x": 5e-3})),
        contact=(
            Contact(
                "y1",
                pressure=20.0 * unit,
                friction_coefficient=0.4,
                regularisation_parameter=epsilon,
            ),
        ),
    )
    prepared = Run(scene, COMM, box_body((3, 2), (2.0, 0.5)))
    check = prepared.solve().checks["stick_creep"]
    assert check.kind == "share"
    assert check.value == pytest.approx(epsilon * 1000 * unit / (bound * 2.0), rel=1e-6)


def test_creep_adds_up_over_load_steps():
    """By the incremental law, points that stick creep by ε at most in each."""
    checks = {steps: Run(pad(steps), COMM, block()).solve().checks for steps in (1, 8)}
    shares = {steps: found["stick_creep"].value for steps, found in checks.items()}
    assert shares[8] == pytest.approx(8 * shares[1], rel=0.05)


def pad(steps):
    contact = Contact(
        "y1", pressure=20, friction_coefficient=5, law="incremental", regularisation_parameter=1e-6
    )
    scene = Scene(
        kinematics="plane strain",
        material=MATERIAL,
        support=(BASE,),
        load=(Load("x1", traction=(1, 0), path=Path(time=(0, 1e-3, 1), factor=(0, 1, 1))),),
        contact=(contact,),
        steps=Steps(steps),
    )
    return scene


def block():
    return box_body((8, 4), (2, 1))


def test_worst_point_is_the_same_on_any_rank():
    values, places = np.zeros(0), np.zeros((0, 3))
    assert worst_of(COMM, values, places) == (0.0, ())
    if COMM.rank == COMM.size - 1:
        values, places = np.array([1.0, 3.0, 3.0]), np.array([[5.0, 0, 0], [2, 0, 1], [2, 0, 0]])
    assert worst_of(COMM, values, places) == (3.0, (2.0, 0.0, 0.0))
    if COMM.rank == 0:
        values, places = np.array([np.nan]), np.array([[7.0, 0, 0]])
    value, place = worst_of(COMM, values, places)
    assert np.isnan(value) and place[0] == 7.0


def test_page_and_terminal_say_what_is_compared(capsys, tmp_path):
    prepared = solved(stacked)
    broken = {
        "tension": Check(0.01, 1e-6, "pad"),
        "equilibrium": Check(1.0, 1e-9, part="lid", parts=(Check(1.0, 1e-9, part="lid"),)),
    }
    result = dataclasses.replace(prepared.solve(), checks=broken)
    page = page_of(result.as_dict())
    assert all(compares(name) in page for name in broken)
    print_result(result, tmp_path)
    said = " ".join(capsys.readouterr().out.split())
    assert all(compares(name) in said for name in broken)
    assert "of lid 1.00e+00 1.00e-09 FAILED" in said


def test_page_and_terminal_show_all_answers_and_the_free_motions(capsys, tmp_path):
    result = solved(stacked).solve()
    quantities = {"friction_force": [1.5, 0.0], "stick_area": 0.25, "slip_area": 0.0}
    branches = [
        BranchRecord(
            start=start,
            newton_iterations=1,
            passed=passed,
            quantities={"normal_force": force, **quantities},
        )
        for start, passed, force in (("as solved", True, 7.125), ("all sticks", False, 8.375))
    ]
    motion = RigidMotion(motion="translation along x of 'lid'", bodies=["lid"], resisted_by=[])
    model = dataclasses.replace(result.model, rigid_motions=[motion])
    shown = dataclasses.replace(result, branches=branches, model=model)
    page = unescape(page_of(shown.as_dict()))
    row = "".join(f"<td>{cell}</td>" for cell in ("8.375", "1.5, 0", "0.25", "0", "FAILED"))
    row = f'<th scope="row">all sticks</th>{row}'
    assert "Answers from other starts" in page and row in page
    assert "translation along x of 'lid': resisted by nothing" in page
    print_result(shown, tmp_path)
    said = " ".join(capsys.readouterr().out.split())
    assert "as solved 7.125 1.5, 0 0.25 0 ok" in said
    alone = dataclasses.replace(result, branches=branches[:1])
    assert "Answers from other starts" not in page_of(alone.as_dict())


def test_of_a_body_unloaded_to_nothing_limits_stay_small():
    """What is left is the accepted imbalance alone: over the forces that it was accepted for."""
    for left, passed in ((1e-6, True), (3e-6, False)):
        check = balance(left, 2e-6, 1e-6)
        assert check.passed == passed
        assert check.limit < 1e-5
    assert balance(0.0, 0.0, 0.0).passed
