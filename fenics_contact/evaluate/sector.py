"""What a sector of a ring says of the whole, and what acts across its cut."""

from __future__ import annotations

import numpy as np

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    EXTERNAL_WORK,
    FRICTION_WORK,
    PRESSURE_INTEGRAL,
    SLIP_AREA,
    STICK_AREA,
    STRAIN_ENERGY,
)
from fenics_contact.results.records.contacts import SectorRecord
from fenics_contact.results.records.record import Quantities

# Those that add up over the sectors, whichever way these are turned.
_SUMS = (
    *(PRESSURE_INTEGRAL, CONTACT_AREA, STICK_AREA, SLIP_AREA),
    *(STRAIN_ENERGY, EXTERNAL_WORK, FRICTION_WORK),
)


def sector_record(forces: InternalForces, quantities: Quantities) -> SectorRecord | None:
    """``cyclic_symmetry`` of ``result.json``; None of a whole body; collective.

    Args:
        forces: Of the answer.
        quantities: Of the sector.
    """
    problem = forces.problem
    cut = problem.discrete.cut
    if cut is None:
        return None
    assert isinstance(forces, BulkForces)
    is_on = cut.is_slave.reshape(forces.across_cut.shape)
    on = np.where(is_on, forces.across_cut, 0.0)
    sectors = cut.given.sectors
    whole = {
        name: sectors * float(value)
        for name in _SUMS
        if (value := quantities.get(name)) is not None
    }
    couplings = _of_couplings(forces, cut)
    of_supports = np.array(_about_axis(problem, cut, forces.reactions))
    of_supports = of_supports - np.sum([*couplings.values(), (0.0, 0.0)], axis=0)
    whole |= _named(sectors * of_supports, problem)
    owned = slice(0, problem.spaces.owned_nodes)
    return SectorRecord(
        sectors=sectors,
        axis=cut.axis.tolist(),
        at=cut.centre[: problem.spaces.components].tolist(),
        jump=cut.mismatch(forces.displacement),
        force=total(problem.comm, on[owned].sum(axis=0)).tolist(),
        moment=_about_axis(problem, cut, on)[0],
        whole=whole,
        couplings={name: _named(sectors * found, problem) for name, found in couplings.items()},
    )


def _named(works: Array, problem: Problem) -> dict[str, float]:
    """Moment about the axis and in space the force along it by their names in results."""
    names = ("torque", "axial_force")[: problem.spaces.components - 1]
    return {name: float(value) + 0.0 for name, value in zip(names, works, strict=False)}


def _of_couplings(forces: BulkForces, cut: CutFaces) -> dict[str, Array]:
    """Moment about the axis, and force along it, on the sector by each coupling; collective."""
    problem, found = forces.problem, dict[str, Array]()
    size = problem.spaces.components
    for number, face in zip(problem.couplings, problem.elastic.faces, strict=True):
        force, arm, moment = np.zeros((3, 3))
        force[:size] = forces.of_supports[number]
        arm[:size] = face.at - cut.centre[:size]
        moment[3 - forces.moments_of_supports.shape[1] :] = forces.moments_of_supports[number]
        label = problem.applied_supports[number].label
        found[label] = np.array([(moment + np.cross(arm, force)) @ cut.axis, force @ cut.axis])
    return found


def _about_axis(problem: Problem, cut: CutFaces, nodal: Array) -> tuple[float, float]:
    """Moment about the axis, and resultant along it, of nodal forces; collective.

    Args:
        problem: The model.
        cut: The cut faces.
        nodal: (nodes, components) (force).
    """
    owned, size = problem.spaces.owned_nodes, problem.spaces.components
    forces = np.zeros((owned, 3))
    forces[:, :size] = nodal[:owned]
    arms = problem.spaces.coordinates[:owned] - cut.centre
    works = np.cross(arms, forces).sum(axis=0), forces.sum(axis=0)
    sums = total(problem.comm, np.array(works)) @ cut.axis
    return float(sums[0]) + 0.0, float(sums[1]) + 0.0  # no −0
