"""Two bodies that overlap as drawn: pressures, energies and their balance against formulas."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Path, Run, Scene, Steps, Support
from fenics_contact.verification.boxes import Box, boxes
from tests.contact.fits import CONFINED, FIT, RATIO, STIFFNESS, balances, stack

COMM = MPI.COMM_WORLD
LATER = Path((0, 0.5, 1), (0, 0, 1))


def rough(law):
    return {"law": law} | ({} if law == "none" else {"friction_coefficient": 0.3})


@pytest.mark.parametrize(
    ("law", "dimension", "solver"),
    [
        ("none", 2, "condensed"),
        ("incremental", 2, "full"),
        ("incremental", 3, "condensed"),
        ("none", 3, "iterative"),
    ],
)
def test_blocks_in_a_frame(law, dimension, solver):
    """p = M o / 2 with the confined modulus M and the overlap o; the work is ½ p o an area."""
    prepared = stack(dimension, FIT, Steps(3), solver, interference=0.0, **rough(law))
    result = prepared.solve()
    balances(prepared, result)
    give = 2 / CONFINED + prepared.problem.contacts[0].penalty_parameter
    assert result.points.contact_pressure == pytest.approx(FIT / give, rel=1e-6)
    for step in result.steps:
        work = step["quantities"]["external_work"]
        assert work == pytest.approx(0.5 * FIT**2 / give, rel=1e-6)


@pytest.mark.parametrize("law", ["none", "incremental"])
def test_a_ring_on_a_shaft(law):
    """Too tight by o, held between planes: p = E o (c² − b²) / (2 (1 − ν²) b c²) (Lamé)."""
    inner, outer, height = 1.0, 2.0, 0.5
    parts = (
        Box("shaft", (0, 0), (inner + FIT, height), (6, 2)),
        Box("ring", (inner, 0), (outer, height), (8, 3)),
    )
    planes = tuple(Support(f"{box.name}.y{end}", {"y": 0}) for box in parts for end in (0, 1))
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(STIFFNESS, RATIO),
        support=(*planes, Support("shaft.x0", {"x": 0})),
        contact=(Contact("shaft.x1", against="ring.x0", **rough(law)),),
        steps=Steps(3),
    )
    prepared = Run(scene, COMM, boxes(parts))
    result = prepared.solve()
    balances(prepared, result)
    pressure = STIFFNESS / (1 - RATIO**2) * FIT * (outer**2 - inner**2) / (2 * inner * outer**2)
    assert result.points.contact_pressure == pytest.approx(pressure, rel=2e-3)
    work = 0.5 * pressure * FIT * 2 * np.pi * inner * height
    assert result.quantities["external_work"] == pytest.approx(work, rel=2e-3)
    assert result.quantities["strain_energy"] == pytest.approx(work, rel=2e-3)


def quarter_of_a_fit(shaft, hub):
    """A hollow shaft, .5 ≤ r ≤ 1, too large for its hub, 1 ≤ r ≤ 2, as tetrahedra of order 2."""
    parts = (Box("shaft", (0.5, 0, 0), (1, 1, 0.5), shaft), Box("hub", (1, 0, 0), (2, 1, 0.5), hub))
    body = boxes(parts, "tetrahedron", order=2)
    x = body.mesh.geometry.x
    radius, angle = x[:, 0].copy(), np.pi / 2 * x[:, 1]
    x[:, 0], x[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    sides = {"y0": "y", "y1": "x", "z0": "z", "z1": "z"}
    scene = Scene(
        kinematics="3D",
        material=Material(STIFFNESS, RATIO),
        discretisation=Discretisation(2),
        support=tuple(
            Support(f"{box.name}.{side}", {axis: 0})
            for box in parts
            for side, axis in sides.items()
        ),
        contact=(Contact("shaft.x1", against="hub.x0", interference=0.02),),
    )
    return Run(scene, COMM, body)


@pytest.mark.parametrize(("shaft", "hub"), [((1, 4, 1), (1, 6, 2)), ((1, 6, 2), (1, 5, 1))])
def test_facets_that_do_not_match_press_evenly(shaft, hub):
    """Lamé, plane strain: p = o/(c_i + c_o), everywhere the same; facets leave gaps of o/20.

    Gaps that shape functions cannot close open a part of the points, and the others carry twice
    the pressure and more, by a force that is still right.
    """
    prepared = quarter_of_a_fit(shaft, hub)
    prepared.solve()
    stiffness, ratio = STIFFNESS / (1 - RATIO**2), RATIO / (1 - RATIO)
    give = ((1 + 0.25) / (1 - 0.25) - ratio + (4 + 1) / (4 - 1) + ratio) / stiffness
    contact = prepared.problem.contacts[0]
    trace, pressure = contact.trace, contact.state().contact_pressure
    off = pressure * give / 0.02 - 1
    assert abs(float(trace.integral(off))) < 0.02 * trace.area
    assert float(trace.integral(off**2)) < 0.2**2 * trace.area


@pytest.mark.parametrize(
    ("law", "moved", "width"),
    [
        ("incremental", (0.02, -0.001), 2),
        ("incremental", (0.2, 0), 2),  # what faces what is found anew
        ("none", (0.2, 0), 2),
        ("none", (0, 0.01), 2),  # drawn apart
        ("none", (0.2, 0), 1),  # the edge of the lower one is passed
    ],
)
def test_pressed_and_shoved_on_from_a_fit(law, moved, width):
    parts = (
        Box("lower", (0, -1), (width, 0), (4 * width, 4)),
        Box("upper", (0, -FIT), (1, 1 - FIT), (5, 4)),
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, RATIO),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", dict(zip("xy", moved, strict=True)), path=LATER),
        ),
        contact=(Contact("upper.y0", against="lower.y1", **rough(law)),),
        steps=Steps(16),
    )
    result = Run(scene, COMM, boxes(parts)).solve()
    assert result.passed, result.verdict
    fitted = result.steps[0]["quantities"]
    stored = fitted["strain_energy"] + fitted["penalty_energy"] + fitted["friction_work"]
    assert fitted["external_work"] == pytest.approx(stored, rel=1e-2)
