"""A scene: what the user says, as frozen data. No FEniCSx in here.

Every class is a frozen, validated dataclass; the same words are the keys of a
scene file (``fenics_contact.scene.reading``). Units are the user's, consistent.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from fenics_contact.scene.accuracy import Accuracy, Share, as_accuracy
from fenics_contact.scene.asked.derivatives import AskedDerivatives
from fenics_contact.scene.asked.fretting import Fretting, require_fretting
from fenics_contact.scene.asked.tolerances import as_tolerances
from fenics_contact.scene.asked.vibration import Damping, Modes, require_vibration
from fenics_contact.scene.conditions import Load, Point, Preload, Support
from fenics_contact.scene.contact import Contact, HalfSpace, Obstacle
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.jumps import require_wear
from fenics_contact.scene.loading.load_paths import load_steps_of, require_cycles
from fenics_contact.scene.loading.motion import Motion, require_motion
from fenics_contact.scene.material import Material
from fenics_contact.scene.quantity_names import VECTORS, QuantityNames
from fenics_contact.scene.steps import SolverSettings as SolverSettings
from fenics_contact.scene.steps import Steps as Steps
from fenics_contact.scene.units.dimensions import LENGTH, LENGTH_OR_NUMBER
from fenics_contact.scene.units.table import Units, convert_texts
from fenics_contact.scene.values import (
    AXES,
    HasUnits,
    Integer,
    Kinematics,
    Number,
    Positive,
    Text,
    Value,
    as_list,
    profiles_of,
    scene_class,
)

_SAME_TIME = 1e-9
_MOST = 1000  # meshes, supports, loads …, each of which takes up to a hundredth of a second


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
        Integer, Field(ge=1, le=2, description="order of the cells' geometry made from a geometry")
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


@scene_class
class Discretisation:
    """The finite element space."""

    degree: Annotated[
        Integer, Field(ge=1, le=2, description="degree of the Lagrange displacements")
    ] = 2


@scene_class
class Scene(HasUnits):
    """Everything a run needs to know.

    A block on a rough floor is pressed down by 10 and pulled by 3, both per area. It stands on
    its lower side, 2 wide, so equilibrium tells what the floor has to carry:

    >>> from fenics_contact import main, run
    >>> main(["new", "own", "--quiet"])  # for its geometry, own.geo
    0
    >>> scene = Scene(
    ...     kinematics="plane strain",
    ...     mesh=MeshSource("own.geo", cell="quadrilateral"),
    ...     material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    ...     load=(Load("top", pressure=10), Load("right", traction=(3, 0))),
    ...     contact=(Contact("bottom", friction_coefficient=0.5),),
    ... )
    >>> found = run(scene)
    >>> abs(found.quantities["normal_force"] - 10) < 1e-8  # the geometry is 1 wide by default
    True
    >>> abs(found.quantities["friction_force"][0] + 3) < 1e-8
    True
    """

    kinematics: Annotated[
        Kinematics, Field(description="in axisymmetric models x is the radius and y the axis")
    ]
    material: Annotated[
        tuple[Material, ...],
        BeforeValidator(as_list, json_schema_input_type=Material | tuple[Material, ...]),
        Field(
            min_length=1,
            max_length=_MOST,
            description="the elastic material: one `[material]`, or several `[[material]]`, "
            "each `on` its group of cells",
        ),
    ]
    mesh: Annotated[
        tuple[MeshSource, ...],
        BeforeValidator(as_list, json_schema_input_type=MeshSource | tuple[MeshSource, ...]),
        Field(
            max_length=_MOST,
            description="one `[mesh]`, or several `[[mesh]]`, each with a `name`; in Python it may "
            "be left out and a `Body` passed instead",
        ),
    ] = ()
    title: Annotated[str, Field(description="one line for results and pictures")] = ""
    thickness: Annotated[
        Value | None,
        LENGTH,
        Field(description="of a plane stress model, > 0; without it, all is per unit"),
    ] = None
    discretisation: Annotated[Discretisation, Field(description="the finite element space")] = (
        Field(default_factory=Discretisation)
    )
    support: Annotated[
        tuple[Support, ...], Field(description=f"supports, up to {_MOST}", max_length=_MOST)
    ] = ()
    load: Annotated[
        tuple[Load, ...], Field(description=f"loads, up to {_MOST}", max_length=_MOST)
    ] = ()
    preload: Annotated[
        tuple[Preload, ...],
        Field(description=f"preloads of bolts, up to {_MOST}", max_length=_MOST),
    ] = ()
    contact: Annotated[
        tuple[Contact, ...],
        Field(description=f"contact surfaces, up to {_MOST}", max_length=_MOST),
    ] = ()
    point: Annotated[
        tuple[Point, ...], Field(description="points whose displacement is a quantity, any number")
    ] = ()
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
    accuracy: Annotated[
        Accuracy | None,
        BeforeValidator(as_accuracy, json_schema_input_type=Share | Accuracy),
        Field(
            description="makes meshes until estimated errors are below it: a number (`accuracy = "
            "1e-3`, before the first table) for all main quantities, or a table"
        ),
    ] = None
    derivatives: Annotated[
        AskedDerivatives | None,
        Field(description="derivatives of quantities in numbers of the scene that are to be found"),
    ] = None
    tolerances: Annotated[
        Mapping[str, Positive],
        BeforeValidator(as_tolerances, json_schema_input_type=Mapping[str, Any]),
        Field(
            description="how far numbers of the scene may be off: key as of `--set` → ±, such as "
            "`contact.0.friction_coefficient = 0.05`; what that makes of each quantity of "
            "`[derivatives]` is told beside its error bar"
        ),
    ] = Field(default_factory=dict)
    fretting: Annotated[
        Fretting | None,
        Field(description="criteria of fatigue by the stress near contacts, over the last cycle"),
    ] = None
    modes: Annotated[
        Modes | None,
        Field(description="natural modes about the state after the last load step"),
    ] = None
    damping: Annotated[
        Damping | None,
        Field(description="modes that are driven to and fro about that state: what joints damp"),
    ] = None
    steps: Annotated[Steps, Field(description="load steps, by default one")] = Field(
        default_factory=Steps
    )
    cycles: Annotated[
        Cycles | None, Field(description="a piece of all load paths that runs again and again")
    ] = None
    motion: Annotated[
        Motion | None, Field(description="bodies have mass, and move in real time")
    ] = None
    solver: Annotated[SolverSettings, Field(description="the nonlinear solver")] = Field(
        default_factory=SolverSettings
    )
    units: Annotated[
        Units | None,
        Field(
            description="of all numbers of the scene and of its results, which are then named "
            'with them; values may then also be texts with a unit, such as `"210 GPa"`'
        ),
    ] = None

    def use_units(self) -> None:
        """Put numbers where there are texts with a unit."""
        convert_texts(self, self.units, self.is_per_unit_thickness)

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
        if dimension == 2 and any(profile.along == "z" for profile in profiles_of(self)):
            raise ValueError(f"a profile along z: a {self.kinematics} model has only x and y")
        for number, contact in enumerate(self.contact):
            _require_axes(contact.obstacle, dimension, f"contact[{number}].obstacle")
            if contact.friction_law is not None:
                contact.friction_law.require_model(self.kinematics, f"contact[{number}]")
        if self.half_space is not None and (self.load or self.preload):
            what = "load" if self.load else "preload"
            raise ValueError(f"half_space: only the contacts' forces reach it, so leave out {what}")
        for number, preload in enumerate(self.preload):
            _require_bolt(self, preload, f"preload[{number}]")
        if self.half_space is not None and self.kinematics == "plane stress":
            raise ValueError("half_space is for plane strain, axisymmetric and 3D models")
        if len(self.mesh) > 1:
            _require_names(self.mesh)
        for number, point in enumerate(self.point):
            if len(point.at) != dimension:
                raise ValueError(
                    f"point[{number}].at has {len(point.at)} entries; "
                    f"a {self.kinematics} model needs {dimension}"
                )
        _require_distinct("points", [point.name for point in self.point])
        _require_distinct("contacts", [contact.label for contact in self.contact])
        _require_distinct("preloads", [preload.label for preload in self.preload])
        _require_known(self)
        require_cycles(self)
        require_motion(self)
        require_wear(self)
        require_fretting(self)
        require_vibration(self)

    @cached_property
    def load_steps(self) -> Steps:
        """All load steps, to the end of the last cycle; of cycles with jumps the ends of all."""
        return load_steps_of(self)

    @property
    def passes_cycles_over(self) -> bool:
        """Whether not every cycle is computed."""
        return self.cycles is not None and self.cycles.jumps is not None

    def path_time(self, time: float) -> float:
        """The pseudo-time at which load paths are asked: of all cycles that in the first.

        Args:
            time: Pseudo-time of the load steps.
        """
        return time if self.cycles is None else self.cycles.repetition.first_time(time)

    @property
    def dimension(self) -> int:
        """Number of displacement components, 3 in 3D, else 2."""
        return 3 if self.kinematics == "3D" else 2

    @property
    def is_per_unit_thickness(self) -> bool:
        """Whether forces, areas and energies of the model are per length."""
        return self.dimension == 2 and self.kinematics != "axisymmetric" and self.thickness is None

    @property
    def names(self) -> QuantityNames:
        """The names by which quantities can be asked for."""
        supports = [*(support.label for support in self.support), *self.symmetry]
        if self.half_space is not None:
            supports.append(self.half_space.label)
        return QuantityNames(
            contacts=tuple(contact.label for contact in self.contact),
            supports=tuple(supports),
            points=tuple(point.name for point in self.point),
            preloads=tuple(preload.label for preload in self.preload),
            dimension=self.dimension,
        )


def _require_bolt(scene: Scene, preload: Preload, key: str) -> None:
    """Its axis fits the model, and a load step ends where it is locked."""
    axis, steps, locked = preload.axis, scene.steps, preload.locked_from
    if len(axis) != scene.dimension:
        raise ValueError(
            f"{key}.axis has {len(axis)} entries; a {scene.kinematics} model needs "
            f"{scene.dimension}"
        )
    if preload.between is not None and not scene.mesh:
        raise ValueError(
            f"{key}.between: only a body of a CAD file can be cut; of a mesh, preload a group of "
            "its cells"
        )
    if scene.kinematics == "axisymmetric" and axis[0] != 0:
        raise ValueError(f"{key}.axis: must be along y, the axis of revolution")
    if locked is None:
        return
    if scene.cycles is None and locked > steps.last * (1 + _SAME_TIME):
        raise ValueError(
            f"{key}.locked_from = {locked:g}: the last load step ends at {steps.last:g}"
        )
    ends = steps.all_times if scene.cycles is None else (*steps.all_times, scene.cycles.begin)
    if not steps.automatic and locked < ends[0] * (1 - _SAME_TIME):
        raise ValueError(
            f"{key}.locked_from = {locked:g}: lies before the end of the first load step, "
            f"{ends[0]:g}, so that no force has tightened it yet"
        )
    if not steps.automatic and min(abs(locked - end) for end in ends) > _SAME_TIME * locked:
        raise ValueError(
            f"{key}.locked_from = {locked:g}: no load step ends there; add it to steps.times"
        )


def _require_known(scene: Scene) -> None:
    """Every quantity that an accuracy or derivatives are asked of is one of the scene."""
    if scene.tolerances and scene.derivatives is None:
        raise ValueError(
            "tolerances: say in [derivatives] of which quantities, such as of = ['normal_force']"
        )
    asked = [("accuracy", name) for name in (() if scene.accuracy is None else scene.accuracy.of)]
    derivatives = scene.derivatives
    asked += [("derivatives.of", name) for name in (() if derivatives is None else derivatives.of)]
    for key, name in asked:
        try:
            found = scene.names.find(name)
        except ValueError as error:
            raise ValueError(f"{key}: {error}") from None
        is_vector = found.quantity in VECTORS or found.quantity.startswith("displacement_")
        if key != "accuracy" and is_vector and found.axis is None:
            raise ValueError(f"{key}: '{name}' is a vector; ask for its components, as {name}_x")


def _require_names(meshes: tuple[MeshSource, ...]) -> None:
    """Several meshes are told apart by their names."""
    for number, mesh in enumerate(meshes):
        if not mesh.name:
            raise ValueError(f"mesh[{number}].name is missing: each of several meshes needs one")
    _require_distinct("meshes", [mesh.name for mesh in meshes])


def _require_distinct(things: str, names: Sequence[str]) -> None:
    """Things of one kind are told apart by their names."""
    name, count = Counter(names).most_common(1)[0] if names else ("", 0)
    if count > 1:
        raise ValueError(f"two {things} are called '{name}': give each its own name")


def _require_axes(obstacle: Obstacle | None, dimension: int, key: str) -> None:
    """Vectors of an obstacle have one entry an axis."""
    for name in ("position", "normal", "along", "direction", "displacement"):
        vector = getattr(obstacle, name, None)
        if vector is not None and len(vector) != dimension:
            raise ValueError(f"{key}.{name} has {len(vector)} entries; it needs {dimension}")
