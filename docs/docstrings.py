"""Sphinx: docstrings of this package as autodoc shows them.

Keys of scene classes are told in the words of the scene reference, not by their annotations. A
class that is in no page is named without a link; one that does not exist stays a warning.
"""

from __future__ import annotations

import dataclasses
import pkgutil
import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

_LITERAL = re.compile(r"(``.*?``)")


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to autodoc."""
    app.connect("autodoc-process-signature", _signature)
    app.connect("autodoc-process-docstring", _add_keys)
    app.connect("autodoc-process-docstring", _escape)
    app.connect("missing-reference", _inner_class)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _is_of_scenes(value: Any) -> bool:
    module = getattr(value, "__module__", "")
    named = module.startswith("fenics_contact.scene")
    return named and isinstance(value, type) and hasattr(value, "__pydantic_fields__")


def _signature(
    app: Sphinx, what: str, name: str, value: Any, options: Any, signature: str, returned: str
) -> tuple[str, str] | None:
    """Of dataclasses the names, with the defaults of a scene class's keys; types are told below."""
    from fenics_contact.scene.reference import keys_of

    if not _is_of_scenes(value):
        if what == "class" and dataclasses.is_dataclass(value):
            return f"({', '.join(field.name for field in dataclasses.fields(value))})", ""
        return None
    words = []
    for key in keys_of(value):
        default = {"none": "None", "see below": "…"}.get(key.default, key.default.strip("`"))
        words.append(key.name if default == "required" else f"{key.name}={default}")
    return f"({', '.join(words)})", ""


def _add_keys(
    app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """What each key of a scene class takes and means."""
    from fenics_contact.scene.reference import keys_of

    if _is_of_scenes(value):
        for key in keys_of(value):
            meaning = re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", key.description)
            takes = re.sub(r"`([^`]+)`", r"``\1``", key.accepts)
            lines.append(f":param {key.name}: {meaning}; {takes}")
        lines.append("")


def _inner_class(
    app: Sphinx, env: Any, node: nodes.Element, shown: nodes.TextElement
) -> nodes.TextElement | None:
    """The plain name of a class of this package that has no page."""
    target = node.get("reftarget", "")
    if node.get("reftype") != "class" or not target.startswith("fenics_contact."):
        return None
    try:
        pkgutil.resolve_name(target)
    except (ImportError, AttributeError):
        return None
    return shown


def _escape(app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    """|x| is an absolute value, and str_ a type: neither is a reference."""
    lines[:] = ["".join(map(_plain, _LITERAL.split(line))) for line in lines]


def _plain(part: str) -> str:
    if part.startswith("``"):
        return part
    return re.sub(r"(?<=\w)_(?=\W|$)", r"\\_", part.replace("|", r"\|"))
