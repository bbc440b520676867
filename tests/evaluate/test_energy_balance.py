"""Work and energies along load steps: exact where nothing changes, convergent where it does."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Path, Run, Scene, Steps, Support, run
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.evaluate.energy_balance import EnergyBalance
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.quantities import global_quantities
from fenics_contact.solve.load_steps.accepted_step import AtEachStep
from fenics_contact.solve.load_steps.load_stepper import solve
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD
THERE_AND_BACK = Path(time=(0.2, 0.4, 0.8, 1), factor=(0, 1, -1, 0))
PRESSED_FIRST = Path(time=(0, 0.2), factor=(0, 1))
INDENTER = Obstacle("parabola", 2, position=(1, 1), indentation=0.03)
SLIDER = dataclasses.replace(
    INDENTER,
    path=Path(time=(0, 0.3), factor=(0, 1)),
    displacement=(0.02, 0),
    displacement_path=Path(time=(0.3, 1), factor=(0, 1)),
)


def rough(obstacle, steps, friction=0.3, law="incremental", **contact):
    """A block on its bottom, an obstacle above."""
    if contact.get("contact") != "bonded":
        contact |= {"friction_coefficient": friction, "law": law}
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, **contact),),
        steps=Steps(steps),
    )


def block(size=(2, 1)):
    return box_body((16, 8), size)


def defects(result):
    """Defect of every step by itself, and the work done in all."""
    found = [step["quantities"]["energy_defect"] for step in result.steps]
    work = [step["quantities"]["external_work"] for step in result.steps]
    return np.diff(found, prepend=0), np.abs(np.diff(work, prepend=0)).sum()


def dragged(obstacle, steps):
    result = run(rough(obstacle, steps), COMM, block())
    assert result.passed, result.verdict
    return result


@pytest.mark.parametrize("kind", ["bonded", "sticking", "springs"])
def test_what_never_changes_balances_exactly(kind):
    """Glue, friction under a given pressure that nothing overcomes, springs always pressed."""
    obstacle = Obstacle(
        indentation=0.02,
        path=PRESSED_FIRST,
        displacement=(0.01, 0),
        displacement_path=THERE_AND_BACK,
    )
    scene = {
        "bonded": rough(obstacle, 10, contact="bonded"),
        "springs": rough(obstacle, 10, friction=0, foundation_stiffness=500),
        "sticking": dataclasses.replace(
            rough(obstacle, 10),
            contact=(Contact("y1", pressure=20, friction_coefficient=5, law="incremental"),),
            load=(Load("x1", traction=(1, 0), path=THERE_AND_BACK),),
        ),
    }[kind]
    result = run(scene, COMM, block())
    by_step, work = defects(result)
    assert result.passed, result.verdict
    assert result.checks["energy_balance"].limit < 1e-8
    assert np.abs(by_step).max() <= 1e-9 * work


def test_gross_slip_balances_exactly_once_it_goes_on():
    """A block dragged over a pad under a given pressure: only where it begins is there a defect."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0.5, "y": 0}),),
        contact=(Contact("y0", pressure=20, friction_coefficient=0.5, law="incremental"),),
        steps=Steps(8),
    )
    result = run(scene, COMM, block())
    by_step, work = defects(result)
    assert result.passed, result.verdict
    assert (result.points.status == "SLIP").all()
    assert np.abs(by_step[1:]).max() <= 1e-9 * work
    dissipated = [step["quantities"]["friction_work"] for step in result.steps]
    # g × area × slip: every point goes 1/16 a step.
    assert np.diff(dissipated) == pytest.approx(0.5 * 20 * 2 * 0.5 / 8, rel=1e-6)
    assert by_step[0] == pytest.approx(-dissipated[0] / 2, rel=1e-2)  # half of it is the rule's


@pytest.mark.parametrize(
    ("obstacle", "friction", "order"), [(INDENTER, 0.0, 1.8), (SLIDER, 0.3, 1.0)]
)
def test_defect_falls_with_the_steps(obstacle, friction, order):
    shares = []
    for steps in (10, 20, 40):
        result = run(rough(obstacle, steps, friction), COMM, block())
        assert result.passed, result.verdict
        shares.append(result.checks["energy_balance"].value)
    assert shares[1] <= 0.02
    assert np.log2(shares[0] / shares[2]) / 2 >= order, shares


def test_slip_back_within_a_step_takes_work_too():
    """Dragged to and fro: forth and back cost the same, step by step, but for where it turns."""
    obstacle = Obstacle(
        indentation=0.03, path=PRESSED_FIRST, displacement=(1, 0), displacement_path=THERE_AND_BACK
    )
    quantities = [step["quantities"] for step in dragged(obstacle, 20).steps]
    spent = np.diff([q["friction_work"] for q in quantities])
    assert (spent[4:] > 0).all()
    # From the last step of pressing to the turn at step 8: |Q| × the way, less what is elastic.
    force = abs(quantities[6]["friction_force"][0])
    assert spent[[4, 5, 6, 9, 10, 13]] == pytest.approx(force * 0.25, rel=2e-2)


def test_bodies_that_slide_past_each_other():
    """What faces what is found anew on the way."""
    lower, upper = Box("lower", (0, -1), (2, 0), (10, 4)), Box("upper", (0.5, 0), (1.5, 1), (5, 3))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", {"y": -0.01}, path=Path(time=(0, 0.3), factor=(0, 1))),
            Support("upper.y1", {"x": 0.1}, path=Path(time=(0.3, 1), factor=(0, 1))),
        ),
        contact=(
            Contact("upper.y0", against="lower.y1", friction_coefficient=0.3, law="incremental"),
        ),
        steps=Steps(20),
    )
    prepared = Run(scene, COMM, boxes((lower, upper)))
    result = prepared.solve()
    assert result.passed, result.verdict
    assert result.checks["energy_balance"].value <= 0.01
    # Gross slip: the friction force along the way of the last step.
    last = [step["quantities"] for step in result.steps[-2:]]
    force = abs(last[1]["friction_force"][0])
    spent = last[1]["friction_work"] - last[0]["friction_work"]
    assert spent == pytest.approx(force * 0.1 / 14, rel=1e-2)


def test_one_step_has_no_path():
    result = run(rough(INDENTER, 1), COMM, block())
    assert "energy_balance" not in result.checks and "energy_defect" not in result.quantities
    stored = result.quantities["strain_energy"] + result.quantities["penalty_energy"]
    assert result.quantities["external_work"] > 1.9 * stored  # of the final forces


def test_static_law_has_no_path():
    result = run(rough(INDENTER, 4, law="static"), COMM, block())
    assert "energy_balance" not in result.checks and "energy_defect" not in result.quantities


def _wrong(solution, how):
    """A step's answer, made wrong by 5 %."""
    if how == "displacement":
        return with_body(
            solution,
            displacement=1.05 * solution.displacement,
            internal_force=1.05 * solution.internal_force,
        )
    force = [1.05 * force for force in solution.normal_force]
    return dataclasses.replace(solution, normal_force=force)


@pytest.mark.parametrize("how", ["displacement", "force", "energy", None])
def test_a_wrong_answer_is_noticed(how):
    prepared = Run(rough(SLIDER, 20), COMM, block())
    problem = prepared.problem
    book, kept = EnergyBalance(problem), {}

    def count(time, solution):
        found = solution if how in ("energy", None) else _wrong(solution, how)
        forces = BulkForces(problem, found)
        by_contact = [contact_quantities(problem, found, 0)]
        kept.update(global_quantities(forces, by_contact))
        kept["strain_energy"] *= 1.05 if how == "energy" else 1
        book.count(forces)
        kept.update(book.quantities(kept))

    solve(problem, None, AtEachStep(count), choice=prepared.choice)
    assert book.check(kept).passed == (how is None)


def test_a_book_goes_on_where_it_was_left():
    """Kept and given back between steps: for a run that is taken up again."""
    results = []
    for leaves in (False, True):
        prepared = Run(rough(SLIDER, 5), COMM, block())
        problem, books, kept = prepared.problem, [EnergyBalance(prepared.problem)], {}

        def count(time, solution, problem=problem, books=books, kept=kept, leaves=leaves):
            forces = BulkForces(problem, solution)
            kept.update(global_quantities(forces, [contact_quantities(problem, solution, 0)]))
            books[-1].count(forces)
            kept.update(books[-1].quantities(kept))
            if leaves:
                books.append(EnergyBalance(problem))
                books[-1].resume(books[-2].sums, forces)

        solve(problem, None, AtEachStep(count), choice=prepared.choice)
        results.append((kept["energy_defect"], books[-1].check(kept)))
    assert results[0] == results[1]


@pytest.mark.parametrize("gap", [0.0, 0.5])
def test_interference_does_no_work_on_the_way_through_a_drawn_gap(gap):
    """Clapeyron's theorem: the final pressure on its way beyond the gap is twice the energy."""
    parts = (Box("lower", (0, 0), (1, 1), (2, 2)), Box("upper", (0, 1 + gap), (1, 2 + gap), (3, 2)))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=(Support("lower.y0", {"x": 0, "y": 0}), Support("upper.y1", {"x": 0, "y": 0})),
        contact=(
            Contact(
                "upper.y0", against="lower.y1", interference=gap + 1e-3, penalty_parameter=2e-6
            ),
        ),
    )
    quantities = run(scene, COMM, boxes(parts)).quantities
    pressure = 1e-3 / (2 / 1000 + 2e-6)
    assert quantities["pressure_integral"] == pytest.approx(pressure, rel=1e-9)
    assert quantities["external_work"] == pytest.approx(1e-3 * pressure, rel=1e-9)
    stored = quantities["strain_energy"] + quantities["penalty_energy"]
    assert quantities["external_work"] == pytest.approx(2 * stored, rel=1e-9)
