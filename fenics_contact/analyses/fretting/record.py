"""Fretting: where the history of stress near contacts is worst, by each criterion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from fenics_contact.results.records.record import ErrorRow, Record


@dataclass(frozen=True, eq=False, kw_only=True)
class WorstPlace(Record):
    """Where a criterion is largest.

    Attributes:
        value: Of the criterion (stress).
        errors: Estimated errors of it; of the mesh, as the difference of two recoveries of the
            stress, or 2.4 times what it changes by within two cells, where that is more.
        at: The place, undeformed, three coordinates (length).
        body: The connected part of the body that it is of.
        contact: The contact on whose surface it lies; empty below a surface or beside it.
        plane: Unit normal of the critical plane, of `swt`.
        life: Cycles to a crack, of `swt` where the scene has constants of the material; null where
            it is endless.
        life_errors: Estimated errors of these.
        safety_factor: The fatigue limit in torsion over the value, of the others; null where no
            load of this kind ever reaches it.
        safety_factor_errors: Estimated errors of it.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"plane", "life_errors", "safety_factor_errors"})

    value: float
    errors: ErrorRow
    at: list[float]
    body: str
    contact: str = ""
    plane: list[float] = field(default_factory=list)
    life: float | None = None
    life_errors: ErrorRow = field(default_factory=dict)
    safety_factor: float | None = None
    safety_factor_errors: ErrorRow = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class FrettingRecord(Record):
    """Criteria of fatigue by the history of stress near contacts.

    Attributes:
        steps: How many states of the body make the cycle, its begin with them.
        places: At how many nodes, all of them in `fretting.csv`.
        crossland_alpha: Factor of the mean stress, by the fatigue limits.
        dang_van_alpha: Likewise.
        worst: `swt`, `crossland`, `dang_van` → where it is largest; empty where nothing touched.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset({"crossland_alpha", "dang_van_alpha"})

    steps: int
    places: int
    crossland_alpha: float | None = None
    dang_van_alpha: float | None = None
    worst: Mapping[str, WorstPlace] = field(default_factory=dict)
