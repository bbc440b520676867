"""The table that a run writes of what joints damp."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.analyses.vibration.record import DampingRecord
from fenics_contact.results.result import Result


def tables(result: Result) -> dict[str, list[list[str]]]:
    """Rows of ``damping.csv``, its header first.

    Args:
        result: Of a run that looked for modes.
    """
    return {"damping.csv": damping_rows(result.damping)} if result.damping else {}


def damping_rows(found: Sequence[DampingRecord]) -> list[list[str]]:
    """The rows of ``damping.csv``, its header first: one a mode and amplitude.

    Bars stand in ``…_error``, which is empty where they were not estimated.

    Args:
        found: At least one.
    """
    names = [name for name in found[0] if name not in ("by", "contacts", "errors")]
    contacts, keys = list(found[0].contacts), list(found[0].by)
    bars = ("natural_frequency", "damping_ratio", "loss")
    rows = [
        [
            *(*keys, *names),
            *(f"{contact}.loss" for contact in contacts),
            *(f"{name}_error" for name in bars),
        ]
    ]
    for one in found:
        values = [one.by[key] for key in keys] + [one[name] for name in names]
        values += [one.contacts[name] for name in contacts]
        known = [one.errors.get(name, {}).get("total") for name in bars]
        values += ["" if error is None else error for error in known]
        rows.append([value if isinstance(value, str) else repr(value) for value in values])
    return rows
