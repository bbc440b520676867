"""Problems in FCLIB's format: what is written is read, and bodies have the program's forces."""

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Study
from fenics_contact.solve.exact import solve
from fenics_contact.verification.memory_check import square
from fenics_contact.verification.memory_worker import body_of, scene_of
from tests.scenes import ROOT

sys.path.append(str(ROOT / "benchmarks"))

import exact_bodies
import exact_problems
import exact_solvers
from exact_format import read_problem, write_problem

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of one rank")


def test_what_is_written_is_read(tmp_path: Path) -> None:
    """With a scalar, as FCLIB's λ."""
    problem = exact_bodies._driven(np.random.default_rng(1))
    answer = solve(problem)
    path = tmp_path / "one.hdf5"
    write_problem(path, answer, "driven", "an obstacle that a force drives")
    found, forces, title = read_problem(path)
    assert title == "driven"
    assert found.scalars == 1
    assert np.array_equal(found.compliance, problem.compliance)
    assert np.array_equal(found.free, problem.free)
    assert np.array_equal(found.laws.coefficient, problem.laws.coefficient)
    assert np.array_equal(forces, answer.forces[:-1])


def test_files_are_laid_out_as_those_of_fclib(tmp_path: Path) -> None:
    """Names and shapes of ``fclib_write_local`` and ``fclib_write_solution``."""
    assert exact_problems.export(tmp_path, 8, 1, quick=True) == (8, 0)
    path = next(tmp_path.glob("half-space-*.hdf5"))
    with h5py.File(path) as file:
        local = file["fclib_local"]
        assert local["spacedim"][()].tolist() == [3]
        assert {"m", "n", "nz", "nzmax", "p", "i", "x"} == set(local["W"])
        assert local["W/nz"][()].tolist() == [-2]  # compressed rows
        assert local["W/p"].shape == (193,) and local["W/i"].dtype == np.int32
        assert {name: of.shape for name, of in local["vectors"].items()} == {
            "q": (192,),
            "mu": (64,),
        }
        assert {"title", "description", "math_info"} == set(local["info"])
        assert file["solution/r"].shape == file["solution/u"].shape == (192,)


def test_rows_count_steps_and_failures(tmp_path: Path) -> None:
    exact_problems.export(tmp_path, 4, 2, quick=True)
    rows = list(exact_solvers.measured(tmp_path, 4))
    assert [row["method"] for row in rows].count("exact") == 4
    assert [row["method"] for row in rows].count("Gauss-Seidel") == 1
    assert not any(row["failed"] for row in rows if row["method"] == "exact")
    assert max(row["residual"] for row in rows if row["method"] == "exact") < 1e-11


def test_a_block_has_the_force_of_the_program() -> None:
    case = square(12)
    scene, body = scene_of(case, "condensed"), body_of(case, MPI.COMM_SELF)
    answer = solve(exact_bodies.problem_of(scene, body))
    found = Study(scene, MPI.COMM_SELF, body).quantities(checks=False).quantities
    assert answer.forces[::2].sum() == pytest.approx(found["normal_force"], rel=1e-3)
    friction = found["friction_force"][0]
    assert abs(answer.forces[1::2].sum()) == pytest.approx(abs(friction), rel=1e-3)
