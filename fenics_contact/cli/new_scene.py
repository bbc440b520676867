"""Scenes to start from: ``fenics-contact new``."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import tomlkit

from fenics_contact.common.atomic_files import make_folder, replace_file
from fenics_contact.common.errors import InputError, MachineError
from fenics_contact.common.program import mesh_file, templates
from fenics_contact.common.wording import did_you_mean

_GEOMETRY = re.compile(r'^file = "([^"]+\.(?:geo|step))"', re.MULTILINE)


def listed() -> str:
    """A line for each scene: its name, and what it is."""
    found = {name: _read(path) for name, path in templates().items()}
    width = max(map(len, found))
    titles = (
        f"  {name:{width}}  {tomllib.loads(text)['title']}" for name, text in sorted(found.items())
    )
    return "\n".join(["Scenes to start from:", *titles, "Write one with: fenics-contact new NAME"])


def write(name: str | None, out: Path | None = None) -> str:
    """Write a scene, and its geometry beside it under the same name.

    Args:
        name: Of the scene.
        out: File to write; by default the name with ``.toml``, in the current folder.

    Returns:
        What was written, and the commands that come next.

    Raises:
        InputError: There is no such scene, or a file is there already, or cannot be written.
    """
    known = templates()
    if name not in known:
        wanted = f"there is no scene '{name}'" if name else "say which scene"
        near = did_you_mean(name, list(known)) if name else ""
        raise InputError(f"new: {wanted}{near or '; there are ' + ', '.join(known)}")
    scene = out or Path(f"{name}.toml")
    if scene.suffix != ".toml":
        raise InputError(f"--out '{scene}': must end in .toml")
    text = _read(known[name])
    (source,) = geometries(text)
    geometry = scene.with_suffix(Path(source).suffix)
    for path in (scene, geometry):
        if path.exists():
            raise InputError(f"new: '{path}' exists, and is left as it is; give another --out")
    text = _GEOMETRY.sub(lambda _: f"file = {tomlkit.string(geometry.name).as_string()}", text)
    try:
        make_folder(scene.parent)
        replace_file(geometry, Path(mesh_file(source)).read_bytes())
        replace_file(scene, text.encode())
    except MachineError as error:
        raise InputError(f"new: {error}") from None
    return _next(tomllib.loads(text)["title"], scene, geometry)


def geometries(text: str) -> set[str]:
    """The files of a scene's meshes."""
    return set(_GEOMETRY.findall(text))


def _next(title: str, scene: Path, geometry: Path) -> str:
    file, results = shlex.quote(str(scene)), shlex.quote(f"results/{scene.stem}")
    commands = {
        f"check {file}": "what would be modelled",
        f"run {file}": f"solves it, into {results}",
        f"report {results}": "pictures and a page",
    }
    width = max(map(len, commands))
    lines = (f"  fenics-contact {words:{width}}  # {what}" for words, what in commands.items())
    wrote = f"Wrote {scene} and its geometry {geometry}: {title}"
    return "\n".join([wrote, "Next:", *lines])


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")
