"""Arrays and a header in one file, with a checksum, replaced in one move."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import InputError

Arrays = dict[str, NDArray[Any]]

_UNREADABLE = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)


def write(path: Path, header: dict[str, Any], arrays: Arrays) -> None:
    """Replace a file in one move, so that it is whole at any moment.

    Raises:
        MachineError: It could not be written.
    """
    text = np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)
    contents = arrays | {"header": text}
    digest = np.frombuffer(_checksum(contents), dtype=np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, checksum=digest, **contents)  # type: ignore[arg-type]
    with buffer.getbuffer() as content:
        replace_file(path, content, durable=True)


def read(path: Path) -> tuple[dict[str, Any], Arrays]:
    """Header and arrays of a file.

    Raises:
        InputError: It is damaged, or no such file at all.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        digest = arrays.pop("checksum").tobytes()
        if digest != _checksum(arrays):
            raise ValueError("checksum")
        header = json.loads(arrays.pop("header").tobytes())
    except _UNREADABLE:
        raise InputError(
            f"--resume: '{path}' is damaged; without --resume the run begins anew"
        ) from None
    return header, arrays


def _checksum(arrays: Arrays) -> bytes:
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype} {array.shape}".encode())
        digest.update(array.tobytes())
    return digest.digest()
