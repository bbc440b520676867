"""The table that a run writes of fretting."""

from __future__ import annotations

from fenics_contact.results.result import Result


def tables(result: Result) -> dict[str, list[list[str]]]:
    """Rows of ``fretting.csv``, its header first.

    Args:
        result: Of a run that looked for fretting.
    """
    places = result.fretting_places
    return {} if places is None else {"fretting.csv": places.rows()}
