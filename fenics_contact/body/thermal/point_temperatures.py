"""Temperatures at the points where materials are evaluated, for moduli that follow them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from dolfinx import fem

from fenics_contact.body.spaces import Spaces
from fenics_contact.body.thermal.temperature_field import temperatures_at
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.temperatures import Temperature


class PointTemperatures:
    """Temperatures at the points of a discontinuous space; collective.

    Args:
        space: Of the materials' values.
        owner: Number of the material at each of its points.
        materials: Of the scene.
        spaces: Those of the body.
    """

    def __init__(
        self,
        space: fem.FunctionSpace,
        owner: Integers,
        materials: Sequence[Material],
        spaces: Spaces,
    ) -> None:
        self._space, self._spaces = space, spaces
        self._places = space.tabulate_dof_coordinates()
        self._reference = np.array([one.reference_temperature for one in materials])[owner]
        self._given: dict[int, tuple[Temperature, AnyIntegers, Array]] = {}

    def given(self, temperatures: Sequence[tuple[Temperature, float]]) -> Array:
        """Temperatures that a scene gives, the reference where it gives none; collective.

        Args:
            temperatures: Those of the scene, once their paths are 1, and their present factors.

        Returns:
            (points,) (temperature).

        Raises:
            InputError: A group has no cells, or a function or a file of a temperature fails.
        """
        found = self._reference.copy()
        for number, (one, factor) in enumerate(temperatures):
            points, rise = self._rise(number, one)
            found[points] += factor * rise
        return found

    def _rise(self, number: int, given: Temperature) -> tuple[AnyIntegers, Array]:
        """Points of a temperature, and its difference from the reference there; collective."""
        known = self._given.get(number)
        if known is None or known[0] != given:
            key, body = f"temperature[{number}]", self._spaces.body
            points: AnyIntegers = np.arange(len(self._reference))
            if given.on:
                cells = body.entities(body.part(given.on, f"{key}.on"))
                points = np.unique(self._space.dofmap.list[cells])
            there = temperatures_at(given, self._places[points], key, self._spaces)
            known = given, points, there - self._reference[points]
            self._given[number] = known
        return known[1:]

    def found(self, rise: Array) -> Array:
        """Temperatures that conduction has found, (points,) (temperature).

        Args:
            rise: Less the reference, at the nodes of this rank, (nodes,) (temperature).
        """
        nodes = self._spaces.displacement_space.dofmap.list
        element = self._spaces.displacement_space.ufl_element().sub_elements[0]
        table = element.tabulate(0, compat.interpolation_points(self._space.element))[0]
        found = self._reference.copy()
        found[self._space.dofmap.list] += rise[nodes] @ table.T
        return found
