"""Temperatures of a body at a pseudo-time, as the scene gives them: at places and at nodes.

A cell without a temperature of its own has the reference temperature of its material.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.body.probe_points import PlacesInBody
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.evaluate.stress_at_places import material_of_cells
from fenics_contact.problem.loads.temperatures import ThermalStrain
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import MAX_TEMPERATURE, TEMPERATURE_OF_POINTS


class TemperaturesAt:
    """Temperatures at places in cells of this rank; collective.

    Args:
        problem: The model.
        places: (places, 3) (length).
        cells: A cell of this rank that holds each, (places,).
    """

    def __init__(self, problem: Problem, places: Array, cells: AnyIntegers) -> None:
        materials = problem.scene.material
        references = np.array([material.reference_temperature for material in materials])
        self._reference = references[material_of_cells(problem)[cells]]
        self._parts: list[tuple[ThermalStrain, Integers, Array]] = []
        for strain in problem.body_scalars:
            if isinstance(strain, ThermalStrain) and not strain.part.described.is_found:
                inside = np.flatnonzero(np.isin(cells, strain.part.cells))
                given = strain.part.temperatures(problem.scene.temperature, places[inside])
                self._parts.append((strain, inside, given))

    def values(self) -> Array:
        """Present temperatures, (places,) (temperature)."""
        found = self._reference.copy()
        for strain, inside, given in self._parts:
            found[inside] += strain.factor * (given - self._reference[inside])
        return found


class TemperaturesInBody:
    """Temperatures at places anywhere in the body; collective.

    Those that conduction has found are interpolated between the nodes. On a face between cells of
    two materials it is their mean.

    Args:
        problem: The model.
        places: (places, 3) (length).
    """

    def __init__(self, problem: Problem, places: Array) -> None:
        self._comm, self._found = problem.comm, PlacesInBody(places, problem.spaces)
        self._count = len(places)
        self._problem = problem
        self._at = TemperaturesAt(problem, places[self._found.numbers], self._found.cells)

    def values(self) -> Array:
        """Present temperatures, (places,), 0 outside of the body; collective (temperature)."""
        summed, values = np.zeros((self._count, 2)), self._at.values()
        if self._problem.conduction is not None:
            nodes = self._problem.spaces.displacement_space.dofmap.list[self._found.cells]
            rise = self._problem.conduction.rise[nodes]
            values = values + np.einsum("pn,pn->p", self._found.weights, rise)
        np.add.at(summed[:, 0], self._found.numbers, values)
        np.add.at(summed[:, 1], self._found.numbers, 1.0)
        values, counts = total(self._comm, summed).T
        return np.asarray(values / np.maximum(counts, 1.0))


class NodalTemperatures:
    """Temperatures at the nodes of a body, the mean of the cells around each; collective."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._spaces = spaces = problem.spaces
        mesh = problem.body.mesh
        own = np.arange(mesh.topology.index_map(mesh.topology.dim).size_local)
        self._nodes = spaces.displacement_space.dofmap.list[own].ravel()
        cells = np.repeat(own, len(self._nodes) // max(len(own), 1))
        self._at = TemperaturesAt(problem, spaces.coordinates[self._nodes], cells)

    def values(self) -> Array:
        """Present temperatures, (nodes,); collective (temperature)."""
        found, count = self._at.values(), len(self._spaces.coordinates)
        columns = [np.bincount(self._nodes, each, count) for each in (found, np.ones(len(found)))]
        summed, cells = self._spaces.summed(np.stack(columns, axis=1)).T
        return np.asarray(summed / np.maximum(cells, 1.0)) + self._rise

    @property
    def _rise(self) -> Array | float:
        """What conduction has found beyond the reference, at the nodes (temperature)."""
        conduction = self._problem.conduction
        return 0.0 if conduction is None else conduction.rise

    def highest(self) -> float:
        """The highest temperature of any cell at its nodes; collective (temperature)."""
        at_cells, rise = self._at.values(), self._rise
        if isinstance(rise, np.ndarray):
            at_cells = at_cells + rise[self._nodes]
        return largest(self._spaces.comm, at_cells)


class ModelTemperatures:
    """Temperatures of a model with such, as quantities; collective."""

    def __init__(self, problem: Problem) -> None:
        self._nodes = NodalTemperatures(problem)
        self._names = [f"{TEMPERATURE_OF_POINTS}{point.name}" for point in problem.scene.point]
        self._points = TemperaturesInBody(problem, np.reshape(problem.points.places, (-1, 3)))

    def quantities(self) -> dict[str, float]:
        """The highest at present, and those of points, by quantity; collective (temperature)."""
        at_points = self._points.values().tolist()
        return {
            MAX_TEMPERATURE: self._nodes.highest(),
            **dict(zip(self._names, at_points, strict=True)),
        }
