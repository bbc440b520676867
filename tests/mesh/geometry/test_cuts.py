"""Bodies of CAD files that are cut for preloads: pieces, numbers of surfaces, refusals."""

import dataclasses
import math

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import MeshSource, Preload
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.size_field import SizeField
from tests import cad
from tests.body.test_connected_parts import parts_of
from tests.mesh.geometry.test_bodies import LABELS, NAMES, cells_of, volume
from tests.mesh.test_loading import area, write
from tests.messages import refused

COMM = MPI.COMM_WORLD
ALONG = (0, 0, 2)
BOLT = Preload("Bolt", ALONG, 1.0, between=(1, 6))
SIZES = {"size": 4, "curvature": 12, "sizes": {"Bolt": 2.0}}


def heights(body, name, axis=(0, 0, 1)):
    """Where a group begins and ends along an axis."""
    from fenics_contact.common import dolfinx_versions as compat

    cells = body.entities(body.groups[name])
    along = body.mesh.geometry.x[np.unique(compat.geometry_nodes(body.mesh)[cells])] @ axis
    low = COMM.allreduce(along.min(initial=np.inf), op=MPI.MIN)
    return low, COMM.allreduce(along.max(initial=-np.inf), op=MPI.MAX)


def of_numbers(body):
    """Sizes of numbered surfaces; points and edges of a body that is cut have no numbers."""
    return {
        number: area(body, number, body.numbers)
        for number, group in body.numbers.items()
        if not group.places
    }


def test_a_bolt_is_cut_and_stays_what_it_was(folder):
    """The piece is between the planes; bodies, numbers and names of surfaces are as before."""
    file = cad.write_shapes(folder / "joint.step", cad.joint, LABELS)
    source = MeshSource(file, groups={"mine": (18,)}, **SIZES)
    before = load_body(source, 3, COMM)
    body = load_body(source, 3, COMM, preloads=(BOLT,))
    piece = BOLT.group
    assert list(body.groups) == [*NAMES, piece, "body", "mine"]
    assert heights(body, piece) == pytest.approx((1, 6), abs=1e-9)
    assert volume(body, piece) == pytest.approx(math.pi * (cad.SHANK / 2) ** 2 * 5, rel=0.06)
    assert volume(body, "Bolt") == pytest.approx(volume(before, "Bolt"), rel=1e-2)
    assert parts_of(body, 3)[0].names == tuple(NAMES)  # it is one, as before
    assert body.relations == before.relations
    numbers, were = of_numbers(body), of_numbers(before)
    assert numbers == {number: pytest.approx(size, rel=1e-2) for number, size in were.items()}
    assert "edge 1" in before.numbers
    assert body.numbers.keys() == were.keys()
    assert {n: body.numbers[n].centre for n in were} == {
        n: pytest.approx(before.numbers[n].centre, abs=1e-6) for n in were
    }
    assert area(body, "mine") == pytest.approx(numbers["18"])


def test_again_with_other_sizes(folder):
    """As adaptive runs mesh it."""
    file = cad.write_shapes(folder / "joint.step", cad.joint, LABELS)
    source = MeshSource(file, **SIZES)
    box = np.array([[[-90.0, -90, -90], [300, -90, -90], [-90, 300, -90], [-90, -90, 300]]])
    finer = SizeField("tetrahedron", box, np.full((1, 4), 1.3))
    body = load_body(source, 3, COMM, [finer], preloads=(BOLT,))
    assert heights(body, BOLT.group) == pytest.approx((1, 6), abs=1e-9)
    assert cells_of(body, BOLT.group) > 50


def test_two_pieces_of_one_body_that_is_glued_to_another(folder):
    """Along an oblique axis; the other body is not cut, and stays glued."""
    turn = 0.4
    axis = (math.sin(turn), 0.0, math.cos(turn))

    def build(occ):
        bar = occ.addBox(0, 0, 0, 1, 1, 10)
        collar = occ.addBox(1, 0, 2, 1, 1, 4)
        occ.fragment([(3, bar)], [(3, collar)])
        occ.rotate([(3, bar), (3, collar)], 0, 0, 0, 0, 1, 0, turn)

    file = cad.write_shapes(folder / "glued.brep", build)
    first = Preload("body_1", axis, 1.0, between=(1, 3), name="first")
    second = Preload("body_1", tuple(-5 * a for a in axis), 1.0, between=(-8, -3), name="second")
    source = MeshSource(file, size=1)
    body = load_body(source, 3, COMM, preloads=(first, second))
    assert heights(body, first.group, axis) == pytest.approx((1, 3), abs=1e-9)
    assert heights(body, second.group, axis) == pytest.approx((3, 8), abs=1e-9)
    sizes = [volume(body, name) for name in (first.group, second.group, "body_1", "body_2")]
    assert sizes == pytest.approx([2, 5, 10, 4], rel=1e-9)
    assert parts_of(body, 3)[0].count == 1
    before = load_body(source, 3, COMM)
    assert of_numbers(body) == pytest.approx(of_numbers(before), rel=1e-9)


def test_faces_in_the_plane(folder):
    def build(occ):
        occ.addRectangle(0, 0, 0, 1, 6)
        occ.addRectangle(1, 0, 0, 3, 1)

    file = cad.write_shapes(folder / "plane.brep", build)
    source = MeshSource(file, size=0.5)
    preload = Preload("body_1", (0, 1), 1.0, between=(2, 6))  # up to its end
    body = load_body(source, 2, COMM, preloads=(preload,))
    assert volume(body, preload.group) == pytest.approx(4, rel=1e-9)
    assert heights(body, preload.group, (0, 1, 0)) == pytest.approx((2, 6), abs=1e-9)
    assert of_numbers(body) == pytest.approx(of_numbers(load_body(source, 2, COMM)), rel=1e-9)


def test_bodies_of_several_meshes(folder):
    def bar(name, x):
        file = folder / f"{name}.brep"
        written = cad.write_shapes(file, lambda occ: occ.addBox(x, 0, 0, 1, 1, 4))
        return MeshSource(written, size=1, name=name)

    preload = Preload("right.body", ALONG, 1.0, between=(1, 2))
    sources = (bar("left", 0), bar("right", 3))
    body = load_body(sources, 3, COMM, preloads=(preload,))
    assert volume(body, preload.group) == pytest.approx(1, rel=1e-9)
    with refused("no_mesh_rigt"):
        wrong = dataclasses.replace(preload, on="rigt.body")
        load_body(sources, 3, COMM, preloads=(wrong,))


@pytest.mark.parametrize(
    ("on", "between", "words"),
    [
        ("bolt", (1, 6), "no_body_bolt"),
        ("Bolt", (-4, 6), "cut_begins_before_the_bolt"),
        ("Bolt", (1, 12), "cut_ends_behind_the_bolt"),
        ("Bolt", (20, 30), "cut_beside_the_bolt"),
    ],
)
def test_refused_by_the_file(on, between, words, folder):
    file = cad.write_shapes(folder / "joint.step", cad.joint, LABELS)
    preload = Preload(on, ALONG, 1.0, between=between)
    with refused(words):
        load_body(MeshSource(file, size=8), 3, COMM, preloads=(preload,))


def test_no_file_that_can_be_cut(folder):
    script = write(folder, 'SetFactory("OpenCASCADE");\nBox(1) = {0,0,0,1,1,4};\n')
    mesh = folder / "bar.msh"
    if COMM.rank == 0:
        mesh.write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")
    COMM.barrier()
    for source, what in ((script, "cut_of_a_script"), (MeshSource(str(mesh)), "cut_of_a_mesh")):
        with refused(what):
            load_body(source, 3, COMM, preloads=(dataclasses.replace(BOLT, on="body"),))
