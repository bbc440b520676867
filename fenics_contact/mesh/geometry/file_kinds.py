"""Kinds of files with a mesh or a geometry: what Gmsh may read, and ways out for all others.

Every file that Gmsh opens is first brought into a folder of its own: scripts written anew from
what was understood of them, meshes and CAD files as copies with the suffix that they are taken for.
Gmsh therefore reads what was examined, whatever becomes of the original, and nothing that lies
beside it (``x.geo.opt``).
"""

from __future__ import annotations

import mmap
import os
import re
import shlex
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import nearest_file
from fenics_contact.mesh.geometry.script_safety import FileRead, GeometryScript
from fenics_contact.mesh.geometry.script_words import ScriptError

#: Kinds by suffix; of CAD files Gmsh is told the format, and takes no other.
_OF_GMSH = {".geo": "geo", ".msh": "msh", ".step": "cad", ".stp": "cad", ".brep": "cad"}
# Of other programs: each has a reader, whose process opens the file and no other than its folder's.
_OF_OTHERS = {".inp": "inp", ".bdf": "bdf", ".med": "med", ".vtu": "vtu", ".xdmf": "xdmf"}
_KINDS = _OF_GMSH | _OF_OTHERS
GEOMETRIES = ("geo", "cad")  #: Kinds that are to be meshed; all others are meshes already.
_CAD_FORMATS = {".step": "step", ".stp": "step", ".brep": "brep"}
# Surfaces of rigid obstacles, of which the first is a list of triangles.
_SURFACES = {".stl": "stl"} | {suffix: "cad" for suffix in _CAD_FORMATS}
# What a script may merge, by suffix. Gmsh takes what is in none of its lists for a script.
_MERGED = _OF_GMSH | {".geo_unrolled": "geo", ".pos": "geo", ".stl": "cad", ".igs": "cad"}
_MERGED |= {".iges": "cad"}
# From its first byte on, else Gmsh takes it for a script.
_MESH = re.compile(rb"\$MeshFormat\s+(\d+)\.?\d*\s+([01])\s+\d+")
# Entities of STEP by which OpenCASCADE opens other files, and their short names. Before and behind
# them there is anything that its scanner could end or begin a word with.
_REFERENCE = re.compile(
    rb"(?:PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS|PDWAD|DOCUMENT_FILE|DCMFL)(?![A-Z0-9_])",
    re.IGNORECASE,
)
_PIECE = 2**20  # bytes that are copied at once
_LARGEST = 2**23  # bytes of a script; larger ones take longer to examine than to mesh
_WAY_OUT = "mesh it with Gmsh yourself and give the .msh"


@dataclass(frozen=True)
class MeshFile:
    """A file that a scene names.

    Attributes:
        key: Of the scene, such as ``mesh.file``, for messages.
        path: The file.
        kind: ``geo``, a script; ``cad``; or the suffix of a mesh, such as ``msh``.
        form: Of a CAD file, as Gmsh calls it.
    """

    key: str
    path: Path
    kind: str
    form: str

    @property
    def is_mesh(self) -> bool:
        """Whether it is a mesh already."""
        return self.kind not in GEOMETRIES

    @property
    def is_of_gmsh(self) -> bool:
        """Whether Gmsh opens it; else a reader of another program's files."""
        return self.kind not in _OF_OTHERS.values()


@dataclass
class Prepared:
    """A file that Gmsh may open.

    Attributes:
        path: The file in place of the one that the scene names.
        names: Files that were brought to Gmsh's folder, and what the user calls them.
        version: Of a mesh: its format's major version.
    """

    path: Path
    names: dict[Path, Path] = field(default_factory=dict)
    version: int = 0

    def translated(self, message: str) -> str:
        """A message of Gmsh with the user's names of files."""
        for path, name in self.names.items():
            message = message.replace(str(path), str(name))
        return message


def kind_of(name: str) -> str:
    """Return the kind of a file as in ``MeshFile``; empty if it cannot be read."""
    return _KINDS.get(Path(name).suffix.lower(), "")


def mesh_file(key: str, name: str) -> MeshFile:
    """A file that a scene names.

    Args:
        key: Of the scene, such as ``mesh.file``.
        name: Its path.

    Raises:
        InputError: It is not there, or of no kind that can be read.
    """
    return _of_kinds(key, name, _KINDS, way_out(Path(name).name))


def surface_file(key: str, name: str) -> MeshFile:
    """A file that a scene names for the surface of a rigid obstacle.

    Args:
        key: Of the scene, such as ``contact[0].obstacle.file``.
        name: Its path.

    Raises:
        InputError: It is not there, or has no surface that can be read.
    """
    return _of_kinds(key, name, _SURFACES)


def _of_kinds(key: str, name: str, kinds: Mapping[str, str], advice: str = "") -> MeshFile:
    """A file whose suffix is one of some."""
    path = Path(name)
    if os.path.isdir(path):
        raise InputError(f"{key} = '{name}': is a folder, not a file")
    if not os.path.isfile(path):  # of any name; pathlib raises for one that is too long
        raise InputError(f"{key} = '{name}': there is no such file{nearest_file(path)}")
    suffix = path.suffix.lower()
    if suffix not in kinds:
        raise InputError(f"{key} = '{name}': must end in {_either(kinds)}{advice}")
    return MeshFile(key, path, kinds[suffix], _CAD_FORMATS.get(suffix, ""))


def prepared(file: MeshFile, folder: Path) -> Prepared:
    """Bring a file, and those that it reads, to Gmsh; refuse what does more than make a mesh.

    Args:
        file: The file.
        folder: Empty, and of this call alone.

    Raises:
        InputError: Naming the file, the line and the word.
    """
    if not file.is_of_gmsh:
        return Prepared(file.path.absolute())
    if file.kind == "stl":
        copy = _copied(file.key, file.path, folder / "surface.stl")
        return Prepared(copy, {copy: file.path})
    if file.kind == "cad":  # which Gmsh reads as that format and no other
        copy = _copied(file.key, file.path, folder / f"shape.{file.form}")
        _require_whole(file.key, file.path, copy)
        return Prepared(copy, {copy: file.path})
    if file.kind == "msh":
        copy = _copied(file.key, file.path, folder / "mesh.msh")
        return Prepared(copy, {copy: file.path}, _mesh_version(file.key, file.path, copy))
    return _Scripts(file, folder).prepared()


class _Scripts:
    """A geometry script with all that it reads, in its folder or below.

    Args:
        file: The script.
        folder: For Gmsh.
    """

    def __init__(self, file: MeshFile, folder: Path) -> None:
        self._key, self._folder = file.key, folder
        self._allowed = file.path.parent.resolve()
        self._first = folder / "1.geo"
        self._names = {self._first: file.path}
        self._targets = {(file.path.resolve(), "geo"): self._first}
        self._scripts: dict[Path, GeometryScript] = {}

    def prepared(self) -> Prepared:
        """All written to the folder, once none of it does what it may not."""
        waiting = [self._first]
        while waiting:
            target = waiting.pop()
            path = self._names[target]
            self._scripts[target] = script = self._parsed(path)
            for file in self._asked(path, script):
                known = set(self._targets.values())
                self._bring(path, file)
                waiting += [
                    t for t in self._targets.values() if t not in known and t.suffix == ".geo"
                ]
        defined = {name for script in self._scripts.values() for name in script.defined()}
        for target, script in self._scripts.items():
            path = self._names[target]

            def opened(file: FileRead, path: Path = path) -> str:
                return self._bring(path, file).name

            with self._refusing(path):
                text = script.checked(defined, opened)
            target.write_text(text, encoding="latin-1")
        return Prepared(self._first, self._names)

    def _parsed(self, path: Path) -> GeometryScript:
        content = _beginning(self._key, path, _LARGEST + 1)
        if len(content) > _LARGEST:
            raise InputError(
                f"{self._key}: {path}: is a script of more than {_LARGEST >> 20} MB; {_WAY_OUT}"
            )
        with self._refusing(path):
            return GeometryScript(content.decode("latin-1"))  # as Gmsh: its words are ASCII

    def _asked(self, path: Path, script: GeometryScript) -> list[FileRead]:
        with self._refusing(path):
            return list(script.files())

    def _bring(self, script: Path, file: FileRead) -> Path:
        """Where Gmsh finds a file that a script reads."""
        where = f'{self._key}: {script}, line {file.line}: {file.command} "{file.name}"'
        # Gmsh takes a name from the file that reads it.
        path = script.parent / file.name.encode("latin-1").decode("utf-8", "replace")
        if Path(file.name).is_absolute() or not path.resolve().is_relative_to(self._allowed):
            raise InputError(
                f"{where} is outside the folder of the geometry, which it may not read"
            )
        suffix = path.suffix.lower()
        kind = "geo" if file.command == "Include" else _MERGED.get(suffix, "")
        if not kind:
            raise InputError(f"{where} must end in {_either(_MERGED)}")
        if not os.path.isfile(path):
            raise InputError(f"{where}: there is no such file")
        key = (path.resolve(), kind)
        if key not in self._targets:
            ending = {"geo": ".geo", "msh": ".msh"}.get(kind, suffix)
            target = self._folder / f"{len(self._targets) + 1}{ending}"
            self._targets[key], self._names[target] = target, path
            if kind != "geo":
                _copied(self._key, path, target)
            if kind == "msh":
                _mesh_version(self._key, path, target)
            if kind == "cad":
                _require_whole(self._key, path, target)
        return self._targets[key]

    @contextmanager
    def _refusing(self, path: Path) -> Iterator[None]:
        """Say of what is wrong with a script where it is, and what to do."""
        try:
            yield
        except ScriptError as error:
            words = f"{self._key}: {path}, line {error.line}: {error}"
            if error.is_forbidden:
                words += f"; a scene's geometry may do nothing else: remove it, or {_WAY_OUT}"
            raise InputError(words) from None


def _copied(key: str, path: Path, target: Path) -> Path:
    """A copy of a file."""
    try:
        source = path.open("rb")
    except OSError as error:
        raise InputError(f"{key}: {path}: cannot be read: {error.strerror}") from None
    with source, target.open("wb") as file:
        shutil.copyfileobj(source, file, _PIECE)
    return target


def _beginning(key: str, path: Path, size: int) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(size)
    except OSError as error:
        raise InputError(f"{key}: {path}: cannot be read: {error.strerror}") from None


def _mesh_version(key: str, path: Path, copy: Path) -> int:
    """The format's major version; refuses what does not start as a mesh: Gmsh would run it."""
    found = _MESH.match(_beginning(key, copy, 4096))
    if found is None or int(found[1]) not in (2, 4):
        raise InputError(
            f"{key} = '{path}': does not start as a Gmsh mesh of version 2 or 4 does ($MeshFormat)"
        )
    if int(found[1]) == 2 and found[2] == b"0":
        _require_counts(key, path, copy)
    return int(found[1])


def _require_counts(key: str, path: Path, copy: Path) -> None:
    """A text of version 2 lists as many nodes and elements as it says: Gmsh passes over more."""
    with copy.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        for section in (b"Nodes", b"Elements"):
            found = re.search(rb"^\$" + section + rb"\s+(\d+)[ \t\r]*\n", content, re.MULTILINE)
            end = content.find(b"$End" + section, found.end()) if found else -1
            if found is None or end < 0:
                continue  # which Gmsh refuses itself
            text = content[found.end() - 1 : end]
            if text.count(b"\n") <= int(found[1]) + 1:
                continue
            lines = len(re.findall(rb"\n[ \t\r]*(?=[^\s$])", text))  # that are not empty
            if lines > int(found[1]):
                raise InputError(
                    f"{key} = '{path}': lists {lines} {section.decode().lower()} where it says "
                    f"{int(found[1])}: correct the number, or remove what was added"
                )


def _require_whole(key: str, path: Path, copy: Path) -> None:
    """A STEP file holds its shapes itself: others that it names would be opened, wherever."""
    if _CAD_FORMATS.get(copy.suffix) != "step" or not copy.stat().st_size:
        return
    with copy.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        found = _REFERENCE.search(content)
        if found is not None:
            line = content[: found.start()].count(b"\n") + 1
            raise InputError(
                f"{key} = '{path}', line {line}: {found[0].decode()} refers to another file, which "
                "a scene's geometry may not; export all parts into one file"
            )


def _either(words: Mapping[str, str]) -> str:
    *first, last = words
    return f"{', '.join(first)} or {last}"


_CAD = "save the part as STEP (.step) in the CAD program"
_NO_SOLID = (
    "it has triangles of a surface and no solid: save the part as STEP (.step) in the CAD program"
)
_MESHIO = "convert it to .msh by meshio (`meshio convert {name} {mesh}`), groups and all"
_GMSH = "open it in Gmsh and save it as .msh"
_ANSYS = "save its mesh as .vtk by ansys-mapdl-reader, and convert that to .msh by meshio"
_HYPERMESH = "export its mesh for Nastran or Abaqus, and convert that to .msh by meshio"
_DRAWING = "a drawing is no body: save the part as STEP (.step) in the CAD program"
_SHAPE = "save it as STEP (.step), for instance in FreeCAD"

_WAYS = {
    **dict.fromkeys((".sldprt", ".sldasm"), _CAD),  # SolidWorks
    **dict.fromkeys((".ipt", ".iam"), _CAD),  # Inventor
    **dict.fromkeys((".catpart", ".catproduct", ".cgr", ".3dxml"), _CAD),  # CATIA
    **dict.fromkeys((".x_t", ".x_b", ".xmt_txt", ".xmt_bin", ".sat", ".sab", ".jt"), _CAD),
    **dict.fromkeys((".prt", ".asm", ".par", ".psm", ".f3d", ".fcstd", ".3dm", ".skp"), _CAD),
    **dict.fromkeys((".scdoc", ".scdocx", ".agdb", ".neu", ".cae"), _CAD),
    **dict.fromkeys((".dwg", ".dxf", ".svg", ".pdf"), _DRAWING),
    **dict.fromkeys((".stl", ".obj", ".ply", ".off", ".3mf", ".amf", ".wrl"), _NO_SOLID),
    **dict.fromkeys((".igs", ".iges"), _SHAPE),
    ".brp": "rename it to {stem}.brep, which is the same",
    **dict.fromkeys((".cdb", ".rst"), _ANSYS),
    **dict.fromkeys((".hm", ".hmascii"), _HYPERMESH),
    **dict.fromkeys((".vtk", ".e", ".ex2", ".exo", ".vol", ".mesh", ".meshb"), _MESHIO),
    **dict.fromkeys((".f3grid", ".mdpa", ".avs", ".ugrid", ".node", ".ele"), _MESHIO),
    **dict.fromkeys((".unv", ".cgns"), _GMSH),
}


def way_out(name: str) -> str:
    """Return advice on a file of another program, to follow a sentence; empty if unknown.

    >>> way_out("lever.SLDPRT")
    '; save the part as STEP (.step) in the CAD program'
    """
    stem, dot, suffix = name.rpartition(".")
    way = _WAYS.get(f"{dot}{suffix}".lower(), "")
    return (
        f"; {way.format(name=shlex.quote(name), stem=stem, mesh=shlex.quote(f'{stem}.msh'))}"
        if way
        else ""
    )
