"""Tables whose rows are spread over the ranks, in sealed files for any number of ranks.

Tables whose rows, or nodes, are spread over the ranks, in files for any number of ranks. Rank 0
writes and reads the file, some rows at a time: no rank ever has more of another's rows. Nodal
values have no ranks in a file: a node is the i-th of a cell, by the number that the cell had in
the mesh as it was read, whichever of its cells that is. Coordinates would not do: nodes of two
bodies may coincide.

Arrays and a header in one file, with a checksum, replaced in one move. Arrays are written and read
one at a time, so that no more than one has to be in memory.
"""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.body.spaces import summed_over_ranks
from fenics_contact.common.arrays import AnyIntegers, Array, Flags, Integers
from fenics_contact.common.atomic_files import naming, replaced_file
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import of_every_rank, on_root, sent_to_root, total
from fenics_contact.results.records.record import plain

_UNREADABLE = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)
_HEADER, _CHECKSUM = "header", "checksum"


class NewArrays:
    """A file of arrays that is being written.

    Args:
        path: Where it is to be.
        archive: What is written to meanwhile.
    """

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        self._path, self._archive = path, archive
        self._digest = hashlib.sha256()

    def add(self, name: str, array: NDArray[Any]) -> None:
        """Write an array.

        Raises:
            MachineError: It could not be written.
        """
        _take(self._digest, name, array)
        self._write(name, array)

    def seal(self, header: dict[str, Any]) -> None:
        """Write what is no array, and the checksum of all."""
        self.add(_HEADER, np.frombuffer(json.dumps(plain(header)).encode(), dtype=np.uint8))
        self._write(_CHECKSUM, np.frombuffer(self._digest.digest(), dtype=np.uint8))

    def _write(self, name: str, array: NDArray[Any]) -> None:
        with (
            naming(self._path),
            self._archive.open(f"{name}.npy", "w", force_zip64=True) as member,
        ):
            np.lib.format.write_array(member, array, allow_pickle=False)


@contextmanager
def replaced_arrays(path: Path) -> Iterator[NewArrays]:
    """A file to write arrays to, which takes its place in one move when it is whole.

    Raises:
        MachineError: It could not be written; what was there stays.
    """
    with replaced_file(path) as temporary, temporary.open("wb") as file:
        with zipfile.ZipFile(file, "w") as archive:
            yield NewArrays(path, archive)
        file.flush()
        os.fsync(file.fileno())


def read_header(path: Path) -> dict[str, Any]:
    """Return the header of a file, once its arrays are found to be as they were written.

    Raises:
        InputError: It is damaged, or no such file at all.
    """
    with _unharmed(path), np.load(path, allow_pickle=False) as file:
        digest = hashlib.sha256()
        for name in file.files:
            if name != _CHECKSUM:
                _take(digest, name, file[name])
        if file[_CHECKSUM].tobytes() != digest.digest():
            raise ValueError(_CHECKSUM)
        header: dict[str, Any] = json.loads(file[_HEADER].tobytes())
    return header


def read_arrays(path: Path, names: list[str]) -> list[NDArray[Any]]:
    """Some arrays of a file.

    Raises:
        InputError: It is damaged, or no such file at all.
    """
    with _unharmed(path), np.load(path, allow_pickle=False) as file:
        return [file[name] for name in names]


def replace_header(path: Path, header: dict[str, Any]) -> None:
    """Change what is no array, in one move.

    Raises:
        InputError: It is damaged, or no such file at all.
        MachineError: It could not be written; what was there stays.
    """
    with _unharmed(path):
        old = np.load(path, allow_pickle=False)
    with old, replaced_arrays(path) as new:
        for name in old.files:
            if name not in (_HEADER, _CHECKSUM):
                new.add(name, old[name])
        new.seal(header)


@contextmanager
def _unharmed(path: Path) -> Iterator[None]:
    """Say of a file that cannot be read that it is damaged."""
    try:
        yield
    except _UNREADABLE:
        raise InputError(
            f"--resume: '{path}' is damaged; without --resume the run begins anew"
        ) from None


def _take(digest: Any, name: str, array: NDArray[Any]) -> None:
    """Let a checksum go on with an array."""
    whole = np.ascontiguousarray(array)
    digest.update(f"{name} {whole.dtype} {whole.shape}".encode())
    digest.update(whole.tobytes())


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
        on_root(comm, lambda: new.append(stack.enter_context(replaced_arrays(path))))
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
        self.header = on_root(comm, lambda: read_header(path))
        self._tables = {name: _Contents(**found) for name, found in self.header["tables"].items()}

    def count(self, table: str) -> int:
        """Rows of a table, of all ranks together."""
        return self._tables[table].rows

    def rows(self, table: str) -> Iterator[Rows]:
        """All rows on every rank, some at a time; collective."""
        contents = self._tables[table]
        for number in range(contents.blocks):
            places = contents.arrays(table, number)
            read = partial(read_arrays, self._path, list(places.values()))
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


class NodalKeys:
    """Names of the nodes of a space that any number of ranks agrees on.

    Args:
        mesh: dolfinx mesh.
        dofmap: Of the space; its blocks are the nodes.
    """

    def __init__(self, mesh: Any, dofmap: Any) -> None:
        self._comm = mesh.comm
        self._index_map = dofmap.index_map
        cells = mesh.topology.index_map(mesh.topology.dim)
        nodes = np.asarray(dofmap.list)
        original = np.asarray(mesh.topology.original_cell_index, dtype=np.int64)[: len(nodes)]
        keys = original[:, None] * nodes.shape[1] + np.arange(nodes.shape[1])
        self._of_node = np.full(self._index_map.size_local + self._index_map.num_ghosts, -1)
        self._of_node[nodes] = keys
        self._own_keys, self._own_nodes = keys[: cells.size_local], nodes[: cells.size_local]

    def own(self, wanted: Flags | None = None) -> tuple[Integers, Integers]:
        """Names and numbers of the nodes that this rank owns.

        Args:
            wanted: Only these.
        """
        nodes = np.arange(self._index_map.size_local)
        if wanted is not None:
            nodes = nodes[wanted[nodes]]
        return self._of_node[nodes], nodes

    def values(self, saved: SavedTables, table: str) -> dict[str, Array] | None:
        """Columns of a table at the nodes of this rank, 0 without a row; collective.

        Returns:
            First axis nodes; None if there are rows of another mesh's nodes.
        """
        # A key names a cell that one rank owns, so each row is taken once.
        columns, rows = saved.taken(
            table, self._own_keys.ravel(), self._own_nodes.ravel(), len(self._of_node)
        )
        if int(total(self._comm, rows)) != saved.count(table):
            return None
        return {name: summed_over_ranks(self._index_map, nodal) for name, nodal in columns.items()}
