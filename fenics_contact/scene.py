"""A scene: what the user says, as frozen data. No FEniCSx in here.

Every class is a frozen, validated dataclass; the same words are the keys of a
scene file (``fenics_contact.scene_file``). Units are the user's, consistent.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, ConfigDict, Field, Strict
from pydantic.dataclasses import dataclass

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
Integer = Annotated[int, Strict()]
Text = Annotated[str, Field(min_length=1)]
AxisName = Literal["x", "y", "z"]
Kinematics = Literal["plane strain", "plane stress", "axisymmetric", "3D"]

AXES: tuple[AxisName, ...] = ("x", "y", "z")
# Index pairs of a stress or strain in the order of a 6 × 6 stiffness matrix.
VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
_CLOSED = ConfigDict(extra="forbid")


@dataclass(frozen=True, config=_CLOSED)
class Profile:
    """A value that varies along one axis, linear between the listed points."""

    along: Annotated[AxisName, Field(description="axis of the mesh along which it varies")]
    at: Annotated[
        tuple[Number, ...], Field(min_length=2, description="increasing coordinates (length)")
    ]
    values: Annotated[
        tuple[Number, ...],
        Field(min_length=2, description="the value at each; constant beyond the ends"),
    ]

    def __post_init__(self) -> None:
        if len(self.at) != len(self.values):
            raise ValueError(f"at has {len(self.at)} entries and values {len(self.values)}")
        if any(b <= a for a, b in zip(self.at, self.at[1:], strict=False)):
            raise ValueError("the coordinates in at must increase")

    def __call__(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values at points of shape (3, n), shape (n,)."""
        return np.interp(points[AXES.index(self.along)], self.at, self.values)


PositionFunction = Callable[[NDArray[np.float64]], Any]
Value = Number | Profile | PositionFunction
Vector = Annotated[tuple[Value, ...], Field(min_length=2, max_length=3)]


@dataclass(frozen=True, config=_CLOSED)
class MeshSource:
    """Where the mesh comes from."""

    file: Annotated[
        Text,
        Field(
            description="Gmsh geometry (`.geo`), mesh (`.msh`) or CAD file (`.step`, `.stp`, "
            "`.brep`); relative to the scene file"
        ),
    ]
    parameters: Annotated[
        Mapping[str, Number],
        Field(description="values for the `DefineConstant` names of a `.geo` file"),
    ] = Field(default_factory=dict)
    cell: Annotated[
        Literal["as meshed", "triangle", "quadrilateral"],
        Field(description="shape of the cells made from a geometry"),
    ] = "as meshed"
    order: Annotated[
        Integer, Field(ge=1, le=2, description="order of the cells' geometry made from a geometry")
    ] = 1
    size: Annotated[
        Positive | None,
        Field(description="largest cell made from a geometry (length); by default Gmsh's choice"),
    ] = None
    curvature: Annotated[
        Annotated[Integer, Field(ge=3)] | None,
        Field(description="cells along a full circle made from a geometry, for finer holes"),
    ] = None
    groups: Annotated[
        Mapping[str, tuple[Integer, ...]],
        Field(
            description="boundary groups named here: name → Gmsh's numbers of surfaces (3D) or "
            "curves (2D), such as `{ fixed = [3, 4] }`"
        ),
    ] = Field(default_factory=dict)


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


def _depth(value: Any) -> int:
    """How deep lists are nested, by the first of each."""
    depth = 0
    while isinstance(value, list | tuple) and value:
        value, depth = value[0], depth + 1
    return depth


_Row = Annotated[tuple[Value, ...], Field(min_length=6, max_length=6)]
Stiffness = Annotated[
    tuple[_Row, ...], Field(min_length=6, max_length=6), BeforeValidator(_stiffness_matrix)
]


@dataclass(frozen=True, config=_CLOSED)
class Material:
    """Linear elasticity (paper, (1.1)): isotropic, or any elastic tensor E_ijkl."""

    youngs_modulus: Annotated[Value | None, Field(description="Young's modulus, > 0 (stress)")] = (
        None
    )
    poissons_ratio: Annotated[
        Value | None,
        Field(description="Poisson's ratio, between −1 and 0.5; from .49 nothing locks"),
    ] = None
    stiffness: Annotated[
        Stiffness | None,
        Field(
            description="instead of the two: 6 × 6 matrix of E_ijkl in the mesh's axes, ordered "
            "xx, yy, zz, yz, xz, xy (no factors 2); symmetric, positive definite (stress)"
        ),
    ] = None
    on: Annotated[
        str, Field(description="physical group of cells that it fills; by default the body")
    ] = ""

    def __post_init__(self) -> None:
        isotropic = (self.youngs_modulus, self.poissons_ratio)
        if self.stiffness is None:
            for key, value in zip(("youngs_modulus", "poissons_ratio"), isotropic, strict=True):
                if value is None:
                    raise ValueError(f"{key} is missing (or give a stiffness)")
        elif isotropic != (None, None):
            raise ValueError("give either youngs_modulus and poissons_ratio, or stiffness")
        young, poisson = isotropic
        if isinstance(young, float | int) and young <= 0:
            raise ValueError(f"youngs_modulus = {young:g} must be greater than 0")
        if isinstance(poisson, float | int) and not -1 < poisson < 0.5:
            raise ValueError(f"poissons_ratio = {poisson:g} must lie between -1 and 0.5")


@dataclass(frozen=True, config=_CLOSED)
class Discretisation:
    """The finite element space."""

    degree: Annotated[
        Integer, Field(ge=1, le=2, description="degree of the Lagrange displacements")
    ] = 2


@dataclass(frozen=True, config=_CLOSED)
class Support:
    """Prescribed displacement components (the paper's Γ_D)."""

    on: Annotated[Text, Field(description="physical group: a boundary, or the whole body")]
    displacement: Annotated[
        Mapping[AxisName, Value],
        Field(min_length=1, description="component → value (length), such as `{ x = 0 }`"),
    ]


@dataclass(frozen=True, config=_CLOSED)
class Load:
    """A given load (the paper's f): exactly one of the three kinds."""

    on: Annotated[Text, Field(description="physical group: boundary, or body for a body force")]
    traction: Annotated[
        Vector | None, Field(description="force per area, one entry per axis (stress)")
    ] = None
    pressure: Annotated[
        Value | None, Field(description="pressure, > 0 pushes on the body (stress)")
    ] = None
    body_force: Annotated[
        Vector | None, Field(description="force per volume, one entry per axis")
    ] = None

    def __post_init__(self) -> None:
        if sum(kind is not None for kind in (self.traction, self.pressure, self.body_force)) != 1:
            raise ValueError("give exactly one of traction, pressure and body_force")


Direction = Annotated[tuple[Number, ...], Field(min_length=2, max_length=3)]
Kind = Literal["prescribed", "unilateral", "winkler", "bonded"]
Shape = Literal[
    "plane", "parabola", "paraboloid", "cylinder", "sphere", "flat punch", "annular punch"
]


@dataclass(frozen=True, config=_CLOSED)
class Obstacle:
    """A rigid obstacle: its shape, where it stands, and what drives it.

    Without a shape and a gap it touches the contact surface everywhere.
    """

    shape: Annotated[
        Shape | None,
        Field(
            description="`paraboloid` and `sphere` in axisymmetric and 3D models, `parabola` and "
            "`cylinder` in plane and 3D ones; a `flat punch` ends at its radius"
        ),
    ] = None
    radius: Annotated[
        Positive | None,
        Field(
            description="of a sphere or cylinder, of curvature at the apex of a parabola or "
            "paraboloid, or outer radius (half width in plane models) of a punch (length)"
        ),
    ] = None
    inner_radius: Annotated[Positive | None, Field(description="of an annular punch (length)")] = (
        None
    )
    gap: Annotated[
        Value | None,
        Field(
            description="instead of a shape: gap along the surface's normal, negative where they "
            "overlap (length); in Python a function of x that returns UFL"
        ),
    ] = None
    position: Annotated[
        Direction | None,
        Field(description="apex, or a point of a plane (length); by default the origin"),
    ] = None
    normal: Annotated[
        Direction | None,
        Field(
            description="outward normal at the apex, of any length; slanting for a tilted "
            "obstacle; by default against that of a flat contact surface"
        ),
    ] = None
    along: Annotated[
        Direction | None,
        Field(description="direction of the straight lines of a 3D parabola or cylinder"),
    ] = None
    direction: Annotated[
        Direction | None,
        Field(description="in which it is driven, of any length; by default its normal"),
    ] = None
    indentation: Annotated[
        Number | None,
        Field(description="how far it is driven (length); by default 0, unless by a force"),
    ] = None
    force: Annotated[
        Annotated[Number, Field(ge=0)] | None,
        Field(description="drives it instead; on the part that is modelled (force)"),
    ] = None

    def __post_init__(self) -> None:
        if self.shape is not None and self.gap is not None:
            raise ValueError("give either a shape or a gap")
        if self.force is not None and self.indentation is not None:
            raise ValueError("give either an indentation or a force")
        needs_radius = self.shape not in (None, "plane")
        if needs_radius and self.radius is None:
            raise ValueError(f"radius is missing for the shape '{self.shape}'")
        if not needs_radius and self.radius is not None:
            raise ValueError("radius: only a curved shape or a punch has one")
        if (self.shape == "annular punch") != (self.inner_radius is not None):
            raise ValueError("inner_radius belongs to the shape 'annular punch', and only there")
        if self.radius and self.inner_radius and self.inner_radius >= self.radius:
            raise ValueError(f"inner_radius = {self.inner_radius:g} must be less than the radius")
        for key in ("normal", "along", "direction"):
            vector = getattr(self, key)
            if vector is not None and not any(vector):
                raise ValueError(f"{key} must not be a zero vector")


@dataclass(frozen=True, config=_CLOSED)
class Contact:
    """A contact surface (the paper's Γ_C): what it meets there, and friction."""

    on: Annotated[Text, Field(description="physical group of the contact surface")]
    pressure: Annotated[
        Value | None,
        Field(description="of `prescribed` contact, ≥ 0, which also loads the body (stress)"),
    ] = None
    name: Annotated[str, Field(description="name in the results; by default that of the group")] = (
        ""
    )
    contact: Annotated[
        Kind | None,
        Field(
            description="`prescribed`: its pressure is given; `unilateral`: an obstacle that the "
            "body may leave but not enter; `winkler`: the same on springs; `bonded`: glued to it; "
            "by default `prescribed` where there is a pressure, `winkler` where there is a "
            "foundation_stiffness, else `unilateral`"
        ),
    ] = None
    obstacle: Annotated[
        Obstacle | None,
        Field(description="what stands against it; by default it touches everywhere, and is fixed"),
    ] = None
    penalty_parameter: Annotated[
        Positive | Literal["auto"],
        Field(
            description="the paper's ε₁ of `unilateral` and `bonded` contact: penetration over "
            "pressure (length/stress); `auto` keeps its bias below .1 %"
        ),
    ] = "auto"
    foundation_stiffness: Annotated[
        Value | None,
        Field(description="of a `winkler` foundation, ≥ 0: pressure over depth (stress/length)"),
    ] = None
    law: Annotated[
        Literal["static", "none"],
        Field(description="friction law: `static` acts on the total displacement (the paper's)"),
    ] = "static"
    friction_coefficient: Annotated[
        Value, Field(description="Coulomb's coefficient, ≥ 0; 0 leaves friction out")
    ] = 0.0
    regularisation_parameter: Annotated[
        Positive | Literal["auto"],
        Field(description="the paper's ε, a slip (length); `auto` keeps its bias below .1 %"),
    ] = "auto"

    def __post_init__(self) -> None:
        prescribed = self.kind == "prescribed"
        if prescribed != (self.pressure is not None):
            raise ValueError(
                "the pressure is missing: prescribed contact needs it"
                if prescribed
                else f"pressure: in {self.kind} contact it is found, not given"
            )
        if (self.kind == "winkler") != (self.foundation_stiffness is not None):
            raise ValueError("foundation_stiffness belongs to winkler contact, and only there")
        if prescribed and self.obstacle is not None:
            raise ValueError("obstacle: prescribed contact has none, only its pressure")
        if self.penalty_parameter != "auto" and self.kind not in ("unilateral", "bonded"):
            raise ValueError(f"penalty_parameter: {self.kind} contact has none")
        if not prescribed and self.law != "none" and self.friction_coefficient != 0:
            raise ValueError(
                f"friction_coefficient: {self.kind} contact is without friction so far; "
                "friction needs a prescribed pressure"
            )
        for key in ("pressure", "friction_coefficient", "foundation_stiffness"):
            value = getattr(self, key)
            if isinstance(value, float | int) and value < 0:
                raise ValueError(f"{key} = {value} must be ≥ 0")

    @property
    def kind(self) -> Kind:
        """What is known of the contact, also where the scene leaves it to the other keys."""
        if self.contact is not None:
            return self.contact
        if self.foundation_stiffness is not None:
            return "winkler"
        return "unilateral" if self.pressure is None else "prescribed"

    @property
    def label(self) -> str:
        """Name in results and messages."""
        return self.name or self.on


@dataclass(frozen=True, config=_CLOSED)
class HalfSpace:
    """Makes the body a piece of a half-space.

    On its outer boundary the displacement is that of the half-space (Boussinesq) under
    the forces that the contacts carry.
    """

    on: Annotated[
        tuple[Text, ...],
        Field(min_length=1, description="physical groups of the outer boundary, inside the body"),
    ]


@dataclass(frozen=True, config=_CLOSED)
class SolverSettings:
    """When the nonlinear solver stops."""

    tolerance: Annotated[
        Number,
        Field(gt=0, lt=1e-3, description="force imbalance over all applied and support forces"),
    ] = 1e-10
    max_iterations: Annotated[
        Integer, Field(ge=1, le=1_000_000, description="Newton steps at the most")
    ] = 50


@dataclass(frozen=True, config=_CLOSED)
class Scene:
    """Everything a run needs to know."""

    kinematics: Annotated[
        Kinematics, Field(description="in axisymmetric models x is the radius and y the axis")
    ]
    material: Annotated[
        tuple[Material, ...],
        BeforeValidator(lambda value: value if isinstance(value, list | tuple) else (value,)),
        Field(
            min_length=1,
            description="the elastic material: one `[material]`, or several `[[material]]`, "
            "each `on` its group of cells",
        ),
    ]
    mesh: Annotated[
        MeshSource | None,
        Field(description="the mesh; in Python it may be left out and a `Body` passed instead"),
    ] = None
    title: Annotated[str, Field(description="one line for results and pictures")] = ""
    thickness: Annotated[
        Value | None,
        Field(description="of a plane stress model, > 0 (length); without it, all is per unit"),
    ] = None
    discretisation: Annotated[Discretisation, Field(description="the finite element space")] = (
        Field(default_factory=Discretisation)
    )
    support: Annotated[tuple[Support, ...], Field(description="supports, any number")] = ()
    load: Annotated[tuple[Load, ...], Field(description="loads, any number")] = ()
    contact: Annotated[tuple[Contact, ...], Field(description="contact surfaces, any number")] = ()
    symmetry: Annotated[
        tuple[Text, ...],
        Field(
            description="physical groups on planes of symmetry across an axis of the mesh; results "
            "are those of the part that is modelled"
        ),
    ] = ()
    half_space: Annotated[
        HalfSpace | None, Field(description="makes the body a piece of a half-space")
    ] = None
    solver: Annotated[SolverSettings, Field(description="the nonlinear solver")] = Field(
        default_factory=SolverSettings
    )

    def __post_init__(self) -> None:
        dimension = self.dimension
        for number, support in enumerate(self.support):
            for axis in support.displacement:
                if AXES.index(axis) >= dimension:
                    raise ValueError(
                        f"support[{number}].displacement.{axis}: a {self.kinematics} model has "
                        f"only the axes {', '.join(AXES[:dimension])}"
                    )
        for number, load in enumerate(self.load):
            for key in ("traction", "body_force"):
                vector = getattr(load, key)
                if vector is not None and len(vector) != dimension:
                    raise ValueError(
                        f"load[{number}].{key} has {len(vector)} entries; "
                        f"a {self.kinematics} model needs {dimension}"
                    )
        if self.thickness is not None and self.kinematics != "plane stress":
            raise ValueError(f"thickness is for plane stress, not for {self.kinematics}")
        if isinstance(self.thickness, float | int) and self.thickness <= 0:
            raise ValueError(f"thickness = {self.thickness:g} must be greater than 0")
        if dimension == 2 and any(profile.along == "z" for profile in _profiles(self)):
            raise ValueError(f"a profile along z: a {self.kinematics} model has only x and y")
        for number, contact in enumerate(self.contact):
            _require_axes(contact.obstacle, dimension, f"contact[{number}].obstacle")
        if self.half_space is not None and self.load:
            raise ValueError("half_space: only the contacts' forces reach it, so leave out load")
        if self.half_space is not None and self.kinematics == "plane stress":
            raise ValueError("half_space is for plane strain, axisymmetric and 3D models")
        labels = [contact.label for contact in self.contact]
        for label in labels:
            if labels.count(label) > 1:
                raise ValueError(f"two contacts are called '{label}': give each its own name")

    @property
    def dimension(self) -> int:
        """Number of displacement components: 3 for 3D, else 2."""
        return 3 if self.kinematics == "3D" else 2


def _require_axes(obstacle: Obstacle | None, dimension: int, key: str) -> None:
    """Vectors of an obstacle have one entry an axis."""
    for name in ("position", "normal", "along", "direction"):
        vector = getattr(obstacle, name, None)
        if vector is not None and len(vector) != dimension:
            raise ValueError(f"{key}.{name} has {len(vector)} entries; it needs {dimension}")


def _profiles(part: Any) -> Iterator[Profile]:
    """All profiles inside a scene or a part of it."""
    if isinstance(part, Profile):
        yield part
    elif dataclasses.is_dataclass(part):
        for field in dataclasses.fields(part):
            yield from _profiles(getattr(part, field.name))
    elif isinstance(part, Mapping):
        for value in part.values():
            yield from _profiles(value)
    elif isinstance(part, tuple):
        for value in part:
            yield from _profiles(value)
