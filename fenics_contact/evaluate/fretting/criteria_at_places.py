"""Criteria of fatigue at the nodes near contacts, their worst places and their bars."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from fenics_contact.analytic.fatigue import criteria
from fenics_contact.analytic.fatigue.critical_plane import swt
from fenics_contact.analytic.fatigue.lives import StrainLife
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import on_root
from fenics_contact.evaluate.fretting.history import StressHistory
from fenics_contact.evaluate.fretting.recovery import Recovery
from fenics_contact.evaluate.fretting.region import Cells, tensors
from fenics_contact.problem.problem import Problem
from fenics_contact.results.fretting_places import FrettingPlaces
from fenics_contact.results.records.fretting import FrettingRecord, WorstPlace
from fenics_contact.results.records.record import ErrorRow
from fenics_contact.scene.asked.fretting import Fretting

# Values so near to the largest are as large: which of them is the worst place must not depend on
# round-off.
_AS_LARGE = 1e-9


@dataclass(frozen=True, eq=False)
class _Found:
    """By one recovery of the stress.

    Attributes:
        columns: Name → values at the places.
        planes: Normals of the critical planes, (places, 3).
    """

    columns: dict[str, Array]
    planes: Array


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
    bars = {name: _apart(better.columns[name], plainer.columns[name]) for name in better.columns}
    names = [contact.label for contact in problem.contacts]
    of_contact = [cells.of_contact.get(node) for node in recovery.node[chosen].tolist()]
    places = FrettingPlaces(
        coordinates=recovery.coordinates[chosen],
        body=[problem.spaces.parts.names[part] for part in recovery.part[chosen].tolist()],
        contact=["" if number is None else names[number] for number in of_contact],
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
        worst=_worst(places, plainer, fretting) if len(chosen) else {},
    )
    return record, places


def _apart(values: Array, others: Array) -> Array:
    """By how much two recoveries differ; not a number where a life is endless by one of them."""
    known = np.isfinite(values) & np.isfinite(others)
    apart = np.full(len(values), np.nan)
    apart[known] = np.abs(values[known] - others[known])
    return apart


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
    if fretting.life is not None:
        line = fretting.life
        life = StrainLife(
            line.strength, line.strength_exponent, line.ductility, line.ductility_exponent
        )
        columns["life"] = life.cycles(columns["swt"], np.asarray(weights @ moduli))
    columns["shear_amplitude"] = criteria.deviator_amplitudes(stress)[0]
    columns["max_mean_stress"] = criteria.mean_stress(stress).max(axis=1)
    alphas = _alphas(fretting)
    if alphas[0] is not None and alphas[1] is not None:
        columns["crossland"] = criteria.crossland(stress, alphas[0])
        columns["dang_van"] = criteria.dang_van(stress, alphas[1])
    return _Found(columns, planes)


def _alphas(fretting: Fretting) -> tuple[float | None, float | None]:
    """Of Crossland and of Dang Van, by the fatigue limits."""
    limits = fretting.limits
    if limits is None:
        return None, None
    both = limits.torsion, limits.tension
    return criteria.crossland_alpha(*both), criteria.dang_van_alpha(*both)


def _worst(places: FrettingPlaces, plainer: _Found, fretting: Fretting) -> dict[str, WorstPlace]:
    """Where each criterion is largest; its bar is that of its place, or of the largest values."""
    found = {}
    for name in ("swt", "crossland", "dang_van"):
        values = places.values.get(name)
        if values is None:
            continue
        place = int(np.argmax(values >= values.max() - _AS_LARGE * np.abs(values).max()))
        value, other = float(values[place]), float(plainer.columns[name].max())
        bar = max(float(places.bars[name][place]), abs(value - other))
        more = _of_swt(places, plainer, place) if name == "swt" else {}
        if name != "swt" and fretting.limits is not None:
            more = _of_limit(fretting.limits.torsion, value, bar)
        found[name] = WorstPlace(
            value=value,
            errors=_by_mesh(bar),
            at=places.coordinates[place].tolist(),
            body=places.body[place],
            contact=places.contact[place],
            **more,
        )
    return found


def _of_swt(places: FrettingPlaces, plainer: _Found, place: int) -> dict[str, Any]:
    """What there is of the critical plane's criterion alone."""
    normal = places.planes[place]
    # Of a normal and its opposite the one whose largest component is > 0.
    normal = normal * np.sign(normal[np.abs(normal).argmax()])
    more: dict[str, Any] = {"plane": normal.tolist()}
    life = places.values.get("life")
    if life is not None and np.isfinite(life[place]):
        bar = max(places.bars["life"][place], abs(life[place] - plainer.columns["life"].min()))
        more |= {"life": float(life[place]), "life_errors": _by_mesh(float(bar))}
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
