"""Meshes made by errors of several bodies of a CAD file: each has sizes of its own."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Discretisation,
    Material,
    MeshSource,
    Scene,
    Support,
    run_with_fields,
)
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.size_field import SizeField
from fenics_contact.simulation.adaptive.next_mesh import _All
from tests import cad
from tests.simulation.adaptive.test_levels import cells_of

COMM = MPI.COMM_WORLD
BORE, FIT, OUTSIDE, PLAY = 0.5, 1.0, 2.0, 0.01
SHAFT, HUB = (1000.0, 0.3), (3000.0, 0.2)


@pytest.mark.serial
@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_that_touch_have_sizes_of_their_own(tmp_path, dimension):
    """A block of small cells under one of large ones, also along the side that they share."""

    def build(occ):
        for level in (0, 1):
            if dimension == 2:
                occ.addRectangle(0, level, 0, 2, 1)
            else:
                occ.addBox(0, level, 0, 2, 1, 1)

    file = cad.write_shapes(tmp_path / "blocks.step", build, ("low", "high"))
    source = MeshSource(file, size=0.5)
    wanted = {"low": 0.1 * (dimension - 1), "high": 0.3 * (dimension - 1)}
    old = load_body(source, dimension, MPI.COMM_SELF)
    cells = cells_of(old.mesh)
    places = cells.points[cells.vertices]
    is_low = places[:, :, 1].max(axis=1) < 1 + 1e-9
    at = np.where(np.isin(np.arange(len(cells.points)), cells.vertices[is_low]), *wanted.values())
    parts = old.cell_tags.values[np.argsort(old.cell_tags.indices)]
    new = load_body(source, dimension, MPI.COMM_SELF, [SizeField.of(cells, at, parts)])
    found = cells_of(new.mesh)
    middles = found.points[found.vertices].mean(axis=1)[:, 1]
    for name, is_in in (("low", middles < 1), ("high", middles > 1)):
        near = is_in & (np.abs(middles - 1) < 1.5 * wanted[name])
        assert np.median(found.sizes()[near]) == pytest.approx(wanted[name], rel=0.35)


def test_bodies_of_joined_meshes_are_known_by_the_numbers_that_gmsh_gave_them():
    """Tags of the second mesh begin behind those of the first."""
    rows = {
        "vertices": np.arange(12).reshape(4, 3),
        "points": np.zeros((4, 3, 2)),
        "squared": np.ones(4),
        "sources": np.array([0, 1, 0, 1]),
        "tags": np.array([1, 4, 3, 5]),
        "edges": np.zeros((0, 4)),
    }
    every = _All("triangle", [rows])
    assert [every.of_source(source)[1].tolist() for source in (0, 1)] == [[1, 3], [1, 2]]


def quarters(occ):
    """Quarters of a hollow shaft and of its hub, and beside them a thin pin."""
    for inner, outer in ((BORE, FIT), (FIT, OUTSIDE)):
        disc, hole = (occ.addDisk(0, 0, 0, radius, radius) for radius in (outer, inner))
        (ring,), _ = occ.cut([(2, disc)], [(2, hole)])
        occ.intersect([ring], [(2, occ.addRectangle(0, 0, 0, 3, 3))])
    occ.addDisk(3, 1, 0, 0.05, 0.05)


def widening(inner, outer, at, pressures, material):
    """Radial displacement of a ring under pressures inside and outside, in plane strain (Lamé)."""
    (young, ratio), (inside, outside) = material, pressures
    wide = outer**2 - inner**2
    even = (inside * inner**2 - outside * outer**2) / wide
    steep = (inside - outside) * (inner * outer) ** 2 / wide
    return (1 + ratio) / young * ((1 - 2 * ratio) * even * at + steep / at)


@pytest.mark.errors
@pytest.mark.serial
def test_a_press_fit_beside_a_pin_that_carries_nothing(tmp_path):
    """The smallest cells at first are the pin's, as of the smallest radius; in the end it has few.

    p = o / (widening of the hub - widening of the shaft) under a pressure of 1.
    """
    file = cad.write_shapes(tmp_path / "fit.step", quarters, ("shaft", "hub", "pin"))
    groups = {"journal": (2,), "seat": (8,), "flat": (1, 5), "upright": (3, 7), "rim": (9,)}
    mesh = MeshSource(file, cell="triangle", order=2, size=0.4, curvature=32, groups=groups)
    scene = Scene(
        kinematics="plane strain",
        mesh=(mesh,),
        discretisation=Discretisation(2),
        material=(Material(*SHAFT, on="shaft"), Material(*HUB, on="hub"), Material(*HUB, on="pin")),
        support=(
            Support("flat", {"y": 0}),
            Support("upright", {"x": 0}),
            Support("rim", {"x": 0, "y": 0}),
        ),
        contact=(Contact("seat", against="journal", name="fit", law="none", interference=PLAY),),
        accuracy=Accuracy(main=1e-2, strain_energy=1e-5),
    )
    found, kept = run_with_fields(scene, COMM)
    give = widening(FIT, OUTSIDE, FIT, (1, 0), HUB) - widening(BORE, FIT, FIT, (0, 1), SHAFT)
    pressure = PLAY / give
    assert found.accuracy["reached"], (found.verdict, found.error_notes)
    assert len(found.levels) > 1
    force = pressure * np.pi / 2 * FIT
    assert found.quantities["pressure_integral"] == pytest.approx(force, rel=1e-5)
    assert found.quantities["max_contact_pressure"] == pytest.approx(pressure, rel=1e-2)

    body = kept.problem.body
    now = {name: COMM.allreduce(len(body.entities(body.groups[name]))) for name in ("pin", "hub")}
    first = load_body(mesh, 2, MPI.COMM_SELF)
    then = {name: len(first.entities(first.groups[name])) for name in now}
    assert then["pin"] > then["hub"]
    assert now["pin"] < 0.1 * now["hub"]
