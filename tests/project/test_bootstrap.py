"""`bootstrap` as a user calls it: in a subprocess, on copies, never on the real .venv."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.scenes import ROOT

pytestmark = pytest.mark.serial

# all that the search itself calls, and no Python or package manager among it
SEARCH_TOOLS = (
    *("cat", "cksum", "date", "dirname", "env", "find", "grep", "head", "id", "mkdir", "mktemp"),
    *("mv", "rm", "rmdir", "sed", "sh", "sleep", "tail", "timeout", "tr", "uname"),
)
# the ranks of one mpirun must not take themselves for those of another
MPI_VARIABLES = ("OMPI_", "PMIX_", "PRTE_", "PMI", "MPI", "HYD")


def copy_project(folder: Path) -> Path:
    folder.mkdir(parents=True)
    for name in ("bootstrap", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    return folder


def environment(**changes: str) -> dict[str, str]:
    kept = {k: v for k, v in os.environ.items() if not k.startswith(MPI_VARIABLES)}
    kept.pop("FENICS_CONTACT_TIMEOUT", None)
    return kept | {"FENICS_CONTACT_PYTHON": sys.executable} | changes


def call(project: Path, *arguments: str, cwd: Path | None = None, **changes: str):
    return subprocess.run(
        [str(project / "bootstrap"), *arguments],
        env=environment(**changes),
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
    )


def start_set_up(project: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [str(project / "bootstrap"), "setup"],
        env=environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy that is set up with the Python of this test run; its path has a space."""
    folder = copy_project(tmp_path_factory.mktemp("bootstrap") / "a project")
    done = call(folder, "setup")
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("fly",),
        ("python",),
        ("mpi",),
        ("mpi", "2"),
        ("mpi", "two", "x.py"),
        ("mpi", "0", "x.py"),
    ],
)
def test_wrong_usage_is_explained(project: Path, arguments: tuple[str, ...]) -> None:
    done = call(project, *arguments)
    assert done.returncode == 2
    assert "Usage: ./bootstrap" in done.stderr
    assert done.stdout == ""


def test_time_limit_that_is_no_number_is_refused(project: Path) -> None:
    done = call(project, "mpi", "1", "-c", "pass", FENICS_CONTACT_TIMEOUT="soon")
    assert done.returncode == 2
    assert "FENICS_CONTACT_TIMEOUT" in done.stderr


@pytest.mark.parametrize("wrong", ["/no/such/python", "sh"])
def test_unusable_explicit_python_is_one_error(tmp_path: Path, wrong: str) -> None:
    done = call(copy_project(tmp_path / "p"), "setup", FENICS_CONTACT_PYTHON=wrong)
    errors = [line for line in done.stderr.splitlines() if "error:" in line]
    assert done.returncode == 1
    assert len(errors) == 1
    assert f"FENICS_CONTACT_PYTHON={wrong} is not a Python that imports dolfinx" in errors[0]
    assert not (tmp_path / "p/.venv").exists()


def test_setup_names_what_it_uses_and_is_quick_again(project: Path) -> None:
    started = time.monotonic()
    done = call(project, "setup")
    assert time.monotonic() - started < 2
    assert "dolfinx 0." in done.stdout
    assert "mpirun" in done.stdout
    assert done.stderr == ""


def test_exit_code_of_one_rank_is_passed_on(project: Path) -> None:
    done = call(project, "python", "-c", "raise SystemExit(7)")
    assert done.returncode == 7
    assert done.stderr == ""


def test_exit_code_of_two_ranks_is_passed_on(project: Path) -> None:
    done = call(project, "mpi", "2", "-c", "from mpi4py import MPI; raise SystemExit(7)")
    assert done.returncode == 7


def test_two_ranks_see_each_other(project: Path) -> None:
    program = (
        "from mpi4py import MPI; print('sum', MPI.COMM_WORLD.allreduce(MPI.COMM_WORLD.rank + 1))"
    )
    done = call(project, "mpi", "2", "-c", program)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "sum 3\n" * 2


def test_arguments_are_relative_to_the_callers_folder(project: Path, tmp_path: Path) -> None:
    (tmp_path / "my program.py").write_text("import os, sys; print(sys.argv[1], os.getcwd())")
    done = call(project, "python", "my program.py", "an argument", cwd=tmp_path)
    assert done.stdout.split() == ["an", "argument", str(tmp_path)]


def test_programs_get_the_package_and_one_thread(project: Path) -> None:
    program = "import os; print(os.environ['OMP_NUM_THREADS'], os.environ['PYTHONPATH'], sep='|')"
    threads, path = call(project, "python", "-c", program, OMP_NUM_THREADS="3").stdout.split("|")
    assert threads == "3"
    assert path.strip().split(":")[0] == str(project)


@pytest.mark.parametrize("how", [("python",), ("mpi", "2")])
def test_dolfinx_may_be_imported_before_all_else(project: Path, how: tuple[str, ...]) -> None:
    program = "import dolfinx; from mpi4py import MPI; print('ranks', MPI.COMM_WORLD.size)"
    done = call(project, *how, "-c", program, LD_LIBRARY_PATH="/of/the user")
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"ranks {how[-1]}\n" * 2 if how[0] == "mpi" else "ranks 1\n"
    program = "import os; print(os.environ['LD_LIBRARY_PATH'])"
    done = call(project, "python", "-c", program, LD_LIBRARY_PATH="/of/the user")
    assert done.stdout.strip().endswith("/of/the user")


def test_unwritable_home_gets_a_cache_of_its_own(project: Path) -> None:
    program = "import os; print(os.environ['XDG_CACHE_HOME'])"
    done = call(project, "python", "-c", program, HOME="/proc/none", XDG_CACHE_HOME="/proc/none")
    assert os.access(done.stdout.strip(), os.W_OK)


def test_error_on_one_rank_ends_all(project: Path) -> None:
    program = "from mpi4py import MPI; c = MPI.COMM_WORLD; 1 / c.rank; c.Barrier()"
    done = call(project, "mpi", "2", "-c", program)
    assert done.returncode not in (0, 124)
    assert "ZeroDivisionError" in done.stderr


def test_hanging_rank_is_ended_by_the_time_limit(project: Path) -> None:
    program = (
        "import time; from mpi4py import MPI; c = MPI.COMM_WORLD; "
        "print('started'); c.rank or time.sleep(99); c.Barrier()"
    )
    done = call(project, "mpi", "2", "-c", program, FENICS_CONTACT_TIMEOUT="3")
    assert done.returncode == 124
    assert "stopped after 3 seconds" in done.stderr
    assert done.stdout.startswith("started\n" * 2)  # what was printed before is not lost


def test_two_set_ups_at_once_do_not_collide(tmp_path: Path) -> None:
    folder = copy_project(tmp_path / "p")
    both = [start_set_up(folder) for _ in range(2)]
    outcomes = [process.communicate(timeout=120) for process in both]
    assert [process.returncode for process in both] == [0, 0], outcomes
    # one of them searched, the other one waited and took over what it found
    assert sum("looking for" in errors for _, errors in outcomes) == 1
    assert not (folder / ".cache/bootstrap/lock").exists()


def test_waiting_for_another_set_up_is_said(tmp_path: Path) -> None:
    folder = copy_project(tmp_path / "p")
    lock = folder / ".cache/bootstrap/lock"
    lock.mkdir(parents=True)
    with subprocess.Popen(["sleep", "99"]) as owner:
        (lock / "pid").write_text(f"{owner.pid}\n")
        waiting = start_set_up(folder)
        assert waiting.stderr is not None
        assert f"(process {owner.pid}) is setting up; waiting" in waiting.stderr.readline()
        assert waiting.poll() is None
        owner.kill()
    # its owner is dead now, so the lock is taken over
    waiting.communicate(timeout=120)
    assert waiting.returncode == 0


def test_interrupted_set_up_leaves_no_lock(tmp_path: Path) -> None:
    folder = copy_project(tmp_path / "p")
    process = start_set_up(folder)
    assert process.stderr is not None
    assert "looking for" in process.stderr.readline()
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=120)
    assert process.returncode == 143
    assert not (folder / ".cache/bootstrap/lock").exists()
    assert not (folder / ".cache/bootstrap/stamp").exists()


def test_half_built_venv_is_not_used(tmp_path: Path) -> None:
    folder = copy_project(tmp_path / "p")
    venv = folder / ".venv"
    (venv / "bin").mkdir(parents=True)
    (venv / "bin/python").symlink_to(sys.executable)
    (venv / "unfinished").touch()
    tools = bare_tools(tmp_path / "bin")
    done = call(folder, "setup", FENICS_CONTACT_PYTHON="", PATH=str(tools), HOME=str(tmp_path))
    assert "was interrupted" in done.stderr
    assert not (venv / "unfinished").exists()
    assert str(venv) not in done.stdout


def bare_tools(folder: Path) -> Path:
    folder.mkdir()
    for name in SEARCH_TOOLS:
        found = shutil.which(name)
        assert found, name
        (folder / name).symlink_to(found)
    return folder


def system_python_has_dolfinx() -> bool:
    python = Path("/usr/bin/python3")
    find = "import importlib.util as u, sys; sys.exit(u.find_spec('dolfinx') is None)"
    return python.exists() and subprocess.run([python, "-c", find], env={}).returncode == 0


@pytest.mark.skipif(system_python_has_dolfinx(), reason="/usr/bin/python3 has dolfinx: a way out")
def test_machine_without_a_way_out_is_told_the_ways(tmp_path: Path) -> None:
    folder = copy_project(tmp_path / "p")
    done = subprocess.run(
        [str(folder / "bootstrap"), "setup"],
        env={"PATH": str(bare_tools(tmp_path / "bin"))},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 1
    for way in ("Debian 13", "Python 3.12", "conda", "Docker"):
        assert way in done.stderr
