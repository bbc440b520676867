"""PETSc's options that a user gives for one run: they win, they leave, and none goes unnoticed."""

from __future__ import annotations

import ctypes
import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import of_every_rank

logger = logging.getLogger(__name__)

# Of Newton's method, its linear solves and the body's factorisation.
PREFIX = "fenics_contact_"
# Of the iterative solver: multigrid in the body, and MUMPS in the cells at the contacts.
BULK_PREFIX = f"{PREFIX}bulk_"
ZONE_PREFIX = f"{PREFIX}zone_"

# What PETSc says of a value that it does not know, or cannot take (its petscerror.h).
_REFUSALS = (56, 60, 62, 63, 83, 86, 92)
# Where it does so: as it reads its database, or looks for the package that an option names. The
# same errors from elsewhere are faults of the program.
_READING = re.compile(r"\b(PetscOptions\w+|\w+SetFromOptions\w*|MatGetFactor)\(\)")


def parse(words: Sequence[str]) -> dict[str, str]:
    """Options by their names in PETSc's database, which all begin with the program's prefix.

    Args:
        words: As on a command line: ``-name``, or ``-name value``; the prefix may be left out.

    Raises:
        InputError: A word is neither a name nor the value of one.

    >>> parse(["-snes_monitor", "-mat_mumps_icntl_14", "40", "-fenics_contact_bulk_pc_type", "ml"])
    ... # doctest: +NORMALIZE_WHITESPACE
    {'fenics_contact_snes_monitor': '', 'fenics_contact_mat_mumps_icntl_14': '40',
     'fenics_contact_bulk_pc_type': 'ml'}
    """
    found: dict[str, str] = {}
    name = ""
    for word in words:
        if _is_name(word):
            name = PREFIX + word.lstrip("-").removeprefix(PREFIX)
            found[name] = ""
        elif name and not found[name]:
            found[name] = word
        else:
            raise InputError(
                f"PETSc options: '{word}' is neither the name of one, which begins with '-' as in "
                "-snes_monitor, nor the value of one that has none yet"
            )
    return found


def _is_name(word: str) -> bool:
    return re.fullmatch(r"--?[A-Za-z]\w*", word) is not None and not _is_number(word)


def _is_number(word: str) -> bool:
    """Also -inf and -nan."""
    try:
        float(word)
    except ValueError:
        return False
    return True


@contextmanager
def given(options: dict[str, str], comm: MPI.Comm) -> Iterator[None]:
    """Options that hold inside, and are gone afterwards; collective.

    A warning names those that no solve asked for, unless the block raises.

    Args:
        options: As ``parse`` finds them.
        comm: Communicator of the run.

    Raises:
        InputError: PETSc refused one, or one with the program's prefix that ``PETSC_OPTIONS`` has.
    """
    database = PETSc.Options()
    before = database.getAll()
    for name, value in options.items():
        database.setValue(name, value)
    every = {name: value for name, value in before.items() if name.startswith(PREFIX)} | options
    try:
        yield
        _report_unused(options, comm)
    except PETSc.Error as error:
        if every and _is_refusal(error):
            said = str(error).splitlines()[-1].split("] ", 1)[-1]
            raise InputError(f"PETSc refused an option of {_listed(every)}: {said}") from None
        raise
    finally:
        for name in options:
            database.delValue(name)
            if name in before:
                database.setValue(name, before[name])


def _is_refusal(error: PETSc.Error) -> bool:
    """Whether PETSc could not take an option; not an error of ours in a callback, or its own."""
    known = error.__cause__ is None and getattr(error, "ierr", 0) in _REFUSALS
    return known and _READING.search(str(error)) is not None


def _report_unused(options: dict[str, str], comm: MPI.Comm) -> None:
    """Name what was used on no rank."""
    used = [name for name in options if is_used(name)]
    used_anywhere = {name for names in of_every_rank(comm, used) for name in names}
    unused = {name: value for name, value in options.items() if name not in used_anywhere}
    if unused:
        logger.warning(
            "PETSc options that no solve asked for: %s; misspelt, or of another solver than this "
            "run's? Those of PETSc as a whole, such as -log_view, go into PETSC_OPTIONS",
            _listed(unused),
        )


def is_used(name: str) -> bool:
    """Whether PETSc was asked for an option on this rank; older petsc4py does not say.

    Args:
        name: With its prefix, without a dash.
    """
    found = ctypes.c_int(0)  # PETSc writes one byte or four, by its version
    ctypes.CDLL(PETSc.__file__).PetscOptionsUsed(None, name.encode(), ctypes.byref(found))
    return bool(found.value)


def _listed(options: dict[str, str]) -> str:
    """Options as a user writes them."""
    return " ".join(f"-{n.removeprefix(PREFIX)} {v or ''}".rstrip() for n, v in options.items())
