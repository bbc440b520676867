"""Solving again from where other answers lead: the same answers, in fewer steps."""

import numpy as np
import pytest

from fenics_contact import Contact, Discretisation, Material, Obstacle, Run, Scene, Support
from fenics_contact.evaluate.contact_quantities import contact_quantities
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from fenics_contact.solve.load_steps.load_stepper import stepping
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.solving_again import AlongLine, last_step_again
from tests.scenes import box_body, with_solver
from tests.simulation.sensitivities.scenes import SPHERE
from tests.simulation.studies.cases import PAD

pytestmark = pytest.mark.errors


def test_answers_along_a_line_are_those_from_the_last_step_in_fewer_steps():
    """A cylinder that is pressed less deep, in eight loads."""
    obstacle = Obstacle("parabola", radius=0.5, position=(1, 1), indentation=0.05)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(2),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=0.2),),
    )
    problem = Run(scene, body=box_body((24, 12), (2, 1))).problem
    found, steps = [], []

    def answers(load_steps: LoadSteps) -> None:
        line, total = AlongLine(load_steps), 0
        for share in np.arange(8, 0, -1) / 8:
            time = load_steps.time * (1 - 0.3 * share)

            def measure(solution):
                nonlocal total
                total += solution.newton_iterations
                return contact_quantities(problem, solution, 0)

            def change(problem, time=time):
                problem.set_time(time)

            pair = []
            for near in (None, line.at(share)):
                total = 0
                pair.append(last_step_again(load_steps, measure, change, near))
                steps.append(total)
            found.append(pair)

    with stepping(problem) as load_steps:
        load_steps.solve()
        answers(load_steps)
    for alone, along in found:
        for name in ("normal_force", "contact_area", "stick_area", "max_slip"):
            assert along[name] == pytest.approx(alone[name], rel=1e-7)
    forces = [along["normal_force"] for _, along in found]
    assert (np.diff(forces) > 0.02 * forces[0]).all()
    assert sum(steps[1::2]) < 0.8 * sum(steps[::2])


@pytest.mark.parametrize(("solver", "fewer"), [("iterative", 1), ("condensed", 0)])
def test_answers_that_are_roughly_known_tell_what_a_change_does_in_fewer_steps(solver, fewer):
    """A pad that is pulled aside, by less: to some per cent of the change. Where answers are cheap,
    all are exact."""
    ball = {**SPHERE, "load.0.traction": (3.0, 0.0, 0.0)}
    scene = with_solver(with_changes(PAD, ball), solver=solver, errors="none")
    problem = Run(scene, body=box_body((5, 5, 3))).problem
    found, steps = [], []

    def answers(load_steps: LoadSteps) -> None:
        def measure(solution):
            steps.append(solution.newton_iterations)
            return contact_quantities(problem, solution, 0)

        def change(problem):
            problem.set_time(0.9 * load_steps.time)

        found.append(measure(load_steps.last.solution))
        for roughly in (False, True):
            found.append(last_step_again(load_steps, measure, change, roughly=roughly))

    with stepping(problem) as load_steps:
        load_steps.solve()
        answers(load_steps)
    answer, exact, rough = found
    for name in ("normal_force", "friction_force", "max_slip", "penalty_energy"):
        change = np.linalg.norm(np.subtract(exact[name], answer[name]))
        off = np.linalg.norm(np.subtract(rough[name], exact[name]))
        assert off <= 0.05 * change, name
    assert steps[2] <= steps[1] - fewer
