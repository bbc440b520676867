"""Natural modes, and what joints damp of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fenics_contact.results.records.record import ErrorRow, Quantities, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class ModeRecord(Record):
    """A natural mode of small amplitude, while all that carries pressure is stuck.

    Attributes:
        number: The lowest is 1.
        natural_frequency: Of small vibrations (cycles/time).
        modal_mass: Of the mode with a largest displacement of 1 (mass).
        errors: `natural_frequency` → its estimated errors by source; empty where none was made.
    """

    number: int
    natural_frequency: float
    modal_mass: float
    errors: Mapping[str, ErrorRow] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class DampingRecord(Record):
    """A mode that is driven to and fro at an amplitude.

    Attributes:
        mode: Its number.
        driven: Largest displacement to which the forces would drive it if nothing slipped (length).
        amplitude: Half of the way to and fro, by the mode's share in the displacement (length).
        natural_frequency: By the secant of the loop (cycles/time).
        damping_ratio: ζ = D/(4πU), with U the energy of that frequency and amplitude.
        loss: D, what friction dissipates in a cycle (energy).
        loop_area: What the forces that drive it put into a cycle, which is D once it closes
            (energy).
        contacts: Name of a contact → what friction dissipates there (energy).
        kind: Of the loop, as of cycles; empty where it did not close.
        cycles: How many were driven.
        by: Key of the scene → its value, where several were asked for.
        errors: `amplitude`, `natural_frequency`, `damping_ratio`, `loss`, and `NAME.loss` of each
            contact → estimated errors by source; empty where none was made.
    """

    mode: int
    driven: float
    amplitude: float
    natural_frequency: float
    damping_ratio: float
    loss: float
    loop_area: float
    contacts: Quantities
    kind: str
    cycles: int
    by: Quantities = field(default_factory=dict)
    errors: Mapping[str, ErrorRow] = field(default_factory=dict)
