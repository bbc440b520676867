"""A history in finite strains that another run goes on with ends as the one that never stopped."""

import pytest

from fenics_contact import Run
from fenics_contact.simulation.state_file import StateFile
from tests.solve.finite.rubber import dragged, long_block

TIMES = (1.0, 1.25, 1.5)


def test_a_drag_goes_on_where_it_was(folder):
    """With slip that is counted along the cylinder, and tractions that have turned with it."""
    whole = Run(dragged(TIMES), body=long_block())
    expected = whole.solve()
    first = Run(dragged(TIMES[:2]), body=long_block())
    first.solve(state=StateFile(folder, first.problem))
    second = Run(dragged(TIMES), body=long_block())
    state = StateFile(folder, second.problem)
    found = second.solve(state=state, saved=state.load())
    for name in ("contact_force", "friction_work", "max_slip", "strain_energy"):
        assert found.quantities[name] == pytest.approx(expected.quantities[name], rel=1e-9), name
    assert found.passed
