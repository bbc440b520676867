"""A condensed body in a file: S, loads and rows made so far, for any number of ranks.

The factorisation is not in it: it is made again when a field inside the body is asked for. By what
cells are called in the mesh as it was read, the file is of that mesh only; of it, of the materials
and of what is held and touches it has digests. Rows, which quick answers ask for beside S, are by
nodes of the mesh and by contact dofs, as the body itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.body.description import BodyDescription
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import from_root, gather_rows, on_root
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation import fingerprint
from fenics_contact.simulation.row_tables import NodalKeys, Rows, SavedTables, write
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.schur import Functional, Row, RowMaker
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness

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


_FORMAT = 3
_DAMAGED = "is damaged, or no file that a study has saved"


def save_body(path: Path, condensed: CondensedBody, scene: str) -> None:
    """Write a condensed body; collective.

    Args:
        path: Of the file.
        condensed: The body.
        scene: The scene's text, empty of one that no file can have.

    Raises:
        InputError: A stabilisation holds it, which is no part of the scene.
        MachineError: The file could not be written; what was there stays.
    """
    discrete = condensed.discrete
    if not condensed.serves(discrete.constrained, ()):
        raise InputError(
            f"{path}: a body that solver.stabilisation holds cannot be saved; add a support"
        )
    keys = _keys_of(discrete)
    names, own = keys.own()
    index_map = discrete.spaces.displacement_space.dofmap.index_map
    numbers = index_map.local_to_global(own.astype(np.int32)) + 1.0  # 0 is of no node
    mixed = discrete.elastic.mixed is not None
    loads = [] if mixed else condensed.loads.known
    nodal = {f"load{i}": condensed.stiffness.whole(one)[own] for i, (one, _) in enumerate(loads)}
    free = condensed.dofs.free
    of_root = free if discrete.spaces.comm.rank == 0 else free[:0]
    dense = {f"load{i}": found[: len(of_root)] for i, (_, found) in enumerate(loads)}
    schur = condensed.bulk.schur
    rows, of_nodes, of_contacts = ([], {}, {}) if mixed else tables(condensed, own)
    nodal |= of_nodes
    dense |= {name: values[: len(of_root)] for name, values in of_contacts.items()}
    dense["schur"] = np.zeros((0, len(free))) if schur is None else schur
    header = {
        "kind": "condensed body",
        "format": _FORMAT,
        "version": compat.versions()["fenics_contact"],
        "mesh": fingerprint.of_mesh(discrete.spaces.body),
        "body": fingerprint.of_body(discrete.description, discrete.spaces.body),
        "sides": [discrete.sides.index(one) for one in condensed.sides],
        "loads": len(loads),
        "rows": rows,
        "scene": scene,
    }
    written = {"nodes": Rows(names, {"number": numbers, **nodal}), "contact": Rows(of_root, dense)}
    write(discrete.spaces.comm, path, header, written)


class SavedBody:
    """A condensed body in a file; collective.

    Attributes:
        scene: Text of the scene that it was saved of, empty where no file can have it.

    Args:
        comm: Communicator.
        path: Of the file.

    Raises:
        InputError: It is damaged, no such file, or of another version.
    """

    def __init__(self, comm: MPI.Comm, path: Path) -> None:
        self._path = path
        if not on_root(comm, path.exists):
            raise InputError(f"{path}: there is no such file")
        try:
            self._saved = SavedTables(comm, path)
        except InputError:
            raise InputError(f"{path}: {_DAMAGED}") from None
        header = self._saved.header
        if header.get("kind") != "condensed body":
            raise InputError(f"{path}: {_DAMAGED}")
        if header["format"] != _FORMAT:
            number = header["format"]
            raise InputError(f"{path}: its format is {number}, this version reads {_FORMAT}")
        version = compat.versions()["fenics_contact"]
        if header["version"] != version:
            raise InputError(f"{path}: version {header['version']} wrote it, this is {version}")
        self.scene: str = header["scene"]
        self._nodal: dict[str, Array] = {}

    def require_fit(self, description: BodyDescription, body: Body) -> None:
        """Refuse a scene of another body; collective.

        Raises:
            InputError: It has another mesh, other materials, supports or contact surfaces.
        """
        header = self._saved.header
        other = fingerprint.differences(fingerprint.of_body(description, body), header["body"])
        if header["mesh"] != fingerprint.of_mesh(body):
            other.append("mesh")
        if other:
            said = ", ".join(other)
            raise InputError(f"{self._path}: the scene needs another body: other {said}")

    def sides(self, discrete: DiscreteBody) -> list[ContactSides]:
        """The surfaces that it was condensed onto."""
        return [discrete.sides[number] for number in self._saved.header["sides"]]

    def suits(
        self, discrete: DiscreteBody, constrained: Integers, sides: Sequence[ContactSides]
    ) -> bool:
        """Whether contacts on such surfaces of the body, so held, may act; collective."""
        mine, comm = self.sides(discrete), discrete.spaces.comm
        has_all = all(any(one is other for other in mine) for one in sides)
        held_so = np.array_equal(constrained, discrete.constrained)
        return bool(comm.allreduce(has_all and held_so, op=MPI.LAND))

    def schur(self, discrete: DiscreteBody, dofs: ContactDofs) -> Array | None:
        """S on rank 0, in the order of contact dofs, None on others; collective."""
        places, dense = self._places(discrete, dofs), self._dense(discrete.spaces.comm)
        if discrete.spaces.comm.rank > 0:
            return None
        return np.ascontiguousarray(dense["schur"][np.ix_(places, places)])

    def give_to(self, condensed: CondensedBody) -> None:
        """Let a body know the loads that were condensed, and the rows; collective."""
        discrete = condensed.discrete
        comm = discrete.spaces.comm
        places, dense = self._places(discrete, condensed.dofs), self._dense(comm)
        for number in range(self._saved.header["loads"]):
            nodal = self._at_nodes(discrete)[f"load{number}"]
            found = dense[f"load{number}"][places] if comm.rank == 0 else np.zeros(len(places))
            condensed.loads.know(condensed.stiffness.share(nodal), found)
        what = self._saved.header["rows"]
        of_contacts = {}
        if what:
            of_root = dense["rows"][places] if comm.rank == 0 else np.zeros((0, len(what)))
            of_contacts["rows"] = of_root
        give_rows(condensed, what, self._at_nodes(discrete), of_contacts)

    def _at_nodes(self, discrete: DiscreteBody) -> dict[str, Array]:
        """Columns of the nodes of this rank; collective."""
        if not self._nodal:
            found = _keys_of(discrete).values(self._saved, "nodes")
            if found is None:
                raise InputError(f"{self._path}: the scene needs another body: other mesh")
            self._nodal = found
        return self._nodal

    def _dense(self, comm: MPI.Comm) -> dict[str, Array]:
        """Return on rank 0 what it had saved of the contact dofs; collective."""
        parts: dict[str, list[Any]] = {}
        for block in self._saved.rows("contact"):
            for name, values in {"keys": block.keys, **block.columns}.items():
                is_kept = comm.rank == 0 or name == "keys"
                parts.setdefault(name, []).append(values if is_kept else values[:0])
        return {name: np.concatenate(part) for name, part in parts.items()}

    def _places(self, discrete: DiscreteBody, dofs: ContactDofs) -> Integers:
        """Where each contact dof was when the file was written; collective."""
        spaces = discrete.spaces
        index_map, size = spaces.displacement_space.dofmap.index_map, spaces.components
        own = np.arange(spaces.owned_nodes, dtype=np.int32)
        now = index_map.local_to_global(own).astype(np.int64)
        before = self._at_nodes(discrete)["number"][own].astype(np.int64) - 1
        at_contact = np.isin(now, np.unique(dofs.free // size))
        pairs = gather_rows(spaces.comm, np.column_stack([now, before])[at_contact])
        pairs = pairs[np.argsort(pairs[:, 0])]
        old_node = pairs[np.searchsorted(pairs[:, 0], dofs.free // size), 1]
        old, keys = old_node * size + dofs.free % size, self._dense(spaces.comm)["keys"]
        if not np.array_equal(np.sort(old), keys):
            raise InputError(f"{self._path}: the scene needs another body: other held")
        return np.asarray(np.searchsorted(keys, old))


def _keys_of(discrete: DiscreteBody) -> NodalKeys:
    return NodalKeys(discrete.spaces.body.mesh, discrete.spaces.displacement_space.dofmap)


def text_of(scene: Scene) -> str:
    """A scene as TOML, its files from anywhere; empty if no file can have all of it."""
    placed = scene.with_files(lambda file: str(Path(file).resolve()))
    text = scene_text(placed)
    try:
        return text if scene_of_text(text, Path("scene.toml")) == placed else ""
    except InputError:
        return ""
