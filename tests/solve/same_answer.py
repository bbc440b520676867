"""One scene by the full and by the condensed solver."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run
from tests.scenes import with_solver

COMM = MPI.COMM_WORLD
LENGTHS = {"indentation", "max_slip", "max_penetration", "max_displacement"}
FORCES = {"reaction", "normal_force", "pressure_integral", "contact_force", "friction_force"}


def solved(scene, body, solver):
    made = Run(with_solver(scene, solver=solver), COMM, body)
    result = made.solve()
    assert result.converged, result.verdict
    assert result.passed, result.verdict
    assert result.model["solver"] == solver
    return made, result


def require_same(scene, body, tolerance=1e-8):
    full, by_full = solved(scene, body, "full")
    condensed, by_condensed = solved(scene, body, "condensed")
    size = COMM.allreduce(np.abs(full.solution.displacement).max(initial=0), op=MPI.MAX)
    difference = np.abs(full.solution.displacement - condensed.solution.displacement)
    assert COMM.allreduce(difference.max(initial=0), op=MPI.MAX) <= tolerance * size
    peak = by_full.quantities["max_contact_pressure"]
    # Newton's method stops at the round-off of the forces: these and pressures differ by as much.
    imbalance = full.solution.imbalance_limit + condensed.solution.imbalance_limit
    largest = 0.0  # of these differences
    for number, contact in enumerate(full.problem.contacts):
        mine, theirs = (made.solution.states[number] for made in (condensed, full))
        area = float(contact.trace.integral(np.ones(len(contact.trace.weights))))
        each = area / COMM.allreduce(int(contact.trace.owned.sum()))
        largest = max(largest, imbalance / each)
        for name in ("contact_pressure", "friction_traction"):
            off = np.abs(getattr(mine, name) - getattr(theirs, name)).max(initial=0)
            assert off <= tolerance * peak + imbalance / each
    supports = COMM.bcast(by_full.supports)  # the root has them
    for name, value in by_full.quantities.items():
        if value is None:
            assert by_condensed.quantities[name] is None, name
            continue
        scale = np.abs(value).max(initial=0) if np.ndim(value) else abs(value)
        scale = max(scale, size if name in LENGTHS else 0)
        if name == "reaction":  # of all supports: next to nothing where no loads act
            scale = np.abs([support["reaction"] for support in supports]).max(initial=0)
        if name == "friction_force":
            scale = max(scale, by_full.quantities["pressure_integral"])
        if name == "contact_moment":
            extent = max(contact.trace.extent() for contact in full.problem.contacts)
            scale = max(scale, by_full.quantities["pressure_integral"] * extent)
        allowed = tolerance * scale
        if name in FORCES:
            allowed += imbalance
        if name == "max_contact_pressure":
            allowed += largest
        if name == "penalty_energy":  # changes by penetration times pressure
            touching = by_full.quantities["contact_area"]
            allowed += largest * touching * by_full.quantities["max_penetration"]
        assert by_condensed.quantities[name] == pytest.approx(value, rel=tolerance, abs=allowed), (
            name
        )
    return condensed
