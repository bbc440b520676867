"""The rows of a condensed body in a file: what quick answers ask for beside S.

By nodes of the mesh and by contact dofs, as the body itself, so on any number of ranks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import from_root
from fenics_contact.solve.condensed.bulk.rank_stiffness import LocalStiffness
from fenics_contact.solve.condensed.bulk.rows import Functional, Row, RowMaker
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
    rows, stiffness = condensed.rows, condensed.stiffness
    what: list[Any] = []
    made: list[Row] = []
    given: list[Array] = []
    for functional, row in rows.given.made:
        what.append([_HELD if functional.forces is None else _LOADS])
        made.append(row)
        given.append(_at_nodes(functional, stiffness))
    for name, group in rows.groups.items():
        if group.is_portable:
            what += [[name, list(key)] for key in group.made]
            made += group.made.values()
    forces = [stiffness.nodal(row.of_forces) for row in made]
    held = [_whole(rows.maker, row.of_held) for row in made]
    at_nodes = {"forces of rows": forces, "held of rows": held, "given of rows": given}
    nodal = {name: _beside(parts, own) for name, parts in at_nodes.items()}
    of_contacts = np.array([row.of_contacts for row in made]).reshape(len(made), rows.maker.count).T
    return what, nodal, {"rows": of_contacts}


def _beside(nodal: Sequence[Array], own: Integers) -> Array:
    """Return values at nodes as columns, (nodes, arrays × components)."""
    return np.concatenate([np.zeros((len(own), 0)), *(values[own] for values in nodal)], axis=1)


def _at_nodes(functional: Functional, stiffness: LocalStiffness) -> Array:
    """Forces or held displacements of a functional, (nodes, components); collective."""
    if functional.forces is not None:
        return stiffness.whole(functional.forces)
    assert functional.held is not None
    return stiffness.nodal(functional.held)


def _whole(maker: RowMaker, of_held: Array) -> Array:
    """A share of forces at held unknowns, at the nodes, of all ranks; collective."""
    share = np.zeros(len(maker.held))
    share[maker.held] = of_held
    return maker.stiffness.whole(share)


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
    if not what:
        return
    rows, stiffness = condensed.rows, condensed.stiffness
    size = condensed.discrete.spaces.components
    forces, held, given = (
        np.hsplit(nodal[f"{name} of rows"], nodal[f"{name} of rows"].shape[1] // size or 1)
        for name in ("forces", "held", "given")
    )
    for number, of in enumerate(what):
        row = Row(
            np.asarray(from_root(stiffness.comm, at_contacts["rows"][:, number])),
            stiffness.share(held[number])[rows.maker.held],
            stiffness.at_unknowns(forces[number]),
        )
        if of == [_LOADS]:
            rows.given.know(Functional(forces=stiffness.share(given[number])), row)
        elif of == [_HELD]:
            rows.given.know(Functional(held=stiffness.at_unknowns(given[number])), row)
        else:
            name, key = of
            rows.group(name).made[tuple(key)] = row
