"""Scenes of ``assemblies.py`` by CalculiX: the same cells of degree 2, loads and friction.

Contacts are ``SURFACE TO SURFACE`` with a linear pressure-overclosure and a slope of sticking; all
bodies have soft springs to the ground besides, without which those that contact alone holds drift
before friction acts. Scenes with bolts are not written.
"""

from __future__ import annotations

import os
import re
import resource
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact import Contact, Scene
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.tagged_mesh import Body

# Nodes of a tetrahedron of degree 2 (`C3D10`) by dolfinx's, and corners of its sides by its own.
_NODES = (0, 1, 2, 3, 9, 6, 8, 7, 5, 4)
_SIDES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))
# Middle nodes of these sides, which a constant traction acts on alone.
_MIDDLES = ((4, 5, 6), (7, 8, 4), (8, 9, 5), (9, 7, 6))
# Of springs to the ground, in all on each body and axis, over Young's modulus (length).
_SOFT = 1e-5


@dataclass(frozen=True)
class Setting:
    """How CalculiX takes contact.

    Attributes:
        slope: Of pressure over overclosure, over Young's modulus (1/length).
        stick: Of friction over slip, over that of pressure.
        first: Share of a load step that is tried first.
    """

    slope: float
    stick: float
    first: float

    @property
    def words(self) -> str:
        """For tables."""
        return f"slope {self.slope:g} E/mm, stick {self.stick:g} of it, first {self.first:g}"


SETTINGS = tuple(
    Setting(slope, 0.1, first) for slope, first in ((5.0, 1.0), (50.0, 1.0), (5.0, 0.1))
)


def measure(scene: Scene, setting: Setting, seconds: float) -> dict[str, Any]:
    """A row: cost, iterations and how far the load has moved, or why there is no answer."""
    with tempfile.TemporaryDirectory() as folder:
        model = Model(scene)
        Path(folder, "scene.inp").write_text("\n".join(model.lines(setting)) + "\n", "utf-8")
        row: dict[str, Any] = {"dofs": 3 * len(model.points), "setting": setting.words}
        threads = {name: "1" for name in ("OMP_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER")}
        with Path(folder, "said").open("w") as said:
            process = subprocess.Popen(
                ["ccx", "-i", "scene"],
                cwd=folder,
                stdout=said,
                stderr=said,
                env=os.environ | threads,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(seconds),) * 2),
            )
            used = os.wait4(process.pid, 0)[2]
        text = Path(folder, "said").read_text("utf-8", errors="replace")
        steps = Path(folder, "scene.sta")
        moved = Path(folder, "scene.dat")
        row |= {
            "seconds": used.ru_utime + used.ru_stime,
            "peak_memory_mb": used.ru_maxrss / 1e3,
            "newton": len(re.findall(r"^ *iteration +\d+", text, re.MULTILINE)),
            "increments": len(steps.read_text().splitlines()) - 2 if steps.exists() else 0,
        }
        if "Job finished" in text and moved.exists():
            last = moved.read_text().rsplit("displacements", 1)[1].splitlines()[1:]
            rows = np.array([line.split()[1:] for line in last if line.strip()], dtype=float)
            return row | {"moved": float(np.linalg.norm(rows.mean(axis=0)))}
        errors = re.findall(r"\*ERROR.*", text)
        return row | {"failed": errors[0] if errors else f"no answer in {seconds:g} s"}


class Model:
    """Nodes, elements and sides of a scene's mesh.

    Attributes:
        points: (nodes, 3) (length).
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._body: Body = load_body(scene.mesh, 3, MPI.COMM_SELF)
        mesh = self._body.mesh
        self.points = mesh.geometry.x
        self._cells = compat.geometry_nodes(mesh)[:, _NODES]
        self._sides = {
            frozenset(cell[list(corners)]): (element, side)
            for element, cell in enumerate(self._cells.tolist())
            for side, corners in enumerate(map(list, _SIDES))
            for cell in (np.array(cell),)
        }

    def sides(self, name: str) -> list[tuple[int, int]]:
        """Elements and their sides that a group's facets are."""
        mesh = self._body.mesh
        facets = self._body.entities(self._body.groups[name])
        nodes = compat.nodes_of_entities(mesh, 2, facets)[:, :3]
        return [self._sides[frozenset(corners)] for corners in nodes.tolist()]

    def nodes(self, name: str) -> list[int]:
        """Nodes on a group's facets."""
        found = [
            self._cells[element, [*_SIDES[side], *_MIDDLES[side]]]
            for element, side in self.sides(name)
        ]
        return np.unique(np.concatenate(found)).tolist()

    def lines(self, setting: Setting) -> Iterator[str]:
        """The input file."""
        scene = self._scene
        (material,) = scene.material
        young = float(material.youngs_modulus)
        yield "*NODE, NSET=ALL"
        for number, place in enumerate(self.points.tolist(), 1):
            yield f"{number}, {', '.join(f'{x:.12g}' for x in place)}"
        yield "*ELEMENT, TYPE=C3D10, ELSET=BODY"
        for number, cell in enumerate((self._cells + 1).tolist(), 1):
            yield f"{number}, {', '.join(map(str, cell))}"
        yield from self._springs(_SOFT * young)
        yield from ("*MATERIAL, NAME=M", "*ELASTIC", f"{young}, {material.poissons_ratio}")
        yield "*SOLID SECTION, ELSET=BODY, MATERIAL=M"
        for number, contact in enumerate(scene.contact):
            yield from self._contact(number, contact, setting, young)
        yield "*BOUNDARY"
        for support in scene.support:
            for axis, value in support.displacement.items():
                place = "xyz".index(axis) + 1
                yield from (f"{n + 1}, {place}, {place}, {value}" for n in self.nodes(support.on))
        yield from ("*NSET, NSET=LOADED", *(f"{n + 1}," for n in self.nodes(scene.load[-1].on)))
        for time in scene.steps.all_times:
            yield from ("*STEP, NLGEOM=NO, INC=1000", "*STATIC", f"{setting.first}, 1., 1e-6, 1.")
            yield "*CLOAD, OP=NEW"
            yield from self._loads(time)
            yield from ("*NODE PRINT, NSET=LOADED, FREQUENCY=1000", "U", "*END STEP")

    def _springs(self, stiffness: float) -> Iterator[str]:
        """Soft springs to the ground at nodes of each body."""
        number = len(self._cells)
        kept: list[int] = []
        for name in _bodies(self._body):
            cells = self._body.entities(self._body.groups[name])
            nodes = np.unique(self._cells[cells][:, :4])
            kept += nodes[np.linspace(0, len(nodes) - 1, 20).astype(int)].tolist()
        for axis in range(1, 4):
            yield f"*ELEMENT, TYPE=SPRING1, ELSET=SPRINGS{axis}"
            for node in kept:
                number += 1
                yield f"{number}, {node + 1}"
            yield from (f"*SPRING, ELSET=SPRINGS{axis}", f"{axis}", f"{stiffness / 20:g}")

    def _contact(
        self, number: int, contact: Contact, setting: Setting, young: float
    ) -> Iterator[str]:
        assert contact.against is not None
        for role, name in (("S", contact.on), ("M", contact.against)):
            yield f"*SURFACE, NAME={role}{number}, TYPE=ELEMENT"
            yield from (f"{element + 1}, S{side + 1}" for element, side in self.sides(name))
        slope = setting.slope * young
        yield f"*SURFACE INTERACTION, NAME=I{number}"
        yield from ("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{slope:g}, {1e-6 * young}")
        yield from ("*FRICTION", f"{contact.friction_coefficient}, {setting.stick * slope:g}")
        yield f"*CONTACT PAIR, INTERACTION=I{number}, TYPE=SURFACE TO SURFACE"
        yield f"S{number}, M{number}"

    def _loads(self, time: float) -> Iterator[str]:
        """Forces at nodes of constant tractions: of each facet a third at each middle node."""
        forces = np.zeros_like(self.points)
        for load in self._scene.load:
            factor = np.interp(time, load.path.time, load.path.factor)
            traction = factor * np.array(load.traction, dtype=float)
            for element, side in self.sides(load.on):
                a, b, c = self.points[self._cells[element, list(_SIDES[side])]]
                area = np.linalg.norm(np.cross(b - a, c - a)) / 2
                forces[self._cells[element, list(_MIDDLES[side])]] += area / 3 * traction
        for node, axis in zip(*np.nonzero(forces), strict=True):
            yield f"{node + 1}, {axis + 1}, {forces[node, axis]:.12g}"


def _bodies(body: Body) -> Sequence[str]:
    """Names of the bodies: groups of cells, without that of all."""
    every = {tag for group in body.groups.values() if group.dimension == 3 for tag in group.tags}
    return [n for n, g in body.groups.items() if g.dimension == 3 and set(g.tags) != every]
