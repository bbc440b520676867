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
from tests.mesh.test_loading import area, write
from tests.mesh.test_soundness import MESH_MUTATIONS

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


def refused(folder, capfd, name, dimension=2):
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
        (SQUARE, "*NODE", "*NODEX", "has no nodes"),
        (SQUARE, "CPE4", "CPE5", "line 17: elements of TYPE = 'CPE5' are not known"),
        (SQUARE, "TYPE=CPE4", "", "elements of TYPE = '' are not known"),
        (SQUARE, "\n102, ", "\n101, ", "the element 101 is defined twice"),
        (SQUARE, "\n102, ", "\n102, 3, ", "want a number and 4 nodes each"),
        (SQUARE, "\n102, ", "\n102x, ", r"line 19: '102x' must be a positive whole number"),
        (SQUARE, "\n102, ", "\n99999999999999999999999, ", "must be a positive whole number"),
        (SQUARE, "\n101, 11,", "\n101, 999,", "nodes that it does not define"),
        (SQUARE, "\n12, ", "\n12, x", "line 6: a node wants its number and its coordinates"),
        (SQUARE, "\n12, ", "\n12, nan", "not finite|a node wants"),
        (SQUARE, "\n12, ", "\n11, ", "defines the node 11 again, elsewhere"),
        (SQUARE, "*NODE", "*NODE, SYSTEM=C", "wants coordinates in the global system"),
        (SQUARE, "*NODE", "*NGEN", r"\*NGEN is not read; write all nodes and elements out"),
        (SQUARE, "*MATERIAL", "*NSET, NSET=a\nb\n*MATERIAL", "nodes 'b' is not defined"),
        (SQUARE, "*MATERIAL", "*NSET, NSET=a\na\n*MATERIAL", "the set of nodes 'a' holds itself"),
        (SQUARE, "*MATERIAL", "*ELSET, ELSET=a\n999\n*MATERIAL", "has the element 999"),
        (SQUARE, "*MATERIAL", "*ELSET\n101\n*MATERIAL", "wants a name: ELSET="),
        (SQUARE, "S1\n", "S7\n", "'S7' names no side of these elements; there are S1 to S4"),
        (SQUARE, "TYPE=CPE4", "TYPE=S4", "'S1' names no side .*: they are shells, whose sides"),
        (SQUARE, "*MATERIAL", "*ELEMENT, TYPE=T2D2\n1, 11, 12\n*SURFACE, NAME=a\n1, S1\n*MATERIAL",
         "which are no cells; a surface of these elements themselves has no label"),
        (BRICK, "*MATERIAL", "*ELEMENT, TYPE=S3\n1, 11, 12, 13\n*SURFACE, NAME=a\n1, E1\n*MATERIAL",
         "'E1' names .*, which are shells; there are SPOS and SNEG, or S1 and S2"),
        (SQUARE, "TYPE=CPE4", "TYPE=CAX4", "kinematics = 'plane strain': the elements of .* are "
         "CAX4, which is axisymmetric; change the scene's kinematics"),
        (SQUARE, "TYPE=CPE4", "TYPE=CPS4R", "are CPS4R, which is plane stress"),
        (SQUARE, "TYPE=CPE4", "TYPE=CPEG4", "are CPEG4, which is generalised plane strain"),
        (SQUARE, "*NODE", "*PART, NAME=a\n*PART, NAME=b\n*NODE", r"is a second \*PART"),
        (SQUARE, "*MATERIAL", "*INSTANCE, NAME=a\n1., 0., 0.\n*MATERIAL", "instance is moved"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=no.inp\n*NODE", "there is no file 'no.inp'"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=\n*NODE", "there is no file ''"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=../x.inp\n*NODE", "'../x.inp' is outside the folder"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=/etc/passwd\n*NODE", "outside the folder"),
        (SQUARE, "*NODE", "*include, input=link.inp\n*NODE", "'link.inp' is outside the folder"),
        (SQUARE, "*NODE", "*INCLUDE, INPUT=f.inp\n*NODE", "includes itself"),
        (SQUARE, "*NODE", "*NODE, INPUT=../x.inp", "is outside the folder"),
        (SQUARE, "TYPE=CPE4", "TYPE=C3D4", "is 3-dimensional, but"),
        (BRICK, "TYPE=C3D8", "TYPE=AC3D8R5", "are not known"),
        (PLATE, "ENDDATA", "", "ends before ENDDATA: is the file truncated"),
        (PLATE, "GRID", "GRIX", "line 5|does not define"),
        (PLATE, "\nCQUAD4", "\nCQUADX", "elements CQUADX are not read; there are: CBAR"),
        (PLATE, "GRID*   11              ", "GRID*   11              3", "coordinate system 3"),
        (PLATE, "\nGRID*   12 ", "\nGRID*   1x ", "field 2 of GRID must be a pos"),
        (PLATE, "0.000000000E+00", "0.0000X0000E+00", "field 4 of GRID must be a number"),
        (PLATE, "\nCQUAD4  102 ", "\nCQUAD4  101 ", "the element 101 is defined twice"),
        (PLATE, "$ a comment", "INCLUDE '../x.bdf'", "is outside the folder of the mesh"),
        (PLATE, "$ a comment", "include 'no.bdf'", "there is no file 'no.bdf'"),
        (PLATE, "CBAR    ", "CQUAD8  ", "CQUAD8 wants 8 nodes, but has 2"),
        (PLATE, "ENDDATA", "BSURFS,1,,,,101,11,12,13\nENDDATA",
         "the grid points 11, 12, 13 are corners of no side of a solid 101"),
    ],
)  # fmt: skip
def test_text_files(folder, capfd, text, old, new, message):
    changed = text.replace(old, new, 1)
    assert changed != text
    name = "f.bdf" if "GRI" in text else "f.inp"
    write(folder, changed, name)
    write(folder.parent, text, "x.inp")
    on_root(lambda: (folder / "link.inp").symlink_to(folder.parent / "x.inp"))
    said = refused(folder, capfd, name, 3 if text is BRICK else 2)
    assert re.search(message, said), said


@pytest.mark.parametrize("content", ["", "hello", "\0\1\2\xff", "*NODE\n", "GRID\n", "<a>"])
@pytest.mark.parametrize("suffix", ["inp", "bdf", "med", "vtu", "xdmf"])
def test_files_of_rubbish(folder, capfd, content, suffix):
    write(folder, content, f"rubbish.{suffix}")
    refused(folder, capfd, f"rubbish.{suffix}")


@pytest.mark.parametrize("name", ["b.inp", "b.bdf", "b.med", "b.vtu", "b.xdmf"])
def test_settings_of_geometries_are_refused(folder, name):
    source, _ = as_file(folder, name, "quadrilateral")
    with pytest.raises(InputError, match=r"is a mesh already: size cannot change it"):
        load_body(MeshSource(source.file, size=0.1), 2, COMM)


@pytest.mark.parametrize(("cell", "kind"), [("C3D6", 6), ("C3D15", 15)])
def test_prisms_are_refused(folder, capfd, cell, kind):
    nodes = "".join(f"{n}, {n % 3}, {n // 3}, {n % 2}\n" for n in range(1, kind + 1))
    element = ", ".join(map(str, range(1, kind + 1)))
    write(folder, f"*NODE\n{nodes}*ELEMENT, TYPE={cell}\n1, {element}\n", "f.inp")
    assert "its cells are of the type Prism" in refused(folder, capfd, "f.inp", 3)


def test_surfaces_of_prisms_do_not_hide_what_they_are(folder, capfd):
    nodes = "".join(f"{n}, {n % 3}, {n // 3}, {n % 2}\n" for n in range(1, 7))
    text = f"*NODE\n{nodes}*ELEMENT, TYPE=C3D6\n1, 1, 2, 3, 4, 5, 6\n*SURFACE, NAME=TOP\n1, S2\n"
    write(folder, text, "f.inp")
    assert "its cells are of the type Prism" in refused(folder, capfd, "f.inp", 3)


def test_mixed_cells_are_refused(folder, capfd):
    more = "*ELEMENT, TYPE=CPE3\n999, 11, 12, 13\n*MATERIAL"
    write(folder, SQUARE.replace("*MATERIAL", more), "f.inp")
    assert "mixes cells (Triangle 3, Quadrilateral 4)" in refused(folder, capfd, "f.inp")


@pytest.mark.parametrize("suffix", ["vtu", "xdmf"])
def test_entities_that_grow_are_refused_at_once(folder, capfd, suffix):
    write(folder, f"{BOMB}]>\n<x>&a29;</x>\n", f"bomb.{suffix}")
    assert "has a <!DOCTYPE …>, which a mesh may not" in refused(folder, capfd, f"bomb.{suffix}")


def test_entities_in_the_information_of_xdmf(folder, capfd):
    as_file(folder, "b.xdmf", "quadrilateral")
    text = COMM.bcast((folder / "b.xdmf").read_text() if COMM.rank == 0 else "")
    more = f"<Information><![CDATA[{BOMB}]>x]]></Information><Topology"
    write(folder, text.replace("<Topology", more, 1), "b.xdmf")
    assert "<!DOCTYPE" in refused(folder, capfd, "b.xdmf")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("b.h5", "../b.h5", "its data in '../b.h5' are outside the folder of the mesh"),
        ("b.h5", "/b.h5", "are outside the folder"),
        ("b.h5", "link.h5", "its data in 'link.h5' are outside the folder"),
        ("b.h5", "no.h5", "its data in 'no.h5' are missing: there is no such file"),
        ("b.h5", "b.xdmf", "is no sound HDF5 file"),
        ("b.h5", "outside.h5", "refers to another file, which a mesh may not"),
        ("b.h5:/data0", "b.h5:/data9", "cannot be read"),
        ('Format="HDF"', 'Format="Binary"', "keeps data in binary files"),
        ("</Grid>", "</Grid><Grid/>", "has 2 grids; it must have one"),
        ("</Grid>", "", "is no sound XML"),
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
    said = refused(folder, capfd, "b.xdmf")
    assert re.search(message, said), said


def test_med_that_names_another_file(folder, capfd):
    as_file(folder, "b.med", "quadrilateral")

    def change():
        import h5py

        with h5py.File(folder / "b.med", "a") as file:
            file["more"] = h5py.ExternalLink("other.med", "/x")

    on_root(change)
    assert "'//more' in it refers to another file" in refused(folder, capfd, "b.med")


def test_med_with_two_meshes(folder, capfd):
    as_file(folder, "b.med", "quadrilateral")

    def change():
        import h5py

        with h5py.File(folder / "b.med", "a") as file:
            file.copy("ENS_MAA/mesh", "ENS_MAA/other")

    on_root(change)
    assert "has 2 meshes; it must have one" in refused(folder, capfd, "b.med")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (r'NumberOfCells="\d+"', 'NumberOfCells="99999999999999"', "cannot be read"),
        (r'NumberOfPoints="\d+"', 'NumberOfPoints="99999999999999"', "cannot be read"),
        (r"(?s)<Piece.*</Piece>", r"\g<0>\g<0>", "has 2 pieces; save it as one"),
        (r"(?s)<Piece.*</Piece>", "", "cannot be read"),
        (r"(?s)</Points>.*", "", "is no sound XML"),
        (r'type="UnstructuredGrid"', 'type="PolyData"', "Expected type UnstructuredGrid"),
    ],
)
def test_vtu(folder, capfd, old, new, message):
    with_meshio(folder, "b.vtu", Block("quadrilateral"), 1, binary=False)
    text = COMM.bcast((folder / "b.vtu").read_text() if COMM.rank == 0 else "")
    changed = re.sub(old, new, text)
    assert changed != text
    write(folder, changed, "b.vtu")
    assert message in refused(folder, capfd, "b.vtu")


def test_huge_data_are_not_made(folder, capfd):
    """A data set of 10¹² numbers that takes no room in its file."""
    as_file(folder, "b.xdmf", "quadrilateral")

    def change():
        import h5py

        with h5py.File(folder / "b.h5", "a") as file:
            del file["data0"]
            file.create_dataset("data0", (10**12, 3), chunks=(1000, 3), dtype="f8")

    on_root(change)
    assert "most likely needs more than the" in refused(folder, capfd, "b.xdmf")


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
