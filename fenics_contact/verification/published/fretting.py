"""Fretting: stress under a bulk load and lives, against published numbers.

A rigid parabola pressed on a half-plane, then sheared while the half-plane is pulled as well. With
one rigid body of the two, and the other incompressible, formulas for equal bodies hold with 2 in
place of 4. The block that stands for the half-plane is loaded, where it ends, as the half-plane is
there: by the radial stress of Flamant's forces, and by the pull.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from scipy.optimize import brentq

from fenics_contact.analyses.fretting.history import tensors
from fenics_contact.analyses.fretting.recovery import Recovery
from fenics_contact.analyses.fretting.table import FatigueLimits, Fretting, StrainLifeLine
from fenics_contact.analyses.fretting.task import FrettingTask
from fenics_contact.analytic import contact as formulas
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import on_root
from fenics_contact.common.program import mesh_file
from fenics_contact.contact.state import STICK
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.cycles import Cycles
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import MeshSource, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, UntrustedError, note_mesh, solved

_YOUNGS_MODULUS, _AMPLITUDE = 200e3, 300.0
_LINE = StrainLifeLine(900.0, -0.09, 0.4, -0.6)
_LIMITS = FatigueLimits(torsion=250.0, tension=400.0)
_TO_AND_FRO = Path(time=(0, 1, 3, 4), factor=(0, 1, -1, 0))


def _block(ratio: float, loads: tuple[Load, ...]) -> tuple[Scene, Body]:
    """A block that is bonded to the ground, so that the stress is the same all over."""
    scene = Scene(
        kinematics="plane stress",
        material=(Material(_YOUNGS_MODULUS, ratio),),
        load=loads,
        contact=(Contact("block.y0", contact="bonded"),),
        steps=Steps(number=4, end=4),
        cycles=Cycles(end=4, increments=8, number=2),
        solver=SolverSettings(errors="none"),
        fretting=Fretting(depth=0.6, limits=_LIMITS, life=_LINE),
    )
    return scene, boxes((Box("block", (0.0, 0.0), (2.0, 1.0), (4, 2)),))


def findings_of_lives(quick: bool) -> Iterator[Finding]:
    """Of tension with ν = 0, which the ground does not hinder, and of shear with ν = .3."""
    pull = (Load("block.y1", traction=(0.0, _AMPLITUDE), path=_TO_AND_FRO),)
    sides = {"y1": (1.0, 0.0), "x1": (0.0, 1.0), "x0": (0.0, -1.0)}
    shear = tuple(
        Load(f"block.{side}", traction=(_AMPLITUDE * x, _AMPLITUDE * y), path=_TO_AND_FRO)
        for side, (x, y) in sides.items()
    )
    limit = _LIMITS.torsion
    for words, ratio, loads, factor in (
        ("tension", 0.0, pull, limit / _AMPLITUDE * _LIMITS.tension / limit),
        ("torsion", 0.3, shear, limit / _AMPLITUDE),
    ):
        scene, body = _block(ratio, loads)
        result = solved(scene, body)
        assert result.fretting is not None
        worst = result.fretting.worst
        parameter = _AMPLITUDE**2 * (1 + ratio) / _YOUNGS_MODULUS
        life = worst["swt"].life
        assert life is not None
        yield Finding(f"swt, {words}", worst["swt"].value, parameter, 1e-6)
        yield Finding(f"life, {words}", life, _known_life(parameter), 1e-5)
        for name in ("crossland", "dang_van"):
            found = worst[name].safety_factor
            assert found is not None
            yield Finding(f"safety factor by {name}, {words}", found, factor, 1e-6)


def _known_life(parameter: float) -> float:
    """N of (s²/E)(2N)^{2b} + s e (2N)^{b+c}, by bisection."""
    line = _LINE
    b, c = line.strength_exponent, line.ductility_exponent

    def missing(logarithm: float) -> float:
        reversals = 2 * np.exp(logarithm)
        elastic = line.strength**2 / _YOUNGS_MODULUS * reversals ** (2 * b)
        plastic = line.strength * line.ductility * reversals ** (b + c)
        return float(elastic + plastic - parameter)

    return float(np.exp(brentq(missing, 0.0, 60.0, xtol=1e-13)))


_YOUNGS_MODULUS_BULK_LOAD, _POISSONS_RATIO = 1000.0, 0.4999
_RADIUS, _HALF_WIDTH, _COEFFICIENT = 50.0, 1.0, 0.5
_MODULUS = formulas.plane_strain_modulus(_YOUNGS_MODULUS_BULK_LOAD, _POISSONS_RATIO)
_HERTZ = formulas.line_contact(
    _MODULUS, _RADIUS, formulas.line_force(_MODULUS, _RADIUS, _HALF_WIDTH)
)
_MESH = {"fine": 1.3, "size": 0.025, "extent": 80.0, "cells_outside": 24}
_QUICK_MESH = _MESH | {"size": 0.05, "cells_outside": 20}
_PRESSED = Path(time=(0.0, 1.0, 2.0), factor=(0.0, 1.0, 1.0))
_SHEARED = Path(time=(0.0, 1.0, 2.0), factor=(0.0, 0.0, 1.0))
# The half-plane's normals at its ends.
_ENDS = {"left": (-1.0, 0.0), "right": (1.0, 0.0)}
# Nodes between the edge and the stick zone that the limit at the edge is taken from, inside of
# both by so much of the half-width: there the stress has square roots.
_INSIDE = 0.1


@dataclass(frozen=True)
class Pulled:
    """Shear and pull of the half-plane.

    Attributes:
        share: Q/μP.
        pull: σ_B/(μ p₀).
    """

    share: float
    pull: float

    @property
    def shear(self) -> float:
        """Q, along x on the body (force per thickness)."""
        return self.share * _COEFFICIENT * _HERTZ.force

    @property
    def stress(self) -> float:
        """σ_B (stress)."""
        return self.pull * _COEFFICIENT * _HERTZ.peak

    @property
    def stick(self) -> float:
        """Half-width of what sticks, c = a √(1 − Q/μP) (length)."""
        return _HALF_WIDTH * sqrt(1 - self.share)

    @property
    def shift(self) -> float:
        """Its middle, e = a σ_B/(2 μ p₀), away from the trailing edge (length)."""
        return _HALF_WIDTH * self.pull / 2

    @property
    def edge_stress(self) -> float:
        """Along the surface at the trailing edge (stress)."""
        a, c, reach = _HALF_WIDTH, self.stick, _HALF_WIDTH + self.shift
        left = 1 - (reach - sqrt(reach**2 - c**2)) / a
        return self.stress + 2 * _COEFFICIENT * _HERTZ.peak * left


def _radial(force: tuple[float, float], normal: tuple[float, float], axis: int) -> Callable:  # type: ignore[type-arg]
    """Traction of Flamant's stress −2 (F·r)/(π r²) r r/r² of a force at the origin, as a function.

    Args:
        force: On the half-plane (force per thickness).
        normal: Of the boundary.
        axis: Of the component.
    """

    def traction(x: Array) -> Array:
        square = np.maximum(x[0] ** 2 + x[1] ** 2, 1e-12)
        stress = -2 / pi * (force[0] * x[0] + force[1] * x[1]) / square
        return np.asarray(stress * (normal[0] * x[0] + normal[1] * x[1]) * x[axis] / square)

    return traction


def bulk_scene(pulled: Pulled, **mesh: float) -> Scene:
    """Pressed in the first step; sheared and pulled together, in proportion, in the second."""
    pressing, shearing = (0.0, -_HERTZ.force), (pulled.shear, 0.0)
    loads = []
    for end, normal in _ENDS.items():
        for force, path in ((pressing, _PRESSED), (shearing, _SHEARED)):
            both = tuple(_radial(force, normal, axis) for axis in (0, 1))
            loads.append(Load(end, traction=both, path=path))
        loads.append(Load(end, traction=(pulled.stress * normal[0], 0.0), path=_SHEARED))
    for force, path in ((pressing, _PRESSED), (shearing, _SHEARED)):
        loads.append(Load("bottom", traction=(_radial(force, (0.0, -1.0), 0), 0.0), path=path))
    obstacle = Obstacle("parabola", radius=_RADIUS, force=_HERTZ.force, path=_PRESSED)
    rubbing = Contact(
        "contact", obstacle=obstacle, law="incremental", friction_coefficient=_COEFFICIENT
    )
    return Scene(
        kinematics="plane strain",
        mesh=(MeshSource(mesh_file("strip.geo"), cell="quadrilateral", parameters=_MESH | mesh),),
        material=(Material(_YOUNGS_MODULUS_BULK_LOAD, _POISSONS_RATIO),),
        support=(Support("bottom", {"y": 0.0}),),
        load=tuple(loads),
        contact=(rubbing,),
        steps=Steps(times=(1.0, 2.0)),
        solver=SolverSettings(errors="none"),
        fretting=Fretting(depth=0.2, begin=1.0),
    )


def findings_of_bulk_load(quick: bool) -> Iterator[Finding]:
    """Where it sticks, and the stress at the trailing edge, with and without pull."""
    for pulled in (Pulled(0.6, 0.5),) if quick else (Pulled(0.6, 0.0), Pulled(0.6, 0.5)):
        prepared = Run(bulk_scene(pulled, **(_QUICK_MESH if quick else {})))
        result = prepared.solve()
        note_mesh(result.model)
        yield from compared(prepared, result, pulled)


def compared(prepared: Run, result: Result, pulled: Pulled) -> Iterator[Finding]:
    """A run beside what it should be.

    Raises:
        UntrustedError: It did not converge, or a check failed.
    """
    if not result.passed or result.points is None:
        raise UntrustedError(result.verdict)
    at = f", σ_B = {pulled.pull:g} μ p₀"
    sticking = result.points.coordinates[result.points.status == STICK, 0]
    middle, width = (sticking.min() + sticking.max()) / 2, np.ptp(sticking) / 2
    yield Finding(f"middle of the stick zone{at}", float(middle), pulled.shift, 0.02, True)
    yield Finding(f"half of its width{at}", float(width), pulled.stick, 0.02, True)
    stress = on_root(prepared.problem.comm, lambda: _edge_stress(prepared, pulled))
    yield Finding(f"stress at the trailing edge{at}", stress, pulled.edge_stress, 0.03)


def _edge_stress(prepared: Run, pulled: Pulled) -> float:
    """The limit from inside of σ_xx − σ_yy, in which the pressure's own part drops out; rank 0.

    At the edge itself the stress has a cusp that no mesh resolves; inside of it, up to where it
    sticks, that difference is smooth.
    """
    task = prepared.analyses.of("fretting")
    assert isinstance(task, FrettingTask)
    history = task.history
    assert history is not None and history.region.cells is not None and history.samples is not None
    recovery = Recovery(history.region.cells, 2)
    x, y = recovery.coordinates[:, 0], recovery.coordinates[:, 1]
    inside = (x > -_HALF_WIDTH + _INSIDE) & (x < pulled.shift - pulled.stick - _INSIDE)
    chosen = np.flatnonzero(inside & (np.abs(y) < 1e-9))
    stress = tensors(recovery.weights(chosen)[0] @ history.samples[-1][:, :6])
    along = stress[:, 0, 0] - stress[:, 1, 1]
    return float(np.polyfit(x[chosen] + _HALF_WIDTH, along, 2)[-1])


def _fretting(quick: bool) -> Iterator[Finding]:
    """Stick zone and edge stress under bulk load; lives of stress that is the same all over."""
    yield from findings_of_bulk_load(quick)
    yield from findings_of_lives(quick)


FRETTING_CASES: tuple[Case, ...] = (
    Case(
        "fretting",
        "parabola sheared on a half-plane under bulk load; lives in tension and torsion",
        "D. Nowell, D. A. Hills, Int. J. Mech. Sci. 29 (1987) 355-365; K. N. Smith, P. Watson, "
        "T. H. Topper, J. Materials 5 (1970) 767-778",
        _fretting,
    ),
)
