"""Springs in steps of Newton's method: where they act, how stiff they are, that none is left."""

import numpy as np
import pytest

from fenics_contact import main
from fenics_contact.solve.globalisation import SpringControl
from fenics_contact.solve.systems.system import sprung


def test_as_many_springs_as_motions():
    rng = np.random.default_rng(3)
    points = rng.random((7, 2))
    motions = np.zeros((14, 3))
    motions[::2, 0] = motions[1::2, 1] = 1.0
    motions[::2, 2], motions[1::2, 2] = -points[:, 1], points[:, 0]
    places = sprung(motions)
    assert len(set(places)) == 3
    assert np.linalg.matrix_rank(motions[places]) == 3
    doubled = np.column_stack([motions, motions[:, :1]])
    assert len(sprung(doubled)) == 3
    assert len(sprung(np.zeros((0, 3)))) == len(sprung(np.zeros(0))) == 0


def test_softer_where_steps_bring_little_and_stiffer_where_the_imbalance_grows():
    control = SpringControl()
    first = control.share([100.0], 1.0)
    assert control.share([100.0, 99.0], 1.0) == pytest.approx(first / 10)
    assert control.share([100.0, 99.0, 1e6], 1.0) == pytest.approx(first)
    assert control.share([100.0, 99.0, 1e6, 1.0], 1.0) == pytest.approx(first)


def test_they_vanish_with_the_imbalance():
    control = SpringControl()
    far = control.share([10.0], 1.0)
    assert control.share([10.0, 1e-6], 1.0) == pytest.approx(1e-3 * far)


@pytest.mark.serial
def test_answers_are_as_exact_as_without_springs():
    """Uniform pressures on cells of very different sizes: forces alone are balanced earlier.

    On the way to that of the sheet steps run so far that round-off lets forces pass.
    """
    cases = ("graded_1e+06", "pair_patch_against", "sheet_1e+04_q2")
    assert main(["verify", "--hard", *cases]) == 0
