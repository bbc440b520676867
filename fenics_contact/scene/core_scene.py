"""A scene as far as no analysis asks more of it: what its parts are judged by."""

from __future__ import annotations

from typing import Literal

from fenics_contact.scene.body import Material, MeshSource
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load, Point, Preload
from fenics_contact.scene.loading.couplings import Coupling, Spring
from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry
from fenics_contact.scene.loading.heat import Heat
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.loading.temperatures import Temperature
from fenics_contact.scene.obstacle import HalfSpace
from fenics_contact.scene.quantity_names import QuantityNames
from fenics_contact.scene.settings import Accuracy, SolverSettings, Steps
from fenics_contact.scene.values import HasUnits, Kinematics, Repetition, Strains, Value


class LoadCycles:
    """Cycles of all load paths, in whichever way they are computed; ``Cycles`` has the table."""

    begin: float
    end: float
    number: int
    increments: int | None
    until: Literal["closed", "end"]
    tolerance: float

    @property
    def repetition(self) -> Repetition:
        """When it runs."""
        return Repetition(self.begin, self.end - self.begin, self.number)


class CoreScene(HasUnits):
    """A scene without the tables of analyses; ``Scene`` says what its keys are."""

    kinematics: Kinematics
    material: tuple[Material, ...]
    mesh: tuple[MeshSource, ...]
    thickness: Value | None
    support: tuple[Support, ...]
    load: tuple[Load, ...]
    preload: tuple[Preload, ...]
    coupling: tuple[Coupling, ...]
    spring: tuple[Spring, ...]
    contact: tuple[Contact, ...]
    point: tuple[Point, ...]
    symmetry: tuple[str, ...]
    half_space: HalfSpace | None
    accuracy: Accuracy | None
    steps: Steps
    cycles: LoadCycles | None
    motion: Motion | None
    temperature: tuple[Temperature, ...]
    heat: tuple[Heat, ...]
    solver: SolverSettings
    cyclic_symmetry: CyclicSymmetry | None
    strains: Strains

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
    def has_temperatures(self) -> bool:
        """Whether temperatures are given, or found by conduction."""
        return bool(self.temperature or self.heat)

    @property
    def moduli_follow_temperature(self) -> bool:
        """Whether a modulus is a table of temperature."""
        return any(material.follows_temperature for material in self.material)

    @property
    def is_exact(self) -> bool:
        """Whether contacts are solved without penalty, or friction without smoothing."""
        is_asked = self.solver.strategy == "exact" or self.has_finite_strains
        return is_asked or any(contact.is_exact for contact in self.contact)

    @property
    def has_finite_strains(self) -> bool:
        """Whether strains, rotations and sliding may be large."""
        return self.strains == "finite"

    @property
    def is_per_unit_thickness(self) -> bool:
        """Whether forces, areas and energies of the model are per length."""
        return self.dimension == 2 and self.kinematics != "axisymmetric" and self.thickness is None

    @property
    def names(self) -> QuantityNames:
        """The names by which quantities can be asked for."""
        supports = [support.label for support in self.support]
        supports += [coupling.label for coupling in self.coupling]
        supports += self.symmetry
        if self.half_space is not None:
            supports.append(self.half_space.label)
        return QuantityNames(
            contacts=tuple(contact.label for contact in self.contact),
            supports=tuple(supports),
            points=tuple(point.name for point in self.point),
            preloads=tuple(preload.label for preload in self.preload),
            dimension=self.dimension,
            have_moments=self.kinematics != "axisymmetric",
        )
