"""The Python of a page as files, a folder each, for tools that read files: ``mypy``.

    python docs/examples_as_files.py FOLDER PAGE …

A block after ``<!-- example: saved as FILE -->`` is a file of that name for all blocks of the page.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

_BLOCK = re.compile(r"(?:<!-- example: saved as (\S+) -->\s+)?^```python\n(.*?)^```", re.S | re.M)


def write(page: Path, folder: Path) -> list[Path]:
    """Write the blocks of a page.

    Args:
        page: A page in Markdown.
        folder: Where to; made if it is not there.

    Returns:
        The files: modules by their names, other blocks as ``example_LINE.py``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    text, files = page.read_text(encoding="utf-8"), []
    for found in _BLOCK.finditer(text):
        line = text.count("\n", 0, found.start(2))
        file = folder / (found[1] or f"example_{line}.py")
        file.write_text(found[2], encoding="utf-8")
        files.append(file)
    return files


if __name__ == "__main__":
    for page in map(Path, sys.argv[2:]):
        write(page, Path(sys.argv[1]) / page.stem)
