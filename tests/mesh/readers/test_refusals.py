"""What readers refuse, each with exit code 2 and one sentence, and nothing hangs."""

import random
import re
import time

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import InputError, MeshSource, main
from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.readers.test_formats import as_file, with_meshio
from tests.mesh.test_loading import area, with_gmsh, write
from tests.mesh.test_soundness import MESH_MUTATIONS
from tests.messages import refused, says

COMM = MPI.COMM_WORLD
SQUARE = inp(Block("quadrilateral"), "CPE4")
BRICK = inp(Block("hexahedron"), "C3D8")
PLATE = bdf(Block("quadrilateral"), "CQUAD4", "CBAR")
SCENE = """
kinematics = "KINEMATICS"
mesh = { file = "FILE" }
material = { youngs_modulus = 1000, poissons_ratio = 0.3 }

[[support]]
on = "n_top"
displacement = { x = 0, y = 0 }
"""
BOMB = '<?xml version="1.0"?>\n<!DOCTYPE x [<!ENTITY a0 "ha">' + "".join(
    f'<!ENTITY a{n} "{10 * f"&a{n - 1};"}">' for n in range(1, 30)
)
SECONDS = 20


def on_root(action):
    if COMM.rank == 0:
        action()
    COMM.barrier()


def refusal(folder, capfd, name, dimension=2):
    """What ``check`` says of a scene with a file, in one sentence."""
    kinematics = "plane strain" if dimension == 2 else "3D"
    write(folder, SCENE.replace("FILE", name).replace("KINEMATICS", kinematics), "scene.toml")
    capfd.readouterr()
    start = time.perf_counter()
    code = main(["check", str(folder / "scene.toml")])
    assert time.perf_counter() - start < SECONDS
    said = COMM.bcast(capfd.readouterr().err)
    assert code == 2, said
    assert re.match("fenics-contact: (mesh|kinematics)", said) and said.count("\n") == 1, said
    assert "Traceback" not in said
    assert name in said
    return said


@pytest.mark.parametrize(
    ("text", "old", "new", "message"),
    [
        (SQUARE, "*NODE", "*NODEX", "inp_without_nodes"),
        (SQUARE, "CPE4", "CPE5", "inp_of_unknown_elements"),
        (SQUARE, "TYPE=CPE4", "", "inp_of_no_elements"),
        (SQUARE, "\n102, ", "\n101, ", "inp_element_twice"),
        (SQUARE, "\n102, ", "\n102, 3, ", "inp_element_of_other_nodes"),
        (SQUARE, "\n102, ", "\n102x, ", "inp_number_is_a_word"),
        (SQUARE, "\n102, ", "\n99999999999999999999999, ", "inp_number_is_huge"),
        (SQUARE, "\n101, 11,", "\n101, 999,", "inp_node_not_defined"),
        (SQUARE, "\n12, ", "\n12, x", "inp_node_without_coordinates"),
        (SQUARE, "\n12, ", "\n12, nan", "inp_node_without_coordinates"),
        (SQUARE, "\n12, ", "\n11, ", "inp_node_again"),
        (SQUARE, "*NODE", "*NODE, SYSTEM=C", "inp_nodes_in_a_system"),
        (SQUARE, "*NODE", "*NGEN", "inp_generates_nodes"),
        (SQUARE, "*MATERIAL", "*NSET, NSET=a\nb\n*MATERIAL", "inp_set_not_defined"),
        (SQUARE, "*MATERIAL", "*NSET, NSET=a\na\n*MATERIAL", "inp_set_holds_itself"),
        (SQUARE, "*MATERIAL", "*ELSET, ELSET=a\n999\n*MATERIAL", "inp_set_of_no_element"),
        (SQUARE, "*MATERIAL", "*ELSET\n101\n*MATERIAL", "inp_set_without_name"),
        (SQUARE, "S1\n", "S7\n", "inp_no_side_s7"),
        (SQUARE, "TYPE=CPE4", "TYPE=S4", "inp_side_of_a_shell"),
        (SQUARE, "*MATERIAL", "*ELEMENT, TYPE=T2D2\n1, 11, 12\n*SURFACE, NAME=a\n1, S1\n*MATERIAL",
         "inp_side_of_a_line"),
        (BRICK, "*MATERIAL", "*ELEMENT, TYPE=S3\n1, 11, 12, 13\n*SURFACE, NAME=a\n1, E1\n*MATERIAL",
         "inp_edge_of_a_shell"),
        (SQUARE, "TYPE=CPE4", "TYPE=CAX4", "inp_elements_axisymmetric"),
        (SQUARE, "TYPE=CPE4", "TYPE=CPS4R", "inp_elements_plane_stress"),
        (SQUARE, "TYPE=CPE4", "TYPE=CPEG4", "inp_elements_generalised"),
        (SQUARE, "*NODE", "*PART, NAME=a\n*PART, NAME=b\n*NODE", "inp_second_part"),
        (SQUARE, "*MATERIAL", "*INSTANCE, NAME=a\n1., 0., 0.\n*MATERIAL", "inp_instance_is_moved"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=no.inp\n*NODE", "inp_include_is_missing"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=\n*NODE", "inp_include_of_nothing"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=../x.inp\n*NODE", "inp_include_outside"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=/etc/passwd\n*NODE", "inp_include_of_passwords"),
        (SQUARE, "*NODE", "*include, input=link.inp\n*NODE", "inp_include_of_a_link"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=f.inp\n*NODE", "inp_includes_itself"),
        (SQUARE, "*NODE", "*NODE, INPUT=../x.inp", "inp_include_outside"),
        (SQUARE, "TYPE=CPE4", "TYPE=C3D4", "inp_of_dimension_3"),
        (BRICK, "TYPE=C3D8", "TYPE=AC3D8R5", "inp_of_acoustic_elements"),
        (PLATE, "ENDDATA", "", "bdf_is_truncated"),
        (PLATE, "GRID", "GRIX", "bdf_node_not_defined"),
        (PLATE, "\nCQUAD4", "\nCQUADX", "bdf_elements_not_read"),
        (PLATE, f"GRID*   11{30 * ' '}", f"GRID*   11{14 * ' '}3{15 * ' '}", "bdf_in_a_system"),
        (PLATE, "\nGRID*   12 ", "\nGRID*   1x ", "bdf_number_is_a_word"),
        (PLATE, "0.000000000E+00", "0.0000X0000E+00", "bdf_coordinate_is_a_word"),
        (PLATE, "\nCQUAD4  102 ", "\nCQUAD4  101 ", "bdf_element_twice"),
        (PLATE, "$ a comment", "INCLUDE '../x.bdf'", "bdf_include_outside"),
        (PLATE, "$ a comment", "include 'no.bdf'", "bdf_include_is_missing"),
        (PLATE, "CBAR    ", "CQUAD8  ", "bdf_element_of_other_nodes"),
        (PLATE, "ENDDATA", "BSURFS,1,,,,101,11,12,13\nENDDATA", "bdf_side_of_no_solid"),
    ],
)  # fmt: skip
def test_text_files(folder, capfd, text, old, new, message):
    changed = text.replace(old, new, 1)
    assert changed != text
    name = "f.bdf" if "GRI" in text else "f.inp"
    write(folder, changed, name)
    write(folder.parent, text, "x.inp")
    on_root(lambda: (folder / "link.inp").symlink_to(folder.parent / "x.inp"))
    says(message, refusal(folder, capfd, name, 3 if text is BRICK else 2))


@pytest.mark.parametrize("content", ["", "hello", "\0\1\2\xff", "*NODE\n", "GRID\n", "<a>"])
@pytest.mark.parametrize("suffix", ["inp", "bdf", "med", "vtu", "xdmf"])
def test_files_of_rubbish(folder, capfd, content, suffix):
    write(folder, content, f"rubbish.{suffix}")
    refusal(folder, capfd, f"rubbish.{suffix}")


@pytest.mark.parametrize("name", ["b.inp", "b.bdf", "b.med", "b.vtu", "b.xdmf"])
def test_settings_of_geometries_are_refused(folder, name):
    source, _ = as_file(folder, name, "quadrilateral")
    with refused("size_of_a_mesh"):
        load_body(MeshSource(source.file, size=0.1), 2, COMM)


def test_cells_that_are_none_of_a_model_are_refused(folder):
    """Gmsh's triangles of order 3."""

    def save(gmsh):
        gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.ElementOrder", 3)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(folder / "cubic.msh"))

    with_gmsh(save)
    with refused("cells_of_order_3"):
        load_body(MeshSource(str(folder / "cubic.msh")), 2, COMM)


@pytest.mark.parametrize("suffix", ["vtu", "xdmf"])
def test_entities_that_grow_are_refused_at_once(folder, capfd, suffix):
    write(folder, f"{BOMB}]>\n<x>&a29;</x>\n", f"bomb.{suffix}")
    says("mesh_has_a_doctype", refusal(folder, capfd, f"bomb.{suffix}"))


def test_entities_in_the_information_of_xdmf(folder, capfd):
    as_file(folder, "b.xdmf", "quadrilateral")
    text = COMM.bcast((folder / "b.xdmf").read_text() if COMM.rank == 0 else "")
    more = f"<Information><![CDATA[{BOMB}]>x]]></Information><Topology"
    write(folder, text.replace("<Topology", more, 1), "b.xdmf")
    says("mesh_has_a_doctype", refusal(folder, capfd, "b.xdmf"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("b.h5", "../b.h5", "xdmf_data_outside"),
        ("b.h5", "/b.h5", "xdmf_data_at_the_root"),
        ("b.h5", "link.h5", "xdmf_data_by_a_link"),
        ("b.h5", "no.h5", "xdmf_data_are_missing"),
        ("b.h5", "b.xdmf", "xdmf_data_are_no_hdf5"),
        ("b.h5", "outside.h5", "xdmf_data_of_another_file"),
        ("b.h5:/data0", "b.h5:/data9", "xdmf_cannot_be_read"),
        ('Format="HDF"', 'Format="Binary"', "xdmf_data_are_binary"),
        ("</Grid>", "</Grid><Grid/>", "xdmf_of_two_grids"),
        ("</Grid>", "", "xdmf_is_no_xml"),
    ],
)
def test_xdmf(folder, capfd, old, new, message):
    as_file(folder, "b.xdmf", "quadrilateral")

    def change():
        import h5py

        text = (folder / "b.xdmf").read_text()
        assert old in text
        (folder / "b.xdmf").write_text(text.replace(old, new, 1))
        h5py.File(folder.parent / "outside.h5", "w").close()
        (folder / "link.h5").symlink_to(folder.parent / "outside.h5")
        with h5py.File(folder / "outside.h5", "w") as file:
            file["data0"] = h5py.ExternalLink(str(folder / "b.h5"), "/data0")

    on_root(change)
    says(message, refusal(folder, capfd, "b.xdmf"))


def test_med_that_names_another_file(folder, capfd):
    as_file(folder, "b.med", "quadrilateral")

    def change():
        import h5py

        with h5py.File(folder / "b.med", "a") as file:
            file["more"] = h5py.ExternalLink("other.med", "/x")

    on_root(change)
    says("med_of_another_file", refusal(folder, capfd, "b.med"))


def test_med_with_two_meshes(folder, capfd):
    as_file(folder, "b.med", "quadrilateral")

    def change():
        import h5py

        with h5py.File(folder / "b.med", "a") as file:
            file.copy("ENS_MAA/mesh", "ENS_MAA/other")

    on_root(change)
    says("med_of_two_meshes", refusal(folder, capfd, "b.med"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (r'NumberOfCells="\d+"', 'NumberOfCells="99999999999999"', "vtu_cannot_be_read"),
        (r'NumberOfPoints="\d+"', 'NumberOfPoints="99999999999999"', "vtu_cannot_be_read"),
        (r"(?s)<Piece.*</Piece>", r"\g<0>\g<0>", "vtu_of_two_pieces"),
        (r"(?s)<Piece.*</Piece>", "", "vtu_cannot_be_read"),
        (r"(?s)</Points>.*", "", "vtu_is_no_xml"),
        (r'type="UnstructuredGrid"', 'type="PolyData"', "vtu_cannot_be_read"),
    ],
)
def test_vtu(folder, capfd, old, new, message):
    with_meshio(folder, "b.vtu", Block("quadrilateral"), 1, binary=False)
    text = COMM.bcast((folder / "b.vtu").read_text() if COMM.rank == 0 else "")
    changed = re.sub(old, new, text)
    assert changed != text
    write(folder, changed, "b.vtu")
    says(message, refusal(folder, capfd, "b.vtu"))


def test_huge_data_are_not_made(folder, capfd):
    """A data set of 10¹² numbers that takes no room in its file."""
    as_file(folder, "b.xdmf", "quadrilateral")

    def change():
        import h5py

        with h5py.File(folder / "b.h5", "a") as file:
            del file["data0"]
            file.create_dataset("data0", (10**12, 3), chunks=(1000, 3), dtype="f8")

    on_root(change)
    says("reader_needs_more_memory", refusal(folder, capfd, "b.xdmf"))


def test_ranges_of_sets_make_no_numbers(folder):
    more = "*NSET, NSET=every, GENERATE\n1, 9000000000000000, 1\n*MATERIAL"
    body = load_body(write(folder, SQUARE.replace("*MATERIAL", more), "f.inp"), 2, COMM)
    assert area(body, "every") == pytest.approx(6)


@pytest.mark.parametrize("number", range(40))
def test_damaged_files(folder, number):
    """A sound body, or one sentence."""
    name = ["b.inp", "b.bdf", "b.med", "b.vtu", "b.xdmf"][number % 5]
    source, _ = as_file(folder, name, "hexahedron")
    chance = random.Random(1982 + number)

    def damage():
        path = folder / ("b.h5" if name == "b.xdmf" and number % 2 else name)
        mutate = MESH_MUTATIONS[number // 5 % 6]  # the others are of sections of .msh
        path.write_bytes(mutate(path.read_bytes(), chance))

    on_root(damage)
    start = time.perf_counter()
    try:
        body = load_body(source, 3, COMM)
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert np.isfinite(body.mesh.geometry.x).all()
    assert time.perf_counter() - start < SECONDS


def test_trusses_alone_are_no_body(folder):
    text = "*NODE, NSET=Nall\n1, 0, 0\n2, 1, 0\n*ELEMENT, TYPE=T3D2\n1, 1, 2\n"
    with refused("trusses_alone"):
        load_body(write(folder, text, "t.inp"), 3, COMM)
