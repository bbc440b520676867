"""The rows of a condensed body in a file: what quick answers ask for beside S.

By nodes of the mesh and by contact dofs, as the body itself, so on any number of ranks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root
from fenics_contact.solve.condensed.body_rows import BodyRows, Functional, Row
from fenics_contact.solve.condensed.condensed_body import CondensedBody

# Of what is given, what a row is of.
_LOADS, _HELD = "loads", "held"


def tables(
    condensed: CondensedBody, own: Integers
) -> tuple[list[Any], dict[str, Array], dict[str, Array]]:
    """The rows as columns; collective.

    Args:
        condensed: The body.
        own: Nodes that this rank writes.

    Returns:
        What each row is of; columns of the nodes, and of the free contact dofs.
    """
    rows = condensed.rows
    nodal: dict[str, Array] = {}
    at_contacts: dict[str, Array] = {}
    what: list[Any] = []
    given: list[tuple[Any, Functional | None, Row]] = [
        (None, functional, row) for functional, row in rows.given.made
    ]
    grouped = [
        ([name, list(key)], None, row)
        for name, group in rows.groups.items()
        for key, row in group.made.items()
    ]
    for number, (of, functional, row) in enumerate([*given, *grouped]):
        columns = {"forces": rows.stiffness.nodal(row.of_forces), "held": _whole(rows, row.of_held)}
        if functional is not None:
            is_load = functional.forces is not None
            of = [_LOADS if is_load else _HELD]
            columns["given"] = (
                rows.stiffness.whole(functional.forces)
                if functional.forces is not None
                else rows.stiffness.nodal(_values(functional))
            )
        nodal |= {f"row{number} {name}": values[own] for name, values in columns.items()}
        at_contacts[f"row{number}"] = row.of_contacts
        what.append(of)
    return what, nodal, at_contacts


def _values(functional: Functional) -> Array:
    assert functional.held is not None
    return functional.held


def _whole(rows: BodyRows, of_held: Array) -> Array:
    """A share of forces at held unknowns, at the nodes, of all ranks; collective."""
    share = np.zeros(len(rows.held))
    share[rows.held] = of_held
    return rows.stiffness.whole(share)


def give_rows(
    condensed: CondensedBody,
    what: Sequence[Any],
    nodal: Mapping[str, Array],
    at_contacts: Mapping[str, Array],
) -> None:
    """Let a body know rows that were made; collective.

    Args:
        condensed: The body.
        what: As ``tables`` gave it.
        nodal: At all nodes of this rank, likewise.
        at_contacts: At the free contact dofs, in their present order, on rank 0.
    """
    rows, stiffness = condensed.rows, condensed.stiffness
    for number, of in enumerate(what):
        found = {name: nodal[f"row{number} {name}"] for name in ("forces", "held")}
        row = Row(
            np.asarray(from_root(stiffness.comm, at_contacts[f"row{number}"])),
            stiffness.share(found["held"])[rows.held],
            stiffness.at_unknowns(found["forces"]),
        )
        if of in ([_LOADS], [_HELD]):
            given = nodal[f"row{number} given"]
            is_load = of == [_LOADS]
            rows.given.know(
                Functional(forces=stiffness.share(given))
                if is_load
                else Functional(held=stiffness.at_unknowns(given)),
                row,
            )
        else:
            name, key = of
            rows.group(name).made[tuple(key)] = row
