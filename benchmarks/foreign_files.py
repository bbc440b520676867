"""Mesh files of other programs, at random from a folder: read, or refused by one sentence.

    python benchmarks/foreign_files.py FOLDER --number 60 --seed 1

Each folder in FOLDER is a collection, of which as many files are drawn as of each other one. That
nothing is lost in silence is held by a count of its own: solids in `.inp` and `.bdf` files, by
their keywords and cards, against those of which the mesh has cells.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import mpi4py.MPI  # noqa: F401
import numpy as np

from fenics_contact.common.errors import FenicsContactError
from fenics_contact.mesh.loading import load_to_look
from fenics_contact.scene.scene import MeshSource

SUFFIXES = (".inp", ".bdf", ".nas", ".msh", ".med", ".vtu", ".xdmf")
_SOLIDS = {4, 5, 6, 8, 10, 13, 15, 20}
_CARDS = {"CTETRA": 3, "CHEXA": 3, "CPENTA": 3, "CPYRAM": 3}


def main() -> int:
    """Read the files, and print what became of them."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("folder", type=Path)
    options.add_argument("--number", type=int, default=60)
    options.add_argument("--seed", type=int, default=1)
    given = options.parse_args()
    rows = [outcome(path) for path in drawn(given.folder, given.number, given.seed)]
    for row in rows:
        print(json.dumps(row, ensure_ascii=False))
    print(dict(Counter(row["what"] for row in rows)))
    return int(any(row["what"] in ("failed", "lost cells") for row in rows))


def drawn(folder: Path, number: int, seed: int) -> list[Path]:
    """Files at random, of each collection in turn."""
    chance = random.Random(seed)
    collections = []
    for one in sorted(path for path in folder.iterdir() if path.is_dir()):
        files = sorted(p for p in one.rglob("*") if p.suffix.lower() in SUFFIXES and is_mesh(p))
        chance.shuffle(files)
        collections.append(files)
    found: list[Path] = []
    while len(found) < number and any(collections):
        found += [files.pop() for files in collections if files]
    return found[:number]


def is_mesh(path: Path) -> bool:
    """Whether it has nodes, and is no pointer to a file elsewhere."""
    text = path.read_bytes()[:2_000_000]
    if text.startswith(b"version https://git-lfs"):
        return False
    word = {".inp": rb"(?im)^\*node\s*(,|$)", ".bdf": rb"(?im)^GRID", ".nas": rb"(?im)^GRID"}
    pattern = word.get(path.suffix.lower())
    return pattern is None or re.search(pattern, text) is not None


def outcome(path: Path) -> dict[str, Any]:
    """What became of a file."""
    row: dict[str, Any] = {"file": str(path)}
    try:
        mesh, _ = load_to_look(MeshSource(str(path)))
    except FenicsContactError as error:
        said = str(error)
        return row | {"what": "refused" if "\n" not in said else "failed", "said": said}
    except Exception as error:
        return row | {"what": "failed", "said": f"{type(error).__name__}: {error}"}
    cells = len(np.unique(mesh.elements))
    row |= {"cells": cells, "cell": mesh.cell, "order": mesh.order, "notes": mesh.notes}
    wanted = counted(path)
    if wanted is not None and mesh.points.shape[1] == 3 and wanted != cells:
        return row | {"what": "lost cells", "counted": wanted}
    if any("subdivided" in note for note in mesh.notes):
        return row | {"what": "subdivided"}
    return row | {"what": "read with notes" if mesh.notes else "read"}


def counted(path: Path) -> int | None:
    """Solids of a file, by its words; None where it includes others, or is of another kind."""
    text = path.read_text(encoding="utf-8", errors="replace")
    if re.search(r"(?im)^\*?\s*include|^\*element.*input\s*=", text):
        return None
    if path.suffix.lower() in (".bdf", ".nas"):
        words = (re.split(r"[\s,*]", line, maxsplit=1)[0] for line in text.splitlines())
        return sum(word.upper() in _CARDS for word in words)
    if path.suffix.lower() != ".inp":
        return None
    count = 0
    for block in re.split(r"(?m)^(?=\*(?!\*))", re.sub(r"(?m)^\*\*.*\n?", "", text)):
        head, _, data = block.partition("\n")
        kind = re.search(r"(?i)^\*element\b.*\btype\s*=\s*\w*?C3D(\d+)", head.replace(" ", ""))
        if kind and int(kind[1]) in _SOLIDS:
            count += len(re.findall(r"\d+", data)) // (1 + int(kind[1]))
    return count


if __name__ == "__main__":
    sys.exit(main())
