"""Natural modes of bodies that contacts hold, from formulas and from bodies that supports hold."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    Modes,
    NotConvergedError,
    Obstacle,
    Scene,
    SolverSettings,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import total
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
FLOOR = Obstacle("plane", position=(0, 0), normal=(0, 1), indentation=0)


def block(**more):
    """A block, 2 wide and 1 high, that a pressure holds down, or supports do."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000.0, 0.3, density=2.0),
        load=(Load("y1", pressure=1.0),),
        modes=Modes(4),
        solver=SolverSettings(errors="none"),
        **more,
    )


HELD = block(support=(Support("y0", {"x": 0, "y": 0}),))
STANDING = block(
    contact=(Contact("y0", obstacle=FLOOR, friction_coefficient=0.5, law="incremental"),)
)


def frequencies(scene, body=None):
    found = run(scene, body=body or box_body((8, 4), (2, 1))).modes
    return np.array([mode.natural_frequency for mode in found])


def test_what_carries_pressure_is_held_as_by_a_support():
    assert frequencies(STANDING) == pytest.approx(frequencies(HELD), rel=1e-3)


def test_smooth_contact_holds_across_and_not_along():
    """As rollers do; without friction a support holds it along."""
    smooth = block(contact=(Contact("y0", obstacle=FLOOR),), support=(Support("x0", {"x": 0}),))
    rollers = block(support=(Support("x0", {"x": 0}), Support("y0", {"y": 0})))
    assert frequencies(smooth) == pytest.approx(frequencies(rollers), rel=1e-3)


def test_what_carries_no_pressure_is_free():
    """A floor that a beam does not reach does not stiffen it."""
    beam = dataclasses.replace(HELD, support=(Support("x0", {"x": 0, "y": 0}),), load=())
    beam = dataclasses.replace(beam, load=(Load("x1", traction=(1e-3, 0)),))
    far = dataclasses.replace(FLOOR, position=(0, -0.1))
    above = dataclasses.replace(beam, contact=(Contact("y0", obstacle=far),))
    assert frequencies(above) == pytest.approx(frequencies(beam), rel=1e-9)


def test_modes_are_orthogonal_and_solve_k_phi_is_omega_squared_m_phi():
    """By the strain energy of a run that the inertia loads: its displacement is the mode."""
    study = Study(HELD, COMM, box_body((8, 4), (2, 1)))
    found = study.vibration()
    owned = study.prepare().problem.spaces.owned_nodes
    shapes = found.shapes

    def product(one, other):
        return float(total(COMM, np.sum(one.shape[:owned] * other.forces[:owned])))

    gram = np.array([[product(a, b) for b in shapes] for a in shapes])
    masses = np.array([mode.mass for mode in shapes])
    assert gram.diagonal() == pytest.approx(masses, rel=1e-12)
    assert np.abs(gram - np.diag(masses)).max() < 1e-8 * masses.max()
    assert all(
        COMM.allreduce(np.linalg.norm(mode.shape, axis=1).max(initial=0), op=MPI.MAX)
        == pytest.approx(1.0)
        for mode in shapes
    )


def test_frequencies_go_by_the_root_of_stiffness_over_density_and_a_study_keeps_the_body():
    study = Study(HELD, COMM, box_body((8, 4), (2, 1)))
    first, heavier = (study.vibration({"material.0.density": rho}).modes for rho in (2.0, 8.0))
    for light, heavy in zip(first, heavier, strict=True):
        assert heavy.natural_frequency == pytest.approx(light.natural_frequency / 2, rel=1e-9)
        assert heavy.modal_mass == pytest.approx(4 * light.modal_mass, rel=1e-6)
    assert study.factorisations == 1


def test_modes_of_a_nearly_incompressible_body():
    """With a mean stress as a second unknown; below ν = .49 cells are a little too stiff."""
    material = [Material(1000.0, ratio, density=2.0) for ratio in (0.4899, 0.4901)]
    below, above = (frequencies(dataclasses.replace(HELD, material=(m,))) for m in material)
    assert above == pytest.approx(below, rel=2.5e-2) and (above < below).all()


def test_a_motion_that_nothing_holds_has_no_frequency():
    free = dataclasses.replace(
        HELD,
        support=(),
        load=(Load("y1", pressure=1.0), Load("y0", pressure=1.0)),
        solver=SolverSettings(errors="none", stabilisation=True),
    )
    with refused("mode_is_a_rigid_motion", NotConvergedError):
        Study(free, COMM, box_body((4, 2), (2, 1))).vibration()
    found = run(free, body=box_body((4, 2), (2, 1)))
    assert found.passed and not found.modes and "No modes: a rigid motion" in found.verdict


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"material": (Material(1.0, 0.3),)}, "modes_need_density"),
        (
            {"contact": (dataclasses.replace(STANDING.contact[0], law="static"),)},
            "modes_of_static_law",
        ),
    ],
)
def test_scenes_without_what_modes_need_are_refused(changes, said):
    with refused(said, SceneError):
        dataclasses.replace(STANDING, **changes)


def test_there_are_not_more_modes_than_half_the_displacements():
    with refused("more_modes_than_displacements"):
        Study(
            dataclasses.replace(HELD, modes=Modes(200)), COMM, box_body((2, 1), (2, 1))
        ).vibration()
