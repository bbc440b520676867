"""Meshes made for an accuracy: sizes, meshing, orders, true errors, and what is said if not."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Discretisation,
    InputError,
    Material,
    MeshSource,
    Run,
    Scene,
    Support,
    load_scene,
    main,
    run,
    run_with_fields,
)
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.refinement import refined
from fenics_contact.mesh.size_field import (
    COARSER,
    FINER,
    Cells,
    SizeField,
    expected_number,
    graded,
    next_sizes,
)
from fenics_contact.simulation.adaptive import target_mesh_size
from fenics_contact.simulation.adaptive import targets as accuracy_asked
from fenics_contact.simulation.adaptive.levels import AdaptiveRun
from fenics_contact.simulation.adaptive.transfer import fitted
from fenics_contact.simulation.output import run_folder as files
from tests.messages import refused
from tests.scenes import ROOT, box_body

pytestmark = pytest.mark.errors
COMM = MPI.COMM_WORLD
SPHERE = ROOT / "demos" / "sphere.toml"
COARSE = ["mesh.parameters.size=1", "mesh.parameters.cells_outside=5"]


def grid(cells):
    """A unit square of triangles, as arrays."""
    x, y = np.meshgrid(*2 * [np.linspace(0, 1, cells + 1)], indexing="ij")
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1)
    across, up = first + cells + 1, first + 1
    vertices = np.stack([[first, across, up], [across, across + 1, up]]).transpose(0, 2, 1)
    return Cells("triangle", np.column_stack([x.ravel(), y.ravel()]), vertices.reshape(-1, 3))


@pytest.mark.parametrize("order", [1, 2])
def test_sizes_make_errors_equal_and_meet_the_number(order):
    """Errors squared c(x) h^(2p + 2) of a smooth c: those of the new sizes are nearly equal."""
    cells = grid(40)
    middle = cells.points[cells.vertices].mean(axis=1)

    def density(points):
        return np.exp(1.5 * points[:, 0] - points[:, 1])

    squared = density(middle) * cells.sizes() ** (2 * order + 2)
    sizes = next_sizes(cells, squared, order, 4000)
    assert expected_number(cells, sizes) == pytest.approx(4000, rel=0.03)
    new = density(cells.points) * sizes ** (2 * order + 2)
    assert new.std() / new.mean() < 0.1
    assert squared.std() / squared.mean() > 0.4


def test_sizes_stay_within_bounds_and_grow_slowly():
    cells = grid(20)
    middle = cells.points[cells.vertices].mean(axis=1)
    squared = np.where(np.linalg.norm(middle, axis=1) < 0.1, 1.0, 1e-12)
    sizes, old = next_sizes(cells, squared, 2, 3 * len(squared)), cells.sizes()[0]
    ends = cells.points[cells.edges()]
    rise = np.abs(np.diff(sizes[cells.edges()], axis=1)[:, 0])
    assert sizes.min() == pytest.approx(old / FINER)
    assert sizes.max() <= COARSER * old * (1 + 1e-12)
    assert (rise <= 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) + 1e-12).all()


def test_grading_is_the_shortest_way():
    """Against all ways of one edge after the other, until nothing changes."""
    cells, random = grid(6), np.random.default_rng(0)
    sizes, edges = random.uniform(0.1, 2, len(cells.points)), cells.edges()
    lengths = np.linalg.norm(np.diff(cells.points[edges], axis=1)[:, 0], axis=1)
    expected = sizes.copy()
    for _ in range(len(sizes)):
        for a, b in ((0, 1), (1, 0)):
            np.minimum.at(expected, edges[:, a], expected[edges[:, b]] + 0.3 * lengths)
    assert graded(cells.points, edges, sizes, 0.3) == pytest.approx(expected)


def cells_of(mesh):
    """A mesh on one rank as arrays."""
    corners = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4}[mesh.topology.cell_name()]
    nodes = compat.geometry_nodes(mesh)[:, :corners]
    used, vertices = np.unique(nodes, return_inverse=True)
    points = mesh.geometry.x[used][:, : mesh.geometry.dim]
    return Cells(mesh.topology.cell_name(), points, vertices.reshape(nodes.shape))


@pytest.mark.serial
@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_gmsh_follows_sizes(cell):
    source = MeshSource(str(ROOT / "meshes" / "half_space.geo"), cell=cell)
    old = cells_of(load_body(source, 2, MPI.COMM_SELF).mesh)

    def wanted(points):
        return 0.03 + 0.2 * np.linalg.norm(points - [2.8, 0], axis=-1)

    field = SizeField.of(old, wanted(old.points)).finer_at(np.array([[2.8, 0]]), np.array([0.03]))
    new = cells_of(load_body(source, 2, MPI.COMM_SELF, [field]).mesh)
    ratio = new.sizes() / wanted(new.points[new.vertices].mean(axis=1))
    assert 0.75 < np.median(ratio) < 1.15
    assert np.quantile(ratio, 0.05) > 0.45
    assert np.quantile(ratio, 0.95) < 1.5


GEOMETRIES = sorted((ROOT / "meshes").glob("*.geo"))


@pytest.mark.serial
@pytest.mark.parametrize("file", GEOMETRIES, ids=lambda file: file.stem)
def test_all_geometries_can_be_meshed_again(file):
    """Groups stay, with their lengths; quarter circles have a circle's length, to order 4."""
    dimension = 3 if file.stem in ("brick", "quarter_space") else 2
    parameters = {
        "brick": {"hexahedra": 0},
        "quarter_space": {"size": 3.6, "cells_outside": 3},
        "annular_punch": {"size": 0.1, "growth": 2},
    }.get(file.stem, {})
    cell = "as meshed" if dimension == 3 else "quadrilateral"
    source = MeshSource(str(file), parameters=parameters, cell=cell)
    body = load_body(source, dimension, MPI.COMM_SELF, curved=True)
    old = cells_of(body.mesh)
    squared = old.sizes() ** (4 + dimension)
    sizes = next_sizes(old, squared, 2, 1.5 * len(squared))
    new = load_body(source, dimension, MPI.COMM_SELF, [SizeField.of(old, sizes)], curved=True)
    assert len(cells_of(new.mesh).vertices) != len(squared)
    assert set(new.groups) == set(body.groups)
    for name, group in new.groups.items():
        rel = 1e-4 if old.cell == "quadrilateral" else 1e-9
        assert measure(new, group) == pytest.approx(measure(body, body.groups[name]), rel=rel)


def measure(body, group):
    """Length, area or volume of a group; collective."""
    entities = body.entities(group)
    if group.dimension == body.dimension:
        of_group = ufl.Measure("dx", domain=body.mesh, subdomain_data=[(1, entities)])(1)
    else:
        facets = compat.boundary_entities(body.mesh.topology, entities)
        of_group = ufl.Measure("ds", domain=body.mesh, subdomain_data=[(1, facets)])(1)
    one = fem.Constant(body.mesh, 1.0)
    found = fem.assemble_scalar(fem.form(one * of_group))
    return body.mesh.comm.allreduce(found)


@pytest.mark.parametrize("dimension", [2, 3])
def test_simplices_are_cut_on_any_number_of_ranks(dimension):
    cell = CellType.triangle if dimension == 2 else CellType.tetrahedron
    body = box_body(dimension * (3,), dimension * (1,), cell)
    index_map = body.mesh.topology.index_map(dimension)
    marked = np.zeros(index_map.size_global, dtype=bool)
    marked[:2] = True
    finer = refined(body, marked if COMM.rank == 0 else None)
    cells = finer.mesh.topology.index_map(dimension).size_global
    assert index_map.size_global + 2 * (2**dimension - 1) <= cells < 4 * index_map.size_global
    for name, group in body.groups.items():
        assert finer.groups[name] == group
        if group.dimension < dimension:
            assert measure(finer, group) == pytest.approx(1.0)


def test_transfer_keeps_quadratic_displacements():
    random = np.random.default_rng(0)
    for dimension in (2, 3):
        points, at = random.random((400, dimension)), random.random((50, dimension))

        def exact(x):
            return np.column_stack([x[:, 0] ** 2 - x[:, 1], 1 + x[:, 0] * x[:, -1]])

        assert fitted(points, exact(points), at) == pytest.approx(exact(at), abs=1e-5)
    assert fitted(points, exact(points), at[:0]).shape == (0, 2)


class Recorder:
    """Solves levels, and keeps dofs and energies."""

    def __init__(self):
        self.dofs, self.energies = [], []

    def __call__(self, level, guess):
        result = level.solve(guess=guess)
        self.dofs.append(result.model["dofs"])
        self.energies.append(result.quantities["strain_energy"])
        return result


def punch(cells, **accuracy):
    """A block glued to a bonded flat punch on a part of its top: singular at the punch's end."""
    return Scene(
        kinematics="plane strain",
        mesh=MeshSource(
            str(ROOT / "meshes" / "foundation_slab.geo"),
            cell="quadrilateral",
            parameters={
                "length": 2,
                "height": 1,
                "patch": 0.5,
                "cells_along": 2 * cells,
                "cells_across": cells,
            },
        ),
        material=Material(1000, 0.3),
        discretisation=Discretisation(2),
        support=(
            Support("bottom", {"x": 0, "y": 0}),
            Support("left", {"x": 0}),
            Support("patch", {"x": 0, "y": -0.01}),
        ),
        accuracy=Accuracy(**accuracy) if accuracy else None,
    )


@pytest.mark.serial
def test_singular_problem_has_order_one_in_dofs_on_adaptive_meshes():
    """Displacements r^(1/2): order 1/4 in dofs on uniform meshes. Driven by displacements, energies
    come from above, by ½ a(e, e) from the exact one, which is extrapolated from the finest meshes.
    """
    levels = Recorder()
    scene = punch(4, strain_energy=1e-9, max_levels=5, max_dofs=30_000)
    found = AdaptiveRun(Run(scene, COMM)).solve(levels)
    exact = levels.energies[-1] - (levels.energies[-2] - levels.energies[-1]) / 6
    dofs, errors = np.array(levels.dofs), np.sqrt(2 * (np.array(levels.energies) - exact))
    assert np.log(errors[1] / errors[3]) / np.log(dofs[3] / dofs[1]) > 0.9
    uniform = [run(punch(cells), COMM) for cells in (8, 32)]
    errors = [np.sqrt(2 * (r.quantities["strain_energy"] - exact)) for r in uniform]
    dofs = [r.model["dofs"] for r in uniform]
    assert 0.2 < np.log(errors[0] / errors[1]) / np.log(dofs[1] / dofs[0]) < 0.35
    true = np.sqrt((levels.energies[2] - exact) / exact)
    assert 0.5 * true < found.levels[2]["energy_error"] < 4 * true
    assert found.exit_code == 3
    assert "not reached" in found.verdict


@pytest.mark.parametrize(("accuracy", "most"), [(1e-2, 4_000), (1e-3, 30_000)])
def test_hertz_reaches_an_accuracy_within_its_dofs(accuracy, most):
    """The paraboloid on a half-space: F = 4/3 E* √R d^1.5, p0 = 2E*/π √(d/R), A = πRd."""
    scene = load_scene(
        SPHERE, ["contact.0.friction_coefficient=0", f"accuracy={accuracy}", *COARSE]
    )
    found = run(scene, COMM)
    modulus = 1000 / (1 - 0.3**2)
    exact = {
        "normal_force": 4 / 3 * modulus * np.sqrt(8),
        "max_contact_pressure": 2 * modulus / np.pi / np.sqrt(8),
        "contact_area": 8 * np.pi,
    }
    assert found.exit_code == 0
    assert found.model["dofs"] <= most
    assert 1 < len(found.levels) < 8
    for name, value in exact.items():
        error = abs(found.quantities[name] / value - 1)
        assert error <= found.levels[-1]["errors"][name] <= accuracy
    assert "reached with mesh" in found.verdict


def test_command_writes_the_last_level_and_says_so(folder, capsys):
    options = ["--set", "contact.0.friction_coefficient=0", "--set", "accuracy.main=0.03"]
    options += [word for key in COARSE for word in ("--set", key)]
    assert main(["check", str(SPHERE), *options]) == 0
    if COMM.rank == 0:
        assert "Adaptive: finer meshes until" in capsys.readouterr().out
    assert main(["run", str(SPHERE), *options, "--out", str(folder)]) == 0
    result = json.loads((folder / "result.json").read_text())
    levels = result["levels"]
    assert result["accuracy"]["reached"]
    assert [level["dofs"] for level in levels][-1] == result["model"]["dofs"]
    assert len(levels) > 1
    assert set(levels[0]["errors"]) == {"normal_force", "max_contact_pressure", "contact_area"}
    assert {"contact.csv", "fields.pvd", "steps.csv"} <= {path.name for path in folder.iterdir()}
    assert not (folder / "next_level").exists()
    assert main(["run", str(SPHERE), *options, "--out", str(folder), "--resume"]) == 2


def test_failure_keeps_the_last_level(folder, monkeypatch):
    def fail(*arguments):
        raise InputError("Gmsh says: no")

    monkeypatch.setattr(target_mesh_size, "next_mesh", fail)
    scene = load_scene(SPHERE, ["contact.0.friction_coefficient=0", "accuracy=1e-4", *COARSE])
    found = files.solve_levels_and_write(Run(scene, COMM), folder)
    assert found.exit_code == 3
    assert found.converged
    assert len(found.levels) == 1
    assert "the next mesh failed: Gmsh says: no" in found.verdict
    written = json.loads((folder / "result.json").read_text())
    assert written["quantities"]["normal_force"] == found.quantities["normal_force"]
    assert not written["accuracy"]["reached"]


@pytest.mark.serial
def test_given_penalty_is_named_and_automatic_one_made_smaller():
    given = ["contact.0.friction_coefficient=0", "accuracy=1e-3", *COARSE]
    scene = load_scene(SPHERE, [*given, "contact.0.penalty_parameter=2e-4"])
    found = run(scene, COMM)
    assert "contact.penalty_parameter is given" in found.accuracy["reason"]
    result = Run(load_scene(SPHERE, given), COMM).solve()
    errors = {"normal_force": {"mesh": 1e-3, "penalty": 5e-4, "total": 1.5e-3}}
    less = accuracy_asked.balanced(
        load_scene(SPHERE, given), result, errors, {"normal_force": 1e-3}
    )
    used = result.contacts[0]["parameters"]["penalty_parameter"]
    assert less.contact[0].penalty_parameter == pytest.approx(used / 5)


@pytest.mark.serial
def test_what_cannot_be_refined_or_estimated_is_said(tmp_path):
    scene = punch(2, strain_energy=1e-6)
    body = load_body(scene.mesh, 2, COMM)
    found = run(dataclasses.replace(scene, mesh=()), COMM, body)
    assert "quadrilaterals that are a mesh already cannot be refined" in found.accuracy["reason"]
    with refused("accuracy_of_no_quantity"):
        run(punch(2, main=1e-3), COMM)
    settings = dataclasses.replace(scene.solver, errors="none")
    with refused("accuracy_without_errors"):
        run(dataclasses.replace(scene, solver=settings), COMM)
    found = run(punch(4, strain_energy=1e-6, max_levels=1), COMM)
    assert "max_levels = 1" in found.accuracy["reason"]
    found = run(punch(4, strain_energy=1e-6, max_dofs=400), COMM)
    assert "max_dofs = 400" in found.accuracy["reason"]
    source = MeshSource(str(ROOT / "meshes" / "brick.geo"))
    brick = dataclasses.replace(
        scene,
        kinematics="3D",
        mesh=(source,),
        support=(Support("bottom", {"x": 0, "y": 0, "z": 0}), Support("top", {"z": -0.01})),
    )
    assert "use tetrahedra" in run(brick, COMM).accuracy["reason"]


def test_bare_triangles_reach_an_accuracy():
    body = box_body((4, 4), (1, 1), CellType.triangle)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}), Support("y1", {"x": 0, "y": -0.01})),
        accuracy=Accuracy(strain_energy=2e-3),
    )
    found, kept = run_with_fields(scene, COMM, body)
    assert found.accuracy["reached"]
    fine = run(dataclasses.replace(scene, accuracy=None), COMM, box_body((40, 40), (1, 1)))
    energy = found.quantities["strain_energy"]
    assert abs(energy / fine.quantities["strain_energy"] - 1) < 2e-3

    moved = kept.fields.displacement
    space = moved.function_space
    cells = space.mesh.topology.index_map(2).size_global
    assert len(found.levels) > 1 and cells == found.levels[-1].cells
    # Of the last mesh: its strains have the energy that was found.
    strain = ufl.sym(ufl.grad(moved))
    density = 1000 / 2.6 * (ufl.inner(strain, strain) + 0.75 * ufl.tr(strain) ** 2)
    local = fem.assemble_scalar(fem.form(density * ufl.dx))
    assert COMM.allreduce(local) == pytest.approx(energy, rel=1e-9)


@pytest.mark.serial
def test_script_of_commands_in_a_name_is_not_run(tmp_path):
    """A group's name could make a command of the geometry that is written out and read again."""
    file = Path(tmp_path) / "evil.geo"
    trace = Path(tmp_path) / "trace"
    name = f"""StrCat('a") = {{1}}; Sys', 'temCall "touch {trace}"; //')"""
    corners = ("0, 0", "1, 0", "1, 1", "0, 1")
    lines = [f"Point({i + 1}) = {{{corner}, 0}};" for i, corner in enumerate(corners)]
    lines += [f"Line({i + 1}) = {{{i + 1}, {(i + 1) % 4 + 1}}};" for i in range(4)]
    lines += ["Curve Loop(1) = {1, 2, 3, 4};", "Plane Surface(1) = {1};"]
    lines += [f"Physical Curve({name}) = {{1}};"]
    file.write_text("\n".join(lines))
    source = MeshSource(str(file), cell="triangle", size=0.5)
    old = cells_of(load_body(source, 2, MPI.COMM_SELF).mesh)
    field = SizeField.of(old, np.full(len(old.points), 0.2))
    assert len(load_body(source, 2, MPI.COMM_SELF, [field]).groups) == 2
    assert not trace.exists()
