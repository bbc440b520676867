"""Answers of a study are those of separate runs, from one factorisation."""

import dataclasses
import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    HalfSpace,
    Material,
    Obstacle,
    Scene,
    Steps,
    Study,
    Support,
    load_scene,
    run,
)
from fenics_contact.common import form_cache
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.simulation.studies import warm_start
from tests.messages import refused
from tests.scenes import ROOT, box_body, slab
from tests.simulation.studies.cases import CASES, DEPTH, MU, ON_A_FLOOR, of_contact, square
from tests.solve.load_steps.histories import block, dragged, shoved, two_blocks

COMM = MPI.COMM_WORLD
# Quantities of one kind: what each is small against is the largest of them.
KINDS = {
    "share": ("slip_since_pairing", "slip_share"),
    "force": ("force", "reaction", "pressure_integral"),
    "area": ("area",),
    "energy": ("energy", "work", "defect"),
    "length": ("slip", "penetration", "indentation", "gap", "displacement", "radius"),
}


WITHOUT_FIELDS = " The range of linear theory was not checked: that takes the fields."
# Of a verdict, what is of the way to the answer.
OF_THE_WAY = r" A pass of the loop on the pressure .* found otherwise\."
# Quantities of single points.
AT_POINTS = ("max_contact_pressure", "max_penetration", "max_slip", "area")


def kind_of(name):
    return next((kind for kind, ends in KINDS.items() if name.endswith(ends)), name)


def require_same(found, expected, tolerance=1e-9):
    assert found.converged == expected.converged
    assert found.verdict == expected.verdict
    assert list(found.checks) == list(expected.checks)
    for name, check in expected.checks.items():
        assert found.checks[name].passed == check.passed, name
    assert len(found.steps) == len(expected.steps)
    pairs = [(found.quantities, expected.quantities)]
    for ours, theirs in zip(found.contacts, expected.contacts, strict=True):
        pairs.append((ours.quantities, theirs.quantities))
    require_same_numbers(pairs, expected, tolerance)


def require_same_numbers(pairs, expected, tolerance, at_points=None):
    """Each over the largest of its kind; those of single points may differ more."""
    sizes = {"share": 1.0}
    for theirs in (expected.quantities, *(c.quantities for c in expected.contacts)):
        for name, value in theirs.items():
            if value is not None:
                size = np.abs(value).max()
                sizes[kind_of(name)] = max(sizes.get(kind_of(name), 0.0), size)
    for support in expected.supports:
        sizes["force"] = max(sizes["force"], np.abs(support.reaction).max())
    for ours, theirs in pairs:
        assert ours.keys() == theirs.keys()
        for name, value in theirs.items():
            if value is None:
                assert ours[name] is None
                continue
            off = np.abs(np.array(ours[name]) - np.array(value)).max()
            allowed = at_points if at_points and name.endswith(AT_POINTS) else tolerance
            assert off <= allowed * sizes[kind_of(name)], (name, off, value)


@pytest.mark.parametrize("name", CASES)
def test_each_answer_is_that_of_its_own_run(name):
    scene, make, every = CASES[name]
    body = make()
    study = Study(scene, COMM, body)
    for changes in every:
        found = study.solve(changes)
        require_same(found, run(study.changed(changes), COMM, body))
        assert not study.other_parts(changes)
    assert study.factorisations == 1


def test_a_whole_scene_may_stand_for_its_changes():
    study = Study(ON_A_FLOOR, COMM, square())
    found, expected = study.solve(study.changed({MU: 0.35})), study.solve({MU: 0.35})
    require_same(found, expected)
    assert study.factorisations == 1
    with refused("study_with_accuracy"):
        study.solve(dataclasses.replace(ON_A_FLOOR, accuracy=0.01))


@pytest.mark.parametrize(
    ("load", "sticks_from"),
    [(100, 8), (200, 7.75), (300, 6.25), (400, 5.25), (600, 3), (700, 1.75)],
)
def test_the_papers_slab_from_one_body(load, sticks_from, slab_study):
    """Where it sticks last, along a slab of 8: example 1 of Campos, Oden and Kikuchi (1982)."""
    answer = slab_study.quantities({"load.0.traction.0": -load})
    assert answer.passed, answer.verdict
    points = answer.points
    sticking = points.coordinates[points.status == "STICK", 0]
    assert sticking.max(initial=0.0) == pytest.approx(sticks_from, abs=1e-9)
    assert slab_study.factorisations == 1


@pytest.fixture(scope="module")
def slab_study():
    study = Study(slab())
    yield study
    study.close()


def test_the_body_is_made_anew_only_where_it_is_another(caplog):
    study = Study(ON_A_FLOOR, COMM, square())
    softer = {"material.0": Material(500, 0.3)}
    assert study.other_parts(softer) == ["material"]
    before, after = study.solve(), study.solve(softer)
    assert study.factorisations == 2
    assert after.quantities["normal_force"] < 0.6 * before.quantities["normal_force"]
    assert study.solve({"material.0": Material(500, 0.3), MU: 0.1}).converged
    assert study.factorisations == 2


@pytest.mark.parametrize("key", ["material.youngs_modulus", "material.0.youngs_modulus"])
def test_a_table_that_stands_alone_may_be_counted(key):
    assert Study(ON_A_FLOOR, COMM, square()).changed({key: 7}).material[0].youngs_modulus == 7


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"contact.0.friction": 1}, "change_of_unknown_key"),
        ({"contact.1.pressure": 1}, "change_of_contact_1"),
        ({"contact.x.pressure": 1}, "change_of_contact_x"),
        ({MU: -1}, "change_to_negative_friction"),
        ({"title.0": 1}, "change_of_a_letter_of_the_title"),
        ({"contact.0": ON_A_FLOOR.contact[0], MU: 1}, "change_of_a_part_and_of_all"),
        ({"accuracy": 0.01}, "study_with_accuracy"),
    ],
)
def test_a_change_that_cannot_be_is_refused_in_one_sentence(changes, said):
    with refused(said):
        Study(ON_A_FLOOR, COMM, square()).solve(changes)


def require_same_answer(found, expected):
    """Of a quick answer, all that it has, which is all that the run has but for fields and bars.

    An automatic ε follows from pressures without friction that a separate run finds to 1e-6 where
    an obstacle floats; its bias, a thousandth of that, is seen in the largest pressure.
    """
    assert found.converged == expected.converged
    pairs = [(found.quantities, expected.quantities)]
    pairs += [(o, t.quantities) for o, t in zip(found.contacts, expected.contacts, strict=True)]
    pairs += [
        ({"reaction": ours.reaction}, {"reaction": theirs.reaction})
        for ours, theirs in zip(found.supports, expected.supports, strict=True)
    ]
    require_same_numbers(pairs, expected, 1e-9, at_points=1e-7)
    for ours, theirs in zip(found.supports, expected.supports, strict=True):
        assert (ours.name, ours.on) == (theirs.name, theirs.on)
        for one, other in zip(ours.displacement, theirs.displacement, strict=True):
            assert one == other or abs(one - other) < 1e-9 * abs(other)
    assert found.preloads.keys() == expected.preloads.keys()
    assert (found.points.status == expected.points.status).all()
    require_same_checks(found, expected)


def require_same_checks(found, expected):
    """Limits and values of all checks but the one of the range of linear theory.

    Values that are round-off in the one are round-off in the other.
    """
    assert [*found.checks, "linear_range"] == list(expected.checks)
    assert (found.exit_code, found.passed) == (expected.exit_code, expected.passed)
    for name, check in found.checks.items():
        theirs = expected.checks[name]
        assert (check.contact, check.part) == (theirs.contact, theirs.part) or check.value < 1e-6
        if name == "stick_creep" and check.kind != theirs.kind:  # by round-off
            continue
        if check.limit < 1e-4:
            assert max(check.value, theirs.value) < 0.2 * theirs.limit, name
            assert check.limit < 2 * theirs.limit, name
        else:
            assert check.value == pytest.approx(theirs.value, abs=1e-6 * check.limit), name
            assert check.limit == pytest.approx(theirs.limit, rel=1e-6), name
    said = f"ll {len(expected.checks)} checks"  # also at the begin of a sentence
    ours = found.verdict.removesuffix(WITHOUT_FIELDS)
    theirs = re.sub(OF_THE_WAY, "", expected.verdict)
    ours = re.sub(OF_THE_WAY, "", ours)
    assert ours.replace(f"ll {len(found.checks)} checks", said) == theirs


# Pairs, bolts to be tightened, and bounds that are no multiple of the pressure: no estimate says
# that they have one answer.
MAY_BE_COLD = ("two bodies", "bolt", "stabilised", "friction by compliance")


@pytest.mark.parametrize("name", CASES)
def test_quick_answers_are_those_of_separate_runs(name):
    """From whatever answer they began."""
    scene, make, every = CASES[name]
    study = Study(scene, COMM, make())
    starts = []
    for changes in [{}, *every, {}]:
        found = study.quantities(changes)
        starts.append(found.start)
        require_same_answer(found, study.solve(changes))
    assert study.factorisations == 1
    assert starts[0] == "cold"
    assert "followed" not in starts
    assert "warm" in starts or name in MAY_BE_COLD, starts


@pytest.mark.parametrize("name", CASES)
def test_a_further_answer_makes_no_form(name, monkeypatch):
    """To look one up costs more than all else of an answer."""
    scene, make, every = CASES[name]
    study = Study(scene, COMM, make())
    for changes in every:
        study.quantities(changes)
    made = []
    monkeypatch.setattr(form_cache, "_compiled", lambda terms, build: made.append(terms))
    for changes in every:
        assert study.quantities(changes).converged
    assert not made


def test_hertz_from_one_body():
    """F ~ d^(3/2) of a sphere on a half-space, whatever the mesh makes of the constant.

    K. L. Johnson, Contact Mechanics, 1985, (4.23).
    """
    study = Study(load_scene(ROOT / "demos" / "sphere.toml", ["contact.0.friction_coefficient=0"]))
    depths = np.array([0.25, 0.5, 1.0, 2.0])
    found = [study.quantities({DEPTH: depth}) for depth in depths]
    forces = np.array([answer.quantities["normal_force"] for answer in found])
    exact = 4 / 3 * 1000 / (1 - 0.3**2) * 8**0.5 * depths**1.5
    assert forces == pytest.approx(exact, rel=5e-3)
    assert [answer.start for answer in found] == ["cold", "warm", "warm", "warm"]
    assert study.factorisations == 1


def test_an_obstacle_that_has_moved_is_followed_in_a_few_steps():
    """Depths and slips are kept, so that the first step goes where the last tangent leads to."""
    study = Study(load_scene(ROOT / "demos" / "sphere.toml"))
    cold = study.quantities().newton_iterations
    radius = "contact.0.obstacle.radius"
    for changes in ({DEPTH: 0.97}, {DEPTH: 1.0}, {radius: 8.1}, {radius: 7.8, DEPTH: 0.99}):
        found = study.quantities(changes)
        assert found.start == "warm"
        assert found.newton_iterations <= 8 < cold / 2
        force = found.quantities["normal_force"]
        study.forget_answer()
        anew = study.quantities(changes)
        assert anew.start == "cold"
        assert force == pytest.approx(anew.quantities["normal_force"], rel=1e-9)


def newton_steps(monkeypatch):
    """Of every load step that is accepted from now on, in a list that grows."""
    found = []
    for name in ("add", "pass_by"):  # the last load step, and those before it
        take = getattr(StepHistory, name)

        def added(history, time, solution, take=take):
            found.append(solution.newton_iterations)
            take(history, time, solution)

        monkeypatch.setattr(StepHistory, name, added)
    return found


@pytest.mark.parametrize("law", ["incremental", "static"])
def test_later_load_steps_begin_at_those_of_the_last_answer(law, monkeypatch):
    """As a whole answer: none of them takes more than three Newton steps, and all are the same."""
    scene = of_contact(dragged(Steps(number=4)), law=law)
    study, found = Study(scene, COMM, block()), newton_steps(monkeypatch)
    study.quantities()
    cold = sum(found)
    for changes in ({MU: 0.303}, {DEPTH: 0.0202}, {"contact.0.obstacle.displacement.0": 0.00404}):
        found.clear()
        answer = study.quantities(changes)
        assert answer.start == "warm"
        later = list(found[1:])
        assert len(later) == 3 and max(later) <= 3 and sum(found) < 0.6 * cold, (found, cold)
        require_same_answer(answer, study.solve(changes))


def test_more_load_steps_than_the_last_answer_had():
    """Those that it did not have begin where they do in a separate run."""
    study = Study(dragged(Steps(number=2)), COMM, block())
    study.quantities()
    changes = {"steps": Steps(number=5)}
    answer = study.quantities(changes)
    assert answer.start == "warm"
    require_same_answer(answer, study.solve(changes))


def test_steps_that_are_cut_and_grow_begin_as_in_a_separate_run():
    """How large they become depends on how many Newton steps they take."""
    study = Study(dragged(Steps(automatic=True, number=4)), COMM, block())
    study.quantities()
    answer = study.quantities({MU: 0.303})
    assert answer.start == "cold"
    require_same_answer(answer, study.solve({MU: 0.303}))
    assert study.quantities({MU: 0.306}, follow=True).start == "followed"


def test_bodies_that_were_paired_anew_begin_with_the_penetrations_they_had(monkeypatch):
    """Measured from other points, as deep: as few Newton steps as before they were."""
    scene = shoved(Steps(times=(0.5, 0.6, 0.7, 0.8)), errors="none")
    study, found = Study(scene, COMM, two_blocks()), newton_steps(monkeypatch)
    study.quantities()
    for changes in ({MU: 0.303}, {"support.1.displacement.y": -0.0101}):
        found.clear()
        answer = study.quantities(changes, follow=True)
        assert answer.start == "followed"
        _, as_meshed, *paired_anew = found
        assert len(paired_anew) == 2 and max(paired_anew) <= as_meshed + 1, found
        require_same_answer(answer, study.solve(changes))


def test_a_doubt_about_an_earlier_load_step_is_said_though_nobody_measures_it():
    """Bodies slide by a fifth of their size in the second of three steps, and hardly in the last.

    Works of all steps count, too, so that an answer's energies are those of a run.
    """
    study = Study(shoved(Steps(times=(0.5, 0.98, 1.0)), errors="none"), COMM, two_blocks())
    whole = study.solve()
    quick = study.quantities()
    (said,) = re.findall(r"Bodies slid far[^:]*", whole.verdict)
    assert "by 0.1" in said
    assert said in quick.verdict
    require_same_answer(quick, whole)


def test_contact_without_friction_serves_all_coefficients_of_coulomb(monkeypatch):
    """It tells ε, and is solved again where anything else changes: friction that is given, too."""
    rubbed = Contact("x0", pressure=2, friction_coefficient=0.5)
    scene = dataclasses.replace(ON_A_FLOOR, contact=(*ON_A_FLOOR.contact, rubbed))
    solved, solve = [], warm_start.contact_without_friction

    def counted(newton, *tolerance):
        solved.append(newton)
        return solve(newton, *tolerance)

    monkeypatch.setattr(warm_start, "contact_without_friction", counted)
    study, other = Study(scene, COMM, square()), "contact.1.friction_coefficient"
    times = []
    for changes in (
        {},
        {MU: 0.31},
        {MU: 0.32},
        {MU: 0},
        {MU: 0.3},
        {other: 0.1},
        {other: 0.1, MU: 0.2},
    ):
        found = study.quantities(changes)
        require_same_answer(found, study.solve(changes))
        times.append(len(solved))
        assert found.start == ("cold" if not changes else "warm")
    assert times == [0, 1, 1, 1, 1, 2, 2]


def test_cattaneo_from_one_body():
    """A cylinder pressed on a half-plane and pushed along it: c/a = √(1 − Q/μP), within a cell.

    K. L. Johnson, Contact Mechanics, 1985, Section 7.2. Near ν = ½ pressing alone makes hardly any
    friction.
    """
    cells, width, coefficient = 40, 3.0, 0.6
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.489),
        half_space=HalfSpace(("x0", "x1", "y0")),
        contact=(
            Contact(
                "y1",
                friction_coefficient=coefficient,
                obstacle=Obstacle(
                    "cylinder", radius=50, position=(1.5, 1.5), force=6, displacement=(1e-4, 0)
                ),
            ),
        ),
    )
    study = Study(scene, COMM, box_body((cells, cells // 2), (width, width / 2)))
    tried = []
    for push in np.linspace(1e-4, 6e-3, 20):
        key = "contact.0.obstacle.displacement.0"
        found = study.quantities({key: push}, checks=False).quantities
        share = abs(found["friction_force"][0]) / (coefficient * found["normal_force"])
        half, stick = found["contact_area"] / 2, found["stick_area"] / 2
        assert abs(stick / half - np.sqrt(1 - share)) < 0.5 * width / cells / half, share
        tried.append(share)
    assert min(tried) < 0.1 and max(tried) > 0.9, tried
    assert study.factorisations == 1


def test_what_was_not_checked_has_not_passed(slab_study):
    answer = slab_study.quantities(checks=False)
    assert answer.converged and not answer.passed
    assert (answer.checks, answer.exit_code) == (None, None)
    assert answer.verdict == "Converged; nothing was checked."


def test_a_wrong_compliance_of_the_contacts_is_noticed():
    """The contacts' own balance says nothing of it: the reactions do, which come from the bulk."""
    study = Study(ON_A_FLOOR, COMM, square())
    assert study.quantities().passed
    study.forget_answer()
    body = study._body.kept.condensed
    if COMM.rank == 0:
        body.bulk.schur *= 1.001
        body._of_schur = None
    answer = study.quantities()
    assert answer.converged and answer.exit_code == 4
    assert not answer.checks["equilibrium"].passed
    assert "do not trust it: failed equilibrium" in answer.verdict


def lifted_block():
    """Two feet on a floor with much friction: it jams, or lifts off, as it came there."""
    return dataclasses.replace(
        ON_A_FLOOR,
        support=(Support("y1", {"x": 0.002, "y": -0.002}),),
        load=(),
        contact=(Contact("y0", friction_coefficient=5),),
    )


def test_beyond_the_limit_of_uniqueness_it_begins_as_a_separate_run():
    """Unless it is to follow, which it says."""
    study = Study(lifted_block(), COMM, square())
    study.quantities()
    limit = study.solve().contacts[0].uniqueness_limit
    assert limit < 5
    above, below = study.quantities({MU: 4.9}), study.quantities({MU: 0.1})
    assert (above.start, above.said) == ("cold", "")
    assert (below.start, below.said) == ("warm", "")
    followed = study.quantities({MU: 4.8}, follow=True)
    assert followed.start == "followed"
    assert "a separate run may find another one" in followed.said


@pytest.mark.errors
def test_error_bars_are_those_of_a_separate_run():
    """Of a body that has served another answer before."""
    body = square()
    study = Study(ON_A_FLOOR, COMM, body)
    study.solve({MU: 0})
    found, expected = study.solve({MU: 0.35}), run(study.changed({MU: 0.35}), COMM, body)
    assert expected.errors["normal_force"]["total"] > 0
    for name, row in expected.errors.items():
        known = [error for error in row.values() if error is not None]
        for source, error in row.items():
            ours = found.errors[name][source]
            assert (ours is None) == (error is None), (name, source)
            size = row["total"] or max(known, default=0.0)
            assert error is None or abs(ours - error) <= 0.01 * size, (name, source)
    assert study.factorisations == 1


def test_another_cut_is_another_mesh():
    """A preload's `between` has its body cut before it is meshed."""
    scene = load_scene(ROOT / "demos" / "joint.toml")
    study = Study(scene, COMM)
    assert study.other_parts({"preload.0.between": (-2, 2)}) == ["mesh", "preloads"]
    assert study.other_parts({"preload.0.force": 5e3}) == []
