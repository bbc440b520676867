"""Supports that meet at an edge."""

from fenics_contact import Material, Path, Run, Scene, SolverSettings, Steps, Support
from tests.messages import refused
from tests.scenes import box_body

LATER = Path(time=(1, 2), factor=(0, 1))


def sheared(path):
    """A block whose top is moved, and whose side is up there as far, by a path of its own."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(
            Support("y0", {"x": 0, "y": 0}),
            Support("y1", {"x": 0.01}, path=LATER),
            Support("x1", {"x": lambda x: 0.01 * x[1]}, path=path),
        ),
        steps=Steps(number=2, end=2),
        solver=SolverSettings(errors="none"),
    )


def test_supports_that_move_a_corner_as_far_do_so_at_the_same_time():
    result = Run(sheared(lambda time: max(time - 1.0, 0.0)), body=box_body((2, 2), (1, 1))).solve()
    assert result.passed, result.verdict
    with refused("supports_move_a_point_differently"):
        Run(sheared(Path(time=(0, 1), factor=(0, 1))), body=box_body((2, 2), (1, 1)))
