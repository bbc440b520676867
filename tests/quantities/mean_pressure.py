"""A quantity that is not the program's: the mean pressure, all that there is of it in one file."""

from fenics_contact.evaluate import contact_quantities
from fenics_contact.evaluate.contact_areas import contact_area
from fenics_contact.evaluate.contact_quantities import ContactAnswer
from fenics_contact.quantities.quantity import Edge, Quantity, Together

NAME = "mean_contact_pressure"
ROW = Quantity(
    NAME,
    "stress",
    "∫ p dA over the area in contact; 0 where nothing touches",
    together=Together.OF_THE_ONLY,
    is_asked_for=True,
    edges=(Edge.CONTACT,),
    is_local=True,
)


def value(answer: ContactAnswer) -> float:
    """Of a contact; collective."""
    area = contact_area(answer.zones)
    force = float(answer.contact.trace.integral(answer.state.contact_pressure))
    return force / area if area > 0 else 0.0


def register() -> None:
    """Make it known."""
    contact_quantities.register(ROW, value)


def unregister() -> None:
    """Make it unknown again."""
    contact_quantities.unregister(NAME)
