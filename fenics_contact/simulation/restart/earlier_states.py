"""State files as versions before tables of rows wrote them, in today's terms."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

from fenics_contact.common.arrays import Array

# Tables by name: of its only block, which array of the file is which column.
Columns = dict[str, dict[str, str]]


def is_earlier(names: Collection[str]) -> bool:
    """Whether a file with such arrays is one of these; today's are ``table/block/column``."""
    return "nodes" in names


def header_in_todays_terms(header: dict[str, Any], read: Callable[[str], Array]) -> dict[str, Any]:
    """What is no array: scalars were arrays, and times stood by themselves.

    Args:
        header: Of the file.
        read: Gives an array of it by its name.
    """

    def unknowns(name: str, time: float | None) -> dict[str, Any] | None:
        if time is None:
            return None
        return {"time": time, "scalars": read(f"{name}_scalars").tolist()}

    last = unknowns("last", header["time"])
    return header | {"last": last, "before": unknowns("before", header["time_before"])}


def tables_of(names: Collection[str], contacts: int) -> Columns:
    """Where the columns of today's tables stand.

    Args:
        names: Of the arrays of the file.
        contacts: How many the run had.
    """
    states = [name for name in ("last", "before") if name in names]
    paired = [f"contact{number}_paired_at" for number in range(contacts)]
    nodal = {name: name for name in (*states, *paired) if name in names}
    tables: Columns = {"nodes": {"keys": "nodes"} | nodal}
    if "mean_stresses" in names:
        columns = {name: f"{name}_mean_stress" for name in states}
        tables["mean_stresses"] = {"keys": "mean_stresses"} | columns
    for number in range(contacts):
        name = f"contact{number}"
        tables[f"{name}_nodes"] = {"keys": f"{name}_nodes", "values": f"{name}_at_nodes"}
        tables[f"{name}_centres"] = {"keys": f"{name}_facets", "values": f"{name}_at_centres"}
    return tables
