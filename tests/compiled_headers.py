"""How tests have forms compiled: quickly, as each is used for a few cells only.

GCC reads the headers of a form once and keeps them compiled; it takes these where they were made
with the same options. The Tiny C Compiler (``CC=tcc``) reads them in no time, and takes a fifth of
GCC's time for a form.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

import ffcx.codegeneration

# Without optimisation, without what debuggers need, without warnings.
QUICKLY = ("-O0", "-g0", "-w")
# The Tiny C Compiler has no complex numbers. Forms of real numbers name them only in types of
# pointers, which may then be pointers to real ones.
_TINY = ("-U__STDC_NO_COMPLEX__", "-D_Complex=")
# What cffi defines and includes before and around a form.
_TEXT = """\
#define _CFFI_
#include <pyconfig.h>
#define Py_LIMITED_API
#include <Python.h>
#include <math.h>
#include <stdalign.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <ufcx.h>
"""


def is_tiny() -> bool:
    """Whether the C compiler is the Tiny C Compiler."""
    return Path(os.environ.get("CC", "").strip()).name == "tcc"


def options() -> list[str]:
    """What the C compiler is told for each form."""
    return [*QUICKLY, *(_TINY if is_tiny() else ("-include", str(compiled())))]


def compiled() -> Path:
    """The header to include, with its compiled form beside it; the same file for all tests.

    In the user's cache, as its path is part of the names of forms, which later runs find again.
    """
    command = command_of_forms()
    key = "\n".join([*command, sys.version, ffcx.__version__, _TEXT])
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = cache / "fenics_contact_tests" / hashlib.sha256(key.encode()).hexdigest()[:16]
    header = folder / "form.h"
    if not header.exists():
        folder.mkdir(parents=True, exist_ok=True)
        # Renamed at the end: other processes may be doing the same.
        with tempfile.TemporaryDirectory(dir=folder) as temporary:
            mine = Path(temporary) / "form.h"
            mine.write_text(_TEXT)
            made = mine.with_suffix(".h.gch")
            subprocess.run([*command, mine, "-o", made], check=True, stdin=subprocess.DEVNULL)
            made.replace(folder / made.name)
            mine.replace(header)
    return header


def command_of_forms() -> list[str]:
    """The C compiler as setuptools calls it for a form."""
    options = [sysconfig.get_config_var(name) or "" for name in ("CC", "CFLAGS", "CCSHARED")]
    options[0] = os.environ.get("CC") or options[0]
    folders = [ffcx.codegeneration.get_include_path(), sysconfig.get_path("include")]
    return [*" ".join(options).split(), *(f"-I{f}" for f in folders), "-std=c17", *QUICKLY]
