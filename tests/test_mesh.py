import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import InputError, MeshSource
from fenics_contact.gmsh_files import load_body
from tests.scenes import SLAB

COMM = MPI.COMM_WORLD

OVERLAPPING = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 2, 1};
Physical Surface("body") = {1};
Physical Curve("all") = {1, 2, 3, 4};
Physical Curve("top") = {3};
Physical Curve(7) = {2};
"""


def write(folder, text, name="g.geo"):
    path = folder / name
    path.write_text(text)
    COMM.barrier()
    return MeshSource(str(path))


def area(body, name):
    entities = body.entities(body.groups[name])
    mesh = body.mesh
    from fenics_contact.compat import boundary_entities

    mesh.topology.create_connectivity(1, 2)
    mesh.topology.create_connectivity(2, 1)
    ds = ufl.Measure(
        "ds", domain=mesh, subdomain_data=[(1, boundary_entities(mesh.topology, entities))]
    )
    return COMM.allreduce(fem.assemble_scalar(fem.form(fem.Constant(mesh, 1.0) * ds(1))))


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("order", [1, 2])
def test_slab_has_the_scenes_cells_and_order(cell, order):
    parameters = {"length": 4, "height": 2, "cells_along": 6, "cells_across": 3}
    body = load_body(MeshSource(SLAB, parameters=parameters, cell=cell, order=order), 2, COMM)
    per_square = 2 if cell == "triangle" else 1
    assert body.mesh.topology.index_map(2).size_global == 18 * per_square
    assert body.mesh.topology.cell_name() == cell
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == order
    assert set(body.groups) == {"slab", "bottom", "right", "top", "left"}
    assert area(body, "top") == pytest.approx(4)
    assert area(body, "left") == pytest.approx(2)


def test_parameters_do_not_leak_from_one_mesh_to_the_next():
    load_body(MeshSource(SLAB, parameters={"cells_along": 3}), 2, COMM)
    body = load_body(MeshSource(SLAB), 2, COMM)
    assert body.mesh.topology.index_map(2).size_global == 32


def test_groups_may_share_facets_and_be_numbers(folder):
    body = load_body(write(folder, OVERLAPPING), 2, COMM)
    assert area(body, "all") == pytest.approx(6)
    assert area(body, "top") == pytest.approx(2)
    assert area(body, "7") == pytest.approx(1)


def test_mesh_file_gives_the_same_body(folder):
    source = write(folder, OVERLAPPING)
    msh = folder / "g.msh"
    if COMM.rank == 0:
        import gmsh

        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(source.file)
        gmsh.model.mesh.generate(2)
        gmsh.write(str(msh))
        gmsh.finalize()
    COMM.barrier()
    direct = load_body(source, 2, COMM)
    body = load_body(MeshSource(str(msh)), 2, COMM)
    assert body.groups == direct.groups
    assert area(body, "all") == pytest.approx(6)
    with pytest.raises(InputError, match="is a mesh already"):
        load_body(MeshSource(str(msh), order=2), 2, COMM)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Line(1) = {1, 2};\n", "Gmsh says"),
        ("Point(1) = {0, 0, 0};\n", "has no Physical Surface"),
        (
            'Point(1) = {0, 0, 0};\nPhysical Surface("b") = {4};\n',
            "Gmsh says|has no Physical Surface",
        ),
    ],
)
def test_bad_geometry_is_one_error_on_every_rank(folder, text, message):
    with pytest.raises(InputError, match=message):
        load_body(write(folder, text), 2, COMM)


def test_unknown_parameter_lists_those_there_are():
    with pytest.raises(InputError, match=r"cells_alon = 4: .*cells_along, height, length"):
        load_body(MeshSource(SLAB, parameters={"cells_alon": 4}), 2, COMM)


def test_parameter_that_the_geometry_overwrites_is_refused(folder):
    source = write(folder, "n = 3;\n" + OVERLAPPING)
    with pytest.raises(InputError, match=r"n = 5: .*overwrites it"):
        load_body(MeshSource(source.file, parameters={"n": 5}), 2, COMM)


def test_missing_file_and_wrong_kind(folder):
    with pytest.raises(InputError, match="there is no such file"):
        load_body(MeshSource(str(folder / "no.geo")), 2, COMM)
    with pytest.raises(InputError, match=r"must end in .geo or .msh"):
        load_body(write(folder, "x", "g.txt"), 2, COMM)


def test_missing_group_lists_those_there_are():
    body = load_body(MeshSource(SLAB), 2, COMM)
    with pytest.raises(InputError, match=r"load\[0\].on = 'rigt': .* bottom, left, right, slab"):
        body.group("rigt", "load[0].on")
    with pytest.raises(InputError, match="must be a boundary"):
        body.boundary("slab", "contact[0].on")
