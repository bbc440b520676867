"""Public numbers from a solution: resultants, areas, energies, contact points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fenics_contact.body.finite.hyperelastic_body import HyperelasticBody
from fenics_contact.common.arrays import Array, Integers, in_3d
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.state import OPEN, SLIP, STICK
from fenics_contact.evaluate.internal_forces import InternalForces, own_dofs
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    EXTERNAL_WORK,
    MAX_STRETCH,
    MIN_STRETCH,
    MIN_VOLUME_RATIO,
    REACTION,
    REACTION_MOMENT,
    SPRING_ENERGY,
    STRAIN_ENERGY,
)
from fenics_contact.quantities.quantity import Quantity, Together
from fenics_contact.results.contact_points import WRITTEN, ContactPoints
from fenics_contact.results.records.contacts import PreloadRecord, SupportRecord
from fenics_contact.solve.systems.solution import Solution


def support_records(forces: InternalForces) -> list[SupportRecord]:
    """A row a support: resultant, moment, and the mean displacement of what it holds; collective.

    Along each axis, None along others (length).
    """
    problem = forces.problem
    size = problem.spaces.owned_nodes * problem.spaces.components
    centres, moments = problem.support_moments.centres, forces.moments_of_supports.tolist()
    turning = [
        {
            REACTION_MOMENT: moment if len(moment) > 1 else moment[0],
            "moment_about": centre.tolist(),
        }
        for centre, moment in zip(centres, moments, strict=False)
    ] or [{}] * len(problem.applied_supports)
    feet = {foot.springs.support: foot for foot in problem.feet}
    return [
        SupportRecord(
            name=support.label,
            on=support.on,
            reaction=reaction.tolist(),
            displacement=feet[number].mean(forces.displacement)
            if number in feet
            else _mean_displacement(forces, dofs[dofs < size]),
            **turned,
        )
        for number, (support, reaction, dofs, turned) in enumerate(
            zip(
                problem.applied_supports,
                forces.of_supports,
                own_dofs(problem),
                turning,
                strict=True,
            )
        )
    ]


def scalar_records(problem: Problem, solution: Solution) -> dict[str, PreloadRecord]:
    """Records of the body's scalars in an answer, by their labels; of those that have one."""
    pairs = zip(problem.body_scalars, solution.scalars, strict=True)
    found = {scalar.label: scalar.record(state) for scalar, state in pairs}
    return {label: record for label, record in found.items() if record is not None}


def _mean_displacement(forces: InternalForces, dofs: Integers) -> list[float | None]:
    """Mean displacement of dofs of all ranks by component, None without any; collective."""
    components = forces.problem.spaces.components
    moved = forces.displacement.reshape(-1)[dofs]
    sums = [np.bincount(dofs % components, w, components) for w in (moved, np.ones(len(dofs)))]
    summed, counts = total(forces.problem.comm, np.stack(sums))
    return [float(s / n) if n > 0 else None for s, n in zip(summed, counts, strict=True)]


def global_quantities(forces: InternalForces, contacts: list[dict[str, Any]]) -> dict[str, Any]:
    """The interface's quantities of the whole model.

    Resultants of contacts are those of the only one, None where there are several: a sum over
    surfaces that point in different directions means nothing.
    """
    problem, solution = forces.problem, forces.solution
    work = forces.given_work
    acting = zip(problem.contacts, solution.contact_force, solution.states, strict=True)
    for surface, force, state in acting:
        kinematics = surface.kinematics
        pushed = total(problem.comm, kinematics.wrench(force))
        work += pushed @ kinematics.motion
        work += pushed[:-1] @ kinematics.direction * kinematics.brought_up
        pressure = float(surface.trace.integral(state.contact_pressure))
        work += pressure * kinematics.pressing_interference
    work += solution.work_on_scalars
    made = of_all_contacts(contacts)
    return {
        **{name: made[name] for name in table.resultants_of_contacts()},
        REACTION: forces.of_all_supports.tolist(),
        **made,
        STRAIN_ENERGY: forces.strain_energy,
        **({SPRING_ENERGY: forces.spring_energy} if problem.is_sprung else {}),
        EXTERNAL_WORK: float(work),
        **forces.at_points(),
    }


def stretch_quantities(forces: InternalForces) -> dict[str, float]:
    """Extreme stretches of a body by their names; none of linear elasticity; collective.

    Args:
        forces: Of the answer.
    """
    elastic = forces.problem.elastic
    if not isinstance(elastic, HyperelasticBody):
        return {}
    found = elastic.stretches_at(forces.displacement)
    return {
        MIN_VOLUME_RATIO: found.volume_ratio,
        MAX_STRETCH: found.most,
        MIN_STRETCH: found.least,
    }


def of_all_contacts(contacts: list[dict[str, Any]]) -> dict[str, Any]:
    """Quantities of the whole model that those of its contacts make."""
    names = list(dict.fromkeys(name for found in contacts for name in found))
    rows = [row for row in table.every() if row.together in _WAYS and _has(row, contacts)]
    rows.sort(key=lambda row: names.index(row.name) if row.name in names else len(names))
    rows.sort(key=lambda row: _ORDER.index((row.together, row.is_of_some)))
    return {
        row.name: _together(row, [found[row.name] for found in contacts if row.name in found])
        for row in rows
    }


_WAYS: dict[Together, Callable[[Sequence[Any]], Any]] = {
    Together.OF_THE_ONLY: lambda found: found[0] if len(found) == 1 else None,
    Together.LARGEST: lambda found: float(max(found, default=0.0)),
    Together.SUM: lambda found: float(sum(found)),
    Together.OF_THE_ONE: lambda found: found[0],
}
# Of the columns of ``steps.csv``, on which scripts may rely.
_ORDER: tuple[tuple[Together | None, bool], ...] = (
    *((way, False) for way in (Together.OF_THE_ONLY, Together.LARGEST, Together.SUM)),
    *((way, True) for way in (Together.OF_THE_ONLY, Together.SUM, Together.LARGEST)),
    *((Together.OF_THE_ONE, is_of_some) for is_of_some in (False, True)),
)


def _together(row: Quantity, found: Sequence[Any]) -> Any:
    """A quantity of the whole model from the values that its contacts have."""
    assert row.together is not None
    return _WAYS[row.together](found)


def _has(row: Quantity, contacts: list[dict[str, Any]]) -> bool:
    """Whether the whole model has a quantity: also without contacts, unless only some have it."""
    have = sum(row.name in found for found in contacts)
    if row.together is Together.OF_THE_ONE:
        return have == 1
    return have > 0 or not row.is_of_some


def contact_points(problem: Problem, solution: Solution) -> ContactPoints:
    """All contact points on every rank; only contact data is gathered."""
    rows = [_rows(number, problem, solution) for number in range(len(problem.contacts))]
    written = (*WRITTEN, *problem.own_arrays)
    widths = [2, 3, 3, *(len(array.columns) for array in written), 1]
    points = np.concatenate(rows) if rows else np.zeros((0, sum(widths)))
    points = gather_rows(problem.comm, points)
    size = np.abs(points[:, 2:5]).max(initial=np.finfo(float).tiny)
    order = np.lexsort((*np.round(points[:, [4, 3, 2]] / size, 9).T, points[:, 0]))
    columns = np.split(points[order], np.cumsum(widths)[:-1], axis=1)
    codes, coordinates, normals, *arrays, weights = columns
    found = {
        array.name: part if array.is_vector else part[:, 0]
        for array, part in zip(written, arrays, strict=True)
    }
    own = {array.name: found.pop(array.name) for array in problem.own_arrays}
    return ContactPoints(
        contact=codes[:, 0].astype(np.int64),
        status=np.array([OPEN, STICK, SLIP])[codes[:, 1].astype(int)],
        coordinates=coordinates,
        normals=normals,
        weights=weights[:, 0],
        **found,
        own=own,
    )


def _rows(number: int, problem: Problem, solution: Solution) -> Array:
    """Owned points of one contact as numbers, in the order of ``contact_points``."""
    trace = problem.contacts[number].trace
    state = solution.states[number]
    status = np.where(state.status == OPEN, 0.0, np.where(state.status == STICK, 1.0, 2.0))
    none = np.full(len(status), np.nan)
    own = [
        state.own.get(array.name, np.stack([none] * len(array.columns), axis=1))
        for array in problem.own_arrays
    ]
    columns = [
        np.full((len(status), 1), float(number)),
        status[:, None],
        trace.coordinates,
        in_3d(trace.normals),
        *(
            in_3d(values) if array.is_vector else values.reshape(-1, 1)
            for array, values in [
                *((array, getattr(state, array.name)) for array in WRITTEN),
                *zip(problem.own_arrays, own, strict=True),
            ]
        ),
        trace.weights[:, None],
    ]
    return np.asarray(np.hstack(columns)[trace.owned])
