"""Steps are cut where energy would rise: a soft body that a stiff obstacle stops."""

import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.solve.globalisation import search_by_secants, share_of_step
from tests.scenes import box_body


@pytest.mark.parametrize("kink", [1e-6, 0.006, 0.3, 0.9])
@pytest.mark.parametrize("stiffness", [1.0, 1e4, 1e9])
def test_zero_of_a_slope_that_turns_steep(kink, stiffness):
    """Even before the kink, stiff beyond it, as a slender body that meets a penalty."""
    tried = []

    def slope_at(share):
        tried.append(share)
        return share - 1.0 + stiffness * max(share - kink, 0.0)

    share = share_of_step(slope_at)
    zero = (1 + stiffness * kink) / (1 + stiffness)
    assert share == pytest.approx(zero, abs=0.1 / (1 + stiffness) * 1.01)
    assert len(tried) < 60


def test_whole_step_where_energy_falls_or_has_no_slope():
    assert share_of_step(lambda share: share - 2.0) == 1.0
    assert share_of_step(lambda share: share - 1.0) == 1.0
    assert share_of_step(lambda share: 1.0 + share) == 1.0


@pytest.mark.parametrize(("zero", "ends"), [(0.4, 0.4), (1.0, 1.0), (9.0, 2.0)])
def test_secants_find_the_zero_of_a_straight_slope_in_two_tries(zero, ends):
    """Also beyond the step, but not farther than twice as far."""
    tried = []

    def slope_at(share):
        tried.append(share)
        return share - zero

    assert search_by_secants(slope_at, -zero) == pytest.approx(ends)
    assert tried[0] == 1.0
    assert len(tried) <= 2 or ends != zero


def test_secants_are_content_with_a_slope_of_half():
    assert search_by_secants(lambda share: share - 1.6, -1.6) == 1.0


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_cantilever_on_a_stop(solver):
    """Its tip would go 6.6 times as far: N = F − 3 E I δ/L³ (Euler and Bernoulli), L/h = 16.

    Secants along the step stall where the tip closes the gap; shear adds .1 % to what it gives way.
    """
    length, height, gap, force = 4.0, 0.25, 0.05, 0.02
    scene = Scene(
        kinematics="plane stress",
        material=Material(1000, 0.0),
        discretisation=Discretisation(2),
        support=(Support("x0", {"x": 0, "y": 0}),),
        load=(Load("x1", traction=(0, -force / height)),),
        contact=(Contact("y0", obstacle=Obstacle(gap=gap)),),
        solver=SolverSettings(solver=solver),
    )
    result = run(scene, body=box_body((16, 2), (length, height)))
    bent = 3 * 1000 * height**3 / 12 * gap / length**3
    assert result.passed
    assert force - result.quantities["normal_force"] == pytest.approx(bent, rel=5e-3)
