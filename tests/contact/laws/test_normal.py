"""The terms across a contact: energy, residual and tangent; what results say of them."""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Support, run
from fenics_contact.problem.problem import Problem
from tests.messages import refused
from tests.scenes import box_body
from tests.solve.matrices import product

COMM = MPI.COMM_WORLD


def pad(dimension, kind="unilateral", degree=2, **keys):
    face = f"{'xyz'[dimension - 1]}0"
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(100, 0.3),
        discretisation={"degree": degree},
        contact=(Contact(face, contact=kind, obstacle=Obstacle(gap=lambda x: 0.1 * x[0]), **keys),),
    )
    return Problem.on_mesh(scene, box_body((3, 2, 2)[:dimension]))


def set_state(problem, x):
    """Closed on one half of the surface, open on the other, away from the kink."""
    surface = problem.contacts[0].trace.surface
    points = surface.coordinates
    state = np.zeros((len(points), surface.components))
    state[:, -1] = np.where(points[:, 0] < 0.4, -0.3, 0.2)
    state[:, 0] = 0.1 * points[:, 0]
    problem.contacts[0].kinematics.move(state + np.reshape(x, (-1, state.shape[1])))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kind", ["unilateral", "winkler", "bonded"])
def test_residual_and_tangent_are_derivatives_of_the_energy(dimension, degree, kind):
    keys = {"foundation_stiffness": lambda x: 3 + x[0]} if kind == "winkler" else {}
    if kind != "winkler":
        keys["penalty_parameter"] = 0.25
    problem = pad(dimension, kind, degree, **keys)
    contact = problem.contacts[0]
    trace, spaces = contact.trace, contact.trace.surface
    energy = fem.form(contact.normal.energy)
    points = spaces.coordinates
    shift = np.stack([np.sin(3 * points[:, 0] + i) for i in range(spaces.components)], axis=1)
    owned = slice(0, spaces.owned_nodes)

    def evaluate(step):
        set_state(problem, step * shift)
        value = COMM.allreduce(fem.assemble_scalar(energy))
        density = contact.trace.integral(contact.state().penalty_energy)
        assert value == pytest.approx(density, rel=1e-12)  # results use the same quadrature
        return value, spaces.assemble(contact.normal.residual)

    value, slope = evaluate(0.0)
    matrix = fem.assemble_matrix(contact.normal.tangent)
    matrix.scatter_reverse()
    change = product(matrix, shift.ravel()).reshape(-1, spaces.components)[owned]
    work = COMM.allreduce(np.sum(slope[owned] * shift[owned]))
    curvature = COMM.allreduce(np.sum(change * shift[owned]))
    moved, force = evaluate(1e-3)
    # Away from the kink the energy is quadratic.
    assert moved - value == pytest.approx(1e-3 * work + 0.5e-6 * curvature, rel=1e-9)
    difference = COMM.allreduce(np.abs((force - slope)[owned] - 1e-3 * change).sum())
    assert difference < 1e-9 * COMM.allreduce(np.abs(change).sum())
    # Forces act on the body against the residual: pressure pushes along −n.
    set_state(problem, 0 * shift)
    state = contact.state()
    pushed = -COMM.allreduce(spaces.assemble(contact.normal.residual)[owned].sum(axis=0))
    traction = state.friction_traction - state.contact_pressure[:, None] * trace.normals
    assert pushed == pytest.approx(trace.integral(traction), rel=1e-9, abs=1e-9)


def block(kind="unilateral", load=((0, -10),), obstacle=None, cells=(4, 4), **keys):
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0}),),
        load=tuple(Load("y1", traction=vector) for vector in load),
        contact=(Contact("y0", contact=kind, obstacle=obstacle, **keys),),
    )
    return scene, lambda comm: box_body(cells, (1, 1), comm=comm)


def solved(scene_and_body, comm=COMM):
    scene, body = scene_and_body
    return run(scene, comm, body(comm))


@pytest.mark.parametrize("degree", [1, 2])
def test_uniform_pressure_is_exact(degree):
    scene, body = block()
    scene = Scene(**(scene.__dict__ | {"discretisation": {"degree": degree}}))
    result = run(scene, COMM, body(COMM))
    assert result.passed
    assert result.points.contact_pressure == pytest.approx(10, rel=1e-8)
    assert result.quantities["normal_force"] == pytest.approx(10, rel=1e-10)
    assert result.quantities["contact_area"] == pytest.approx(1, rel=1e-12)
    assert result.quantities["slip_area"] == pytest.approx(1, rel=1e-12)
    assert (result.points.status == "SLIP").all()


def test_winkler_sinks_by_force_over_stiffness_and_stores_energy():
    result = solved(block("winkler", foundation_stiffness=40))
    assert -result.points.gap == pytest.approx(10 / 40, rel=1e-9)
    assert result.quantities["penalty_energy"] == pytest.approx(0.5 * 40 * 0.25**2, rel=1e-9)
    assert result.contacts[0]["parameters"]["foundation_stiffness"] == 40
    assert "penetration" not in result.checks


def test_bonded_holds_tension_and_shear():
    result = solved(block("bonded", load=((3, 10),)))
    assert result.quantities["normal_force"] == pytest.approx(-10, rel=1e-8)
    assert result.contacts[0]["law"] == "stick"
    assert (result.points.status == "STICK").all()
    assert result.quantities["stick_area"] == pytest.approx(1)
    assert result.quantities["friction_force"][0] + result.quantities["reaction"][
        0
    ] == pytest.approx(-3, rel=1e-8)


def test_energies_balance_under_dead_loads():
    """Linear problem: stored energy is half the work of the forces at their ends."""
    result = solved(block("winkler", foundation_stiffness=40))
    stored = result.quantities["strain_energy"] + result.quantities["penalty_energy"]
    assert stored == pytest.approx(0.5 * result.quantities["external_work"], rel=1e-9)


def test_obstacle_in_work_balance():
    """A driven obstacle works on the body: F d / 2 where everything stays in contact."""
    obstacle = Obstacle("plane", position=(0, 0), indentation=0.01)
    scene, body = block(load=(), obstacle=obstacle)
    scene = Scene(**(scene.__dict__ | {"support": (Support("y1", {"x": 0, "y": 0}),)}))
    result = run(scene, COMM, body(COMM))
    stored = result.quantities["strain_energy"] + result.quantities["penalty_energy"]
    assert result.quantities["external_work"] == pytest.approx(
        result.quantities["normal_force"] * 0.01, rel=1e-9
    )
    assert stored == pytest.approx(0.5 * result.quantities["external_work"], rel=1e-9)


@pytest.mark.parametrize("ratio", [1.0, 0.1])
def test_penalty_bias_is_its_compliance(ratio):
    """Pressed by a displacement, the pressure is that of block and penalty in series."""
    parameter = ratio * 1e-4
    obstacle = Obstacle("plane", indentation=0.01)
    scene, body = block(load=(), obstacle=obstacle, penalty_parameter=parameter)
    support = (Support("y1", {"y": 0}), Support("x0", {"x": 0}))
    result = run(Scene(**(scene.__dict__ | {"support": support})), COMM, body(COMM))
    stiffness = 1000 / (1 - 0.3**2)  # uniaxial stress in plane strain, height 1
    assert result.quantities["max_contact_pressure"] == pytest.approx(
        0.01 / (1 / stiffness + parameter), rel=1e-6
    )


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"contact": "unilateral", "pressure": 1}, "unilateral_contact_with_pressure"),
        ({"contact": "prescribed"}, "prescribed_contact_without_pressure"),
        ({"contact": "winkler"}, "winkler_contact_without_stiffness"),
        ({"foundation_stiffness": 1, "contact": "unilateral"}, "foundation_of_no_winkler"),
        ({"pressure": 1, "obstacle": Obstacle()}, "prescribed_contact_with_obstacle"),
        ({"foundation_stiffness": 1, "penalty_parameter": 1e-3}, "winkler_contact_with_penalty"),
        ({"contact": "bonded", "friction_coefficient": 0.3}, "bonded_contact_with_friction"),
        ({"foundation_stiffness": -1}, "foundation_stiffness_is_negative"),
    ],
)
def test_contradictions_are_refused(keys, message):
    with refused(message, ValueError):
        Contact("top", **keys)


def test_kind_follows_from_the_keys():
    assert Contact("top").kind == "unilateral"
    assert Contact("top", pressure=1).kind == "prescribed"
    assert Contact("top", foundation_stiffness=1).kind == "winkler"


def test_forms_know_neither_the_facets_normal_nor_the_volume():
    energy = pad(3).contacts[0].normal.energy
    assert not ufl.algorithms.analysis.extract_type(energy, ufl.classes.FacetNormal)
    assert [integral.integral_type() for integral in energy.integrals()] == [
        "cell"
    ]  # of the surface
