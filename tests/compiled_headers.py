"""The headers of a compiled form, read by the C compiler once and not for every form.

It takes what it has kept where that was made with the same options; else it reads the headers.
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
