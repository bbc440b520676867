"""Actions of the commands of ``fenics-contact``."""

from __future__ import annotations

import argparse
import logging
import signal
import sys
from collections.abc import Callable
from pathlib import Path

from mpi4py import MPI

from fenics_contact.cli.progress import activity
from fenics_contact.cli.summary import print_model, print_result
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import petsc_options, program
from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import (
    READER_LEFT,
    Interrupts,
    attempt,
    drop_output,
    explain,
    failing_together,
    say,
)
from fenics_contact.common.parallel import of_every_rank, on_root
from fenics_contact.common.terminal import PlainFormatter
from fenics_contact.common.wording import one_line
from fenics_contact.contact.laws.allowed import allow_laws
from fenics_contact.results.load_history import Announce
from fenics_contact.results.result import Result
from fenics_contact.scene.reading import load_scene
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.output.journal_file import FolderLock
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.state_file import StateFile

logger = logging.getLogger(__name__)


def execute(options: argparse.Namespace) -> int:
    """Do what a command line asks for, and return the exit code; collective.

    Args:
        options: As ``cli.program.parse`` finds them.
    """
    if options.version:
        return guarded(lambda: on_root(MPI.COMM_WORLD, _print_all_versions))
    _log_to_terminal(options, logging.WARNING if options.command == "verify" else logging.INFO)
    actions: dict[str, Callable[[], int]] = {
        "check": lambda: _check(options),
        "compare": lambda: on_root(MPI.COMM_WORLD, lambda: _compare(options)),
        "explore": lambda: _explore(options),
        "fit": lambda: _fit(options),
        "look": lambda: on_root(MPI.COMM_WORLD, lambda: _look(options)),
        "new": lambda: on_root(MPI.COMM_WORLD, lambda: _new(options)),
        "report": lambda: on_root(MPI.COMM_WORLD, lambda: _asked_report(options)),
        "run": lambda: _run(options),
        "schema": lambda: _schema(options),
        "sweep": lambda: _sweep(options),
        "verify": lambda: _verify(options),
    }

    def act() -> int:
        for module in getattr(options, "laws", ()):
            allow_laws(module)
        return actions[options.command]()

    return guarded(act)


def execute_script(scene: Scene, options: argparse.Namespace) -> int:
    """Do with a scene what a script's command line asks for; collective.

    Args:
        scene: What to solve.
        options: As ``cli.program.parse_script`` finds them.
    """
    _log_to_terminal(options, logging.INFO)
    return guarded(lambda: _solve(scene, options.out, options, not options.no_pictures))


def guarded(action: Callable[[], int], comm: MPI.Comm = MPI.COMM_WORLD) -> int:
    """Run an action; turn what goes wrong into words and an exit code; collective.

    What goes wrong on one rank alone ends them all (``failing_together``).
    """
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # PETSc would call it a crash
    try:
        with failing_together(comm):
            code = action()
            sys.stdout.flush()
            comm.Barrier()  # a launcher ends the other ranks at the first that fails
            return code
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # rich's answer to it
            return READER_LEFT
        raise
    except (Exception, KeyboardInterrupt) as error:
        found = of_every_rank(comm, explain(error))
    if comm.rank == 0:
        for said in dict(reversed(found)).values():  # the first rank's of every code
            say(said)
        if found[0][0] == READER_LEFT:
            drop_output()
    comm.Barrier()
    return int(found[0][0])


def _load(options: argparse.Namespace) -> Scene:
    return on_root(MPI.COMM_WORLD, lambda: load_scene(options.scene, options.overrides))


def _check(options: argparse.Namespace) -> int:
    from fenics_contact.simulation.adaptive.targets import adaptive_plan
    from fenics_contact.simulation.description import words_on_contact_dofs
    from fenics_contact.trust.convergence.coarse_contacts import hidden_obstacles, words_on_hidden

    comm = MPI.COMM_WORLD
    scene = _load(options)
    with activity(scene.load_steps, comm, options.quiet):
        prepared = _prepared(scene, comm)
        model = prepared.model
        plan = adaptive_plan(prepared)
        hidden = hidden_obstacles(prepared.problem)
        condensed = words_on_contact_dofs(prepared.problem, prepared.choice)
    if comm.rank == 0 and not options.quiet:
        body = prepared.problem.body
        relations = [relation.words for relation in body.relations]
        said = (
            relations,
            [*body.notes, *words_on_hidden(hidden, body.dimension), *condensed],
        )
        print_model(scene, model, body.known_groups(), prepared.contacts(), plan, *said)
    return 0


def _run(options: argparse.Namespace) -> int:
    scene = _load(options)
    folder = options.out or Path("results") / options.scene.stem
    return _solve(scene, folder, options, pictures=False)


def _solve(scene: Scene, folder: Path, options: argparse.Namespace, pictures: bool) -> int:
    comm = MPI.COMM_WORLD
    settings = petsc_options.parse(options.petsc)
    files.require_writable(folder, comm)
    with FolderLock(folder) as lock, petsc_options.given(settings, comm):
        on_root(comm, lock.take)
        with activity(scene.load_steps, comm, options.quiet, scene.unit_names) as announce:
            prepared = _prepared(scene, comm)
            on_root(comm, lambda: lock.take(make=True))
            solve = _solve_steps if scene.accuracy is None else _solve_levels
            result = solve(prepared, folder, options.resume, announce)
        if isinstance(result, int):
            return result
    if comm.rank == 0 and (not options.quiet or not result.passed):
        print_result(result, folder)
    if pictures:
        on_root(comm, lambda: _draw(folder, options.quiet))
    return result.exit_code


def _prepared(scene: Scene, comm: MPI.Comm) -> Run:
    """A scene made ready, on the mesh with which it begins; collective."""
    if scene.accuracy is None:
        return Run(scene, comm)
    from fenics_contact.simulation.adaptive.next_mesh import first_run

    return first_run(scene, comm)


def _solve_steps(
    prepared: Run, folder: Path, resume: bool, announce: Announce | None
) -> Result | int:
    """The load steps of a scene; the exit code alone where an earlier run has done them all."""
    state = StateFile(folder, prepared.problem, prepared.scene)
    saved = state.load() if resume else None
    if not resume:
        state.remove()
    if saved is not None and saved.is_done(prepared.scene):
        logger.info("'%s' holds a finished run: nothing to resume", folder)
        return saved.exit_code or 0
    if saved is not None:
        logger.info("resuming after time %g", saved.time)
    elif resume:
        logger.info("there is no '%s' to resume from: beginning at the start", state.path)
    with Interrupts() as interrupts:
        asked = interrupts.requested
        result = files.solve_and_write(prepared, folder, state, saved, asked, announce)
    if result.converged and not result.interrupted:
        state.finish(result.exit_code)
    return result


def _solve_levels(prepared: Run, folder: Path, resume: bool, announce: Announce | None) -> Result:
    """The meshes of a scene that asks for an accuracy."""
    if resume:
        raise InputError("--resume: a scene with accuracy begins at its first mesh; leave it out")
    StateFile(folder, prepared.problem).remove()
    with Interrupts() as interrupts:
        return files.solve_levels_and_write(prepared, folder, interrupts.requested, announce)


def _draw(folder: Path, quiet: bool) -> None:
    """Pictures after a run: the answer stands without them."""
    notes: list[str] = []
    attempt(MPI.COMM_SELF, "no pictures", lambda: _report(folder, quiet), 0, notes)
    for note in notes:
        logger.warning("%s", note.removesuffix("."))


def _schema(options: argparse.Namespace) -> int:
    from fenics_contact.cli.completion import print_text

    return print_text(options)


def _asked_report(options: argparse.Namespace) -> int:
    """The page of a folder, or its figures for a paper."""
    if options.figures is None:
        if options.width is not None:
            raise InputError("--width: is that of --figures; say --figures pdf or --figures svg")
        return _report(options.folder, options.quiet)
    from fenics_contact.report.drawing.figures import Paper
    from fenics_contact.report.report import write_figures

    for path in write_figures(options.folder, Paper(options.figures, options.width)):
        if not options.quiet:
            print(f"  {one_line(str(path))}")
    return 0


def _report(folder: Path, quiet: bool) -> int:
    from fenics_contact.analyses import registry
    from fenics_contact.report.page.fit import write_fit_page
    from fenics_contact.report.page.sweep import write_sweep_page
    from fenics_contact.report.page.sweep_files import RECORD
    from fenics_contact.report.report import PAGE, write_report
    from fenics_contact.results.fit_record import RECORD as FIT

    if (folder / RECORD).exists():
        written = [write_sweep_page(folder)]
    elif (folder / FIT).exists():
        written = [write_fit_page(folder)]
    else:
        own = [one for one in registry.every() if one.page_of and (folder / one.page_of).exists()]
        written = [one.part("page").PAGE.write_own(folder) for one in own]
        if not written or (folder / "result.json").exists():
            written += [*(picture.path for picture in write_report(folder)), folder / PAGE]
    for path in [] if quiet else written:
        print(f"  {one_line(str(path))}")
    return 0


def _compare(options: argparse.Namespace) -> int:
    from fenics_contact.cli.compare import compare

    return compare(options)


def _sweep(options: argparse.Namespace) -> int:
    from fenics_contact.cli.sweep import sweep

    return sweep(options)


def _explore(options: argparse.Namespace) -> int:
    from fenics_contact.cli.explore import explore

    return explore(options)


def _fit(options: argparse.Namespace) -> int:
    from fenics_contact.cli.fit import fit

    return fit(options)


def _look(options: argparse.Namespace) -> int:
    from fenics_contact.cli.new_scene import look_at

    said = look_at(options.file, options.out, options.tolerance)
    if not options.quiet:
        print(said)
    return 0


def _new(options: argparse.Namespace) -> int:
    from fenics_contact.cli import new_scene

    said = new_scene.listed() if options.list else new_scene.write(options.name, options.out)
    if not options.quiet:
        print(said)
    return 0


def _print_all_versions() -> int:
    from petsc4py import PETSc

    found = compat.versions()
    mpi = " ".join(found["mpi"].split(",")[0].replace("Version:", "").split())
    print(
        f"fenics-contact {program.VERSION}, with dolfinx {found['dolfinx']}, PETSc "
        f"{'.'.join(map(str, PETSc.Sys.getVersion()))}, Python {found['python']}, {mpi}"
    )
    print(f"To cite it: {program.how_to_cite()}")
    return 0


def _verify(options: argparse.Namespace) -> int:
    if options.hard and options.errors:
        raise InputError("verify: give either --hard or --errors")
    if options.errors:
        from fenics_contact.verification.error_bars.command import verify_errors

        return verify_errors(
            options.names, options.quick, options.json, options.table, quiet=options.quiet
        )
    if options.hard:
        from fenics_contact.verification.hard.command import verify_hard

        if options.quick:
            raise InputError("verify --hard has no --quick: name the cases to run")
        return verify_hard(options.names, options.json, options.table, quiet=options.quiet)
    if options.table is not None:
        raise InputError("verify --table: there is none of these; add --hard or --errors")
    from fenics_contact.verification.command import verify

    return verify(options.names, options.quick, options.json, quiet=options.quiet)


def _log_to_terminal(options: argparse.Namespace, level: int) -> None:
    """Messages of rank 0 to the terminal; libraries stay silent about their own steps."""
    level = logging.WARNING if options.quiet else level
    level = logging.DEBUG if options.verbose else level
    logger = logging.getLogger("fenics_contact")
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(PlainFormatter("%(message)s"))
    handler.addFilter(lambda record: MPI.COMM_WORLD.rank == 0)
    handler.setLevel(level)
    for earlier in list(logger.handlers):
        logger.removeHandler(earlier)
    logger.addHandler(handler)
    logger.setLevel(level)
