"""The room of a process that meshes or reads one file: what it may take, and how it answers.

It imports nothing that would start MPI.
"""

import contextlib
import io
import json
import os
import resource
import shutil
import signal
import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np

Job = dict[str, Any]
Arrays = dict[str, np.ndarray]


class RefusedError(Exception):
    """Raised with what is wrong with the scene's [mesh], to follow the name of its key."""


def answer(work: Callable[[Job], tuple[dict[str, Any], Arrays]], writes: int = 0) -> None:
    """Do the job and write the mesh, or what is wrong with it, to standard output as an ``.npz``.

    The job is this program's first argument (JSON), and the second the number of a pipe: it ends
    when that is closed.

    Args:
        work: From the job to the model's description and the mesh's arrays.
        writes: Bytes that files may have in the end, where sizes of cells are given.
    """
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries print; standard output is for the mesh alone
    job = json.loads(sys.argv[1])
    threading.Thread(target=_end_with, args=(int(sys.argv[2]), job["folder"]), daemon=True).start()
    _restrict(job, writes)
    arrays: Arrays = {}
    try:
        description, arrays = work(job)
    except RefusedError as error:
        description = {"refused": str(error)}
    except Exception as error:  # Gmsh raises plain Exceptions, and damaged files raise any
        description = {"failed": " ".join(str(error).split()), "error": type(error).__name__}
    buffer = io.BytesIO()
    arrays["description"] = np.array(json.dumps(description))
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    output.write(buffer.getbuffer())
    output.close()


def _end_with(pipe: int, folder: str) -> None:
    """End when the run that started this process does: then its end of the pipe is closed."""
    os.read(pipe, 1)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def _restrict(job: Job, writes: int) -> None:
    """No file may grow and no program may start from here on; memory has an end."""
    # Should Gmsh be brought to start one, it finds none. The system lets root start processes.
    os.environ["PATH"] = os.devnull
    resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    # With sizes a file is to be written once the script has run, which cannot raise the limit.
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, writes if job.get("sizes") else 0))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if job["memory"]:
        with contextlib.suppress(ValueError):  # a lower limit is in force already
            resource.setrlimit(resource.RLIMIT_AS, (job["memory"], job["memory"]))
