"""Criteria of fatigue at the nodes near contacts, their worst places and their bars."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from fenics_contact.analyses.fretting.history import Cells, StressHistory, tensors
from fenics_contact.analyses.fretting.record import FrettingPlaces, FrettingRecord, WorstPlace
from fenics_contact.analyses.fretting.recovery import Recovery
from fenics_contact.analyses.fretting.table import Fretting
from fenics_contact.analytic import fatigue_criteria as criteria
from fenics_contact.analytic.critical_plane import StrainLife, swt
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import on_root
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.record import ErrorRow

# Values so near to the largest are as large: which of them is the worst place must not depend on
# round-off.
_AS_LARGE = 1e-9
# Of the change within a cell beside the edge of a contact.
_OF_A_CELL = 0.5
# Where each half of the size adds 1/√2 of what the one before did: all of them over the first.
_ALL_HALVES = 1 / (np.sqrt(2) - 1)


@dataclass(frozen=True, eq=False)
class _Found:
    """Criteria at the places, by one recovery of the stress.

    Attributes:
        columns: Name → values at the places.
        planes: Normals of the critical planes, (places, 3).
        moduli: Young's there, (places,) (stress).
    """

    columns: dict[str, Array]
    planes: Array
    moduli: Array


def evaluate_fretting(
    problem: Problem, fretting: Fretting, history: StressHistory
) -> tuple[FrettingRecord, FrettingPlaces] | None:
    """Criteria of fatigue at all nodes near where contacts touched; collective.

    Args:
        problem: The model.
        fretting: What its scene asks for.
        history: Of stress over the last cycle.

    Returns:
        The same on every rank; None where no cycle is complete.
    """
    touched = history.touched()
    if history.states == 0:
        return None

    def on_rank_0() -> tuple[FrettingRecord, FrettingPlaces]:
        cells, samples = history.region.cells, history.samples
        assert cells is not None and samples is not None
        return _evaluated(problem, fretting, cells, samples, touched)

    return on_root(problem.comm, on_rank_0)


def _evaluated(
    problem: Problem, fretting: Fretting, cells: Cells, samples: Array, touched: Array
) -> tuple[FrettingRecord, FrettingPlaces]:
    """On rank 0.

    Args:
        problem: The model.
        fretting: What its scene asks for.
        cells: Near the contacts.
        samples: (states, samples, 12).
        touched: Where contact points touched, (points, 3).
    """
    recovery = Recovery(cells, problem.spaces.degree)
    chosen = _chosen(recovery, touched, fretting.depth, problem.spaces.size)
    moduli = cells.youngs_modulus.reshape(-1)
    better, plainer = (
        _criteria(fretting, weights, samples, moduli) for weights in recovery.weights(chosen)
    )
    around = recovery.neighbours(chosen)
    bars = {
        name: _largest_around(_apart(values, plainer.columns[name]), around)
        for name, values in better.columns.items()
    }
    names = [contact.label for contact in problem.contacts]
    of_contact = [cells.of_contact.get(node) for node in recovery.node[chosen].tolist()]
    contact = ["" if number is None else names[number] for number in of_contact]
    coordinates = recovery.coordinates[chosen]
    near = _near_edges(coordinates, contact, around, touched, problem.spaces.size)
    for name in ("swt", "crossland", "dang_van", "shear_amplitude", "max_mean_stress"):
        if name in bars:
            bars[name] = _at_cusps(bars[name], better.columns[name], around, near)
    places = FrettingPlaces(
        coordinates=coordinates,
        body=[problem.spaces.parts.names[part] for part in recovery.part[chosen].tolist()],
        contact=contact,
        values=better.columns,
        bars=bars,
        planes=better.planes,
    )
    alphas = _alphas(fretting)
    record = FrettingRecord(
        steps=len(samples),
        places=len(chosen),
        crossland_alpha=alphas[0],
        dang_van_alpha=alphas[1],
        worst=_worst(places, better.moduli, around, fretting) if len(chosen) else {},
    )
    return record, places


def _apart(values: Array, others: Array) -> Array:
    """Return the difference of two recoveries; not a number where a life is endless by one."""
    known = np.isfinite(values) & np.isfinite(others)
    apart = np.full(len(values), np.nan)
    apart[known] = np.abs(values[known] - others[known])
    return apart


def _largest_around(values: Array, around: csr_matrix) -> Array:
    """The largest at places in the cells around each: differences pass through 0 here and there."""
    if len(values) == 0:
        return values
    found = np.fmax.reduceat(values[around.indices], around.indptr[:-1])
    return np.where(np.isfinite(values), found, np.nan)


def _near_edges(
    coordinates: Array, contact: list[str], around: csr_matrix, touched: Array, size: float
) -> Integers:
    """Places within two cells of an edge of what touched.

    Args:
        coordinates: Of all places (length).
        contact: Of each the contact on whose surface it lies; empty off the surfaces.
        around: Which of them share a cell.
        touched: Where contact points touched, (points, 3) (length).
        size: Of the body (length).
    """
    if len(coordinates) == 0:
        return np.zeros(0, dtype=np.int64)
    on_surface = np.array([bool(name) for name in contact])
    has_touched = cKDTree(touched).query(coordinates)[0] <= _AS_LARGE * size
    beside_open = np.asarray(around @ (on_surface & ~has_touched).astype(float)) > 0
    edge = on_surface & has_touched & beside_open
    return np.flatnonzero(around @ (around @ edge.astype(float)))


def _at_cusps(bars: Array, values: Array, around: csr_matrix, near: Integers) -> Array:
    """Bars where stress may have a cusp: at least half of its change within a cell."""
    found = bars.copy()
    for place in near.tolist():
        beside = around.indices[around.indptr[place] : around.indptr[place + 1]]
        change = float(np.abs(values[beside] - values[place]).max())
        found[place] = np.fmax(found[place], _OF_A_CELL * change)
    return found


def _chosen(recovery: Recovery, touched: Array, depth: float, size: float) -> Integers:
    """Places near to what touched, sorted by their coordinates, the same on any number of ranks."""
    if len(touched) == 0:
        return np.zeros(0, dtype=np.int64)
    near = cKDTree(touched).query(recovery.coordinates)[0] <= depth * (1 + _AS_LARGE)
    found = np.flatnonzero(near)
    keys = np.round(recovery.coordinates[found] / (_AS_LARGE * size))
    return found[np.lexsort((recovery.part[found], *keys.T[::-1]))]


def _criteria(fretting: Fretting, weights: csr_matrix, samples: Array, moduli: Array) -> _Found:
    """All criteria of stress and strain by one recovery.

    Args:
        fretting: What the scene asks for.
        weights: Of the samples at the places, sparse, (places, samples).
        samples: (states, samples, 12).
        moduli: Young's, (samples,).
    """
    states = [np.asarray(weights @ values) for values in samples]
    history = np.stack(states, axis=1)
    stress, strain = tensors(history[..., :6]), tensors(history[..., 6:])
    columns: dict[str, Array] = {}
    columns["swt"], planes = swt(stress, strain)
    at_places, line = np.asarray(weights @ moduli), _line(fretting)
    if line is not None:
        columns["life"] = line.cycles(columns["swt"], at_places)
    columns["shear_amplitude"] = criteria.deviator_amplitudes(stress)[0]
    columns["max_mean_stress"] = criteria.mean_stress(stress).max(axis=1)
    alphas = _alphas(fretting)
    if alphas[0] is not None and alphas[1] is not None:
        columns["crossland"] = criteria.crossland(stress, alphas[0])
        columns["dang_van"] = criteria.dang_van(stress, alphas[1])
    return _Found(columns, planes, at_places)


def _line(fretting: Fretting) -> StrainLife | None:
    """Return the strain-life line, where the scene has its constants."""
    asked = fretting.life
    if asked is None:
        return None
    exponents = asked.strength_exponent, asked.ductility_exponent
    return StrainLife(asked.strength, exponents[0], asked.ductility, exponents[1])


def _alphas(fretting: Fretting) -> tuple[float | None, float | None]:
    """Return the constants α of Crossland and of Dang Van, by the fatigue limits."""
    limits = fretting.limits
    if limits is None:
        return None, None
    both = limits.torsion, limits.tension
    return criteria.crossland_alpha(*both), criteria.dang_van_alpha(*both)


def _worst(
    places: FrettingPlaces, moduli: Array, around: csr_matrix, fretting: Fretting
) -> dict[str, WorstPlace]:
    """Where each criterion is largest.

    At a smooth peak it hardly changes within two cells, of a contact's surface along that. At a
    cusp, as stress has at the edge of a contact, errors fall with the root of the cell's size: that
    change is taken for what half the size would add, and all further halves for 1/(√2 − 1) of it.
    """
    found = {}
    for name in ("swt", "crossland", "dang_van"):
        values = places.values.get(name)
        if values is None:
            continue
        place = int(np.argmax(values >= values.max() - _AS_LARGE * np.abs(values).max()))
        beside = _beside(place, around, places.contact)
        value = float(values[place])
        change = _ALL_HALVES * (value - float(values[beside].min()))
        bar = max(float(places.bars[name][place]), change)
        more = _of_swt(places, float(moduli[place]), place, bar, _line(fretting))
        if name != "swt":
            limits = fretting.limits
            more = {} if limits is None else _of_limit(limits.torsion, value, bar)
        found[name] = WorstPlace(
            value=value,
            errors=_by_mesh(bar),
            at=places.coordinates[place].tolist(),
            body=places.body[place],
            contact=places.contact[place],
            **more,
        )
    return found


def _beside(place: int, around: csr_matrix, contact: list[str]) -> Integers:
    """Places within two cells of one; of one on a contact's surface those that are on it, too."""
    near = np.flatnonzero((around[[place]] @ around).toarray()[0])
    if not contact[place]:
        return near
    return near[[contact[number] == contact[place] for number in near.tolist()]]


def _of_swt(
    places: FrettingPlaces, modulus: float, place: int, bar: float, line: StrainLife | None
) -> dict[str, Any]:
    """Return the numbers that only the criterion of the critical plane has."""
    normal = places.planes[place]
    # Of a normal and its opposite the one whose largest component is > 0.
    normal = normal * np.sign(normal[np.abs(normal).argmax()])
    more: dict[str, Any] = {"plane": normal.tolist()}
    value = places.values["swt"][place]
    if line is None or value <= 0:
        return more
    most, life, least = (
        float(line.cycles(max(value + off, 0.0), modulus)) for off in (-bar, 0.0, bar)
    )
    if np.isfinite(life):
        more |= {"life": life, "life_errors": _by_mesh(max(most - life, life - least))}
    return more


def _of_limit(limit: float, value: float, bar: float) -> dict[str, Any]:
    """The factor that a fatigue limit is above a value by, where it is above 0."""
    if value <= 0:
        return {}
    factor = limit / value
    off = factor * bar / (value - bar) if bar < value else np.inf
    return {"safety_factor": factor, "safety_factor_errors": _by_mesh(off)}


def _by_mesh(bar: float) -> ErrorRow:
    """A bar of the mesh alone: penalty, friction and load steps are not estimated."""
    return {"mesh": bar if np.isfinite(bar) else None, "total": None}
