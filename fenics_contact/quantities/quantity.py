"""A quantity of a run: all that is known of it without an answer."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Together(Enum):
    """How the quantity of the whole model follows from those of its contacts.

    The value says it in a sentence of ``docs/results.md``: of all contacts, and of those that have
    the quantity where some have not.
    """

    OF_THE_ONLY = "of the only contact; `null` with several", ""
    OF_THE_ONE = "", "of the only contact that has one"
    SUM = "sum", "sum of those that have it"
    LARGEST = "the largest of all", "the largest of those that have it"
    NOT_THERE = "not there", "not there"


class Edge(Enum):
    """An edge on a contact surface: where contact ends, or where sticking ends."""

    CONTACT = 0
    STICK = 1


class Singular(Enum):
    """The kind of quantity by which it converges, or not, where stress has no bound.

    Stress has none beside a step of prescribed displacements, or at a pressed corner.
    """

    RESULTANT = "a sum of tractions"
    PEAK = "the pressure's peak"
    ENERGY = "the energy of the whole model"


# What adds up over the thickness of plane bodies.
_EXTENSIVE = ("force", "force·length", "area", "volume", "energy", "impulse")


@dataclass(frozen=True)
class Quantity:
    """A key of ``quantities`` of ``result.json``.

    Attributes:
        name: The key.
        unit: Such as ``force``; empty of a pure number.
        meaning: What it is of a contact, or of the whole model where contacts have none.
        together: How the whole model's is made of those of contacts; None where contacts have none.
        is_of_some: Whether some contacts have none, such as those that do not wear.
        is_vector: Whether it has a component along each axis.
        is_moment: Whether its components are about the axes: in plane models it is one number.
        is_asked_for: Whether an accuracy, a derivative or a fit can name it.
        has_true_value: Whether there is one to be apart from: then it has an error bar. Others
            count points, or say how a run went.
        needs: ``friction``, or ``contact found`` and not given; without it nothing is said.
        relative_to: Name of the quantity that an accuracy of it is relative to, where it may
            vanish; empty where it is relative to itself.
        no_value: What is said where it has none.
        instead: Name of the quantity that stands for it where it has no value.
        edges: What bounds it, of an area or of its radius.
        is_local: Whether it depends on how pressure or slip is spread: a mesh with few points
            across a contact does not tell how wrong it is.
        singular: What it follows where stress has no bound.
        is_secondary: Whether others say it as well: shown only where all quantities are.
    """

    name: str
    unit: str
    meaning: str
    together: Together | None = None
    is_of_some: bool = False
    is_vector: bool = False
    is_moment: bool = False
    is_asked_for: bool = False
    has_true_value: bool = True
    needs: str = ""
    relative_to: str = ""
    no_value: str = "none"
    instead: str = ""
    edges: tuple[Edge, ...] = ()
    is_local: bool = False
    singular: Singular | None = None
    is_secondary: bool = False

    @property
    def whole(self) -> str:
        """How the value of the whole model is made of those of contacts, in words; or empty."""
        return "" if self.together is None else self.together.value[self.is_of_some]

    @property
    def is_extensive(self) -> bool:
        """Whether it is in proportion to the thickness of plane bodies, all else being the same."""
        return self.unit in _EXTENSIVE
