"""The part of a scene that says where a mesh comes from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field

from fenics_contact.scene.units.dimensions import LENGTH, LENGTH_OR_NUMBER
from fenics_contact.scene.values import Integer, Number, Positive, Text, scene_class


@scene_class
class MeshSource:
    """Where the mesh of a body comes from.

    >>> MeshSource("slab.geo", cell="quadrilateral", parameters={"cells_along": 16}).order
    1
    """

    file: Annotated[
        Text,
        Field(
            description="Gmsh geometry (`.geo`), CAD file (`.step`, `.stp`, `.brep`) or mesh: "
            "`.msh`, `.inp` (Abaqus, CalculiX), `.bdf` (Nastran), `.med` (Salome), `.vtu`, "
            "`.xdmf`; relative to the scene file"
        ),
    ]
    parameters: Annotated[
        Mapping[str, Annotated[Number, LENGTH_OR_NUMBER]],
        Field(
            description="values for the `DefineConstant` names of a `.geo` file; those with a "
            "unit are lengths"
        ),
    ] = Field(default_factory=dict)
    cell: Annotated[
        Literal["as meshed", "triangle", "quadrilateral"],
        Field(description="shape of the cells made from a geometry"),
    ] = "as meshed"
    order: Annotated[
        Integer,
        Field(
            ge=1,
            le=2,
            description="order of the cells' geometry made from a geometry: 2 follows round sides",
        ),
    ] = 1
    size: Annotated[
        Positive | None,
        LENGTH,
        Field(description="largest cell made from a geometry; by default Gmsh's choice"),
    ] = None
    sizes: Annotated[
        Mapping[str, Annotated[Positive, LENGTH]],
        Field(
            description="largest cell of single bodies of a geometry, in place of `size`: name → "
            "size, such as `{ bolt = 1.5, plate = 3 }`"
        ),
    ] = Field(default_factory=dict)
    curvature: Annotated[
        Annotated[Integer, Field(ge=3)] | None,
        Field(description="cells along a full circle made from a geometry, for finer holes"),
    ] = None
    time_limit: Annotated[
        Positive,
        Field(description="seconds that meshing or reading the file may take, each time"),
    ] = 600.0
    groups: Annotated[
        Mapping[str, tuple[Integer, ...]],
        Field(
            description="boundary groups named here: name → Gmsh's numbers of surfaces (3D) or "
            "curves (2D), such as `{ fixed = [3, 4] }`"
        ),
    ] = Field(default_factory=dict)
    name: Annotated[
        str,
        Field(
            description="of all its cells; where there are several meshes each needs one, and its "
            "groups are called `name.group`"
        ),
    ] = ""

    def __post_init__(self) -> None:
        if "." in self.name:
            raise ValueError(f"name = '{self.name}' must not contain a '.'")
