"""Where a run is one whose pressure has a formula: which one, and its numbers.

It takes the force that the run found. What does not fit the formula's assumptions has none.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import cbrt, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.analytic import contact as formulas
from fenics_contact.analytic.contact import HertzContact
from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import FRICTION_FORCE, NORMAL_FORCE
from fenics_contact.report.contact_surfaces import covers, relative_curvature
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.load_history import History
from fenics_contact.results.records.run import Outcome
from fenics_contact.scene.body import Material
from fenics_contact.scene.scene import Scene

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_FLAT = 1e-6
# Of an elastic mismatch |β| (Dundurs) below this friction does not change the pressure by more
# than this share, nor pressing cause slip that matters (Johnson, Section 5.4).
_ALIKE = 0.05
# Contacts wider than this share of the radius of curvature are no half-spaces' any more; nor are
# those of bodies that are not so many times as large.
_NARROW, _LARGE = 0.2, 5.0
# The force stays, by this share, while a contact is sheared.
_STEADY = 1e-2


@dataclass(frozen=True)
class AnalyticContact:
    """Pressure and, perhaps, friction that formulas give for a run's force.

    Attributes:
        label: Of the pressure.
        hertz: Force of the whole contact, its radius or half-width, and the peak of the pressure;
            of a punch, its mean.
        line: Whether it is a line contact; else a point contact.
        punch: Whether the obstacle is flat.
        centre: On the surface, (3,) (length).
        poissons_ratio: Of the body whose points the contact has.
        smooth: Whether the formulas for stresses below it hold: there is no friction.
        direction: Axis of the friction traction; None where that has no formula.
        friction_peak: ± μ p₀, on the body along that axis.
        stick: Half-width or radius of what sticks, 0 without such a formula (length).
    """

    label: str
    hertz: HertzContact
    line: bool
    punch: bool
    centre: Array
    poissons_ratio: float
    smooth: bool
    direction: int | None = None
    friction_peak: float = 0.0
    stick: float = 0.0

    def pressure(self, distance: Array) -> Array:
        """At a distance from the middle (stress)."""
        if self.punch:
            return formulas.punch_pressure(self.hertz, self.line, distance)
        return formulas.elliptic_pressure(self.hertz, distance)

    def friction(self, distance: Array) -> Array:
        """Friction traction on the body at a distance from the middle, by Cattaneo and Mindlin."""
        coefficient = self.friction_peak / self.hertz.peak
        return formulas.partial_slip(self.hertz, coefficient, self.stick, distance)

    def axis_shear(self, depth: Array) -> Array:
        """Largest shear stress (σ₁ − σ₃)/2 below the middle, of all directions; not of a punch."""
        axial, lateral = self.axis_stress(depth)
        third = self.poissons_ratio * (axial + lateral) if self.line else lateral
        return np.ptp([axial, lateral, third], axis=0) / 2

    def axis_stress(self, depth: Array) -> tuple[Array, Array]:
        """Normal and lateral stress below the middle; not of a punch."""
        if self.line:
            return formulas.line_axis_stress(self.hertz, depth)
        return formulas.axis_stress(self.hertz, depth, self.poissons_ratio)


def recognise(
    scene: Scene | None, result: Outcome, table: ContactTable, body: UnstructuredGrid
) -> AnalyticContact | None:
    """The formulas of a run, None where there are none.

    They are Hertz's for a rigid paraboloid, sphere, parabola or cylinder on a half-space and for
    two curved bodies in plane strain or with an axis, that of a flat punch on a half-space, and
    Cattaneo's and Mindlin's for Hertz's contacts that are sheared after pressing.

    Args:
        scene: What was solved; None where that is not known.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        body: A pyvista grid of it.
    """
    if scene is None or len(result.contacts) != 1 or scene.load or scene.thickness:
        return None
    contact, rows = scene.contact[0], table.of(result.contacts[0].name)
    if contact.kind != "unilateral" or not rows.closed.any():
        return None
    found = _of_bodies if contact.against else _of_obstacle
    analytic = found(scene, result, rows, body)
    if analytic is None or not _is_whole(scene, result, analytic, rows):
        return None
    return analytic


def _of_obstacle(
    scene: Scene, result: Outcome, rows: ContactTable, _: UnstructuredGrid
) -> AnalyticContact | None:
    """A rigid obstacle on a half-space."""
    obstacle, moduli = scene.contact[0].obstacle, _moduli(scene.material)
    if obstacle is None or scene.half_space is None or scene.support or moduli is None:
        return None
    across = _axis_across(rows)
    if len(scene.material) != 1 or across is None:
        return None
    for vector in (obstacle.normal, obstacle.direction):
        if vector is not None:
            sizes = np.abs(vector)
            if np.delete(sizes, across).max() > _FLAT * sizes.max():
                return None
    line = scene.kinematics == "plane strain"
    shape = obstacle.kind
    punch = shape is not None and shape.has_edge and not shape.has_inner_radius
    if scene.kinematics == "3D" and punch:
        return None  # its edge cuts through cells
    is_hertzian = shape is not None and shape.is_hertzian and obstacle.along is None
    if not (punch or is_hertzian):
        return None
    centre = np.zeros(3)
    centre[: len(obstacle.position or ())] = obstacle.position or ()
    centre[across] = rows.numbers["xyz"[across]].mean()
    assert obstacle.radius is not None
    youngs, poisson = moduli
    modulus = formulas.plane_strain_modulus(youngs, poisson)
    mismatch = (1 - 2 * poisson) / (2 * (1 - poisson))
    return _with_force(
        scene, result, line, punch, centre, across, modulus, obstacle.radius, poisson, mismatch
    )


def _of_bodies(
    scene: Scene, result: Outcome, rows: ContactTable, body: UnstructuredGrid
) -> AnalyticContact | None:
    """Two bodies whose surfaces are curved, each large against the contact."""
    contact = scene.contact[0]
    assert contact.against is not None
    if scene.kinematics not in ("plane strain", "axisymmetric") or scene.half_space is not None:
        return None
    names = [mesh.name for mesh in scene.mesh]
    sides = [name.split(".")[0] for name in (contact.on, contact.against)]
    if len(names) != 2 or sorted(sides) != sorted(names):
        return None
    filled = {part.on: _moduli((part,)) for part in scene.material}
    both = [filled.get(name, filled.get("")) for name in sides]
    if len(filled) != len(scene.material) or not set(filled) <= {"", *names} or None in both:
        return None
    carrier = result.contacts[0].slave or contact.on
    slave = both[sides.index(carrier.split(".")[0])]
    middle = dict(_mirrors(scene, result)).get(0)
    shape = relative_curvature(rows, body, middle)
    if shape is None:
        return None
    first, second = (pair for pair in both if pair is not None)
    modulus = 1 / (
        1 / formulas.plane_strain_modulus(*first) + 1 / formulas.plane_strain_modulus(*second)
    )
    mismatch = _dundurs(first, second)
    line = scene.kinematics == "plane strain"
    assert slave is not None
    found = _with_force(
        scene, result, line, False, shape.centre, 1, modulus, shape.radius, slave[1], mismatch
    )
    if found is None or shape.smallest_body < _LARGE * found.hertz.radius:
        return None
    other = (shape.other - shape.centre[0])[:, None]
    if not covers(other, found.hertz.radius, [] if middle is None else [0]):
        return None
    return found if found.hertz.radius < _NARROW * shape.smallest_radius else None


def _with_force(
    scene: Scene,
    result: Outcome,
    line: bool,
    punch: bool,
    centre: Array,
    across: int,
    modulus: float,
    radius: float,
    poissons_ratio: float,
    mismatch: float,
) -> AnalyticContact | None:
    """The formulas for the force that was found, of the whole contact."""
    force = result.contacts[0].quantities[NORMAL_FORCE]
    if force is None or force <= 0:
        return None
    whole = 2 ** len(_planes(result)) * force
    hertz = _hertz(whole, line, punch, modulus, radius)
    if not punch and hertz.radius > _NARROW * radius and _is_round(scene):
        return None
    rough = result.contacts[0].carries_shear
    changes = rough and (abs(mismatch) > _ALIKE or punch)
    name = "flat punch" if punch else "Hertz"
    smooth = AnalyticContact(
        label=f"{name}, without friction" if changes else name,
        hertz=hertz,
        line=line,
        punch=punch,
        centre=centre,
        poissons_ratio=poissons_ratio,
        smooth=not rough,
    )
    if not rough or changes:
        return smooth
    return _sheared(smooth, scene, result, across)


def _hertz(force: float, line: bool, punch: bool, modulus: float, radius: float) -> HertzContact:
    if punch:
        return HertzContact(force, radius, force / (2 * radius if line else pi * radius**2))
    if line:
        return formulas.line_contact(modulus, radius, force)
    indentation = cbrt((3 * force / (4 * modulus)) ** 2 / radius)
    return formulas.paraboloid(modulus, radius, indentation)


def _sheared(
    smooth: AnalyticContact, scene: Scene, result: Outcome, across: int
) -> AnalyticContact:
    """With Cattaneo's and Mindlin's friction, if it was pressed first, then sheared one way.

    Shear that went to and fro before has left nothing where it is as large now as ever.
    """
    contact, history = scene.contact[0], History.of(result)
    coefficient = contact.coulomb_coefficient
    normal, tangential = (history.of_contact(0, name) for name in (NORMAL_FORCE, FRICTION_FORCE))
    if contact.law != "incremental" or coefficient is None:
        return smooth
    if not _is_held_as_one(scene):
        return smooth
    if normal is None or tangential is None:
        return smooth
    if result.contacts[0].slave not in (None, contact.on):
        tangential = -tangential  # the curve is of the slave's points, the force of `on`
    mirrored = dict(_mirrors(scene, result))
    axes = [i for i in range(tangential.shape[1]) if i != across and i not in mirrored]
    if not axes:
        return smooth
    direction = max(axes, key=lambda axis: abs(tangential[-1, axis]))
    shear, most = tangential[:, direction], coefficient * normal[-1]
    share = abs(shear[-1]) / most
    pressed = np.abs(shear) < 1e-3 * most
    steady = np.abs(normal / normal[-1] - 1) < _STEADY
    others = [i for i in axes if i != direction]
    aside = np.abs(tangential[:, others]).max(initial=0.0) > _STEADY * most
    largest = np.abs(shear).max() <= (1 + 1e-3) * abs(shear[-1])
    if aside or not (largest and (pressed | steady).all() and 1e-3 < share < 1 - 1e-3):
        return smooth
    stick = smooth.hertz.radius * (sqrt(1 - share) if smooth.line else cbrt(1 - share))
    peak = float(coefficient) * smooth.hertz.peak * np.sign(shear[-1])
    values = {**vars(smooth), "direction": direction, "friction_peak": float(peak), "stick": stick}
    return AnalyticContact(**values)


def _is_held_as_one(scene: Scene) -> bool:
    """Whether each body is held on one group alone, which is moved as a whole.

    Held otherwise it may be stretched, which moves what sticks off the middle.
    """
    groups = {support.on for support in scene.support}
    supports = scene.support
    values = [value for support in supports for value in support.displacement.values()]
    bodies = {group.split(".")[0] for group in groups}
    is_moved = all(isinstance(v, float | int) for v in values)
    is_moved &= not any(support.is_elastic for support in supports)
    return len(bodies) == len(groups) and is_moved and not any(s.is_turned for s in supports)


def _planes(result: Outcome) -> list[tuple[int, float]]:
    """Axis and coordinate of the planes of symmetry."""
    found = re.findall(r"([xyz]) = ([-+.\deE]+)", result.model.symmetry)
    return [("xyz".index(axis), float(place)) for axis, place in found]


def _mirrors(scene: Scene, result: Outcome) -> list[tuple[int, float]]:
    """Return the planes of symmetry and the axis of revolution."""
    return [*_planes(result), *([(0, 0.0)] if scene.kinematics == "axisymmetric" else [])]


def _is_round(scene: Scene) -> bool:
    """Whether the obstacle is a sphere or cylinder, which Hertz takes for its paraboloid."""
    obstacle = scene.contact[0].obstacle
    return obstacle is not None and obstacle.kind is not None and obstacle.kind.is_round


def _moduli(materials: tuple[Material, ...]) -> tuple[float, float] | None:
    """E and ν of the one isotropic and uniform material."""
    youngs, poisson = materials[0].youngs_modulus, materials[0].poissons_ratio
    if isinstance(youngs, float | int) and isinstance(poisson, float | int):
        return float(youngs), float(poisson)
    return None


def _dundurs(first: tuple[float, float], second: tuple[float, float]) -> float:
    """β of two bodies in plane strain (Johnson, (5.3))."""
    (shear, poisson), (other, other_poisson) = ((e / (2 * (1 + n)), n) for e, n in (first, second))
    soft, other_soft = (1 - 2 * poisson) / shear, (1 - 2 * other_poisson) / other
    sums = (1 - poisson) / shear + (1 - other_poisson) / other
    return 0.5 * (soft - other_soft) / sums


def _axis_across(rows: ContactTable) -> int | None:
    """The axis to which a flat surface is normal."""
    normals = rows.vectors("nx", "ny", "nz")
    axis = int(np.argmax(np.abs(normals[0])))
    flat = np.eye(3)[axis] * np.sign(normals[0, axis])
    return axis if np.abs(normals - flat).max() < _FLAT else None


def _is_whole(scene: Scene, result: Outcome, analytic: AnalyticContact, rows: ContactTable) -> bool:
    """Whether the surface covers the formula's contact, with its middle in planes of symmetry."""
    components = 3 if scene.kinematics == "3D" else 2
    across = int(np.argmax(np.abs(rows.vectors("nx", "ny", "nz").mean(axis=0))))
    tangential = [axis for axis in range(components) if axis != across]
    offsets = (rows.vectors("x", "y", "z") - analytic.centre)[:, tangential]
    size = np.ptp(offsets, axis=0).max()
    mirrors = _mirrors(scene, result)
    if any(abs(analytic.centre[axis] - place) > _FLAT * size for axis, place in mirrors):
        return False
    mirrored = [tangential.index(axis) for axis, _ in mirrors if axis != across]
    return covers(offsets, analytic.hertz.radius, mirrored)
