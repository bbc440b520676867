"""The few lines that matter most: what preloads and contacts carry, and what friction took."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fenics_contact.common.plain_text import one_line
from fenics_contact.quantities.names import (
    FRICTION_FORCE,
    FRICTION_WORK,
    MAX_CONTACT_PRESSURE,
    MAX_SLIP,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    SLIP_SHARE,
)
from fenics_contact.quantities.table import QuantityValue, measured_by
from fenics_contact.results.quantities import idle_quantities
from fenics_contact.results.records.contacts import ContactRecord, PreloadRecord
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.records.units import NO_UNITS, UnitsRecord
from fenics_contact.results.words.rounding import is_none, rounded, sizes_of

# Of what friction can hold: what it does not hold.
_NO_SHARE = 1e-9


def headlines(result: Outcome) -> list[str]:
    """A line a preload and a contact, and what friction dissipated; none without an answer.

    Args:
        result: Of a run.
    """
    if not result.converged:
        return []
    words = _Words(result.units or NO_UNITS, sizes_of(result.quantities, result.contacts))
    lines = [words.of_preload(name, preload) for name, preload in result.preloads.items()]
    lines += [words.of_contact(contact) for contact in result.contacts if contact.quantities]
    lines += _parts(result)
    if result.contacts and FRICTION_WORK not in idle_quantities(result.contacts):
        lines.append(f"Friction dissipated {words.estimate(FRICTION_WORK, result)}.")
    return lines


@dataclass(frozen=True)
class _Words:
    """Words for a run's values.

    Attributes:
        units: Its own; without names where it has none.
        sizes: Of its forces, pressures and so on.
    """

    units: UnitsRecord
    sizes: Mapping[str, float]

    def of_preload(self, name: str, preload: PreloadRecord) -> str:
        """Return the force of a preload, and whether its length is locked."""
        force = self._with_bar(preload.force, preload.errors, "force", "force")
        locked = ", its length locked" if preload.locked else ""
        return f"Preload '{one_line(name)}': force {force}{locked}."

    def of_contact(self, contact: ContactRecord) -> str:
        """Return the force, largest pressure and slip of a contact."""
        found, idle = contact.quantities, idle_quantities([contact])
        pressing = NORMAL_FORCE if found.get(NORMAL_FORCE) is not None else PRESSURE_INTEGRAL
        words = []
        if found.get(pressing) is not None:
            words.append(f"presses with {self.estimate(pressing, contact)}")
        friction = found.get(FRICTION_FORCE)
        if isinstance(friction, list) and FRICTION_FORCE not in idle:
            force = math.hypot(*friction)
            said = self._with_bar(force, contact.errors, FRICTION_FORCE, "force")
            share = _share(contact)
            if not is_none(force, self.sizes["force"]):
                words.append(f"friction {said}" + (f" ({share} of its limit)" if share else ""))
            elif share not in (
                "",
                "0 %",
                "-",
            ):  # around an axis forces cancel, and their moments do not
                words.append(f"friction at {share} of its limit")
        for key, said in (
            (MAX_CONTACT_PRESSURE, "peak pressure"),
            (MAX_SLIP, "slips by up to"),
        ):
            if found.get(key) is None or key in idle:
                continue
            if not is_none(found[key], self.sizes[measured_by(key)]):
                words.append(f"{said} {self.estimate(key, contact)}")
        return f"Contact '{one_line(contact.name)}': {', '.join(words)}."

    def estimate(self, key: str, found: ContactRecord | Outcome) -> str:
        """A quantity with its bar."""
        value = found.quantities[key]
        assert value is not None
        return self._with_bar(value, found.errors, key, measured_by(key))

    def _with_bar(self, value: QuantityValue, errors: Errors, key: str, measured: str) -> str:
        """Without a bar where the run estimated none at all, and where none is needed."""
        said, bar = rounded(value, errors.get(key), self.sizes[measured])
        unit = self.units.of(measured)
        return f"{said}{f' ± {bar}' if errors and bar else ''}{f' {unit}' if unit else ''}"


def _share(contact: ContactRecord) -> str:
    """How much of what friction can hold it does; empty of files before that was written."""
    if SLIP_SHARE not in contact.quantities:
        return ""
    share = contact.quantities[SLIP_SHARE]
    return "-" if share is None else _percent(share)


def _percent(share: float) -> str:
    """A share of a limit; what is round-off is none."""
    return f"{100 * share:.3g} %" if share > _NO_SHARE else "0 %"


def _parts(result: Outcome) -> list[str]:
    """How much of what friction can hold of it each part uses, all its contacts together."""
    shares = {} if result.slip_limit is None else result.slip_limit.parts
    return [
        f"Part '{one_line(name)}': friction holds it with {_percent(share)} of its limit."
        for name, share in shares.items()
        if share is not None
    ]
