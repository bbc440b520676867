"""What files of others have registered, so that a test can take it out again."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from fenics_contact.analytic import obstacle_shapes
from fenics_contact.contact.laws import normal
from fenics_contact.contact.laws.friction import rules
from fenics_contact.evaluate import contact_quantities
from fenics_contact.problem import loads
from fenics_contact.simulation.sensitivities import gradients


def registered() -> dict[Callable[[Any], None], list[Any]]:
    """Return all that is known, by the function that takes it out."""
    return {
        loads.unregister: list(loads.LAWS),
        obstacle_shapes.unregister: list(obstacle_shapes.names()),
        contact_quantities.unregister: list(contact_quantities._REGISTERED),
        normal.unregister: list(normal._REGISTERED),
        rules.unregister: list(rules._REGISTERED),
        gradients.unregister: list(gradients._OF_CONTACTS),
    }


@contextmanager
def nothing_stays_registered() -> Iterator[None]:
    """Take out, at the end, what has been registered since the beginning."""
    before = registered()
    try:
        yield
    finally:
        for unregister, known in registered().items():
            for one in known:
                if one not in before[unregister]:
                    unregister(one)
