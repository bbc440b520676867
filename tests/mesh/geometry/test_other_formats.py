"""Files of other programs are refused with what to make of them."""

import pytest
from mpi4py import MPI

from fenics_contact.mesh.geometry import file_kinds
from tests.messages import refused

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("lever.SLDPRT", "mesh_of_solidworks"),
        ("lever.x_t", "mesh_of_parasolid"),
        ("lever.stl", "mesh_of_triangles"),
        ("lever.cdb", "mesh_of_ansys"),
        ("two bodies.vtk", "mesh_of_vtk"),
        ("lever.unv", "mesh_of_ideas"),
    ],
)
def test_a_way_out_is_named(tmp_path, name, way):
    (tmp_path / name).touch()
    with refused(way):
        file_kinds.mesh_file("mesh.file", str(tmp_path / name))


def test_other_suffixes_are_refused_without_one(tmp_path):
    (tmp_path / "a.xyz").touch()
    with refused("no_such_suffix_xyz"):
        file_kinds.mesh_file("mesh.file", str(tmp_path / "a.xyz"))


def test_no_format_that_is_read_is_said_to_be_another_program_s():
    assert not set(file_kinds._WAYS) & set(file_kinds._KINDS)


def test_a_near_name_of_a_file_is_suggested(tmp_path):
    (tmp_path / "slab.geo").touch()
    with refused("mesh_file_misspelt"):
        file_kinds.mesh_file("mesh.file", str(tmp_path / "slap.geo"))
