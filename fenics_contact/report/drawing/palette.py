"""Pictures with 256 colours, which take a third of the room."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.report.drawing.style import COLOURS

if TYPE_CHECKING:
    from PIL.Image import Image

_LARGE = 150_000  # bytes from which a picture is made smaller for a page
_EVERY = 4  # pixels between those that colours are chosen from


def palette_of(pictures: list[NDArray[np.uint8]]) -> Image:
    """The 256 colours of pictures, (height, width, 3) each, as Pillow takes them."""
    from PIL import Image

    # Without a share of their own, colours of a few points alone would be given up.
    height, width = pictures[0].shape[:2]
    own = [np.full((height // 12, width, 3), _rgb(colour)) for colour in COLOURS.values()]
    return Image.fromarray(np.concatenate([*pictures, *own]).astype(np.uint8)).quantize(256)


def small_png(path: Path) -> bytes:
    """The content of a PNG file, with fewer colours if it is large."""
    content = path.read_bytes()
    if len(content) < _LARGE:
        return content
    from PIL import Image

    picture = Image.open(io.BytesIO(content)).convert("RGB")
    palette = palette_of([np.asarray(picture)[::_EVERY, ::_EVERY]])
    small = io.BytesIO()
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(small, "PNG")
    return min(content, small.getvalue(), key=len)


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))
