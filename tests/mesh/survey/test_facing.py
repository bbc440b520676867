"""Surfaces of a geometry, and which of them face each other."""

import math

import pytest
from mpi4py import MPI

from fenics_contact import MeshSource
from fenics_contact.mesh.facing_surfaces import bolts, facing_pairs
from fenics_contact.mesh.loading import load_to_look
from fenics_contact.mesh.survey import survey
from tests import cad
from tests.mesh.test_loading import write
from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="looks on one rank")


def looked_at(file, **settings):
    return survey(*load_to_look(MeshSource(str(file), **settings)))


def numbers(found, pairs):
    return [
        tuple(tuple(found.surfaces[n].number for n in side) for side in (pair.first, pair.second))
        for pair in pairs
    ]


def test_every_kind_with_its_measure_and_place(folder):
    """A box with a ball on it, a cone and a ring beside it."""

    def build(occ):
        box = occ.addBox(0, 0, 0, 4, 4, 1)
        occ.cut([(3, box)], [(3, occ.addCylinder(2, 2, 0, 0, 0, 1, 0.5))])
        occ.addSphere(10, 0, 0, 2)
        occ.addCone(20, 0, 0, 0, 0, 2, 2, 1)
        occ.addTorus(30, 0, 0, 3, 0.5)

    found = looked_at(cad.write_shapes(folder / "kinds.step", build), curvature=8)
    assert [round(body.measure, 6) for body in found.bodies] == [
        round(value, 6)
        for value in (
            16 - math.pi / 4,
            4 / 3 * math.pi * 8,
            math.pi * 2 / 3 * (4 + 2 + 1),
            2 * math.pi**2 * 3 * 0.25,
        )
    ]
    kinds = {}
    for surface in found.surfaces:
        kinds.setdefault(surface.shape.kind, []).append(surface)
    assert {kind: len(found) for kind, found in kinds.items()} == {
        "plane": 8,
        "cylinder": 1,
        "sphere": 1,
        "cone": 1,
        "torus": 1,
    }
    (hole,), (ball,), (cone,), (ring,) = (kinds[k] for k in ("cylinder", "sphere", "cone", "torus"))
    assert (hole.shape.radius, hole.measure) == pytest.approx((0.5, math.pi))
    assert not hole.is_outward and ball.is_outward and cone.is_outward and ring.is_outward
    assert hole.shape.centre[:2] == pytest.approx((2, 2))
    assert hole.shape.axis == pytest.approx((0, 0, 1))
    assert (ball.shape.radius, ball.measure) == pytest.approx((2, 16 * math.pi))
    assert ball.shape.centre == pytest.approx((10, 0, 0))
    assert cone.shape.centre == pytest.approx((20, 0, 4))  # its apex
    assert cone.shape.angle == pytest.approx(math.degrees(math.atan(0.5)))
    assert cone.measure == pytest.approx(math.pi * 3 * 5**0.5)
    assert (ring.shape.ring, ring.shape.radius) == pytest.approx((3, 0.5))


def test_joint_has_the_pairs_that_an_engineer_would_name(folder):
    found = looked_at(cad.write_shapes(folder / "a.step", cad.joint), curvature=12)
    pairs = facing_pairs(found)
    assert sorted(numbers(found, pairs)) == [
        *(((3,), (12,)), ((5,), (19,)), ((7,), (18,)), ((10,), (17,)), ((14,), (18,)))
    ]
    ring = math.pi / 4 * (cad.HEAD**2 - cad.HOLE**2)
    plane = [pair for pair in pairs if pair.gap < 0.1]
    assert [pair.gap for pair in plane] == pytest.approx([0, 0, 0], abs=1e-12)
    assert plane[1].area == pytest.approx(ring, rel=0.06)  # of polygons
    assert plane[0].area == pytest.approx(cad.WIDE**2 - math.pi / 4 * cad.HOLE**2, rel=0.03)
    # The shank is (HOLE - SHANK)/2 off the holes: one cylinder, and both its holes.
    shank = [pair for pair in pairs if pair.gap > 0.1]
    assert [pair.gap for pair in shank] == pytest.approx([0.5, 0.5])
    assert all(pair.is_exact for pair in shank)


def test_a_pin_in_a_wide_hole_is_no_pair_unless_it_is_asked_for(folder):
    """A clearance of .6 on a radius of 2.5 is more than holes for bolts have."""
    file = cad.write_shapes(folder / "a.step", lambda occ: cad.joint(occ, 3.8))
    found = looked_at(file, curvature=12)
    assert all(pair.gap < 0.1 for pair in facing_pairs(found))
    wider = facing_pairs(found, tolerance=0.61)
    assert [pair.gap for pair in wider if pair.gap > 0.1] == pytest.approx([0.6, 0.6])


def test_a_shaft_in_its_hole_is_a_pair_and_its_head_is_not():
    """The joint of the demo: a clearance of .5, and a head whose side is 2 wider than the hole."""
    found = looked_at(ROOT / "meshes" / "joint.step", curvature=12)
    pairs = facing_pairs(found)
    assert {(*first, *second) for first, second in numbers(found, pairs)} == {
        *((3, 21), (7, 14), (9, 22), (15, 23), (18, 22))
    }
    (bolt,) = bolts(found, pairs)
    assert found.bodies[bolt.body].name == "bolt_M8"
    assert bolt.axis == pytest.approx((0, 0, 1))
    assert bolt.between == pytest.approx((-2, 2))  # of a shank from -5 to 5
    assert bolt.area == pytest.approx(math.pi * 4**2)


def test_overlap_of_a_press_fit_is_a_negative_gap(folder):
    file = cad.write_shapes(folder / "a.step", lambda occ: cad.joint(occ, 5.1))
    found = looked_at(file, curvature=8)
    pairs = facing_pairs(found)
    gaps = dict(zip(numbers(found, pairs), [pair.gap for pair in pairs], strict=True))
    assert gaps[((7,), (18,))] == gaps[((14,), (18,))] == pytest.approx(-0.05)


CORNER = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 4, 1, 1};
Box(2) = {0, 1, 0, 1, 3, 1};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Box(4) = {1.5, 1.5, 0, 2, 2, 1};
Mesh.MeshSizeMax = 1;
"""


def test_boxes_that_overlap_are_no_pair(folder):
    """A block in the corner of an angle, with room all around."""
    found = looked_at(write(folder, CORNER).file)
    assert len(found.bodies) == 2
    assert facing_pairs(found) == []
    pairs = facing_pairs(found, tolerance=0.5001)
    assert sorted(pair.gap for pair in pairs) == pytest.approx([0.5, 0.5])


def test_halves_of_a_hole_are_one_contact(folder):
    def build(occ):
        box = occ.addBox(-2, -2, 0, 4, 4, 1)
        halves = [occ.addCylinder(0, 0, 0, 0, 0, 1, 1, angle=math.pi) for _ in range(2)]
        occ.rotate([(3, halves[1])], 0, 0, 0, 0, 0, 1, math.pi)
        occ.cut([(3, box)], [(3, half) for half in halves])
        occ.addCylinder(0, 0, -1, 0, 0, 3, 1)

    found = looked_at(cad.write_shapes(folder / "a.brep", build), curvature=12)
    (pair,) = facing_pairs(found)
    assert (len(pair.first), len(pair.second), pair.gap) == (2, 1, pytest.approx(0, abs=1e-12))
    assert pair.area == pytest.approx(2 * math.pi, rel=0.05)


def test_sides_in_the_plane(folder):
    text = (
        'SetFactory("OpenCASCADE");\nRectangle(1) = {0,0,0,2,1};\nRectangle(2) = {1,1.001,0,3,1};\n'
    )
    found = looked_at(write(folder, text).file)
    assert found.dimension == 2
    (pair,) = facing_pairs(found)
    assert numbers(found, [pair]) == [((3,), (5,))]
    assert (pair.gap, pair.area) == (pytest.approx(0.001), pytest.approx(1, rel=0.02))
