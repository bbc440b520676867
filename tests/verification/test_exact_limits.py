"""The exact answer as the limit of penalty and smoothing: scenes of ``verify exact_limits``."""

import pytest

from fenics_contact.verification.exact_limits import limit_scenes, orders

SCENES = {one.name: one for one in limit_scenes()}


def test_there_are_twenty_scenes() -> None:
    assert len(SCENES) == 20


@pytest.mark.parametrize("name", ["parabola under a force", "two bodies whose meshes match"])
def test_a_tenth_of_a_parameter_leaves_a_tenth_of_the_difference(name: str) -> None:
    found = list(orders(SCENES[name]))
    assert len(found) == 4
    for one in found:
        assert one.passed, (one.quantity, one.value)
