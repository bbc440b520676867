"""A rank that fails, errors in callbacks, no memory: words and an exit code.

A failing rank is tried in processes of their own, as it ends them all.
"""

import os
import resource
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact import Contact, InputError, Load, Material, Run, Scene, Support, run
from fenics_contact.cli.commands import guarded
from fenics_contact.common import mumps
from fenics_contact.common.errors import MachineError, NotConvergedError
from fenics_contact.common.failures import READER_LEFT, explain, original
from fenics_contact.common.memory import free_memory_for, memory_limit
from fenics_contact.simulation import end_of_run as simulation
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.solver_choice import choose_solver
from tests.messages import refused, says
from tests.scenes import PULLED_BLOCK, ROOT, box_body, with_solver

COMM = MPI.COMM_WORLD


def pressed(cells=(4, 3), coefficient=0.3, **settings):
    """A block under a given pressure on its rough top, pulled aside; and its mesh."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        load=(Load("x0", traction=(5, 0)),),
        contact=(Contact("y1", pressure=20, friction_coefficient=coefficient),),
    )
    return with_solver(scene, **settings), COMM, box_body(cells, (1, 1))


# ------------------------------------------------------------------ one rank alone

# Faults that a rank meets alone, by where; each is to be told of within ten seconds.
FAULTY = """
import os, pathlib, signal, sys, time
import numpy as np
from mpi4py import MPI
from fenics_contact import Run, main, run
from fenics_contact.common import failures as faults
from fenics_contact.solve import newton
from fenics_contact.simulation import end_of_run as simulation
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.trust.error_estimates import estimates
from fenics_contact.verification import command
from tests.scenes import PULLED_BLOCK, box_body

def now():
    pathlib.Path(sys.argv[2]).write_text(str(time.monotonic()))

def fail(*arguments):
    now()
    raise ValueError("two and two are five")

def run_out_of_memory(*arguments):
    now()
    np.ones((10**8, 10**6))

def be_killed(*arguments):
    now()
    os.kill(os.getpid(), signal.SIGKILL)

where = sys.argv[1]
if MPI.COMM_WORLD.rank == 1:
    if where == "callback":
        newton.Newton._set_residual = fail
    if where == "verify":
        faults._PATIENCE = 0.5
        command.run_case = run_out_of_memory
    if where == "killed":
        simulation.contact_points = be_killed
    if where == "estimate":
        estimates.iteration_errors = fail
if where == "verify":
    sys.exit(main(["verify", "slab", "--quick"]))
body = box_body((2, 2, 2))
if where == "estimate":
    folder = pathlib.Path(sys.argv[2]).parent / "out"
    files.solve_and_write(Run(PULLED_BLOCK, body=body), folder)
try:
    run(PULLED_BLOCK, body=body)
except Exception:  # a script that tries its luck with another scene
    run(PULLED_BLOCK, body=body)
"""


def on_two_ranks(folder, where):
    """Exit code, what was said, and seconds from the fault to the end."""
    script, mark = folder / "faulty.py", folder / "mark"
    script.write_text(FAULTY)
    beside = os.path.join(os.path.dirname(sys.executable), "mpirun")
    launcher = beside if os.path.exists(beside) else shutil.which("mpirun")
    environment = {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "PYTHONPATH": str(ROOT),
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    }
    with subprocess.Popen(
        [launcher, "-n", "2", sys.executable, str(script), where, str(mark)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        start_new_session=True,
    ) as process:
        try:
            said = process.communicate(timeout=60)[1]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    return process.returncode, said, time.monotonic() - float(mark.read_text())


@pytest.mark.serial
@pytest.mark.parametrize(
    ("where", "code", "words"),
    [
        ("callback", 1, "ValueError: two and two are five"),  # in a script, through PETSc
        ("verify", 5, "the machine failed: out of memory: Unable to allocate 728"),
    ],
)
def test_a_rank_that_fails_alone_ends_the_run_with_its_message(tmp_path, where, code, words):
    found, said, seconds = on_two_ranks(tmp_path, where)
    assert found == code, said
    assert "fenics-contact: rank 1 of 2 failed, and with it the run: " in said
    assert words in said
    assert ("Traceback" in said) == (code == 1)
    assert seconds < 10


@pytest.mark.serial
def test_a_rank_that_is_killed_takes_the_others_along(tmp_path):
    code, _, seconds = on_two_ranks(tmp_path, "killed")
    assert code != 0
    assert seconds < 10


# ------------------------------------------------------------------ all ranks alike


def test_errors_that_all_ranks_share_are_ordinary(capsys):
    """Scripts can go on after them; the terminal has them once."""

    def refuse():
        raise InputError("no such thing")

    assert guarded(refuse) == 2
    said = capsys.readouterr().err
    assert said == ("fenics-contact: no such thing\n" if COMM.rank == 0 else "")
    with refused("friction_coefficient_fails"):
        run(*pressed(coefficient=lambda x: 1 / (COMM.rank + 1 - COMM.size)))  # on one rank
    assert run(*pressed()).passed


def test_a_fault_of_the_program_shows_where_it_is(capsys):
    assert guarded(lambda: {}["key"]) == 1
    said = COMM.bcast(capsys.readouterr().err)
    assert "a fault of the program" in said and "Traceback" in said and "KeyError: 'key'" in said


def test_an_error_in_a_callback_is_not_petscs(monkeypatch):
    """And the solve after it has the options of its own."""

    def fail(*arguments):
        raise NotConvergedError("the matter is soft")

    with monkeypatch.context() as patch, pytest.raises(ValueError, match="of a tangent"):
        patch.setattr(Newton, "_set_tangent", _raising(ValueError("of a tangent")))
        run(*pressed())
    assert not PETSc.Options().hasName("fenics_contact_snes_linesearch_type")
    monkeypatch.setattr(Newton, "_converged", fail)
    assert "the matter is soft" in run(*pressed()).verdict  # its type is kept as well


@pytest.mark.serial
def test_a_reader_that_leaves_is_no_crash(tmp_path):
    """As with `| head`; PETSc would have called it one."""
    script = tmp_path / "talking.py"
    script.write_text(
        "import sys\nfrom rich.console import Console\n"
        "from fenics_contact.cli.commands import guarded\n"
        "talk = print if sys.argv[1:] else Console().print\n"
        "sys.exit(guarded(lambda: [talk('much to say') for _ in range(9999)] and 0))\n"
    )
    for how in ([], ["plain"]):
        with subprocess.Popen(
            [sys.executable, str(script), *how],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        ) as process:
            process.stdout.close()
            said = process.stderr.read()
        assert process.returncode == READER_LEFT == 141
        assert "PETSC" not in said and "Traceback" not in said and "Exception" not in said


def _raising(error):
    def fail(*arguments):
        raise error

    return fail


def test_what_is_said_of_an_error():
    nested = PETSc.Error(101)
    nested.__cause__ = PETSc.Error(101)
    nested.__cause__.__cause__ = error = MachineError("no room")
    assert original(nested) is error
    assert explain(nested) == (5, "no room")
    assert explain(KeyboardInterrupt()) == (130, "interrupted")
    assert explain(PETSc.Error(55))[0] == 5
    code, said = explain(OSError(5, "Input/output error", "mesh.msh"))
    assert code == 5 and "the machine failed" in said and "mesh.msh" in said
    # as dolfinx words what PETSc tells it
    code, said = explain(
        RuntimeError(
            "Failed to successfully call PETSc function 'MatXIJSetPreallocation'. PETSc error code "
            "is: 55, Out of memory"
        )
    )
    assert code == 5
    says("machine_has_no_memory", said)
    assert explain(RuntimeError("PETSc error code is: 56, No support"))[0] == 1
    for said in ("Failed just-in-time compilation of form: x", "JIT compilation failed on rank 0."):
        code, words = explain(RuntimeError(said))
        assert code == 5
        says("form_not_compiled", words, said=said)


# ------------------------------------------------------------------ memory


@pytest.mark.parametrize(
    ("solver", "option", "words"),
    [
        ("condensed", "fenics_contact_mat_mumps_icntl_23", "out of memory"),
        ("full", "fenics_contact_mat_mumps_icntl_23", "out of memory"),
        ("condensed", "fenics_contact_mat_mumps_icntl_14", "workspace is too small"),
        ("full", "fenics_contact_mat_mumps_icntl_14", "workspace is too small"),
        ("iterative", "fenics_contact_zone_mat_mumps_icntl_14", "workspace is too small"),
    ],
)
def test_factorisation_without_memory_is_the_machines_failure(capsys, solver, option, words):
    """MUMPS may take a megabyte, or no more than it foresees less 99 %."""
    made = pressed((40, 40) if option.endswith("23") else (12, 12), solver=solver)
    if solver == "iterative":
        made = with_solver(PULLED_BLOCK, solver=solver), COMM, box_body((3, 3, 3))
    PETSc.Options().setValue(option, 1 if option.endswith("23") else -99)
    try:
        assert guarded(lambda: run(*made).exit_code) == 5
    finally:
        PETSc.Options().delValue(option)
    said = COMM.bcast(capsys.readouterr().err)
    assert words in said and "INFOG(1) = -" in said and said.count("\n") == 1


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
def test_a_workspace_that_is_too_small_is_made_larger(solver, monkeypatch):
    """By every solver that factorises; the answer and its Newton steps are the same."""
    made = with_solver(PULLED_BLOCK, solver=solver), COMM, box_body((3, 3, 3))
    expected, tried = run(*made), []
    plain = mumps.failure

    def failure(factor):
        found = plain(factor)
        tried.append((factor.getMumpsIcntl(14), isinstance(found, mumps.WorkspaceError)))
        return found

    monkeypatch.setattr(mumps, "failure", failure)
    monkeypatch.setattr(mumps, "SPARE_WORKSPACE", (-99, 50))
    found = run(*made)
    assert found.exit_code == 0
    assert (-99, True) in set().union(*COMM.allgather(tried))
    assert found.steps[0].newton_iterations == expected.steps[0].newton_iterations
    assert found.quantities["strain_energy"] == pytest.approx(expected.quantities["strain_energy"])


def test_mumps_error_codes():
    """As the users' guide of MUMPS lists them."""

    class Factor:
        def __init__(self, code, rows=3):
            self.getMumpsInfog = lambda number: code if number == 1 else 0
            self.getSize = lambda: (rows, rows)

    assert mumps.failure(Factor(0)) is None
    assert mumps.failure(Factor(-16, rows=0)) is None
    assert isinstance(mumps.failure(Factor(-10)), NotConvergedError)
    assert "out of memory" in str(mumps.failure(Factor(-13)))
    assert "workspace" in str(mumps.failure(Factor(-9)))
    assert "it failed" in str(mumps.failure(Factor(-53)))


def test_numpy_without_memory(capsys, monkeypatch):
    monkeypatch.setattr(simulation, "contact_points", lambda *rest: np.ones((10**8, 10**6)))
    assert guarded(lambda: run(*pressed()).exit_code) == 5
    said = COMM.bcast(capsys.readouterr().err)
    says("numpy_has_no_memory", said)
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("limit", "column", "name"),
    [(resource.RLIMIT_AS, 0, "ulimit -v"), (resource.RLIMIT_DATA, 5, "ulimit -d")],
)
def test_limits_of_a_process_count(limit, column, name):
    """Every rank has its own; what it uses already is gone."""
    prepared = Run(*pressed())
    soft, hard = resource.getrlimit(limit)
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[column]) * resource.getpagesize()
    room = 20_000_000
    resource.setrlimit(limit, (used + room, hard))
    try:
        free, words = free_memory_for(COMM), memory_limit(COMM)
        if prepared.choice.memory < free:
            assert choose_solver(prepared.problem).name == "condensed"
    finally:
        resource.setrlimit(limit, (soft, hard))
    assert 0.5 * room * COMM.size < free <= room * COMM.size
    assert name in words
