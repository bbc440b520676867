"""The command ``fenics-contact``, and the same for scripts that build their own scene."""

from __future__ import annotations

import argparse
import logging
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path

from mpi4py import MPI

from fenics_contact import files
from fenics_contact.adaptivity import adaptive_plan
from fenics_contact.errors import InputError
from fenics_contact.faults import READER_LEFT, drop_output, explain, failing_together, say
from fenics_contact.interrupts import Interrupts
from fenics_contact.parallel import on_root
from fenics_contact.progress import step_bar
from fenics_contact.result import Result
from fenics_contact.scene import Scene
from fenics_contact.scene_file import load_scene
from fenics_contact.simulation import Run
from fenics_contact.state_file import StateFile
from fenics_contact.summary import print_model, print_result

logger = logging.getLogger(__name__)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run ``fenics-contact`` and return its exit code."""
    parser = argparse.ArgumentParser(
        prog="fenics-contact",
        description="Contact with friction in elastostatics (Campos, Oden & Kikuchi 1982).",
        epilog="Exit codes: 0 converged and all checks passed, 2 bad input or no equilibrium, "
        "3 not converged, 4 a physics check failed, 5 the machine failed, 130 interrupted.",
    )
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="solve a scene; also under mpirun -n N")
    check = commands.add_parser("check", help="say what would be modelled, without solving")
    report = commands.add_parser("report", help="pictures and a page from the files of a run")
    verify = commands.add_parser("verify", help="run analytic and published benchmarks")
    for command in (run, check):
        command.add_argument("scene", metavar="SCENE.toml", type=Path)
        command.add_argument(
            "--set",
            dest="overrides",
            metavar="table.key=value",
            action="append",
            default=[],
            help="replace a value of the scene; list entries count from 0: load.0.pressure=5",
        )
        _add_verbosity(command)
    run.add_argument(
        "--out", type=Path, help="folder for the results (default: results/ and the scene's name)"
    )
    _add_resume(run)
    report.add_argument("folder", metavar="DIR", type=Path)
    verify.add_argument("names", metavar="NAME", nargs="*", help="benchmarks to run (default: all)")
    verify.add_argument("--quick", action="store_true", help="coarser and fewer: about a minute")
    verify.add_argument("--hard", action="store_true", help="the hard cases instead: minutes")
    verify.add_argument("--errors", action="store_true", help="error bars against true errors")
    verify.add_argument("--json", metavar="FILE", type=Path, help="write a list of what was found")
    verify.add_argument(
        "--table", metavar="FILE", type=Path, help="of hard cases or errors: write it, in Markdown"
    )
    options = parser.parse_args(arguments)
    if options.command == "verify":
        return guarded(lambda: _verify(options))
    if options.command == "report":
        return guarded(lambda: on_root(MPI.COMM_WORLD, lambda: _report(options.folder)))
    _log_to_terminal(options)
    return guarded(lambda: _scene_command(options))


def run_script(
    scene: Scene, default_folder: str, description: str = "", arguments: Sequence[str] | None = None
) -> int:
    """What a demo script does with its scene: solve, write, draw; for any number of ranks.

    Args:
        scene: What to solve.
        default_folder: Where results go without ``--out``.
        description: Text of ``--help``.
        arguments: Command line; by default that of the process.

    Returns:
        The exit code.
    """
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=Path, default=Path(default_folder), help="results folder")
    parser.add_argument("--no-pictures", action="store_true", help="write files only")
    _add_resume(parser)
    _add_verbosity(parser)
    options = parser.parse_args(arguments)
    _log_to_terminal(options)
    pictures = not options.no_pictures
    return guarded(lambda: _solve(scene, options.out, options.resume, pictures))


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
        found = comm.allgather(explain(error))
    if comm.rank == 0:
        for said in dict(reversed(found)).values():  # the first rank's of every code
            say(said)
        if found[0][0] == READER_LEFT:
            drop_output()
    comm.Barrier()
    return found[0][0]


def _scene_command(options: argparse.Namespace) -> int:
    comm = MPI.COMM_WORLD
    scene = on_root(comm, lambda: load_scene(options.scene, options.overrides))
    if options.command == "run":
        folder = options.out or Path("results") / options.scene.stem
        return _solve(scene, folder, options.resume, pictures=False)
    prepared = Run(scene, comm)
    model = prepared.model
    plan = adaptive_plan(prepared)
    if comm.rank == 0:
        print_model(scene, model, prepared.contacts(), plan)
    return 0


def _solve(scene: Scene, folder: Path, resume: bool, pictures: bool) -> int:
    comm = MPI.COMM_WORLD
    files.require_writable(folder, comm)
    prepared = Run(scene, comm)
    if scene.accuracy is not None:
        result = _solve_levels(prepared, folder, resume)
        return _conclude(result, folder, pictures)
    state = StateFile(folder, prepared.problem)
    saved = state.load() if resume else None
    if not resume:
        state.remove()
    if saved is not None and saved.is_done(scene):
        logger.info("'%s' holds a finished run: nothing to resume", folder)
        return saved.exit_code or 0
    if saved is not None:
        logger.info("resuming after time %g", saved.last.unknowns.time)
    elif resume:
        logger.info("there is no '%s' to resume from: beginning at the start", state.path)
    with (
        Interrupts() as interrupts,
        step_bar(scene.steps, comm) if _shows_steps() else nullcontext() as announce,
    ):
        asked = interrupts.requested
        result = files.solve_and_write(prepared, folder, state, saved, asked, announce)
    if result.converged:
        state.finish(result.exit_code)
    return _conclude(result, folder, pictures)


def _solve_levels(prepared: Run, folder: Path, resume: bool) -> Result:
    """A scene that asks for an accuracy."""
    if resume:
        raise InputError("--resume: a scene with accuracy begins at its first mesh; leave it out")
    StateFile(folder, prepared.problem).remove()
    steps, comm = prepared.scene.steps, prepared.problem.comm
    with (
        Interrupts() as interrupts,
        step_bar(steps, comm) if _shows_steps() else nullcontext() as announce,
    ):
        return files.solve_levels_and_write(prepared, folder, interrupts.requested, announce)


def _conclude(result: Result, folder: Path, pictures: bool) -> int:
    """Say what came out, and draw it."""
    comm = MPI.COMM_WORLD
    if comm.rank == 0 and (logger.isEnabledFor(logging.INFO) or not result.passed):
        print_result(result, folder)
    if pictures:
        on_root(comm, lambda: _draw(folder))
    return result.exit_code


def _shows_steps() -> bool:
    return logger.isEnabledFor(logging.INFO)


def _draw(folder: Path) -> None:
    """Pictures after a run: the answer stands without them."""
    try:
        _report(folder)
    except InputError as error:
        logger.warning("no pictures: %s", error)


def _report(folder: Path) -> int:
    from fenics_contact.report import write_report

    for path in write_report(folder):
        print(f"  {path}")
    return 0


def _verify(options: argparse.Namespace) -> int:
    if options.hard and options.errors:
        raise InputError("verify: give either --hard or --errors")
    if options.errors:
        from fenics_contact.verification.bars.command import verify_errors

        return verify_errors(options.names, options.quick, options.json, options.table)
    if options.hard:
        from fenics_contact.verification.hard.command import verify_hard

        if options.quick:
            raise InputError("verify --hard has no --quick: name the cases to run")
        return verify_hard(options.names, options.json, options.table)
    if options.table is not None:
        raise InputError("verify --table: there is none of these; add --hard or --errors")
    from fenics_contact.verification.command import verify

    return verify(options.names, options.quick, options.json)


def _add_resume(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on from the last load step in the folder, on any number of ranks; the scene's "
        "steps and solver may have changed, nothing else",
    )


def _add_verbosity(parser: argparse.ArgumentParser) -> None:
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--verbose", action="store_true", help="every Newton step")
    group.add_argument("--quiet", action="store_true", help="warnings only")


def _log_to_terminal(options: argparse.Namespace) -> None:
    """Messages of rank 0 to the terminal; libraries stay silent about their own steps."""
    level = logging.WARNING if options.quiet else logging.INFO
    level = logging.DEBUG if options.verbose else level
    logger = logging.getLogger("fenics_contact")
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("%(message)s"))
    handler.addFilter(lambda record: MPI.COMM_WORLD.rank == 0)
    logger.handlers = [handler]
    logger.setLevel(level)
