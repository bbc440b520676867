"""Sizes of the cells of each body, as fields of Gmsh; for its process alone."""

from __future__ import annotations

import gmsh

from fenics_contact.common.wording.suggestions import question
from fenics_contact.mesh.geometry.bodies import Bodies
from fenics_contact.mesh.geometry.process_room import Job, RefusedError

_UNLIMITED = 1e22  # Gmsh's own
_LISTS = {2: "SurfacesList", 3: "VolumesList"}


def limit_sizes(job: Job, bodies: Bodies) -> None:
    """No cell of a body is larger than ``mesh.sizes`` says; where it is silent, ``mesh.size``.

    Raises:
        RefusedError: There is no such body.
    """
    for name in job["body_sizes"]:
        if name not in bodies.parts:
            raise RefusedError(
                f"{job['key']}.sizes.{name}: {job['name']} has no body of that name"
                f"{question(name, bodies.parts)}; it has: {', '.join(bodies.parts)}"
            )
    if job["body_sizes"]:
        set_least(limiting_fields(job, bodies))
        gmsh.option.setNumber("Mesh.MeshSizeMax", largest_size(job, bodies))


def limiting_fields(job: Job, bodies: Bodies, factor: float = 1) -> list[int]:
    """Numbers of Gmsh's fields that limit the cells of the bodies that have a size of their own.

    Args:
        job: With the sizes.
        bodies: Of the model.
        factor: By which all sizes are multiplied.
    """
    field, fields = gmsh.model.mesh.field, []
    for name, size in _sizes(job, bodies).items() if job["body_sizes"] else []:
        if size is not None:
            fields.append(field.add("Constant"))
            field.setNumbers(fields[-1], _LISTS[bodies.dimension], bodies.parts[name])
            field.setNumber(fields[-1], "VIn", factor * size)
            field.setNumber(fields[-1], "VOut", _UNLIMITED)
            field.setNumber(fields[-1], "IncludeBoundary", 1)
    return fields


def largest_size(job: Job, bodies: Bodies) -> float:
    """The largest cell that any body may have (length)."""
    sizes = _sizes(job, bodies).values() if job["body_sizes"] else [job["size"]]
    return max(size or _UNLIMITED for size in sizes)


def set_least(fields: list[int]) -> None:
    """Have Gmsh take the least of some fields, by their numbers."""
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", fields)
    gmsh.model.mesh.field.setAsBackgroundMesh(least)


def _sizes(job: Job, bodies: Bodies) -> dict[str, float | None]:
    return {name: job["body_sizes"].get(name, job["size"]) for name in bodies.parts}
