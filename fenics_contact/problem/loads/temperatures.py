"""Thermal strains as scalars of the body's energy, whose values the temperatures give."""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr

from fenics_contact.body.preloaded_part import ScalarForces
from fenics_contact.body.thermal.heated_part import HeatedPart
from fenics_contact.problem.scalar_unknown import BodyScalar, KnownProblem, ScalarUnknown
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.loading.temperatures import Temperature, expansions
from fenics_contact.scene.values import CONSTANT


class ThermalStrain(BodyScalar):
    """By how much a length would expand freely, q = L α (T − reference), which is given.

    L is the extent of the body, so that q is a length as other scalars are. Where the temperature
    varies in space, it is the largest difference that counts, and its field over that is part of
    what a unit of q does to the body.

    Attributes:
        part: The cells that it heats.
        table: Number of the temperature in the scene.
        material: Number of the material.
        factor: Of the path, at present.

    Args:
        part: The cells that it heats.
        forces: What a unit of it does to the body.
        material: The material of the cells.
        given: The temperature of the scene; None where it is found by conduction.
        words: Behind its name in results, to tell materials apart.
    """

    has_slack = False

    def __init__(
        self,
        part: HeatedPart,
        forces: ScalarForces,
        material: Material,
        given: Temperature | None,
        words: str,
    ) -> None:
        self.part, self.table, self.material = part, part.described.table, part.described.material
        label = "temperature by conduction" if given is None else given.label
        super().__init__(f"{label}{words}", forces)
        path = CONSTANT if given is None else given.path
        self._path = KeyedPath(path, f"temperature[{self.table}].path")
        found = expansions(material)
        assert found is not None
        self._per_degree = found[0] * part.spaces.size
        self._rise, self._is_uniform = part.largest_rise, False
        if given is not None and isinstance(given.value, float | int):
            self._rise = given.value - material.reference_temperature
            self._is_uniform = True
        self._is_even = not isinstance(material.thermal_expansion, tuple)
        self.factor = 0.0

    @property
    def name(self) -> str:
        """Name of the scalar in results."""
        return self.label

    @property
    def term(self) -> str:
        """Name of the energy term that it makes, for results."""
        return self.label

    @property
    def force(self) -> float:
        """None acts on it: its value is given."""
        return 0.0

    @property
    def has_force(self) -> bool:
        """Whether anything moves it: the temperature does."""
        return True

    @property
    def is_locked(self) -> bool:
        """Whether the scene keeps its value: always."""
        return True

    @property
    def is_given(self) -> bool:
        """Whether the scene gives its value at all times: it does."""
        return True

    @property
    def keeps_last(self) -> bool:
        """Whether it keeps the value of the last load step: no, the scene gives each."""
        return False

    @property
    def at_begin(self) -> float:
        """Its value before anything acts; where a temperature is found the field grows, not it."""
        return self.held if self.part.described.is_found else 0.0

    @property
    def brings(self) -> float:
        """How far it may bring nodes at present, as a part expands (length)."""
        return abs(self.held)

    @property
    def held(self) -> float:
        """Its value at present (length)."""
        return self._per_degree * self._rise * self.factor

    @property
    def start(self) -> float:
        """The value at which a load step begins (length)."""
        return self.held

    def set_time(self, time: float, more: float = 0.0) -> None:
        """Bring the temperature to a pseudo-time."""
        self.factor = self._path(time)

    def slope(self, name: str, time: float) -> float | None:
        """Derivative of its value by a number of the scene; None where it says none.

        Args:
            name: ``value`` of the temperature, ``thermal_expansion`` or ``reference_temperature``
                of the material.
            time: Pseudo-time.
        """
        factor = self._path(time)
        if name == "thermal_expansion" and self._is_even:
            return self.part.spaces.size * self._rise * factor
        signs = {"value": 1.0, "reference_temperature": -1.0}
        if name in signs and self._is_uniform:
            return signs[name] * self._per_degree * factor
        return None

    def force_of(self, stress: Expr) -> Expr:
        """∂W/∂q of a stress, −∫ σ : (its strain free of stress for a unit), weighted."""
        strain = self.part.stressless_strain(ufl.as_ufl(-1.0))
        return self.part.spaces.weight * ufl.inner(stress, strain) * self.part.measure


def thermal_strains(problem: KnownProblem) -> list[ScalarUnknown]:
    """One for each part of the body that has a temperature."""
    elastic, scene, found = problem.elastic, problem.scene, list[ScalarUnknown]()
    several = len(scene.material) > 1
    for part, forces in zip(elastic.heated, elastic.forces_of_heated, strict=True):
        described = part.described
        given = None if described.is_found else scene.temperature[described.table]
        words = f" in material {described.material}" if several else ""
        material = scene.material[described.material]
        found.append(ThermalStrain(part, forces, material, given, words))
    return found
