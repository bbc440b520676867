"""Forms that another program compiles are waited for; those that a killed one left are not."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import ufl
from dolfinx import fem, jit, mesh
from mpi4py import MPI

from fenics_contact.common import form_cache
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD

# Compiles a form of its own, and prints its integral over the unit square.
COMPILE = """
import sys
from fenics_contact.common import form_cache
from dolfinx import fem, mesh
from mpi4py import MPI
import ufl
form_cache._QUIET = float(sys.argv[1])
square = mesh.create_unit_square(MPI.COMM_WORLD, 1, 1)
x = ufl.SpatialCoordinate(square)
print(fem.assemble_scalar(form_cache.form(x[0] * ufl.dx)))
"""

# Stands in for the compiler: says that it was called, and takes its time.
SLOW = """#!/bin/sh
echo called >> "{marks}"
sleep {seconds}
exec "{compiler}" "$@"
"""


def program(folder, slow=0.0, quiet=0.0):
    """A program of its own that compiles the form, with the cache in the folder."""
    compiler = folder / f"slow_{slow:g}"
    real = shutil.which("gcc") or shutil.which("cc")
    compiler.write_text(SLOW.format(marks=folder / "marks", seconds=slow, compiler=real))
    compiler.chmod(0o755)
    environment = {
        **os.environ,
        "XDG_CACHE_HOME": str(folder),
        "CC": str(compiler),
        "LDSHARED": f"{real} -shared",
        "PYTHONPATH": str(ROOT),
    }
    return subprocess.Popen(
        [sys.executable, "-c", COMPILE, str(quiet)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        start_new_session=True,
    )


def calls(folder):
    """How often a compiler was called."""
    marks = folder / "marks"
    return len(marks.read_text().splitlines()) if marks.exists() else 0


def wait_for_call(folder, process):
    while calls(folder) == 0:
        assert process.poll() is None, process.communicate()[1]
        time.sleep(0.05)


@pytest.mark.serial
def test_a_form_that_a_killed_program_left_is_compiled_anew(tmp_path):
    killed = program(tmp_path, slow=600)
    wait_for_call(tmp_path, killed)
    os.killpg(killed.pid, signal.SIGKILL)
    killed.communicate()
    # Several at once, so that some wait while others find out that nobody compiles it.
    for process in [program(tmp_path) for _ in range(3)]:
        said, errors = process.communicate(timeout=60)
        assert float(said) == pytest.approx(0.5), errors
    assert calls(tmp_path) == 2


@pytest.mark.serial
def test_a_form_that_another_program_compiles_is_waited_for(tmp_path):
    """Also where its files have not changed for long: the lock says that it is at work."""
    first = program(tmp_path, slow=4)
    wait_for_call(tmp_path, first)
    second = program(tmp_path)
    for process in (first, second):
        said, errors = process.communicate(timeout=60)
        assert float(said) == pytest.approx(0.5), errors
    assert calls(tmp_path) == 1


def test_ranks_begin_an_abandoned_form_anew_together(monkeypatch):
    square = mesh.create_unit_square(COMM, 3, 3)
    x = ufl.SpatialCoordinate(square)
    power = COMM.bcast(2 + int(np.random.default_rng().integers(10**9)) / 1e9)

    def integral():
        return COMM.allreduce(fem.assemble_scalar(form_cache.form(x[0] ** power * ufl.dx)))

    cache = Path(jit.get_options()["cache_dir"])
    before = set(cache.glob("*.c.cached")) if cache.exists() else set()
    COMM.Barrier()
    wanted = integral()
    new = [file for file in set(cache.glob("*.c.cached")) - before if _is_of(file, power)]
    COMM.Barrier()
    monkeypatch.setattr(form_cache, "_QUIET", 0.0)
    if COMM.rank == 0:
        for file in new:
            file.unlink()
    COMM.Barrier()
    assert len(new) == 1
    assert integral() == wanted
    assert new[0].exists()


def _is_of(file, power):
    """Whether the form holds this number."""
    return f"{power:.9g}"[:8] in file.with_suffix("").read_text()


def test_a_failure_of_the_compiler_is_no_reason_to_wait(monkeypatch):
    def fail(*arguments, **options):
        raise RuntimeError("Failed JIT compilation of form: no compiler")

    monkeypatch.setattr(fem, "form", fail)
    square = mesh.create_unit_square(COMM, 2, 2)
    with pytest.raises(RuntimeError, match="no compiler"):
        form_cache.form(fem.Constant(square, 1.0) * ufl.dx)


def test_all_forms_are_had_from_here():
    """One compiled past it would have no lock, and could be taken for an abandoned one."""
    files = (ROOT / "fenics_contact").rglob("*.py")
    past = [f.name for f in files if re.search(r"\bfem\.(form|Expression)\(", f.read_text())]
    assert past == ["form_cache.py"]
