"""A quantity that is not the program's, with its gradient: the mean of the pressure, by forces."""

from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.evaluate import contact_quantities
from fenics_contact.quantities.quantity import Quantity, Together
from fenics_contact.simulation.sensitivities import gradients

NAME = "weighted_contact_pressure"
ROW = Quantity(
    NAME,
    "stress",
    "∫ p² dA over ∫ p dA, the pressure that an average part of the force acts under; 0 without one",
    together=Together.OF_THE_ONLY,
    is_asked_for=True,
    is_local=True,
)


def _moments(answer):
    """∫ p dA and ∫ p² dA; collective."""
    trace, pressure = answer.contact.trace, answer.state.contact_pressure
    return float(trace.integral(pressure)), float(trace.integral(pressure**2))


def value(answer):
    """Of a contact; collective."""
    force, second = _moments(answer)
    return second / force if force > 0 else 0.0


def gradient(answer, axis):
    """In the pressure at each point; collective."""
    force, second = _moments(answer)
    none = AnswerGradient.none(answer.contact)
    if force <= 0:
        return none
    by_pressure = 2 * answer.state.contact_pressure / force - second / force**2
    return none.adding(pressure=answer.contact.trace.weights * by_pressure)


def register():
    """Make it known."""
    contact_quantities.register(ROW, value)
    gradients.register(NAME, gradient)


def unregister():
    """Make it unknown again."""
    gradients.unregister(NAME)
    contact_quantities.unregister(NAME)
