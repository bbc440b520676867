"""A scene: what the user says, as frozen data. No FEniCSx in here.

Every class is a frozen, validated dataclass; the same words are the keys of a
scene file (``fenics_contact.scene.reading``). Units are the user's, consistent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from fenics_contact.analyses.derivatives.table import DerivativeRequest, as_tolerances
from fenics_contact.analyses.fretting.table import Fretting
from fenics_contact.analyses.stability.table import Stability
from fenics_contact.analyses.stress_lines.table import Line
from fenics_contact.analyses.vibration.table import Damping, Modes
from fenics_contact.scene.body import Material, with_values_by_name
from fenics_contact.scene.body import MeshSource as MeshSource
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.fit import require_fit
from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.loading.conditions import Load, Point, Preload
from fenics_contact.scene.loading.couplings import Coupling, Spring
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry
from fenics_contact.scene.loading.heat import Heat
from fenics_contact.scene.loading.load_paths import load_steps_of
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.loading.temperatures import Temperature
from fenics_contact.scene.obstacle import HalfSpace
from fenics_contact.scene.settings import Accuracy, Share, as_accuracy
from fenics_contact.scene.settings import SolverSettings as SolverSettings
from fenics_contact.scene.settings import Steps as Steps
from fenics_contact.scene.units.dimensions import LENGTH, UnitNames
from fenics_contact.scene.units.table import Units, convert_texts
from fenics_contact.scene.values import (
    Integer,
    Kinematics,
    Positive,
    Strains,
    Text,
    Value,
    as_list,
    scene_class,
)

_MOST = 1000  # meshes, supports, loads …, each of which takes up to a hundredth of a second


@scene_class
class Discretisation:
    """The finite element space."""

    degree: Annotated[
        Integer,
        Field(
            ge=1,
            le=2,
            description="degree of the Lagrange displacements; 1 only where cells are not curved",
        ),
    ] = 2


@scene_class
class Scene(CoreScene):
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
        FREE_AT_RESUME,
        Field(
            max_length=_MOST,
            description="one `[mesh]`, or several `[[mesh]]`, each with a `name`; in Python it may "
            "be left out and a `Body` passed instead",
        ),
    ] = ()
    title: Annotated[
        str, FREE_AT_RESUME, Field(description="one line for results and pictures")
    ] = ""
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
    coupling: Annotated[
        tuple[Coupling, ...],
        Field(description=f"boundaries that move with a point, up to {_MOST}", max_length=_MOST),
    ] = ()
    spring: Annotated[
        tuple[Spring, ...],
        Field(description=f"springs between couplings, up to {_MOST}", max_length=_MOST),
    ] = ()
    contact: Annotated[
        tuple[Contact, ...],
        Field(description=f"contact surfaces, up to {_MOST}", max_length=_MOST),
    ] = ()
    point: Annotated[
        tuple[Point, ...], Field(description="points whose displacement is a quantity, any number")
    ] = ()
    line: Annotated[
        tuple[Line, ...],
        FREE_AT_RESUME,
        Field(
            description=f"lines along which `lines.csv` has stress and strain, up to {_MOST}",
            max_length=_MOST,
        ),
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
        DerivativeRequest | None,
        FREE_AT_RESUME,
        Field(description="derivatives of quantities in numbers of the scene that are to be found"),
    ] = None
    tolerances: Annotated[
        Mapping[str, Positive],
        BeforeValidator(as_tolerances, json_schema_input_type=Mapping[str, Any]),
        FREE_AT_RESUME,
        Field(
            description="how far numbers of the scene may be off: key as of `--set` → ±, such as "
            "`contact.0.friction_coefficient = 0.05`; what that makes of each quantity of "
            "`[derivatives]` is told beside its error bar"
        ),
    ] = Field(default_factory=dict)
    fretting: Annotated[
        Fretting | None,
        FREE_AT_RESUME,
        Field(description="criteria of fatigue by the stress near contacts, over the last cycle"),
    ] = None
    modes: Annotated[
        Modes | None,
        FREE_AT_RESUME,
        Field(description="natural modes about the state after the last load step"),
    ] = None
    damping: Annotated[
        Damping | None,
        FREE_AT_RESUME,
        Field(description="modes that are driven to and fro about that state: what joints damp"),
    ] = None
    stability: Annotated[
        Stability | None,
        FREE_AT_RESUME,
        Field(description="complex modes about that state, which is one of steady sliding: squeal"),
    ] = None
    steps: Annotated[Steps, FREE_AT_RESUME, Field(description="load steps, by default one")] = (
        Field(default_factory=Steps)
    )
    cycles: Annotated[
        Cycles | None, Field(description="a piece of all load paths that runs again and again")
    ] = None
    motion: Annotated[
        Motion | None, Field(description="bodies have mass, and move in real time")
    ] = None
    solver: Annotated[SolverSettings, FREE_AT_RESUME, Field(description="the nonlinear solver")] = (
        Field(default_factory=SolverSettings)
    )
    units: Annotated[
        Units | None,
        FREE_AT_RESUME,
        Field(
            description="of all numbers of the scene and of its results, which are then named "
            'with them; values may then also be texts with a unit, such as `"210 GPa"`'
        ),
    ] = None
    temperature: Annotated[
        tuple[Temperature, ...],
        Field(description=f"temperatures of bodies, up to {_MOST}", max_length=_MOST),
    ] = ()
    cyclic_symmetry: Annotated[
        CyclicSymmetry | None,
        Field(
            description="the body is one sector of a ring, whose cut faces move alike; results are "
            "those of the sector"
        ),
    ] = None
    heat: Annotated[
        tuple[Heat, ...],
        Field(
            description=f"of boundaries, up to {_MOST}: temperatures are then found by conduction",
            max_length=_MOST,
        ),
    ] = ()
    strains: Annotated[
        Strains,
        Field(
            description="`small`: linear elasticity; `finite`: large strains, rotations and "
            "sliding in plane strain, with the stored energy that `material.law` names"
        ),
    ] = "small"

    def use_units(self) -> None:
        """Put numbers where there are texts with a unit, and values of materials by name."""
        convert_texts(self, self.units, self.is_per_unit_thickness)
        materials = with_values_by_name(self.material, self.units is not None)
        if materials != self.material:
            object.__setattr__(self, "material", materials)
            convert_texts(self, self.units, self.is_per_unit_thickness)

    def __post_init__(self) -> None:
        require_fit(self)

    @property
    def files(self) -> list[str]:
        """Paths of the files that it names, of meshes, then of obstacles and of temperatures."""
        obstacles = (contact.obstacle for contact in self.contact)
        return [
            *(mesh.file for mesh in self.mesh),
            *(one.file for one in obstacles if one is not None and one.file is not None),
            *(one.file for one in self.temperature if one.file is not None),
        ]

    def with_files(self, path_of: Callable[[str], str]) -> Scene:
        """The scene with other paths of its files.

        Args:
            path_of: Gives the new path of each.
        """
        meshes = tuple(replace(mesh, file=path_of(mesh.file)) for mesh in self.mesh)
        contacts = tuple(
            contact
            if contact.obstacle is None or contact.obstacle.file is None
            else replace(
                contact, obstacle=replace(contact.obstacle, file=path_of(contact.obstacle.file))
            )
            for contact in self.contact
        )
        temperatures = tuple(
            one if one.file is None else replace(one, file=path_of(one.file))
            for one in self.temperature
        )
        return replace(self, mesh=meshes, contact=contacts, temperature=temperatures)

    @property
    def unit_names(self) -> UnitNames | None:
        """Names of the units of its numbers and results; None where it has none."""
        return None if self.units is None else self.units.names(self.is_per_unit_thickness)

    @cached_property
    def load_steps(self) -> Steps:
        """All load steps, to the end of the last cycle; of cycles with jumps the ends of all."""
        return load_steps_of(self)

    @property
    def at_rest(self) -> Scene:
        """The scene without motion in one load step, with friction at rest and no bolt locked."""
        contacts = tuple(
            replace(one, friction_law=one.friction_law and one.friction_law.at_rest)
            for one in self.contact
        )
        preloads = tuple(replace(one, locked_from=None) for one in self.preload)
        return replace(self, contact=contacts, preload=preloads, motion=None, steps=Steps())
