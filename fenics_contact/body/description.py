"""The part of a scene that describes the body, without loads and contacts.

Mesh, materials, and which displacements and surfaces supports and contacts need: all that is
computed from it holds for any laws, coefficients, obstacles, loads, values and load steps.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.couplings import GROUND, Spring, Way
from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry
from fenics_contact.scene.loading.support_axes import SupportAxes
from fenics_contact.scene.loading.temperatures import Temperature, expansions
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import RAMP, Kinematics, Strains, Value


@dataclass(frozen=True)
class HeldGroup:
    """A group that a support holds.

    Attributes:
        on: Its name.
        axes: Components of its displacement, such as ``("x", "y")``.
    """

    on: str
    axes: tuple[str, ...]


@dataclass(frozen=True)
class SpringGroup:
    """A boundary that springs hold.

    Attributes:
        on: Its name.
        support: Number of the support.
        stiffness: By number of the direction, such as ``((0, 100.0),)``; inf where they hold.
        by_area: Whether this is by area (stress/length), not in all (force/length).
        axes: Their directions; None for the axes of the mesh, ``normal`` for that of the boundary.
    """

    on: str
    support: int
    stiffness: tuple[tuple[int, float], ...]
    by_area: bool
    axes: SupportAxes | Literal["normal"] | None


@dataclass(frozen=True)
class CoupledGroup:
    """A boundary that moves as a rigid body, or whose mean motion a point follows.

    Attributes:
        on: Its name.
        at: The point that moves with it; None for the centroid of the boundary.
        label: Name in messages and results; no part of what the body is.
        is_rigid: Whether it moves as a rigid body.
    """

    on: str
    at: tuple[float, ...] | None
    label: str = field(compare=False)
    is_rigid: bool = True


@dataclass(frozen=True)
class Joint:
    """Springs between two coupled faces, or between one and the ground.

    Attributes:
        faces: Their numbers among all couplings; one of springs to the ground.
        stiffness: By way in which faces move (force/length, or force·length).
        gaps: Of stops among these, which act once the first point has moved so far along an axis
            relative to the second, or against it where they are < 0 (length).
    """

    faces: tuple[int, ...]
    stiffness: tuple[tuple[Way, float], ...]
    gaps: tuple[tuple[Way, float], ...] = ()


@dataclass(frozen=True)
class PreloadedGroup:
    """A part of the body whose unstressed length is changed.

    Attributes:
        on: Its name.
        axis: Along which, of any length.
        label: Name in messages; no part of what the body is.
    """

    on: str
    axis: tuple[float, ...]
    label: str = field(compare=False)


@dataclass(frozen=True)
class HeatedGroup:
    """The cells of a material that have a temperature, and how they expand by it.

    Attributes:
        table: Number of the temperature in the scene.
        on: Name of the group of cells, empty for the body.
        material: Number of the material.
        axes: Expansion along each axis over the largest; empty where the material has none.
        field: Where it varies in space, the temperature as the scene gives it, without its path.
        reference: At which such a field expands nothing (temperature).
        is_found: Whether its temperature is found, by conduction.
    """

    table: int
    on: str
    material: int
    axes: tuple[float, ...]
    field: Temperature | None = None
    reference: float = 0.0
    is_found: bool = False

    @property
    def extent(self) -> HeatedGroup:
        """Group of the same cells and expansion, without the values of its temperature field."""
        field = None if self.field is None else Temperature(value=0.0)
        return dataclasses.replace(self, field=field, reference=0.0)


@dataclass(frozen=True)
class CandidateContact:
    """A surface that may touch something.

    Attributes:
        on: Name of its group.
        against: That of the surface opposite, None where a rigid obstacle stands, or nothing.
        slave: Which of the two is to be the slave: ``auto``, ``on`` or ``against``.
        label: Name in messages; no part of what the body is.
    """

    on: str
    against: str | None
    slave: str
    label: str = field(compare=False)


@dataclass(frozen=True)
class BodyDescription:
    """Description from which spaces, stiffness, held dofs and contact surfaces follow.

    Attributes:
        kinematics: Kinematic model, such as ``plane strain``.
        dimension: Displacement components.
        thickness: Of plane models, None where it plays no part (length).
        degree: Of the elements.
        material: Of the parts, without densities: masses are no part of a stiffness.
        held: What supports hold.
        symmetry: Groups in planes of symmetry.
        outer: Groups of the outer boundary of a piece of a half-space.
        contacts: In scene order.
        preloads: Likewise.
        springs: Of supports that give way, likewise.
        couplings: Boundaries that move with a point, likewise.
        joints: Springs between these, likewise.
        heated: Cells that have a temperature, by temperature and material.
        cyclic_symmetry: The cut faces of a sector, or None.
        temperatures: Those that moduli follow at first, once their paths are 1, with their factors;
            none where no modulus follows any.
        strains: ``small``, or ``finite`` with a stored energy in place of Hooke's law.
    """

    kinematics: Kinematics
    dimension: int
    thickness: Value | None
    degree: int
    material: tuple[Material, ...]
    held: tuple[HeldGroup, ...]
    symmetry: tuple[str, ...]
    outer: tuple[str, ...]
    contacts: tuple[CandidateContact, ...]
    preloads: tuple[PreloadedGroup, ...] = ()
    springs: tuple[SpringGroup, ...] = ()
    couplings: tuple[CoupledGroup, ...] = ()
    joints: tuple[Joint, ...] = ()
    heated: tuple[HeatedGroup, ...] = ()
    cyclic_symmetry: CyclicSymmetry | None = None
    temperatures: tuple[tuple[Temperature, float], ...] = ()
    strains: Strains = "small"

    @classmethod
    def of(cls, scene: Scene) -> BodyDescription:
        """Return the description of a scene's body."""
        return cls(
            kinematics=scene.kinematics,
            dimension=scene.dimension,
            thickness=scene.thickness,
            degree=scene.discretisation.degree,
            material=tuple(each.elastic for each in scene.material),
            held=tuple(HeldGroup(each.on, each.held(scene.dimension)) for each in scene.support),
            symmetry=scene.symmetry,
            outer=scene.half_space.on if scene.half_space else (),
            contacts=tuple(
                CandidateContact(each.on, each.against, each.slave, each.label)
                for each in scene.contact
            ),
            preloads=tuple(
                PreloadedGroup(each.group, each.axis, each.label) for each in scene.preload
            ),
            springs=tuple(
                SpringGroup(
                    each.on,
                    number,
                    each.stiffnesses(scene.dimension),
                    each.foundation_stiffness is not None,
                    each.axes if each.normal is None else "normal",
                )
                for number, each in enumerate(scene.support)
                if each.is_elastic
            ),
            couplings=tuple(
                CoupledGroup(each.on, each.at, each.label, each.is_rigid) for each in scene.coupling
            ),
            joints=tuple(_joint(each, scene) for each in scene.spring),
            heated=(
                *(
                    _heated(scene, table, material)
                    for table in range(len(scene.temperature))
                    for material in range(len(scene.material))
                ),
                *_heated_by_conduction(scene),
            ),
            cyclic_symmetry=scene.cyclic_symmetry,
            temperatures=temperatures_at(scene, scene.load_steps.all_times[-1]),
            strains=scene.strains,
        )

    def differences(self, other: BodyDescription) -> Sequence[str]:
        """Names of what is not the same."""
        names = (each.name for each in dataclasses.fields(self))
        return [name for name in names if getattr(self, name) != getattr(other, name)]

    def differences_without_temperature_fields(self, other: BodyDescription) -> Sequence[str]:
        """Names of attributes that differ, but for the values of temperature fields.

        With couplings these values count, as thermal strain does work in their motions.
        """
        found = self.differences(other)
        if self.couplings:
            return found
        one, another = ([each.extent for each in body.heated] for body in (self, other))
        return [name for name in found if name != "heated" or one != another]


def temperatures_at(scene: Scene, time: float) -> tuple[tuple[Temperature, float], ...]:
    """Return given temperatures that moduli follow, once their paths are 1, and their factors.

    Args:
        scene: The scene.
        time: Pseudo-time.
    """
    if not scene.moduli_follow_temperature:
        return ()
    at = scene.path_time(time)
    return tuple((dataclasses.replace(one, path=RAMP), one.path(at)) for one in scene.temperature)


def _heated(scene: Scene, table: int, number: int) -> HeatedGroup:
    given, material = scene.temperature[table], scene.material[number]
    found = expansions(material)
    axes = () if found is None else found[1]
    if given.is_uniform:
        return HeatedGroup(table, given.on, number, axes)
    field = dataclasses.replace(given, on="", path=RAMP)
    return HeatedGroup(table, given.on, number, axes, field, material.reference_temperature)


def _heated_by_conduction(scene: Scene) -> Iterator[HeatedGroup]:
    """Cells of materials that expand, where heat flows."""
    for number, material in enumerate(scene.material if scene.heat else ()):
        found = expansions(material)
        if found is not None and found[0] != 0:
            reference = material.reference_temperature
            yield HeatedGroup(0, "", number, found[1], None, reference, is_found=True)


def _joint(spring: Spring, scene: Scene) -> Joint:
    labels = [coupling.label for coupling in scene.coupling]
    faces = tuple(labels.index(name) for name in spring.between if name != GROUND)
    ways, gaps = spring.by_way(scene.kinematics), spring.gaps(scene.kinematics)
    return Joint(faces, tuple(ways.items()), tuple(gaps.items()))
