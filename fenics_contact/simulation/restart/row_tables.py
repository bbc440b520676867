"""Tables whose rows are spread over the ranks, in a file that any number of ranks can read.

Rank 0 writes and reads the file, some rows at a time: no rank ever has more of another's rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.parallel import of_every_rank, on_root, sent_to_root
from fenics_contact.simulation.restart import sealed_arrays
from fenics_contact.simulation.restart.sealed_arrays import NewArrays

_MOST_ROWS = 2**16  # of a block


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of a table.

    Attributes:
        keys: By which they are known on any number of ranks, (rows,).
        columns: What they hold, first axis rows.
    """

    keys: Integers
    columns: Mapping[str, Array]

    def part(self, chosen: slice) -> Rows:
        """Some of them."""
        return Rows(self.keys[chosen], {name: c[chosen] for name, c in self.columns.items()})


@dataclass(frozen=True)
class _Contents:
    """Contents of a table in a file: numbers of rows and blocks, and names of columns."""

    rows: int
    blocks: int
    columns: tuple[str, ...]

    def arrays(self, table: str, number: int) -> dict[str, str]:
        """The names of a block's arrays: its keys, then its columns."""
        return {name: f"{table}/{number}/{name}" for name in ("keys", *self.columns)}


def write(comm: MPI.Comm, path: Path, header: dict[str, Any], tables: Mapping[str, Rows]) -> None:
    """Replace a file; collective.

    Args:
        comm: Communicator.
        path: Of the file.
        header: What is no array, the same on every rank.
        tables: This rank's own rows of each, in the same order on every rank.

    Raises:
        MachineError: It could not be written; what was there stays.
    """
    new: list[NewArrays] = []  # on rank 0
    contents = {}
    with ExitStack() as stack:
        on_root(comm, lambda: new.append(stack.enter_context(sealed_arrays.replaced_arrays(path))))
        for table, rows in tables.items():
            counts = of_every_rank(comm, len(rows.keys))
            number = 0
            for block in _blocks(comm, rows, counts):
                on_root(comm, partial(_add, new, f"{table}/{number}", block))
                number += 1
            contents[table] = asdict(_Contents(sum(counts), number, tuple(rows.columns)))
        on_root(comm, lambda: new[0].seal(header | {"tables": contents}))
        on_root(comm, stack.close)


def _blocks(comm: MPI.Comm, rows: Rows, counts: list[int]) -> Iterator[Rows]:
    """Rows of all ranks, some at a time, on rank 0; the others get what does not count."""
    for rank, count in enumerate(counts):
        # Of a table without rows, one block that has none.
        for first in range(0, max(count, int(rank == 0)), _MOST_ROWS):
            yield sent_to_root(comm, rows.part(slice(first, first + _MOST_ROWS)), rank)


def _add(new: list[NewArrays], name: str, block: Rows) -> None:
    new[0].add(f"{name}/keys", block.keys)
    for column, values in block.columns.items():
        new[0].add(f"{name}/{column}", values)


class SavedTables:
    """The tables of a file; collective.

    Attributes:
        header: What is no array.

    Args:
        comm: Communicator.
        path: Of the file.

    Raises:
        InputError: It is damaged.
    """

    def __init__(self, comm: MPI.Comm, path: Path) -> None:
        self._comm, self._path = comm, path
        self.header = on_root(comm, lambda: sealed_arrays.read_header(path))
        self._tables = {name: _Contents(**found) for name, found in self.header["tables"].items()}

    def count(self, table: str) -> int:
        """Rows of a table, of all ranks together."""
        return self._tables[table].rows

    def rows(self, table: str) -> Iterator[Rows]:
        """All rows on every rank, some at a time; collective."""
        contents = self._tables[table]
        for number in range(contents.blocks):
            places = contents.arrays(table, number)
            read = partial(sealed_arrays.read_arrays, self._path, list(places.values()))
            keys, *columns = on_root(self._comm, read)
            yield Rows(keys, dict(zip(contents.columns, columns, strict=True)))

    def taken(
        self, table: str, keys: Integers, places: AnyIntegers, count: int
    ) -> tuple[dict[str, Array], int]:
        """The rows that have a key of this rank, each at its place; collective.

        Args:
            table: Its name.
            keys: No two the same, (keys,).
            places: Where the row of each goes, (keys,).
            count: Of places.

        Returns:
            Columns, first axis places, 0 where no row goes; and how many rows there were.
        """
        order = np.argsort(keys)
        ordered, rows = keys[order], 0
        found: dict[str, Array] = {}
        for block in self.rows(table):
            near = np.searchsorted(ordered, block.keys)
            mine = np.flatnonzero(near < len(keys))
            mine = mine[ordered[near[mine]] == block.keys[mine]]
            at = places[order[near[mine]]]
            rows += len(mine)
            for name, values in block.columns.items():
                column = found.setdefault(name, np.zeros((count, *values.shape[1:])))
                column[at] = values[mine]
        return found, rows
