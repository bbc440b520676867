"""Halves and quarters of models whose planes supports hold: what planes of symmetry give."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.analytic.two_bodies import Tube
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.verification.boxes import Box, boxes, quarter_rings

COMM = MPI.COMM_WORLD
STIFFNESS, RATIO = 2e5, 0.3
BORE, MIDDLE, OUTER, FIT = 0.2, 0.5, 1.0, 6.667e-4
QUARTER = {"y0": "y", "y1": "x"}
# Facets of order 2 around the quarter: averaged over one side alone, normals at their ends are 3e-5
# off, over which a reaction of the planes is felt as pressure.
AROUND = 17


def fitted(planes, kinematics, degree, solver="condensed", **contact):
    """A shaft and a hub that is too tight, held in planes of symmetry by supports."""
    return Scene(
        kinematics=kinematics,
        material=Material(STIFFNESS, RATIO),
        discretisation=Discretisation(degree),
        support=tuple(
            Support(f"{part}.{side}", {axis: 0})
            for part in ("shaft", "hub")
            for side, axis in planes.items()
        ),
        contact=(Contact("shaft.x1", against="hub.x0", **{"interference": FIT} | contact),),
        solver=SolverSettings(solver=solver, errors="none"),
    )


def parts(gap=0.0, along=()):
    """Of the same, with meshes that do not match; ``along``: heights and cells."""
    bottom, top, cells = ((0,), (1,), along) if along else ((), (), ())
    return (
        Box("shaft", (BORE, 0, *bottom), (MIDDLE, 1, *top), (3, AROUND, *cells)),
        Box("hub", (MIDDLE + gap, 0, *bottom), (OUTER, 1, *top), (4, AROUND + 3, *cells)),
    )


def pressure(is_long):
    """Lamé's, of the whole shaft and hub."""
    shaft, hub = (Tube(*radii, STIFFNESS, RATIO) for radii in ((BORE, MIDDLE), (MIDDLE, OUTER)))
    give = shaft.compliance(MIDDLE, "outside", is_long) + hub.compliance(MIDDLE, "inside", is_long)
    return FIT / give


@pytest.mark.parametrize(
    ("cell", "slave", "solver"),
    [
        ("quadrilateral", "on", "condensed"),
        ("triangle", "against", "condensed"),
        ("triangle", "on", "full"),
    ],
)
def test_a_quarter_of_a_press_fit(cell, slave, solver):
    scene = fitted(QUARTER, "plane stress", 2, solver, slave=slave)
    result = Run(scene, COMM, quarter_rings(parts(), COMM, 2, cell)).solve()
    assert result.passed, result.verdict
    whole = 0.5 * np.pi * MIDDLE * pressure(is_long=False)
    assert result.quantities["pressure_integral"] == pytest.approx(whole, rel=1e-3)


@pytest.mark.parametrize(("cell", "law"), [("hexahedron", "incremental"), ("tetrahedron", "none")])
def test_an_eighth_of_a_long_press_fit(cell, law):
    """Three planes across three axes, two of which meet in edges of the surfaces."""
    rough = {} if law == "none" else {"law": law, "friction_coefficient": 0.3}
    scene = fitted(QUARTER | {"z0": "z", "z1": "z"}, "3D", 2, **rough)
    result = Run(scene, COMM, quarter_rings(parts(along=(1,)), COMM, 2, cell)).solve()
    assert result.passed, result.verdict
    whole = 0.5 * np.pi * MIDDLE * pressure(is_long=True)
    assert result.quantities["pressure_integral"] == pytest.approx(whole, rel=1e-2)


def test_ends_of_facets_are_faced_across_a_gap():
    """The shaft's ends lie in the planes; a tilted normal of the hub's end would pass beside it."""
    gap = 0.01
    planes = fitted(QUARTER, "plane stress", 1, slave="against", interference=FIT + gap)
    prepared = Run(planes, COMM, quarter_rings(parts(gap), COMM, 1, "triangle"))
    contact = prepared.problem.contacts[0]
    assert COMM.allreduce(int((~contact.sides.pairing.faced).sum())) == 0
    at = contact.trace.coordinates[: len(contact.nodes)]
    for axis in (0, 1):
        ends = np.abs(at[:, axis]) < 1e-9
        assert np.all(contact.trace.normals[: len(contact.nodes)][ends, axis] == 0)


def barrel(comm):
    """Sections through half of a barrel, whose radius is cos z, and of a tube around it."""
    drawn = (Box("barrel", (0, 0), (1, 0.7), (4, 3)), Box("tube", (1, 0), (1.5, 0.7), (3, 5)))
    body = boxes(drawn, "quadrilateral", comm, 2)
    places = body.mesh.geometry.x
    own = np.unique(compat.geometry_nodes(body.mesh)[body.entities(body.group("barrel", ""))])
    places[own, 0] *= np.cos(places[own, 1])
    return body


@pytest.mark.parametrize("side", ["y0", "y1"])
def test_half_a_barrel_in_a_tube(side):
    """Its widest circle lies in the plane. Held at its narrow end it does not go on smoothly."""
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(STIFFNESS, RATIO),
        support=tuple(Support(f"{part}.{side}", {"y": 0}) for part in ("barrel", "tube")),
        contact=(
            Contact(
                "barrel.x1",
                against="tube.x0",
                interference=0.005,
                law="incremental",
                friction_coefficient=0.1,
                slave="on",
            ),
        ),
        solver=SolverSettings(errors="none"),
    )
    prepared = Run(scene, COMM, barrel(COMM))
    result = prepared.solve()
    assert result.passed, result.verdict
    trace = prepared.problem.contacts[0].trace
    at_end = np.abs(trace.coordinates[:, 1] - (0.0 if side == "y0" else 0.7)) < 1e-9
    right, close = (0.0, 1e-12) if side == "y0" else (np.sin(np.arctan(np.sin(0.7))), 5e-3)
    normals = trace.normals_at_nodes[trace.numbers][at_end, 1]
    assert normals == pytest.approx(right, abs=close)


def test_a_wedge_on_a_wall_keeps_its_normal():
    """The wall holds it as a mirror would, but its straight side does not turn at the wall."""
    body = boxes([Box("wedge", (0, 0), (1, 0.5), (4, 2))], "quadrilateral", COMM, 1)
    places = body.mesh.geometry.x
    places[:, 1] += 0.01 * places[:, 0] * (1 - places[:, 1] / 0.5)
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, RATIO),
        support=(Support("wedge.x0", {"x": 0}), Support("wedge.y1", {"y": -1e-3})),
        contact=(Contact("wedge.y0", obstacle=Obstacle(normal=(-0.01, 1))),),
        solver=SolverSettings(errors="none"),
    )
    prepared = Run(scene, COMM, body)
    normals = prepared.problem.contacts[0].trace.normals
    assert normals[:, 0] == pytest.approx(0.01 / np.hypot(1, 0.01), rel=1e-9)
    assert prepared.solve().passed
