"""Several bodies in one mesh: where they come from, and what is known of each by itself."""

import dataclasses
import json
import re

import basix.ufl
import dolfinx
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.mesh import compute_midpoints
from mpi4py import MPI

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    NoEquilibriumError,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
    load_scene,
    main,
)
from fenics_contact.body.connected_parts import Parts
from fenics_contact.common.parallel import gather_rows
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.mesh.loading import load_body
from fenics_contact.problem.rigid_motions import RigidMotions, apart, rigid_fields
from fenics_contact.results.result import Check
from fenics_contact.trust.comparison import nearer_to_failing
from fenics_contact.trust.resultant_checks import equilibrium
from tests.messages import refused
from tests.scenes import SLAB
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD


def write(folder, name, text):
    path = folder / name
    if COMM.rank == 0:
        path.write_text(text)
    COMM.barrier()
    return str(path)


def rectangle(x, y, size=(2, 1), groups=True):
    """A geometry of a rectangle with Gmsh's own numbers, or with named groups as well."""
    text = f'SetFactory("OpenCASCADE");\nRectangle(1) = {{{x}, {y}, 0, {size[0]}, {size[1]}}};\n'
    if groups:
        text += 'Physical Surface("body") = {1};\nPhysical Curve("bottom") = {1};\n'
        text += 'Physical Curve("right") = {2};\nPhysical Curve("top") = {3};\n'
    return text


def two(folder, **of_upper):
    """An upper and a lower body, which touch along a line but share no node."""
    upper = MeshSource(write(folder, "u.geo", rectangle(0, 1)), size=0.4, name="upper")
    lower = MeshSource(write(folder, "l.geo", rectangle(0, 0)), size=0.3, name="lower")
    return dataclasses.replace(upper, **of_upper), lower


def scene_of(meshes, names, **others):
    """Each body on its own bottom, pulled at its right and pressed from above, as it may be."""
    given = {
        "upper": (Support("upper.bottom", {"x": 0, "y": 0}), Load("upper.right", pressure=-7)),
        "lower": (Support("lower.bottom", {"x": 0, "y": 0.1}), Load("lower.top", (3, -2))),
    }
    stiff = {"upper": Material(1000, 0.3, on="upper"), "lower": Material(50, 0.2, on="lower")}
    return Scene(
        kinematics="plane strain",
        mesh=meshes,
        material=tuple(stiff[name] for name in names),
        support=tuple(given[name][0] for name in names),
        load=tuple(given[name][1] for name in names),
        **others,
    )


def with_plain_names(scene):
    """The scene of a single mesh, where groups keep their own names."""
    prefix = f"{scene.mesh[0].name}."
    plain = {
        key: tuple(
            dataclasses.replace(part, on=part.on.removeprefix(prefix))
            for part in getattr(scene, key)
        )
        for key in ("support", "load")
    }
    return dataclasses.replace(scene, **plain)


def displacements(prepared):
    """Coordinates and displacements of all nodes, part by part: part → sorted rows."""
    spaces, owned = prepared.problem.spaces, prepared.problem.spaces.owned_nodes
    found = prepared.solution.displacement[:owned]
    part = spaces.parts.of_node[:owned, None].astype(float)
    rows = gather_rows(COMM, np.hstack([part, spaces.coordinates[:owned].round(9), found]))
    rows = rows[np.lexsort(rows[:, :4].T)]
    return [rows[rows[:, 0] == number, 1:] for number in range(spaces.parts.count)]


def solved(scene, body=None):
    prepared = Run(scene, COMM, body)
    assert prepared.solve().passed
    return prepared


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_two_bodies_together_move_as_each_alone(folder, solver):
    upper, lower = two(folder)
    settings = SolverSettings(solver=solver)
    together = solved(scene_of((upper, lower), ("upper", "lower"), solver=settings))
    assert together.model["bodies"] == ["upper", "lower"]
    for number, mesh in enumerate((upper, lower)):
        name = mesh.name
        alone = solved(with_plain_names(scene_of((mesh,), (name,), solver=settings)))
        assert alone.model["bodies"] == [name]
        rows, expected = displacements(together)[number], displacements(alone)[0]
        assert rows.shape == expected.shape
        assert np.abs(rows - expected).max() < 1e-10 * np.abs(expected[:, 3:]).max()
        assert np.abs(expected[:, 3:]).max() > 1e-3


def test_a_scene_file_of_two_meshes(folder, capfd):
    """Relative files, parameters, overrides; one material fills both; check names the bodies."""
    write(folder, "u.geo", rectangle(0, 1))
    text = f"""
kinematics = "plane strain"
material = {{ youngs_modulus = 1000, poissons_ratio = 0.3 }}
[[mesh]]
name = "upper"
file = "u.geo"
size = 0.5
cell = "triangle"
[[mesh]]
name = "lower"
file = "{SLAB}"
cell = "triangle"
parameters = {{ cells_along = 4 }}
[[support]]
on = "upper.bottom"
displacement = {{ x = 0, y = 0 }}
[[support]]
on = "lower.bottom"
displacement = {{ x = 0, y = 0 }}
[[load]]
on = "lower.slab"
body_force = [1, 0]
"""
    path = write(folder, "scene.toml", text)
    scene = load_scene(path, ["mesh.1.parameters.cells_along=2"])
    assert [mesh.file for mesh in scene.mesh] == [str(folder / "u.geo"), SLAB]
    assert scene.mesh[1].parameters == {"cells_along": 2}
    upper = load_body(scene.mesh[0], 2, COMM).mesh.topology.index_map(2).size_global
    body = load_body(scene.mesh, 2, COMM)
    assert body.mesh.topology.index_map(2).size_global == upper + 2 * 2
    assert body.source == f"{folder / 'u.geo'} and {SLAB}"
    out = folder / "out"
    assert main(["run", path, "--out", str(out), "--quiet"]) == 0
    found = json.loads((out / "result.json").read_text())
    assert found["model"]["bodies"] == ["upper", "lower"]
    capfd.readouterr()
    assert main(["check", path]) == 0
    said = COMM.bcast(capfd.readouterr().out)
    assert re.search(r"bodies +upper, lower", said)


def test_numbers_of_unnamed_groups_take_the_name_too(folder):
    upper, lower = (
        MeshSource(write(folder, f"{n}.geo", rectangle(0, y, groups=False)), size=1, name=n)
        for n, y in (("upper", 1), ("lower", 0))
    )
    body = load_body((upper, dataclasses.replace(lower, groups={"side": (2, 3)})), 2, COMM)
    assert {"upper", "upper.body", "lower", "lower.body", "lower.side"} == set(body.groups)
    facets = body.entities(body.group("upper.3", "on"))
    heights = compute_midpoints(body.mesh, 1, facets)[:, 1]
    assert COMM.allreduce(len(heights)) > 0 and (heights == 2).all()
    with refused("no_group_3_of_several_meshes"):
        body.group("3", "load[0].on")


def test_one_mesh_keeps_the_names_of_its_groups(folder):
    upper, _ = two(folder)
    body = load_body(upper, 2, COMM)
    assert set(body.groups) == {"upper", "body", "bottom", "right", "top"}
    named = load_body(dataclasses.replace(upper, name="body"), 2, COMM)
    assert set(named.groups) == {"body", "bottom", "right", "top"}
    with refused("mesh_name_is_a_group"):
        load_body(dataclasses.replace(upper, name="top"), 2, COMM)


def test_names_that_do_not_tell_meshes_apart_are_refused(folder):
    upper, lower = two(folder)
    for wrong, message in (
        ("", "mesh_name_is_missing"),
        ("upper", "two_meshes_of_one_name"),
    ):
        with refused(message, ValueError):
            scene_of((upper, dataclasses.replace(lower, name=wrong)), ("upper", "lower"))
    with refused("mesh_name_has_a_dot", ValueError):
        MeshSource("a.geo", name="a.b")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"file": "nowhere.geo"}, "no_mesh_file_nowhere"),
        ({"parameters": {"n": 1}}, "no_such_constant_of_one_mesh"),
        ({"groups": {"side": (9,)}}, "no_curve_9"),
        ({"groups": {"top": (1,)}}, "group_is_there_already"),
    ],
)
def test_what_is_wrong_with_one_of_the_meshes(folder, change, message):
    with refused(message):
        load_body(two(folder, **change), 2, COMM)


def test_a_script_that_is_refused_is_named_by_its_mesh(folder):
    upper, lower = two(folder)
    bad = MeshSource(write(folder, "b.geo", 'SystemCall "ls";'), name="bad")
    with refused("statement_of_third_mesh_refused"):
        load_body((upper, lower, bad), 2, COMM)


def test_group_of_another_mesh_or_without_its_mesh(folder):
    upper, lower = two(folder)
    scene = scene_of((upper, lower), ("upper", "lower"))
    for wrong, said in (("bottom", "no_group_bottom"), ("lower.left", "no_group_left_of_lower")):
        with refused(said):
            Run(dataclasses.replace(scene, support=(Support(wrong, {"x": 0}),)), COMM)
    with refused("cells_without_material"):
        Run(dataclasses.replace(scene, material=scene.material[:1]), COMM)


def strips(cells, rows, scattered=False):
    """Row i of square cells from y = 2i on; scattered, neighbours are of different ranks."""
    points = [(x, 2.0 * row + y) for row in range(rows) for x in range(cells + 1) for y in (0, 1)]
    starts = [2 * ((cells + 1) * row + cell) for row in range(rows) for cell in range(cells)]
    quadrilaterals = np.add.outer(starts, [0, 2, 1, 3])
    here = slice(None) if COMM.rank == 0 else slice(0)

    def scatter(comm, size, kinds, given):
        destinations = np.arange(len(given[0]) // 4, dtype=np.int32)[:, None] % size
        made = dolfinx.graph.adjacencylist(destinations)
        return getattr(made, "_cpp_object", made)  # from dolfinx 0.10 on

    mesh = dolfinx.mesh.create_mesh(
        COMM,
        cells=quadrilaterals[here].astype(np.int64),
        x=np.array(points)[here],
        e=ufl.Mesh(basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(2,))),
        **({"partitioner": scatter} if scattered else {}),
    )
    return Body(mesh, None, None, {})


def parts_of(body, components=2):
    """The parts, and the nodes of this rank with how many it owns, of degree 2."""
    space = fem.functionspace(body.mesh, ("Lagrange", 2, (components,)))
    return (
        Parts(body, space),
        space.tabulate_dof_coordinates(),
        space.dofmap.index_map.size_local,
    )


@pytest.mark.parametrize("scattered", [False, True])
@pytest.mark.parametrize(("cells", "rows"), [(40, 2), (1, 60), (3, 7), (6, 1), (1, 2), (1, 1)])
def test_parts_are_the_same_however_the_cells_are_dealt_out(cells, rows, scattered):
    """Row i is part i, also where each rank holds but pieces of it, or nothing at all."""
    parts, points, owned = parts_of(strips(cells, rows, scattered))
    assert parts.names == tuple(f"part {i + 1}" for i in range(rows))
    row = points[:, 1].round() // 2
    assert (parts.of_node == row).all()
    assert parts.sums(np.ones(owned)) == pytest.approx(3 * (2 * cells + 1))
    assert parts.sizes == pytest.approx(cells / 2)
    middle = np.column_stack([np.full(len(points), cells / 2), 2 * row + 0.5])
    assert np.abs(parts.arms[:, :2] - (points[:, :2] - middle)).max(initial=0.0) < 1e-12


def test_partitions_of_these_tests_are_the_hard_ones():
    """A rank with no cell of a part, a rank with no cell, and parts in pieces."""

    def cells_held(body):
        cells = body.mesh.topology.index_map(2)
        return COMM.allgather(cells.size_local + cells.num_ghosts)

    assert COMM.size == 1 or max(cells_held(strips(1, 2, True))) == 1
    assert COMM.size == 1 or min(cells_held(strips(1, 1))) == 0
    pieces = connected_pieces(strips(40, 2, True))
    assert COMM.size == 1 or min(COMM.allgather(pieces)) > 2


def connected_pieces(body):
    """How many pieces this rank's cells make by themselves: those without one to their right."""
    cells = body.mesh.topology.index_map(2)
    numbers = np.arange(cells.size_local + cells.num_ghosts, dtype=np.int32)
    x = dolfinx.mesh.compute_midpoints(body.mesh, 2, numbers)
    return sum(not (np.abs(x - (a + 1, b, c)).max(axis=1) < 0.1).any() for a, b, c in x)


def test_bodies_that_touch_are_two_and_that_share_a_node_are_one(folder):
    text = "".join(
        f"Point({number}) = {{{x}, {y}, 0}};\n"
        for number, (x, y) in enumerate([(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1)], 1)
    )
    for first, corners in ((1, (1, 2, 3)), (4, (1, 4, 5))):
        for side in range(3):
            text += f"Line({first + side}) = {{{corners[side]}, {corners[(side + 1) % 3]}}};\n"
        text += f"Curve Loop({first}) = {{{first}, {first + 1}, {first + 2}}};\n"
        text += f"Plane Surface({first}) = {{{first}}};\n"
    source = MeshSource(write(folder, "corner.geo", text), size=0.3)
    assert parts_of(load_body(source, 2, COMM))[0].names == ("body",)
    upper, lower = two(folder)
    touching = load_body((lower, upper), 2, COMM)
    assert parts_of(touching)[0].names == ("lower", "upper")


def test_names_of_the_parts_of_one_mesh(folder):
    """A group that is just a part names it; one of several parts, or of half a part, does not."""
    text = 'SetFactory("OpenCASCADE");\n'
    for number, x in enumerate((0, 1, 3, 5, 7)):  # the first two share a side
        text += f"Rectangle({number + 1}) = {{{x}, 0, 0, 1, 1}};\n"
    text += "Coherence;\n"
    text += 'Physical Surface("all") = {1, 2, 3, 4, 5};\nPhysical Surface("half") = {1};\n'
    text += 'Physical Surface("both") = {3, 4};\nPhysical Surface("last") = {5};\n'
    text += 'Physical Surface("too") = {5};\n'
    body = load_body(MeshSource(write(folder, "g.geo", text), size=0.6), 2, COMM)
    parts, points, _ = parts_of(body)
    last = parts.names.index("last")  # Gmsh decides on its place
    assert parts.names == tuple("last" if i == last else f"part {i + 1}" for i in range(4))
    assert ((points[:, 0] > 6.5) == (parts.of_node == last)).all()


def test_free_motions_are_those_of_each_body(folder):
    scene = scene_of(two(folder), ("upper", "lower"))
    spaces = Run(scene, COMM).problem.spaces
    nowhere = Run(dataclasses.replace(scene, load=()), COMM).problem
    assert RigidMotions(nowhere).count == 0
    names, fields = rigid_fields(spaces)
    assert len(names) == 3
    each = apart(spaces.parts, fields)
    assert (each[spaces.parts.of_node == 0][..., 3:] == 0).all()
    assert (each[spaces.parts.of_node == 1][..., :3] == 0).all()
    assert (each[..., :3] + each[..., 3:] == fields).all()


@pytest.mark.parametrize(
    ("supports", "motion"),
    [
        (("upper", "x"), "translation along y of 'upper'"),
        (("lower", "y"), "translation along x of 'lower'"),
    ],
)
def test_a_body_that_nothing_holds_is_named(folder, supports, motion):
    name, axis = supports
    scene = scene_of(two(folder), ("upper", "lower"))
    loose = tuple(Support(s.on, {axis: 0}) if s.on.startswith(name) else s for s in scene.support)
    # All of the body along one axis: no rotation is left.
    loose = (*loose, Support(name, {axis: 0}))
    push = Load(f"{name}.right", traction=(1, 1))
    with refused("motion_is_pushed", NoEquilibriumError, motion=motion):
        Run(dataclasses.replace(scene, support=loose, load=(push,)), COMM)


def slabs(folder, upper_force, lower_force):
    """Two blocks that slide along x on pads of bound 1, which hold 2 each."""
    scene = scene_of(two(folder), ("upper", "lower"))
    return dataclasses.replace(
        scene,
        support=(Support("upper", {"y": 0}), Support("lower", {"y": 0})),
        load=(
            Load("upper.right", traction=(upper_force, 0)),
            Load("lower.right", traction=(lower_force, 0)),
        ),
        contact=(
            Contact("upper.top", pressure=2, friction_coefficient=0.5),
            Contact("lower.bottom", pressure=4, friction_coefficient=0.25),
        ),
    )


def test_friction_of_one_body_does_not_hold_the_other(folder):
    """Together the pads hold 4: the whole as one rigid body would use less than its limit."""
    prepared = Run(slabs(folder, 1.8, 0), COMM)
    assert prepared.free_motion.modes == 2
    assert prepared.free_motion.used_share == pytest.approx(0.9, rel=1e-9)
    assert prepared.free_motion.motion == "translation along x of 'upper'"
    result = prepared.solve()
    assert result.passed
    found = [contact["quantities"]["friction_force"][0] for contact in result.contacts]
    assert found == pytest.approx([-1.8, 0], abs=1e-8)
    said = {"motion": "translation along x of 'lower'", "share": "1.1"}
    with refused("loads_exceed_friction", NoEquilibriumError, **said):
        Run(slabs(folder, -0.2, 2.2), COMM)


BOX_SIDES = ("box.bottom", "box.top", "box.side")


def box(folder, name, z):
    """A geometry of a block of 1 × 1 × 0.5 from z on."""
    text = f'SetFactory("OpenCASCADE");\nBox(1) = {{0, 0, {z}, 1, 1, 0.5}};\n'
    source = MeshSource(write(folder, f"{name}.geo", text), size=0.25, name=name)
    return dataclasses.replace(source, groups={"bottom": (5,), "top": (6,), "side": (2,)})


BARE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 5 0 0
2 6 0 0
3 5 1 0
4 5 0 1
$EndNodes
$Elements
1
1 4 2 1 1 1 2 3 4
$EndElements
"""


def test_a_mesh_without_any_facets_beside_one_with(folder):
    bare = MeshSource(write(folder, "bare.msh", BARE), name="bare")
    body = load_body((bare, box(folder, "box", 0)), 3, COMM)
    found = {f"bare.side_{number}" for number in range(1, 5)}  # of the tetrahedron, by angle
    assert set(body.groups) == {"bare", "bare.1", "box", "box.body", *BOX_SIDES, *found}
    assert parts_of(body, 3)[0].names == ("bare", "box")
    facets = body.entities(body.boundary("box.top", "on"))
    assert (compute_midpoints(body.mesh, 2, facets)[:, 2] == 0.5).all()


@pytest.mark.parametrize("degree", [1, 2])
def test_iterative_solver_with_a_body_that_only_contact_holds(folder, degree):
    """Supports of the one do not keep multigrid's matrix of the other from being singular."""
    scene = Scene(
        kinematics="3D",
        mesh=(box(folder, "held", 0), box(folder, "loose", 2)),
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=(Support("held.bottom", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("held.side", traction=(0, 1, 2)), Load("loose.top", traction=(0.5, 0, -4))),
        contact=(
            Contact(
                "loose.bottom",
                obstacle=Obstacle("plane", position=(0, 0, 2), normal=(0, 0, 1)),
                friction_coefficient=0.4,
                regularisation_parameter=1e-6,
            ),
        ),
    )
    answers = []
    for solver in ("full", "iterative"):
        settings = SolverSettings(solver=solver, strategy="monolithic")
        answers.append(displacements(solved(dataclasses.replace(scene, solver=settings))))
    for full, iterative in zip(*answers, strict=True):
        assert np.abs(full - iterative).max() < 1e-7 * np.abs(full[:, 3:]).max()


def test_equilibrium_fails_for_errors_that_cancel_in_the_sum_over_bodies(folder):
    """Equal and opposite forces missing at two points of one place, one of each body."""
    scene = scene_of(two(folder), ("upper", "lower"))
    support = (scene.support[0], Support("lower.top", {"x": 0, "y": 0.1}))
    load = (scene.load[0], Load("lower.right", traction=(3, -2)))
    prepared = solved(dataclasses.replace(scene, support=support, load=load))
    problem, solution = prepared.problem, prepared.solution
    spaces = problem.spaces

    def check_of(wrong):
        forces = BulkForces(problem, wrong)
        given = (problem.load + forces.reactions)[: spaces.owned_nodes]
        return equilibrium(forces), spaces.parts.sums(given)

    assert check_of(solution)[0].passed
    corner = np.abs(spaces.coordinates - (0, 1, 0)).max(axis=1) < 1e-9
    internal = solution.internal_force.copy()
    for part, force in enumerate((0.01, -0.01)):
        internal[corner & (spaces.parts.of_node == part)] += force
    check, left = check_of(with_body(solution, internal_force=internal))
    assert np.abs(left.sum(axis=0)).max() < 1e-9
    assert np.abs(left[0]) == pytest.approx(0.01, rel=1e-6)
    assert not check.passed


def test_moments_are_taken_about_each_body(folder):
    """A couple missing in one body that the other's makes up for."""
    upper, lower = two(folder)
    scene = scene_of((upper, lower), ("upper", "lower"))
    support = (scene.support[0], Support("lower.top", {"x": 0, "y": 0.1}))
    load = (scene.load[0], Load("lower.right", traction=(3, -2)))
    prepared = solved(dataclasses.replace(scene, support=support, load=load))
    problem, solution = prepared.problem, prepared.solution
    spaces = problem.spaces
    internal = solution.internal_force.copy()
    for part, sign in enumerate((1, -1)):
        for x, force in ((0, 0.01), (2, -0.01)):
            there = np.abs(spaces.coordinates - (x, 1, 0)).max(axis=1) < 1e-9
            internal[there & (spaces.parts.of_node == part), 1] += sign * force
    forces = BulkForces(problem, with_body(solution, internal_force=internal))
    assert not equilibrium(forces).passed


def test_a_value_that_is_not_a_number_is_not_passed_over():
    lost, good = Check(np.nan, 1.0), Check(0.5, 1.0)
    assert nearer_to_failing(lost, good) is lost
    assert nearer_to_failing(good, lost) is lost
    assert nearer_to_failing(good, Check(0.4, 0.5)).limit == 0.5
