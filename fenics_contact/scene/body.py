"""The parts of a scene that describe the body: where its mesh comes from, its materials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from fenics_contact.common.arrays import Array
from fenics_contact.scene.laws import energies
from fenics_contact.scene.units.dimensions import (
    CONDUCTIVITY,
    DENSITY,
    EXPANSION,
    LENGTH,
    LENGTH_OR_NUMBER,
    OF_KEY,
    STRESS,
    TEMPERATURE,
)
from fenics_contact.scene.units.materials import MATERIALS, names
from fenics_contact.scene.values import (
    VOIGT,
    Integer,
    Number,
    OneOf,
    Positive,
    Text,
    Value,
    scene_class,
)

#: Poisson's ratio from which a displacement alone locks.
NEARLY_INCOMPRESSIBLE = 0.49


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
    least_size: Annotated[
        Positive | None,
        LENGTH,
        Field(
            description="smallest cell made from a geometry, also where `curvature` asks for "
            "smaller ones: at small radii that matter little"
        ),
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
        for size in (self.size, *self.sizes.values()):
            if size is not None and self.least_size is not None and size < self.least_size:
                raise ValueError(
                    f"least_size = {self.least_size:g} must not exceed the largest cell, {size:g}"
                )


def _stiffness_matrix(value: Any) -> Any:
    """A tensor E_ijkl of shape (3, 3, 3, 3) as the 6 × 6 matrix; anything else as it is."""
    if isinstance(value, list | tuple) and _depth(value) == 4:
        value = np.array(value, dtype=float)
    if isinstance(value, np.ndarray) and value.shape == (3, 3, 3, 3):
        for axes in ((1, 0, 2, 3), (0, 1, 3, 2), (2, 3, 0, 1)):
            if not np.allclose(value, value.transpose(axes), rtol=1e-10):
                raise ValueError("E_ijkl must equal E_jikl, E_ijlk and E_klij")
        value = np.array([[value[i, j, k, m] for k, m in VOIGT] for i, j in VOIGT])
    return value.tolist() if isinstance(value, np.ndarray) else value


def _depth(value: object) -> int:
    """How deep lists are nested, by the first of each."""
    depth = 0
    while isinstance(value, list | tuple) and value:
        value, depth = value[0], depth + 1
    return depth


_Row = Annotated[tuple[Annotated[Value, STRESS], ...], Field(min_length=6, max_length=6)]
_Matrix = Annotated[tuple[_Row, ...], Field(min_length=6, max_length=6)]
_Three = Field(min_length=3, max_length=3)
_Square = Annotated[tuple[Annotated[tuple[Number, ...], _Three], ...], _Three]
_Tensor = Annotated[tuple[Annotated[tuple[_Square, ...], _Three], ...], _Three]
Stiffness = Annotated[
    tuple[_Row, ...],
    Field(min_length=6, max_length=6),
    BeforeValidator(_stiffness_matrix, json_schema_input_type=_Matrix | _Tensor),
]


@scene_class
class ModulusTable:
    """A modulus that follows the temperature, linear between the listed ones.

    >>> ModulusTable(temperature=(20, 220), values=(210e3, 190e3)).at(np.array([0, 120])).tolist()
    [210000.0, 200000.0]
    """

    temperature: Annotated[
        tuple[Annotated[Number, TEMPERATURE], ...],
        Field(min_length=2, description="increasing temperatures"),
    ]
    values: Annotated[
        tuple[Annotated[Number, OF_KEY], ...],
        Field(min_length=2, description="the modulus at each; constant beyond the ends"),
    ]

    def __post_init__(self) -> None:
        if len(self.temperature) != len(self.values):
            raise ValueError(
                f"temperature has {len(self.temperature)} entries and values {len(self.values)}"
            )
        if any(b <= a for a, b in zip(self.temperature, self.temperature[1:], strict=False)):
            raise ValueError("the temperatures must increase")

    def at(self, temperature: Array) -> Array:
        """The modulus at temperatures.

        Args:
            temperature: At points, (points,) (temperature).
        """
        return np.interp(temperature, self.temperature, self.values)


_Expansions = Annotated[tuple[Annotated[Number, EXPANSION], ...], _Three]


@scene_class
class Material:
    """Linear elasticity (paper, (1.1)): isotropic, or any elastic tensor E_ijkl.

    Fibres along x, in a material with E_ijkl = λ δ_ij δ_kl + 2μ I_ijkl otherwise:

    >>> import numpy as np
    >>> delta = np.eye(3)
    >>> tensor = 100 * np.einsum("ij,kl->ijkl", delta, delta)
    >>> tensor += 80 * np.einsum("ik,jl->ijkl", delta, delta)
    >>> tensor += 80 * np.einsum("il,jk->ijkl", delta, delta)
    >>> tensor[0, 0, 0, 0] += 500
    >>> [row[0] for row in Material(stiffness=tensor).stiffness]
    [760.0, 100.0, 100.0, 0.0, 0.0, 0.0]
    >>> Material(youngs_modulus=1000, poissons_ratio=0.5)
    Traceback (most recent call last):
    fenics_contact.common.errors.SceneError: Material: poissons_ratio = 0.5 must lie between -1 and 0.5
    """  # noqa: E501

    youngs_modulus: Annotated[
        Value | ModulusTable | None, STRESS, Field(description="Young's modulus, > 0")
    ] = None
    poissons_ratio: Annotated[
        Value | ModulusTable | None,
        Field(description="Poisson's ratio, between −1 and 0.5; from .49 nothing locks"),
    ] = None
    stiffness: Annotated[
        Stiffness | None,
        Field(
            description="instead of the two: 6 × 6 matrix of E_ijkl in the mesh's axes, ordered "
            "xx, yy, zz, yz, xz, xy; no factors 2, symmetric, positive definite"
        ),
    ] = None
    on: Annotated[
        str, Field(description="physical group of cells that it fills; by default the body")
    ] = ""
    density: Annotated[
        Value | None,
        DENSITY,
        Field(
            description="ρ > 0; needed where masses count, as of modes, and of loads by "
            "`acceleration` or `rotation`"
        ),
    ] = None

    name: Annotated[
        Annotated[Text, OneOf(names)] | None,
        Field(
            description="of a material of the table that `fenics-contact materials` prints, whose "
            "values hold where none are given beside it; needs `[units]`"
        ),
    ] = None

    thermal_expansion: Annotated[
        Annotated[Number, EXPANSION] | _Expansions | None,
        EXPANSION,
        Field(
            description="α, strain over temperature: a number, or three, one an axis of the mesh "
            "(in axisymmetric models radial, axial, around); needed where there are temperatures"
        ),
    ] = None
    reference_temperature: Annotated[
        Number, TEMPERATURE, Field(description="at which it has the size that is meshed")
    ] = 0.0
    conductivity: Annotated[
        Positive | None,
        CONDUCTIVITY,
        Field(description="of heat; needed where a scene has `[[heat]]`"),
    ] = None
    law: Annotated[
        Annotated[Text, OneOf(energies.names)] | None,
        Field(
            description="stored energy in finite strains, which has the moduli in small ones: "
            + "; ".join(f"`{name}`: {formula}" for name, formula in energies.FORMULAS.items())
        ),
    ] = None
    constants: Annotated[
        Mapping[str, Annotated[Number, STRESS]],
        Field(
            description="of `law`, in place of `youngs_modulus`: "
            + "; ".join(
                f"`{', '.join(names)}` of `{law}`" for law, names in energies.CONSTANTS.items()
            )
            + "; G = 2 (c10 + c01) and 2 c10"
        ),
    ] = Field(default_factory=dict)

    def __post_init__(self) -> None:
        isotropic = (self.youngs_modulus, self.poissons_ratio)
        self._require_constants()
        if self.stiffness is None and self.name is None:
            for key, value in zip(("youngs_modulus", "poissons_ratio"), isotropic, strict=True):
                if value is None and not (self.constants and key == "youngs_modulus"):
                    raise ValueError(f"{key} is missing (or give a stiffness)")
        elif self.stiffness is not None and isotropic != (None, None):
            raise ValueError("give either youngs_modulus and poissons_ratio, or stiffness")
        for young in _numbers(self.youngs_modulus):
            if young <= 0:
                raise ValueError(f"youngs_modulus = {young:g} must be greater than 0")
        for poisson in _numbers(self.poissons_ratio):
            if not -1 < poisson < 0.5:
                raise ValueError(f"poissons_ratio = {poisson:g} must lie between -1 and 0.5")
        if isinstance(self.density, float | int) and self.density <= 0:
            raise ValueError(f"density = {self.density:g} must be greater than 0")

    def _require_constants(self) -> None:
        """Refuse constants that the law has not, and a modulus together with constants."""
        names = energies.CONSTANTS.get(self.law or "", ())
        if set(self.constants) != set(names):
            known, given = (", ".join(one) or "none" for one in (names, self.constants))
            raise ValueError(f"constants: the law '{self.law}' has {known}; given are {given}")
        if self.constants and self.youngs_modulus is not None:
            raise ValueError("youngs_modulus: it follows from the constants; leave one of them out")
        values = [one for one in self.constants.values() if isinstance(one, float | int)]
        if self.law and len(values) == len(names) > 0:
            shear = energies.shear_modulus(self.law, self.constants)
            if shear <= 0:
                raise ValueError(f"constants: they give a shear modulus of {shear:g}, not above 0")

    @property
    def modulus(self) -> Value | ModulusTable | None:
        """Young's modulus in small strains, given or by the constants of its law."""
        if (
            not self.constants
            or self.law is None
            or not isinstance(self.poissons_ratio, float | int)
        ):
            return self.youngs_modulus
        return 2 * (1 + self.poissons_ratio) * energies.shear_modulus(self.law, self.constants)

    @property
    def follows_temperature(self) -> bool:
        """Whether one of its moduli is a table of temperature."""
        moduli = (self.youngs_modulus, self.poissons_ratio)
        return any(isinstance(one, ModulusTable) for one in moduli)

    @cached_property
    def elastic(self) -> Material:
        """The material without what is no part of a stiffness."""
        return replace(
            self,
            density=None,
            thermal_expansion=None,
            reference_temperature=self.reference_temperature if self.follows_temperature else 0.0,
            conductivity=None,
        )

    @property
    def by_name(self) -> dict[str, Any]:
        """Values of the table, with their units, of the keys that are not given."""
        if self.name is None:
            return {}
        known = MATERIALS[self.name]
        values: dict[str, Any] = {
            "density": f"{known.density:g} kg/m³",
            "thermal_expansion": f"{known.thermal_expansion:g}e-6 1/K",
        }
        if self.stiffness is None:
            values["youngs_modulus"] = f"{known.youngs_modulus:g} GPa"
            values["poissons_ratio"] = known.poissons_ratio
        return {key: value for key, value in values.items() if getattr(self, key) is None}


def _numbers(modulus: Value | ModulusTable | None) -> tuple[float, ...]:
    """The numbers that a modulus is given by; none of functions, profiles and texts with a unit."""
    every = modulus.values if isinstance(modulus, ModulusTable) else (modulus,)
    return tuple(one for one in every if isinstance(one, float | int))


def with_values_by_name(materials: tuple[Material, ...], has_units: bool) -> tuple[Material, ...]:
    """Return materials with the values of those that are named.

    Args:
        materials: Of a scene.
        has_units: Whether the scene has units, in which values of the table can be had.

    Raises:
        ValueError: It has none, and needs such values.
    """
    found = []
    for number, material in enumerate(materials):
        values = material.by_name
        if set(values) == {"thermal_expansion"} and not has_units:
            values = {}
        if values and not has_units:
            key = f"material[{number}]" if len(materials) > 1 else "material"
            raise ValueError(
                f"{key}.name = {material.name!r}: its values are in SI, so that the scene needs "
                'its own units, such as [units] with length = "mm" and force = "N"'
            )
        found.append(replace(material, **values) if values else material)
    return tuple(found)
