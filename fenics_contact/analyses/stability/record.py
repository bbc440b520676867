"""Modes of bodies that slide steadily, and the friction coefficient at which one begins to grow."""

from __future__ import annotations

from dataclasses import dataclass, field

from fenics_contact.results.records.record import Record


@dataclass(frozen=True, eq=False, kw_only=True)
class ComplexModeRecord(Record):
    """A mode of small vibrations about steady sliding.

    Attributes:
        number: The lowest frequency is 1.
        frequency: At which it swings; 0 where it does not (cycles/time).
        growth_rate: Its amplitude grows as exp(growth_rate · t); < 0 where it decays (1/time).
        damping_ratio: −growth_rate over its angular frequency, < 0 where it grows.
        grows: Whether it does, by more than round-off.
    """

    number: int
    frequency: float
    growth_rate: float
    damping_ratio: float
    grows: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class ModesAtCoefficient(Record):
    """Stability of steady sliding at a friction coefficient.

    Attributes:
        friction_coefficient: The largest of all contacts.
        frequencies: Of its modes, rising (cycles/time).
        growth_rates: Likewise (1/time).
        largest_growth_rate: Of these; 0 where none grows by more than round-off (1/time).
    """

    friction_coefficient: float
    frequencies: list[float]
    growth_rates: list[float]
    largest_growth_rate: float


@dataclass(frozen=True, eq=False, kw_only=True)
class StabilityRecord(Record):
    """Whether steady sliding lasts.

    Attributes:
        friction_coefficient: Of the scene, the largest of all contacts.
        modes: At that coefficient.
        critical_coefficient: The smallest one at which a mode grows; null where none was asked for,
            or none up to the largest one that was asked for.
        curve: Modes over the coefficient, where they were asked for.
    """

    friction_coefficient: float
    modes: list[ComplexModeRecord]
    critical_coefficient: float | None = None
    curve: list[ModesAtCoefficient] = field(default_factory=list)
