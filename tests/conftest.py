"""Tests run on one rank and on two: the same asserts, on global numbers only."""

from __future__ import annotations

import copy
import functools
import gc
import importlib.metadata
import importlib.util
import json
import logging
import os
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from fenics_contact.mesh import loading
from fenics_contact.report.drawing import style
from fenics_contact.simulation import end_of_run, step_driver  # loads FEniCSx in the right order
from fenics_contact.trust.error_estimates.budget import ErrorBudget
from fenics_contact.trust.exact_bias import Bias
from tests import compiled_headers, messages, shares
from tests.scenes import ROOT

from ffcx.codegeneration import jit  # isort: skip
from mpi4py import MPI  # isort: skip
from petsc4py import PETSc  # isort: skip

COMM = MPI.COMM_WORLD


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    gc.disable()  # until all is imported, of which nothing is garbage
    if COMM.rank > 0:  # one rank reports
        reporter = config.pluginmanager.getplugin("terminalreporter")
        config.pluginmanager.unregister(reporter)
    if config.getoption("write_messages"):
        if COMM.size > 1 or config.getoption("numprocesses", None):
            raise pytest.UsageError("--write-messages: one process writes them")
        messages.WRITTEN = {}


def pytest_unconfigure(config):
    if messages.WRITTEN is not None:
        messages.write()
    COMM.Barrier()  # a rank that ends early would take the report of rank 0 with it


def pytest_addoption(parser):
    parser.addoption(
        "--write-messages", action="store_true",
        help="write what messages say now into tests/messages.toml",
    )  # fmt: skip
    shares.add_options(parser)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """With ``--dist loadfile`` files that take long are not begun last."""
    if config.getoption("dist") != "loadfile":
        return None
    from tests.longest_first import LongestFirst  # xdist is there

    return LongestFirst(config, log)


def pytest_collection_modifyitems(config, items):
    left_out = shares.left_out(items, config.getoption, COMM.size)
    config.hook.pytest_deselected(items=[item for item in items if item in left_out])
    items[:] = [item for item in items if item not in left_out]


def pytest_collection_finish(session):
    """All that is imported by now stays: garbage is not looked for in it again and again."""
    gc.freeze()
    gc.enable()


def pytest_runtest_logreport(report):
    """A test that fails on one rank leaves the others waiting: end the run, and say why."""
    if COMM.size > 1 and report.failed:
        print(f"\n[rank {COMM.rank}] {report.nodeid}\n{report.longreprtext}", file=sys.stderr)
        sys.stderr.flush()
        COMM.Abort(1)


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item, nextitem):
    """The command line's messages end with the test; communicators are freed after each file.

    Meshes and PETSc's objects that are done with hold them, and MPICH has 2048; on all ranks, also
    on those that skip a file's tests.
    """
    logger = logging.getLogger("fenics_contact")
    logger.handlers.clear()
    logger.setLevel(logging.NOTSET)
    if nextitem is None or nextitem.path != item.path:
        gc.collect()
        PETSc.garbage_cleanup(COMM)


def _without_errors(patch):
    patch.setattr(step_driver, "error_budget", lambda *history: ErrorBudget())
    patch.setattr(end_of_run, "exact_bias", lambda load_steps: Bias())


@pytest.fixture(scope="module", autouse=True)
def _error_budget_of_fixtures(request):
    """What a file solves for its tests has errors estimated if one of these is of errors."""
    tests = (item for item in request.session.items if item.path == request.path)
    with pytest.MonkeyPatch.context() as patch:
        if not any(test.get_closest_marker("errors") for test in tests):
            _without_errors(patch)
        yield


@pytest.fixture(autouse=True)
def _error_budget(request, monkeypatch):
    """Only tests of errors have them estimated: it takes about as long as a run."""
    if request.node.get_closest_marker("errors") is None:
        _without_errors(monkeypatch)


@pytest.fixture(autouse=True)
def _pdfs_quickly(request, monkeypatch):
    """Empty PDFs beside pictures, which take half their time; for papers outlines of letters.

    Instead of parts of fonts, which take a fifth of the time of a figure.
    """
    if request.node.get_closest_marker("pdf") is not None:
        return
    saved = Figure.savefig

    def save(figure, path, **look):
        if Path(path).suffix == ".pdf" and "format" not in look:
            return Path(path).touch()
        return saved(figure, path, **look)

    monkeypatch.setattr(Figure, "savefig", save)
    monkeypatch.setitem(style.STYLE, "pdf.fonttype", 3)


@pytest.fixture(scope="session", autouse=True)
def _forms_compiled_quickly(tmp_path_factory):
    """The C compiler does not optimise forms: small meshes never give back the time it takes.

    Nor does it read Python's headers again for each of them (``compiled_headers``), and what a
    process has loaded it does not look for again.

    A file for dolfinx says so, hence programs that tests start find it too. Its cache holds these
    forms beside those of users, for the compiler's options are part of a form's name. And
    setuptools looks through all installed packages once, not several times a form.
    """
    config = tmp_path_factory.mktemp("config")
    options = config / "dolfinx" / "dolfinx_jit_options.json"
    options.parent.mkdir()
    options.write_text(json.dumps({"cffi_extra_compile_args": compiled_headers.options()}))
    entry_points = functools.cache(importlib.metadata.entry_points)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(config))
        if compiled_headers.is_tiny():  # it knows no option by which Debian's Python links
            patch.setenv("LDSHARED", f"{os.environ['CC']} -shared")
        patch.setattr(importlib.metadata, "entry_points", entry_points)
        search = loaded_once(without_listing(jit.get_cached_module))
        patch.setattr(jit, "get_cached_module", search)
        yield


def loaded_once(load):
    """A search for compiled forms, but for those that this process has.

    What is no longer there is searched for as ever, for it is to be compiled anew.
    """
    loaded = {}

    def find(module_name, object_names, cache_dir, timeout):
        wanted = (str(cache_dir), module_name, *object_names)
        if wanted in loaded and Path(cache_dir, f"{module_name}.c.cached").exists():
            return loaded[wanted]
        objects, module = load(module_name, object_names, cache_dir, timeout)
        if module is not None:
            loaded[wanted] = objects, module
        return objects, module

    return find


def without_listing(load):
    """FFCx's search, which lists all files of the cache for each form, thousands: by its name."""

    def find(module_name, object_names, cache_dir, timeout):
        file = Path(cache_dir, module_name + EXTENSION_SUFFIXES[0])
        if not Path(cache_dir, f"{module_name}.c.cached").exists() or not file.exists():
            return load(module_name, object_names, cache_dir, timeout)
        spec = importlib.util.spec_from_file_location(module_name, file)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return [getattr(module.lib, name) for name in object_names], module

    return find


@pytest.fixture(scope="session")
def _meshes_made():
    return {}


@pytest.fixture(autouse=True)
def _geometries_of_the_repository(_meshes_made, monkeypatch):
    """Gmsh makes each mesh of these once: it starts slowly, and few tests are of it."""
    make, ours, made = loading._read, os.path.abspath(ROOT / "meshes"), _meshes_made

    def read(key, source, dimension, sizes, curved, cuts):
        if sizes is not None or not os.path.abspath(source.file).startswith(ours):
            return make(key, source, dimension, sizes, curved, cuts)
        wanted = repr((key, source, dimension, curved, cuts))
        if wanted not in made:
            made[wanted] = make(key, source, dimension, None, curved, cuts)
        return copy.deepcopy(made[wanted])

    monkeypatch.setattr(loading, "_read", read)


@pytest.fixture
def folder(tmp_path) -> Path:
    """A temporary folder, the same on every rank."""
    return COMM.bcast(tmp_path)
