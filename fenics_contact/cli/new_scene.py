"""Scenes to start from: ``fenics-contact new``, and ``look``, by a file of the user's."""

from __future__ import annotations

import json
import logging
import os
import re
import shlex
import tomllib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomlkit

from fenics_contact.cli.proposal import Proposal, gap_words
from fenics_contact.common.atomic_files import make_folder, replace_file
from fenics_contact.common.errors import InputError, MachineError
from fenics_contact.common.program import mesh_file, templates
from fenics_contact.common.wording import did_you_mean, one_line
from fenics_contact.mesh.facing_surfaces import facing_pairs
from fenics_contact.mesh.loading import is_geometry, load_to_look
from fenics_contact.mesh.survey import FoundPlace, FoundSurface, Survey, survey
from fenics_contact.report.gallery import require
from fenics_contact.report.page.look import BodyRow, Look, PairRow, PlaceRow, SurfaceRow, look_page
from fenics_contact.scene.scene import MeshSource

logger = logging.getLogger(__name__)

PAGE, SCENE = "look.html", "scene.toml"
_BEFORE = 0.04  # of the diagonal of all: how far numbers stand before their surfaces
_CURVATURE = 12  # cells around a full circle of a CAD file


def look_at(path: Path, out: Path | None, tolerance: float | None) -> str:
    """Look at a CAD or mesh file, and write what was found.

    Args:
        path: The file.
        out: Folder for the page and the scene; by default ``results/NAME_look``.
        tolerance: Of gaps between surfaces that face each other (length).

    Returns:
        What was found and written, and the commands that come next.

    Raises:
        InputError: The file cannot be read, or there is a scene in the folder already.
    """
    require("plotly")
    folder = out or Path("results") / f"{path.stem}_look"
    scene, page = folder / SCENE, folder / PAGE
    if scene.exists():
        raise InputError(f"look: '{scene}' exists, and is left as it is; give another --out")
    curvature = _CURVATURE if path.suffix.lower() in (".step", ".stp", ".brep") else None
    logger.info("reading '%s'", path)
    mesh, exact = load_to_look(MeshSource(str(path), curvature=curvature))
    found = survey(mesh, exact)
    logger.info("looking for pairs of surfaces, among %d", len(found.surfaces))
    pairs = facing_pairs(found, tolerance)
    name = os.path.relpath(path, folder).replace(os.sep, "/")
    made_for = next(iter(mesh.kinematics), "")
    proposal = Proposal(
        *(found, pairs, name, curvature, is_geometry(MeshSource(str(path)))),
        *(made_for, mesh.order),
    )
    text = proposal.text()
    commands = [f"fenics-contact {what} {shlex.quote(str(scene))}" for what in ("check", "run")]
    look = Look(
        title=path.name,
        dimension=found.dimension,
        bodies=[
            BodyRow(number, body.label, f"{body.measure:.5g}")
            for number, body in enumerate(found.bodies, start=1)
        ],
        surfaces=[_row(surface, found) for surface in found.surfaces],
        pairs=[
            PairRow(
                contact.name,
                (*contact.pair.first, *contact.pair.second),
                _sides(found, contact.pair.bodies, (contact.pair.first, contact.pair.second)),
                gap_words(contact.pair),
            )
            for contact in proposal.contacts
        ],
        relations=[*(relation.words for relation in found.relations), *mesh.notes],
        scene=text,
        commands=commands,
        cells=found.cells,
        places=[_place_row(one, found.dimension) for one in found.places],
    )
    drawn = look_page(look, [surface.triangles for surface in found.surfaces], found.rest)
    try:
        make_folder(folder)
        replace_file(page, drawn.encode())
        replace_file(scene, text.encode())
    except MachineError as error:
        raise InputError(f"look: the page cannot be written: {error}") from None
    return _said(look, page, scene)


def _sides(found: Survey, bodies: Sequence[int], sides: Sequence[Sequence[int]]) -> tuple[str, str]:
    words = [
        f"{found.bodies[body].label}: {', '.join(_called(found.surfaces[n]) for n in side)}"
        for body, side in zip(bodies, sides, strict=True)
    ]
    return words[0], words[1]


def _called(surface: FoundSurface) -> str:
    return str(surface.number) if surface.number is not None else surface.name


def _row(surface: FoundSurface, found: Survey) -> SurfaceRow:
    shape = surface.shape
    kind = shape.kind if surface.is_outward or not shape.radius else f"{shape.kind} (hole)"
    return SurfaceRow(
        called=_called(surface),
        names=", ".join(surface.names),
        bodies=surface.bodies,
        kind=f"{kind}, inside" if surface.is_inside else kind,
        measure=f"{surface.measure:.5g}",
        place=_place(surface, found.dimension),
        at=_before(surface, _BEFORE * found.size),
    )


def _place_row(found: FoundPlace, dimension: int) -> PlaceRow:
    ends = [_vector(end, dimension) for end in found.ends]
    place = f"around {_vector(found.centre, dimension)}"
    if found.length == 0 and len(ends) == 1:
        place = ends[0]
    elif found.length and len(ends) == 2:
        place = f"from {ends[0]} to {ends[1]}"
    length = f"{found.length:.5g}" if found.length else ""
    return PlaceRow(found.name, length, place, found.pieces)


def _before(surface: FoundSurface, distance: float) -> tuple[float, ...]:
    """A place before the middle of a surface."""
    middles = surface.triangles.mean(axis=1)
    nearest = int(np.argmin(np.linalg.norm(middles - middles.mean(axis=0), axis=1)))
    return tuple((middles[nearest] + distance * surface.normals[nearest]).tolist())


def _place(surface: FoundSurface, dimension: int) -> str:
    """Where a surface is: its centre or axis, its normal, its radii."""
    shape = surface.shape
    words = [f"{'apex' if shape.kind == 'cone' else 'centre'} {_vector(shape.centre, dimension)}"]
    if shape.kind in ("plane", "straight line"):
        words.append(f"normal {_vector(surface.normals[0], dimension)}")
    elif shape.axis:
        words.append(f"axis {_vector(shape.axis, dimension)}")
    if shape.ring is not None:
        words.append(f"ring radius {shape.ring:.5g}")
    if shape.radius is not None:
        words.append(f"radius {shape.radius:.5g}")
    if shape.angle is not None:
        words.append(f"half-angle {shape.angle:.4g}°")
    return ", ".join(words)


def _vector(values: Sequence[float], dimension: int) -> str:
    size = max(1.0, *(abs(value) for value in values))
    shown = [0.0 if abs(value) < 1e-9 * size else value for value in values[:dimension]]
    return f"({', '.join(f'{value:.5g}' for value in shown)})"


def _said(look: Look, page: Path, scene: Path) -> str:
    kind = "curves" if look.dimension == 2 else "surfaces"
    lines = [
        f"{look.title}: {_count(look.bodies, 'bodies')}, {_count(look.surfaces, kind)}",
        *(f"  {body.number} {body.name} ({body.measure})" for body in look.bodies),
        *(f"  {words}" for words in look.relations),
        *_points_and_edges(look),
        f"{_count(look.pairs, 'pairs')} for contacts" + (":" if look.pairs else ""),
        *(f"  {p.name}: {p.sides[0]}; {p.sides[1]}; they {p.words}" for p in look.pairs),
        f"Wrote {page} and {scene}",
        "Next:",
        f"  open {page} in a browser",
        *(f"  {command}" for command in look.commands),
    ]
    return "\n".join(map(one_line, lines))


def _points_and_edges(look: Look) -> list[str]:
    """A line on the points and edges that supports may hold."""
    if not look.places:
        return []
    edges = [row for row in look.places if row.length]
    points = [row for row in look.places if not row.length]
    counts = [_count(rows, word) for rows, word in ((points, "points"), (edges, "edges")) if rows]
    first = look.places[0].called
    return [f"  {' and '.join(counts)} that supports may hold, such as on = {json.dumps(first)}"]


def _count(things: Sequence[object], word: str) -> str:
    one = {"bodies": "body"}.get(word, word.removesuffix("s"))
    return f"{len(things)} {one if len(things) == 1 else word}"


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
