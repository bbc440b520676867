"""Steady sliding: complex modes against matrices written out, motions, and other models of it."""

import csv
import dataclasses
import re

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.linalg import eig

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Rayleigh,
    Scene,
    Stability,
    Support,
    run,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import total
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.sliding import (
    growth_in_time,
    moving_block,
    sliding_block,
)
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD


def exponents(scene, body):
    found = run(scene, body=body)
    assert found.passed and found.stability is not None, found.verdict
    modes = found.stability.modes
    return np.array([mode.growth_rate + 2j * np.pi * mode.frequency for mode in modes])


def largest_growth(scene, body):
    return exponents(scene, body).real.max()


def written_out(cells, coefficient, number):
    """s by LᵀKR and LᵀMR of the block, u_n = 0 and w_n = −μ w_t where the normal is outward."""
    body = boxes([Box("block", (0.0, 0.0), (2.0, 1.0), (2 * cells, cells))], comm=MPI.COMM_SELF)
    space = fem.functionspace(body.mesh, ("Lagrange", 1, (2,)))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    shear, lame = 1000 / 2.6, 1000 * 0.3 / (1.3 * 0.4)
    strain = ufl.sym(ufl.grad(u))
    stress = 2 * shear * strain + lame * ufl.tr(strain) * ufl.Identity(2)
    stiffness = fem.assemble_matrix(fem.form(ufl.inner(stress, ufl.grad(v)) * ufl.dx)).to_dense()
    places = space.tabulate_dof_coordinates()
    bottom, top = places[:, 1] < 1e-9, places[:, 1] > 1 - 1e-9
    mass = np.zeros((len(places), 2))
    quarter = 1 / (4 * cells**2)
    for nodes in space.dofmap.list:
        mass[nodes] += quarter
        mass[nodes[bottom[nodes]], 1] -= quarter
        if bottom[nodes].any():
            mass[nodes[~bottom[nodes]], 1] += quarter * bottom[nodes].sum() / 2
    free = np.flatnonzero(~np.repeat(top, 2))
    across = 2 * np.flatnonzero(bottom) + 1
    trial = np.eye(2 * len(places))
    test = trial.copy()
    test[across, across - 1] = -coefficient  # the body slides along +x, its normal is −y
    kept = np.setdiff1d(free, across)
    trial, test = trial[:, kept], test[:, kept]
    reduced = test.T @ stiffness @ trial, test.T @ np.diag(mass.ravel()) @ trial
    squares = eig(*reduced, right=False)
    squares = squares[np.argsort(np.abs(squares))][:number]
    found = 1j * np.sqrt(squares)
    return np.where(found.imag < 0, -found, found)


def by_size(values):
    return values[np.lexsort((values.real, np.round(values.imag, 2)))]


@pytest.mark.parametrize(("coefficient", "growth"), [(0.1, 0.9), (0.3, 4.0)])
def test_modes_are_those_of_the_reduced_matrices(coefficient, growth):
    """The unsymmetric eigenvalue problem, written out for a body that touches with all nodes."""
    scene, body = sliding_block(4, Stability(number=10))
    contact = dataclasses.replace(scene.contact[0], friction_coefficient=coefficient)
    found = by_size(exponents(dataclasses.replace(scene, contact=(contact,)), body))
    expected = by_size(written_out(4, coefficient, len(found)))
    assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max()
    assert found.real.max() == pytest.approx(expected.real.max(), rel=1e-2)
    assert expected.real.max() > growth


@pytest.mark.serial  # some hundred steps, which two ranks take far longer for
def test_the_block_grows_in_time_as_its_mode_does():
    """By the motion of the same state, which a small push disturbs."""
    rate = largest_growth(*sliding_block(3, Stability(number=14)))
    scene, body = moving_block(3, 0.5, 1.5)
    found = run(scene, body=body)
    assert found.converged, found.verdict
    assert growth_in_time(found, last=0.5) == pytest.approx(rate, rel=0.05)
    assert rate > 3


def test_damping_of_the_bodies_takes_growth_away():
    """½ (α + β ω²), as long as it is little; much of it leaves nothing that grows."""
    scene, body = sliding_block(3, Stability(number=12))
    free = exponents(scene, body)
    little = Rayleigh(mass=0.2, stiffness=1e-5)
    damped = exponents(
        dataclasses.replace(scene, stability=Stability(number=12, rayleigh=little)), body
    )
    worst = free[np.argmax(free.real)]
    lost = 0.5 * (0.2 + 1e-5 * worst.imag**2)
    assert damped.real.max() == pytest.approx(worst.real - lost, rel=1e-3)
    much = Stability(number=12, rayleigh=Rayleigh(stiffness=5e-3))
    assert largest_growth(dataclasses.replace(scene, stability=much), body) < 0


def test_a_thin_slice_in_3d_flutters_as_in_plane_strain():
    """Of one layer of cells: so thin that those of its two sides move alike."""
    plane, body = sliding_block(3, Stability(number=8))
    contact = dataclasses.replace(
        plane.contact[0],
        obstacle=Obstacle(
            "plane", position=(0, 0, 0), normal=(0, 1, 0), displacement=(-1.0, 0.0, 0.0)
        ),
    )
    slice_ = dataclasses.replace(
        plane,
        kinematics="3D",
        support=(Support("block.y1", {"x": 0, "y": -0.01}), Support("block", {"z": 0})),
        contact=(contact,),
    )
    solid = boxes([Box("block", (0, 0, 0), (2, 1, 0.02), (6, 3, 1))], cell="hexahedron")
    found, expected = (by_size(exponents(*pair)) for pair in ((slice_, solid), (plane, body)))
    assert found == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_a_block_on_a_stiff_body_flutters_as_on_a_rigid_plate():
    """That supports move by; it has hardly any mass of its own."""
    alone, body = sliding_block(3, Stability(number=8))
    stiff = Material(1e7, 0.3, density=1.0, on="lower")
    pair = dataclasses.replace(
        alone,
        material=(dataclasses.replace(alone.material[0], on="block"), stiff),
        support=(*alone.support, Support("lower.y0", {"x": -0.05, "y": 0.0})),
        contact=(
            Contact("block.y0", against="lower.y1", friction_coefficient=0.3, law="incremental"),
        ),
    )
    low = Box("lower", (-0.5, -0.5), (2.5, 0.0), (9, 2))
    both = boxes([Box("block", (0.0, 0.0), (2.0, 1.0), (6, 3)), low])
    assert largest_growth(pair, both) == pytest.approx(largest_growth(alone, body), rel=3e-2)


def test_the_smallest_coefficient_at_which_something_grows_is_found_between_two_of_the_curve():
    scene, body = sliding_block(4, Stability(number=6, up_to=0.4, points=5))
    found = run(scene, body=body).stability
    critical = found.critical_coefficient
    assert [point.friction_coefficient for point in found.curve] == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert found.curve[0].largest_growth_rate == 0
    expected = [written_out(4, critical + change, 7).real.max() for change in (-2e-3, 2e-3)]
    assert expected[0] < 1e-3 < expected[1]


def test_coulombs_law_that_is_named_squeals_as_the_default_does():
    scene, body = sliding_block(3, Stability(number=3))
    named = dataclasses.replace(scene.contact[0], friction_law={"kind": "coulomb"})
    found = exponents(dataclasses.replace(scene, contact=(named,)), body)
    assert found == pytest.approx(exponents(scene, body), rel=1e-9, abs=1e-9)


def test_what_sticks_is_not_asked_whether_it_slides():
    scene, body = sliding_block(3, Stability())
    contact = scene.contact[0]
    near = dataclasses.replace(contact.obstacle, displacement=(-1e-4, 0.0))
    scene = dataclasses.replace(scene, contact=(dataclasses.replace(contact, obstacle=near),))
    found = run(scene, body=body)
    assert found.stability is None
    assert "No stability: 0.83 of what carries pressure at 'block.y0' sticks" in found.verdict


def test_a_body_that_nothing_but_friction_holds_sideways_is_refused():
    contact = Contact(
        "y0",
        obstacle=Obstacle("plane", position=(0, 0, 0), normal=(0, 1, 0), displacement=(-1, 0, 0)),
        friction_coefficient=0.3,
        law="incremental",
    )
    scene = Scene(
        kinematics="3D",
        material=Material(1000.0, 0.3, density=1.0),
        discretisation=Discretisation(1),
        support=(Support("x0", {"x": 0.0}),),
        load=(Load("y1", pressure=10.0),),
        contact=(contact,),
        stability=Stability(number=4),
    )
    found = run(scene, body=box_body((3, 2, 2), (2, 1, 1)))
    assert found.stability is None
    assert "No stability: a rigid motion is held by nothing while the contact" in found.verdict


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"material": (Material(1.0, 0.3),)}, "stability_needs_density"),
        ({"contact": ()}, "stability_without_friction"),
        ({"law": "static"}, "stability_of_static_friction"),
        ({"friction_coefficient": lambda x: 0.3 + 0 * x[0]}, "stability_of_a_function"),
        ({"solver": "stabilisation"}, "stability_with_stabilisation"),
    ],
)
def test_scenes_without_what_steady_sliding_needs_are_refused(changes, said):
    scene, _ = sliding_block(3, Stability())
    if "solver" in changes:
        changes = {"solver": dataclasses.replace(scene.solver, stabilisation=True)}
    elif {"law", "friction_coefficient"} & set(changes):
        changes = {"contact": (dataclasses.replace(scene.contact[0], **changes),)}
    with refused(said, SceneError):
        dataclasses.replace(scene, **changes)


def test_there_are_not_more_modes_than_half_the_displacements():
    """So many are known once there is an answer, which stays."""
    scene, body = sliding_block(2, Stability(number=200))
    result = run(scene, body=body)
    assert result.passed and result.stability is None
    assert re.search(r"No stability: stability.number = 200: .* at most", result.verdict)


def test_shapes_are_one_long_and_those_of_a_pair_are_conjugate():
    scene, body = sliding_block(3, Stability(number=12))
    ready = Run(scene, body=body)
    ready.solve()
    owned = ready.problem.spaces.owned_nodes
    found = ready.analyses.of("stability").found.shapes
    shapes = [mode.shape[:owned] for mode in found]
    angles = np.linspace(0, np.pi, 181)
    for shape in shapes:
        way = np.array([np.linalg.norm((shape * np.exp(1j * a)).real, axis=1) for a in angles])
        longest = COMM.allreduce(way.max(initial=0), op=MPI.MAX)
        assert longest == pytest.approx(1.0, rel=1e-3)
    growing = max(range(12), key=lambda number: found[number].exponent.real)
    apart = np.abs(shapes[growing] - shapes[growing + 1].conj()) ** 2
    assert total(COMM, float(apart.sum())) < 1e-10


def test_a_run_writes_curves_and_shapes(folder):
    scene, body = sliding_block(3, Stability(number=2, up_to=0.4, points=3))
    result = solve_and_write(Run(scene, COMM, body), folder)
    assert result.passed and result.timings.stability > 0
    assert result.stability.critical_coefficient is None
    assert "Up to a coefficient of 0.4 none of them grows" in result.verdict
    COMM.Barrier()
    read = read_result(folder).stability
    assert read.modes[1].frequency == result.stability.modes[1].frequency
    with (folder / "stability.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["friction_coefficient"]) for row in rows[::2]] == [0.0, 0.2, 0.4]
    assert float(rows[3]["frequency"]) == result.stability.curve[1].frequencies[1]
    assert (folder / "squeal.pvd").exists() and (folder / "squeal000002.pvtu").exists()
