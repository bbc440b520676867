"""Scripts that solve many scenes: one that is done with gives back its communicators at once.

An MPI has but a few thousand, a run holds some forty, and Python's collector counts objects only.
"""

import dataclasses
import gc

import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Material,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
)
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.simulation.state_file import StateFile
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
PLANE = Scene(
    kinematics="plane strain",
    material=Material(1000, 0.3),
    support=(Support("y1", {"x": 0.0001, "y": -0.001}),),
    contact=(Contact("y0", friction_coefficient=0.3),),
)
SPACE = dataclasses.replace(
    PLANE,
    kinematics="3D",
    support=(Support("z1", {"x": 0, "y": 0, "z": 0}),),
    contact=(Contact("z0", obstacle=Obstacle("plane", force=1), friction_coefficient=0.3),),
)
SCENES = {
    "condensed": PLANE,
    "full": dataclasses.replace(PLANE, solver=SolverSettings(solver="full")),
    "iterative": dataclasses.replace(SPACE, solver=SolverSettings(solver="iterative")),
    "nearly incompressible": dataclasses.replace(PLANE, material=Material(1000, 0.49999999)),
    "branches": dataclasses.replace(PLANE, solver=SolverSettings(branches=True)),
    "steps": dataclasses.replace(PLANE, steps=Steps(number=2)),
    "not converged": dataclasses.replace(PLANE, solver=SolverSettings(max_iterations=1)),
}


@pytest.fixture
def no_collector():
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def body_and_witness(scene):
    """A body, and its communicator with what is made of that: those held, and those given back."""
    held, given_back = ["of the body's mesh"], []

    def copied(comm, key, value):
        held.append(value)
        return value

    key = MPI.Comm.Create_keyval(copied, lambda *freed: given_back.append(freed[2]))
    body = box_body((3, 3, 3)[: scene.dimension])
    body.mesh.comm.Set_attr(key, "made of it")
    return body, held, given_back


def collect_what_ufl_keeps():
    """That of older versions keeps what it has checked in cycles of its own."""
    if compat.DOLFINX_VERSION < (0, 10):
        gc.collect()


def is_freed(scene, solve):
    """Whether what a run made is given back with it; again where forms had to be compiled.

    Compiling leaves cycles behind, on the rank that does it.
    """
    for _ in range(3):
        body, held, given_back = body_and_witness(scene)
        run = Run(scene, COMM, body)
        solve(run)
        del body
        assert len(given_back) < len(held) > 1  # the run has them
        del run
        collect_what_ufl_keeps()
        if COMM.allreduce(len(given_back) == len(held), MPI.LAND):
            return True
    return False


@pytest.mark.parametrize("name", SCENES)
def test_a_run_that_is_done_with_is_freed(name, no_collector):
    def solve(run):
        assert run.solve().converged == (name != "not converged")

    assert is_freed(SCENES[name], solve)


def test_one_that_wrote_files_is_freed(folder, no_collector):
    def solve(run):
        assert solve_and_write(run, folder, StateFile(folder, run.problem)).converged

    assert is_freed(SCENES["steps"], solve)


def study_is_freed():
    """Whether a study holds no more after two answers than after one, and nothing afterwards."""
    body, held, given_back = body_and_witness(SCENES["condensed"])
    study = Study(SCENES["condensed"], COMM, body)
    assert study.solve({"contact.0.friction_coefficient": 0.2}).converged
    once = len(held) - len(given_back)
    assert study.solve({"contact.0.friction_coefficient": 0.1}).converged
    collect_what_ufl_keeps()
    twice = len(held) - len(given_back)  # the second run is all that took the first's place
    del body, study
    collect_what_ufl_keeps()
    return twice == once and len(given_back) == len(held)


def test_a_study_that_is_done_with_is_freed(no_collector):
    """Again where forms had to be compiled, which leaves cycles behind."""
    assert any(COMM.allreduce(study_is_freed(), MPI.LAND) for _ in range(3))
