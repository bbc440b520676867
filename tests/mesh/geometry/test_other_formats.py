"""Files of other programs are refused with what to make of them."""

import pytest
from mpi4py import MPI

from fenics_contact import InputError
from fenics_contact.mesh.geometry import file_kinds, other_formats

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("lever.SLDPRT", "save the part as STEP (.step) in the CAD program"),
        ("lever.x_t", "save the part as STEP (.step) in the CAD program"),
        ("lever.stl", "it has triangles of a surface and no solid: save the part as STEP"),
        ("lever.cdb", "by ansys-mapdl-reader, and convert that to .msh by meshio"),
        ("two bodies.vtk", "meshio convert 'two bodies.vtk' 'two bodies.msh'"),
        ("lever.unv", "open it in Gmsh and save it as .msh"),
    ],
)
def test_a_way_out_is_named(tmp_path, name, way):
    (tmp_path / name).touch()
    with pytest.raises(InputError) as caught:
        file_kinds.mesh_file("mesh.file", str(tmp_path / name))
    said = str(caught.value)
    assert said.startswith("mesh.file = '") and "must end in .geo, .msh, " in said and way in said


def test_other_suffixes_are_refused_without_one(tmp_path):
    (tmp_path / "a.xyz").touch()
    with pytest.raises(InputError, match=r"must end in [^;]*$"):
        file_kinds.mesh_file("mesh.file", str(tmp_path / "a.xyz"))


def test_no_format_that_is_read_is_said_to_be_another_program_s():
    assert not set(other_formats._WAYS) & set(file_kinds._KINDS)


def test_a_near_name_of_a_file_is_suggested(tmp_path):
    (tmp_path / "slab.geo").touch()
    with pytest.raises(InputError, match=r"there is no such file \(did you mean 'slab.geo'\?\)"):
        file_kinds.mesh_file("mesh.file", str(tmp_path / "slap.geo"))
