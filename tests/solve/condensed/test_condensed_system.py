"""The condensed solver against the full one, and its parts against dense algebra."""

import dataclasses

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI
from scipy.sparse import csr_matrix, find

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Support,
    run,
)
from fenics_contact.common import mumps
from fenics_contact.common.errors import MachineError
from fenics_contact.common.factors import local_factor
from fenics_contact.common.timings import Timings
from fenics_contact.solve.condensed.condensed_loads import CondensedLoads
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.condensed.constant_tangent import ConstantTangent, OfSchur
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.condensed.tangent import UnknownsTangent
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness
from tests.messages import refused
from tests.scenes import box_body, with_solver
from tests.solve.condensed.stiff_and_soft import Split
from tests.solve.same_answer import require_same, solved

COMM = MPI.COMM_WORLD
TRIANGLE, TETRAHEDRON = mesh.CellType.triangle, mesh.CellType.tetrahedron
CLAMP = Support("y0", {"x": 0, "y": 0})


def pressed(kinematics="plane strain", degree=2, nu=0.3, driven=None, **contact):
    """A punch pressed into a block that stands on its clamped bottom."""
    axis = 2 if kinematics == "3D" else 1
    top = "xyz"[axis]
    shape = {"plane strain": "parabola", "plane stress": "parabola"}.get(kinematics, "paraboloid")
    middle = [0.0 if kinematics == "axisymmetric" else 0.5] * axis
    position = (*middle, 0.5 if kinematics == "3D" else 1.0)
    obstacle = Obstacle(shape, radius=3, position=position, **(driven or {"indentation": 0.02}))
    return Scene(
        kinematics=kinematics,
        material=Material(1000, nu),
        discretisation=Discretisation(degree=degree),
        support=(Support(f"{top}0", dict.fromkeys("xyz"[: axis + 1], 0)),),
        symmetry=("x0",) if kinematics == "axisymmetric" else (),
        contact=(Contact(f"{top}1", obstacle=obstacle, **contact),),
    )


def floor(**changes):
    """A block that lies on a rough floor, and is pressed down and pushed aside."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        load=(Load("y1", traction=(0.6, -10)),),
        contact=(Contact("y0", friction_coefficient=0.4),),
    )
    return dataclasses.replace(scene, **changes)


def half_space(nu=0.3, **driven):
    scene = pressed("axisymmetric", nu=nu, driven=driven)
    return dataclasses.replace(scene, support=(), half_space=HalfSpace(("y0", "x1")))


def half_plane(nu=0.3):
    """A force and a tangential resultant, both of one contact."""
    driven = {"force": 5.0, "displacement": (0.004, 0)}
    scene = pressed(nu=nu, driven=driven, friction_coefficient=0.3)
    return dataclasses.replace(scene, support=(), half_space=HalfSpace(("x0", "x1", "y0")))


SLIDING = {"indentation": 0.02, "displacement": (0.004, 0)}
STEPS = Steps(number=4)
SCENES = {
    "frictionless Q2": pressed(),
    "Q1": pressed(degree=1, friction_coefficient=0.5),
    "sliding obstacle": pressed(driven=SLIDING, friction_coefficient=0.3),
    "force": pressed(driven={"force": 5.0}, friction_coefficient=0.5),
    "incremental": dataclasses.replace(
        pressed(friction_coefficient=0.5, law="incremental"), steps=STEPS
    ),
    "axisymmetric": pressed("axisymmetric", friction_coefficient=0.6),
    "plane stress": pressed("plane stress", friction_coefficient=0.6),
    "nearly incompressible": pressed(nu=0.499, friction_coefficient=0.5),
    "nearly incompressible, force": pressed(nu=0.4999, driven={"force": 5.0}),
    "winkler": pressed(foundation_stiffness=1e4, friction_coefficient=0.5),
    "bonded": pressed(contact="bonded", driven={"indentation": 0.01}),
    "bonded, force": pressed(contact="bonded", driven={"force": 5.0}),
    "half-space": half_space(indentation=0.02),
    "half-space, force": half_space(force=5.0),
    "half-space, nearly incompressible": half_space(0.499, indentation=0.02),
    "half-plane, sheared": half_plane(),
    "half-plane, sheared, nearly incompressible": half_plane(0.499),
    "floor": floor(),
    "floor, moved support": floor(
        load=(), support=(Support("y1", {"x": 0.02, "y": -0.01}),), steps=STEPS
    ),
    "floor, two loads": floor(
        load=(
            Load("y1", traction=(0, -10), path=Path((0, 0.5, 1), (0, 1, 1))),
            Load("y1", traction=(2.0, 0), path=Path((0, 0.5, 1), (0, 0, 1))),
        ),
        steps=STEPS,
    ),
    "prescribed": floor(
        support=(CLAMP,),
        contact=(Contact("x0", pressure=5.0, friction_coefficient=0.3),),
    ),
    "two contacts": pressed(friction_coefficient=0.4),
}
SCENES["two contacts"] = dataclasses.replace(
    SCENES["two contacts"],
    support=(),
    contact=(
        *SCENES["two contacts"].contact,
        Contact("y0", friction_coefficient=0.3, name="floor"),
    ),
)


@pytest.mark.parametrize("name", SCENES)
def test_the_same_answer(name):
    require_same(SCENES[name], box_body((8, 8), (1, 1)))


@pytest.mark.parametrize("name", SCENES)
def test_the_same_with_stiff_and_soft_apart(name, monkeypatch):
    """As on contacts with many dofs."""
    split = Split(monkeypatch)
    require_same(SCENES[name], box_body((8, 8), (1, 1)))
    split.require_used()


@pytest.mark.parametrize(
    ("cell", "degree"), [(None, 1), (None, 2), (TETRAHEDRON, 1), (TETRAHEDRON, 2)]
)
def test_the_same_in_space_with_stiff_and_soft_apart(cell, degree, monkeypatch):
    split = Split(monkeypatch)
    scene = pressed("3D", degree, friction_coefficient=0.4)
    require_same(scene, box_body((4, 4, 2), cell=cell))
    split.require_used()


@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
def test_the_same_by_every_strategy(strategy):
    scene = with_solver(pressed(friction_coefficient=0.6), strategy=strategy)
    require_same(scene, box_body((8, 8), (1, 1)))


@pytest.mark.parametrize(
    ("cell", "degree"), [(None, 1), (None, 2), (TETRAHEDRON, 1), (TETRAHEDRON, 2)]
)
def test_the_same_in_space(cell, degree):
    scene = pressed("3D", degree, friction_coefficient=0.4)
    require_same(scene, box_body((4, 4, 2), cell=cell))


@pytest.mark.parametrize("nu", [0.3, 0.49])
@pytest.mark.parametrize(
    ("contact", "symmetry"),
    [({"friction_coefficient": 0.4}, ()), ({"contact": "bonded"}, ("y0",))],
    ids=["friction", "half, bonded"],
)
@pytest.mark.parametrize("driven", [{"force": 1.5}, {"indentation": 0.02}], ids=["force", "depth"])
def test_the_same_on_a_sheared_half_space(driven, contact, symmetry, nu):
    """Tangential resultants beside an obstacle's position, or beside the normal one."""
    half = bool(symmetry)
    middle = (0.5, 0.0 if half else 0.5)
    scene = pressed("3D", nu=nu, driven=driven | {"displacement": (0.003, 0, 0)}, **contact)
    obstacle = dataclasses.replace(scene.contact[0].obstacle, position=(*middle, 0.5))
    scene = dataclasses.replace(
        scene,
        support=(),
        symmetry=symmetry,
        contact=(dataclasses.replace(scene.contact[0], on="patch", obstacle=obstacle),),
        half_space=HalfSpace(("x0", "x1", "z0", "y1", *(() if half else ("y0",)))),
    )

    def is_near(x):
        return (np.abs(x[0] - middle[0]) < 0.3) & (np.abs(x[1] - middle[1]) < 0.3)

    made = require_same(scene, box_body((4, 4, 2), patches={"patch": ("z1", is_near)}))
    assert len(made.problem.unknowns) == (2 if half else 3)


@pytest.mark.parametrize("driven", [{"force": 1.5}, {"indentation": 0.02}], ids=["force", "depth"])
def test_the_same_where_a_contact_reaches_the_outer_boundary(driven):
    """Its points there move with the resultants, and its forces with them."""
    driven = driven | {"displacement": (0.003, 0.001, 0)}
    scene = pressed("3D", 1, driven=driven, contact="bonded")
    scene = dataclasses.replace(
        scene, support=(), half_space=HalfSpace(("x0", "x1", "y0", "y1", "z0"))
    )
    require_same(scene, box_body((4, 4, 2)))


@pytest.mark.parametrize(("degree", "nu"), [(1, 0.499), (2, 0.3), (2, 0.499)])
def test_the_same_on_triangles(degree, nu):
    scene = pressed(degree=degree, nu=nu, friction_coefficient=0.4)
    require_same(scene, box_body((8, 8), (1, 1), cell=TRIANGLE))


def test_contact_on_one_rank_alone():
    """The surface is a corner of the body; other ranks have none of it."""
    scene = pressed(friction_coefficient=0.4)
    obstacle = Obstacle("parabola", radius=3, position=(0.0, 1.0), indentation=0.02)
    contact = dataclasses.replace(scene.contact[0], on="corner", obstacle=obstacle)
    body = box_body((8, 8), (1, 1), patches={"corner": ("y1", lambda x: x[0] < 0.3)})
    require_same(dataclasses.replace(scene, contact=(contact,)), body)


def test_ranks_without_a_cell():
    """One cell: all ranks but one have none, and no unknowns at all."""
    require_same(SCENES["frictionless Q2"], box_body((1, 1), (1, 1)))


def test_the_bulk_is_factorised_once():
    """Over load steps and passes; the full solver factorises in every Newton step."""
    scene = SCENES["incremental"]
    counts = {}
    for solver in ("condensed", "full"):
        made = Run(with_solver(scene, solver=solver), COMM, box_body((8, 8), (1, 1)))
        made.problem.set_time(1.0)
        result = made.solve()
        counts[solver] = result.model["bulk_factorisations"]
        assert len(result.steps) == 4
    assert counts["condensed"] == 1
    assert counts["full"] >= sum(step["newton_iterations"] for step in result.steps)


def dense(stiffness):
    """K of all ranks together as a dense array, by the numbers of its unknowns."""
    coo = stiffness.matrix.tocoo()
    numbers = stiffness.numbers
    parts = COMM.allgather((numbers[coo.row], numbers[coo.col], coo.data))
    rows, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    size = int(max(rows.max(), columns.max())) + 1
    return csr_matrix((values, (rows, columns)), shape=(size, size)).toarray()


@pytest.mark.parametrize("kind", ["lu", "cholesky"])
@pytest.mark.parametrize("ordering", [mumps.MINIMUM_DEGREE, mumps.AUTOMATIC])
@pytest.mark.parametrize("nu", [0.3, 0.499])
def test_schur_complement_against_dense_elimination(nu, ordering, kind, monkeypatch):
    """By each factorisation that some size or machine gets."""
    chosen = mumps.Factorisation(kind, ordering)
    monkeypatch.setattr(mumps, "fastest", lambda is_plane, unknowns: chosen)
    problem = Run(pressed(nu=nu), COMM, box_body((6, 5), (1, 1))).problem
    system = CondensedSystem(problem, Timings())
    stiffness = LocalStiffness(problem.discrete)
    whole = dense(stiffness)
    index_map = problem.spaces.displacement_space.dofmap.index_map
    nodes = index_map.local_to_global((problem.constrained // 2).astype(np.int32))
    held = np.unique(np.concatenate(COMM.allgather(2 * nodes + problem.constrained % 2)))
    contact = system.dofs.free
    inside = np.setdiff1d(np.arange(len(whole)), np.union1d(held, contact))
    left = np.linalg.solve(whole[np.ix_(inside, inside)], whole[np.ix_(inside, contact)])
    expected = whole[np.ix_(contact, contact)] - whole[np.ix_(contact, inside)] @ left
    bulk = CondensedBulk(stiffness, system.held, contact)
    if COMM.rank == 0:
        assert np.abs(bulk.schur - expected).max() <= 1e-11 * np.abs(expected).max()
    else:
        assert bulk.schur is None
    system.destroy()
    bulk.destroy()


class CountingBulk:
    """Condenses loads by a matrix, and counts."""

    def __init__(self, size):
        self.comm, self.count, self.solves = COMM, 3, 0
        self.matrix = np.random.default_rng(1).normal(size=(3, size))

    def condense(self, load):
        self.solves += 1
        return self.matrix @ load


@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_round_off_of_the_bulk_is_that_of_each_product(nu):
    """20 × machine epsilon × Σ |K_ij| |u_j| over the displacements' rows, of all ranks' cells."""
    problem = Run(pressed(nu=nu), COMM, box_body((6, 5), (1, 1))).problem
    stiffness = LocalStiffness(problem.discrete)
    values = np.sin(1.0 + stiffness.numbers)
    products = np.abs(stiffness.matrix.toarray()) * np.abs(values)
    own = products[: len(stiffness.displacements)].sum()
    expected = 20 * np.finfo(float).eps * COMM.allreduce(own)
    assert stiffness.round_off(values) == pytest.approx(expected, rel=1e-12)
    assert stiffness.round_off(2 * values) == pytest.approx(2 * expected, rel=1e-12)


def test_combinations_of_known_loads_cost_no_solve():
    bulk = CountingBulk(5)
    loads = CondensedLoads(bulk)
    first, second = np.arange(5.0), np.array([1e6, 0, 0, 1.0, 2e-3])
    for load in (first, second, 3 * first, 0.1 * first - 7 * second, 0 * first):
        assert loads.condense(load) == pytest.approx(bulk.matrix @ load, rel=1e-11, abs=1e-9)
    assert bulk.solves == 2
    loads.condense(np.ones(5))
    assert bulk.solves == 3


@pytest.mark.parametrize("derived", [0, 3])
@pytest.mark.parametrize("free", [0, 2])
@pytest.mark.parametrize("stiffness", [1.0, 1e9])
@pytest.mark.parametrize("is_large", [False, True])
def test_tangent_against_a_plain_solve(free, stiffness, derived, is_large, monkeypatch):
    """Whatever is in contact, also where S lets the body move and the penalty is stiff."""
    if is_large:
        Split(monkeypatch)
    random = np.random.default_rng(2)
    root = random.normal(size=(12, 12 - free))
    schur, columns = root @ root.T, random.normal(size=(12, 1))
    rows = random.normal(size=(derived, 12))
    every = np.vstack([np.eye(13), np.hstack([rows, np.zeros((derived, 1))])])
    constant = ConstantTangent(columns, np.array([1.0]), rows, OfSchur(schur.copy()))
    tangent = UnknownsTangent(constant, np.arange(12) // 3)
    whole = np.zeros((13, 13))
    whole[:12, :12], whole[:12, 12:], whole[12, 12] = schur, columns, 1.0
    for active in (range(4), range(12), range(5, 9), [2, 3, *range(13, 13 + derived)]):
        spring = np.zeros((13 + derived, 13 + derived))
        part = random.normal(size=(len(active), len(active)))
        spring[np.ix_(active, active)] = stiffness * (part @ part.T)
        tangent.set(find(spring))
        spring = every.T @ spring @ every
        right = random.normal(size=13)
        found = tangent.solve(right)
        # A derived jump is a difference of displacements, which a stiff spring nearly cancels.
        lost = 1e-15 * tangent.magnitude(np.abs(found)) if derived else 0.0
        expected = pytest.approx((whole + spring) @ found, rel=1e-9, abs=lost)
        assert tangent.multiply(found) == expected
        for matrix, answer in (
            (whole + spring, found),
            ((whole + spring).T, tangent.solve_transposed(right)),
        ):
            left = np.abs(matrix @ answer - right).max()
            assert left <= 1e-9 * np.abs(matrix).max() * np.abs(answer).max()


def test_a_compliance_that_an_earlier_answer_found_is_used_at_once():
    """Also on many contact dofs, where a first answer splits them into stiff and soft."""
    random = np.random.default_rng(5)
    root, none = random.normal(size=(450, 450)), np.zeros((0, 450))
    schur = root @ root.T + 450 * np.eye(450)
    constant = ConstantTangent(none.T.copy(), np.zeros(0), none, OfSchur(schur.copy()))
    first = UnknownsTangent(constant, np.arange(450) // 3)
    assert not constant.of_schur.knows_compliance
    assert first.compliance is not None
    later = ConstantTangent(none.T.copy(), np.zeros(0), none, constant.of_schur)
    tangent = UnknownsTangent(later, np.arange(450) // 3)
    spring = np.zeros((450, 450))
    spring[range(9), range(9)] = 1e7
    tangent.set(find(spring))
    right = random.normal(size=450)
    found = tangent.solve(right)
    np.testing.assert_allclose(found, np.linalg.solve(schur + spring, right), rtol=1e-8, atol=1e-14)
    assert not tangent._is_split


def test_singular_tangent_is_no_number_instead_of_a_wrong_one():
    none = np.zeros((0, 2))
    constant = ConstantTangent(none.T.copy(), np.zeros(0), none, OfSchur(np.diag([1.0, 0.0])))
    tangent = UnknownsTangent(constant, np.zeros(2, dtype=np.int64))
    tangent.set(find(np.zeros((2, 2))))
    assert np.isnan(tangent.solve(np.ones(2))).all()


def test_obstacle_that_only_held_nodes_touch():
    """No displacement of the contact is free: the obstacle's position alone is unknown."""
    obstacle = Obstacle("plane", position=(0, 4), force=1.0)
    scene = floor(
        discretisation=Discretisation(degree=1),
        support=(Support("x0", {"x": 0, "y": 0}), Support("x1", {"x": 0, "y": 0})),
        load=(Load("y0", traction=(0, 1)),),
        contact=(Contact("y1", contact="bonded", obstacle=obstacle),),
    )
    body = box_body((1, 4), (1, 4))
    (_, by_full), (_, found) = (solved(scene, body, kind) for kind in ("full", "condensed"))
    assert found.quantities["indentation"] == pytest.approx(by_full.quantities["indentation"])


def test_failed_factorisation_is_an_error_on_every_rank(monkeypatch):
    """MUMPS runs out of workspace on the last rank; S would be anything."""
    plain = local_factor._of_mumps

    def without_memory(operator, kind):
        found = plain(operator, kind)
        found.getFactorMatrix().setMumpsIcntl(23, 1)  # megabytes
        return found

    if COMM.rank == COMM.size - 1:
        monkeypatch.setattr(local_factor, "_of_mumps", without_memory)
        monkeypatch.setattr(mumps, "SPARE_WORKSPACE", (-90, -80))
    scene = with_solver(pressed(), solver="condensed")
    with refused("mumps_out_of_memory", MachineError):
        Run(scene, COMM, box_body((40, 40), (1, 1))).solve()


def test_linear_problems_need_no_condensation():
    scene = dataclasses.replace(floor(), support=(CLAMP,), contact=())
    result = run(scene, COMM, box_body((4, 4), (1, 1)))
    assert result.passed
    assert result.model["solver"] == "full"
