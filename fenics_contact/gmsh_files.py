"""The room for Gmsh: geometries and mesh files to a ``Body``.

Gmsh runs on rank 0 only; what goes wrong there is raised on every rank.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact import compat
from fenics_contact.errors import InputError
from fenics_contact.mesh import Body, Group
from fenics_contact.parallel import on_root
from fenics_contact.scene import MeshSource

_CELLS = {"triangle": 0, "quadrilateral": 1}  # Gmsh's Mesh.RecombineAll


def load_body(source: MeshSource, dimension: int, comm: MPI.Comm) -> Body:
    """Mesh a geometry, or read a mesh, and distribute it.

    Args:
        source: File and how to mesh it.
        dimension: Dimension of the model, 2 or 3; the mesh must have the same.
        comm: Communicator; collective.

    Raises:
        InputError: The file is missing, Gmsh refuses it, or it has no usable groups.
    """
    with _session(comm):
        groups = on_root(comm, lambda: _build(source, dimension))
        model: Any = None
        if comm.rank == 0:
            import gmsh

            model = gmsh.model
        mesh, cell_tags, facet_tags = compat.model_to_mesh(model, comm, dimension)
    return Body(mesh, cell_tags, facet_tags, groups, source.file)


@contextmanager
def _session(comm: MPI.Comm) -> Iterator[None]:
    """A quiet Gmsh on rank 0, ended whatever happens."""
    if comm.rank != 0:
        yield
        return
    import gmsh

    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        yield
    finally:
        gmsh.finalize()


def _build(source: MeshSource, dimension: int) -> dict[str, Group]:
    """Fill Gmsh's model with a mesh in which every part has its own tag."""
    import gmsh

    path = Path(source.file)
    if not path.is_file():
        raise InputError(f"mesh.file = '{source.file}': there is no such file")
    if path.suffix not in (".geo", ".msh"):
        raise InputError(f"mesh.file = '{source.file}': must end in .geo or .msh")
    try:
        if path.suffix == ".geo":
            _mesh_geometry(source, dimension)
        elif source.parameters or source.cell != "as meshed" or source.order != 1:
            raise InputError(
                f"mesh.file = '{source.file}' is a mesh already: "
                "parameters, cell and order are only for .geo files"
            )
        else:
            gmsh.open(source.file)
        return _tag_parts(source.file, dimension)
    except InputError:
        raise
    except Exception as error:  # Gmsh raises plain Exceptions
        raise InputError(f"mesh.file = '{source.file}': Gmsh says: {error}") from None


def _mesh_geometry(source: MeshSource, dimension: int) -> None:
    import gmsh

    known = _constants(source.file) if source.parameters else []
    for name, value in source.parameters.items():
        if name not in known:
            raise InputError(
                f"mesh.parameters.{name} = {value:g}: {source.file} defines no such constant; "
                f"it has: {', '.join(known) or 'none'}"
            )
        gmsh.parser.setNumber(name, [value])
    if source.cell != "as meshed":
        gmsh.option.setNumber("Mesh.RecombineAll", _CELLS[source.cell])
    gmsh.option.setNumber("Mesh.ElementOrder", source.order)
    gmsh.merge(source.file)  # unlike `open`, it keeps the values just set
    for name, value in source.parameters.items():
        if list(gmsh.parser.getNumber(name)) != [value]:
            raise InputError(
                f"mesh.parameters.{name} = {value:g}: {source.file} overwrites it; "
                "let the file set it with DefineConstant"
            )
    gmsh.model.mesh.generate(dimension)


def _constants(file: str) -> list[str]:
    """Names of the variables of a geometry, found by reading it once."""
    import gmsh

    gmsh.open(file)
    names = list(gmsh.parser.getNames())
    gmsh.clear()
    gmsh.parser.clear()
    gmsh.onelab.clear()  # it remembers the constants' own values and would restore them
    return names


def _tag_parts(file: str, dimension: int) -> dict[str, Group]:
    """Replace the physical groups by one tag a geometric part.

    A facet can then belong to several of the user's groups, which dolfinx's
    mesh tags (one value a facet) could not say.
    """
    import gmsh

    groups: dict[str, Group] = {}
    for group_dimension, tag in gmsh.model.getPhysicalGroups():
        if group_dimension < dimension - 1:
            continue
        name = gmsh.model.getPhysicalName(group_dimension, tag) or str(tag)
        parts = gmsh.model.getEntitiesForPhysicalGroup(group_dimension, tag)
        groups[name] = Group(int(group_dimension), tuple(int(part) for part in parts))
    cells = {part for g in groups.values() if g.dimension == dimension for part in g.tags}
    if not cells:
        kind = "Physical Surface" if dimension == 2 else "Physical Volume"
        raise InputError(
            f"mesh.file = '{file}': has no {kind}, so it is not known what the body is"
        )
    _check_cells(file, dimension, cells)
    gmsh.model.removePhysicalGroups()
    for part_dimension in (dimension - 1, dimension):
        for part in {p for g in groups.values() if g.dimension == part_dimension for p in g.tags}:
            gmsh.model.addPhysicalGroup(part_dimension, [part], part)
    return groups


def _check_cells(file: str, dimension: int, parts: set[int]) -> None:
    """All cells must be of one type, and there must be some."""
    import gmsh

    kinds = {k for part in parts for k in gmsh.model.mesh.getElementTypes(dimension, part)}
    names = sorted(gmsh.model.mesh.getElementProperties(kind)[0] for kind in kinds)
    if not names:
        raise InputError(f"mesh.file = '{file}': the body has no cells of dimension {dimension}")
    if len(names) > 1:
        raise InputError(
            f"mesh.file = '{file}': mixes cells ({', '.join(names)}); all must be of one type"
        )
