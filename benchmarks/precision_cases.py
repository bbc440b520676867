"""What ``work_precision.py`` computes: scenes by method, from coarse to fine, and references."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any

from fenics_contact import Discretisation, Obstacle, Scene, Steps
from fenics_contact.scene.settings import Accuracy
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.indenters import (
    HERTZ,
    annulus_scene,
    half_space_scene,
    on_fixed_boundary,
)
from fenics_contact.verification.published.shear import slab_scene

# A paraboloid (R = 8, d = 1, so a ≈ 2.83) on a square of side 60 that stands for a half-space.
# "Uniform": cells of h everywhere. "Graded": cells of h on a square of side 4, then 3.2/h that
# grow geometrically. "Adaptive": what the program makes of a coarse mesh by its estimated errors.
EXTENT, FINE, OUTSIDE = 60.0, 4.0, 3.2
COEFFICIENT, STEPS = 0.6, 20
# The ring of example 4 on a cylinder of this radius and height, held around.
RING_EXTENT = 4.0

Scenes = Callable[[str, int], Scene]


@dataclasses.dataclass(frozen=True)
class Case:
    """A contact that is computed by several methods, each to several accuracies.

    Attributes:
        name: In rows and file names.
        title: Of the picture.
        scene: By method and level.
        levels: By method, the first and the last level.
        asked: Of the adaptive method, what a level asks for.
        references: By quantity.
        without: Sources that the references have, too, so that they are no errors here.
    """

    name: str
    title: str
    scene: Scenes
    levels: Mapping[str, tuple[int, int]]
    asked: Callable[[float], Accuracy]
    references: Mapping[str, float]
    without: tuple[str, ...] = ()

    def series(self, method: str, quick: bool) -> list[Scene]:
        """Scenes from coarse to fine."""
        first, last = self.levels[method]
        if method == ADAPTIVE:
            start = self.scene(method, first)
            accuracies = ACCURACIES[: len(ACCURACIES) - 2 * quick]
            return [dataclasses.replace(start, accuracy=self.asked(each)) for each in accuracies]
        last -= quick * (2 if method.endswith("uniform") else 1)
        return [self.scene(method, level) for level in range(first, max(last, first + 1) + 1)]


ADAPTIVE = "adaptive"
METHODS = ("P1 uniform", "Q2 uniform", "Q2 graded", ADAPTIVE)
ACCURACIES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)


def hertz(method: str, level: int) -> Scene:
    """A paraboloid on a half-space, cells of 1/2^level at the contact."""
    size = 0.5**level
    outside = OUTSIDE / size
    if method.endswith("uniform"):
        outside = (EXTENT - FINE) / size + 1  # the geometry's ratio becomes 1 with one more
    scene = half_space_scene(
        Obstacle("paraboloid", radius=8, indentation=1),
        extent=EXTENT,
        fine=FINE,
        size=size,
        cells_outside=round(outside),
    )
    return of_method(scene, method)


def rough(method: str, level: int) -> Scene:
    """The same with friction."""
    return with_friction(hertz(method, level), COEFFICIENT)


def in_steps(method: str, level: int) -> Scene:
    """The same with the incremental law."""
    scene = with_friction(hertz(method, level), COEFFICIENT, "incremental")
    settings = dataclasses.replace(scene.solver, strategy="monolithic")
    return dataclasses.replace(scene, steps=Steps(STEPS), solver=settings)


def slab(method: str, level: int) -> Scene:
    """Example 1: 8 by 1, cells of 1/2^level."""
    return of_method(slab_scene(cells=(8 * 2**level, 2**level)), method)


def ring(method: str, level: int) -> Scene:
    """Example 4 on a short cylinder, cells of 1/2^level at the edges."""
    scene = on_fixed_boundary(annulus_scene())
    (mesh,) = scene.mesh
    # A growth of 1 has no geometric series.
    growth = 1.0001 if method.endswith("uniform") else {0: 3.0, 1: 2.0}.get(level, 1.4)
    parameters = {"extent": RING_EXTENT, "size": 0.5**level, "growth": growth}
    mesh = dataclasses.replace(mesh, parameters=dict(mesh.parameters) | parameters)
    scene = with_friction(dataclasses.replace(scene, mesh=(mesh,)), 0.3)
    return of_method(scene, method)


def of_method(scene: Scene, method: str) -> Scene:
    """The scene with the method's elements, and all errors estimated."""
    simplices = method.startswith("P") or method == ADAPTIVE
    return dataclasses.replace(
        scene,
        mesh=tuple(
            dataclasses.replace(mesh, cell="triangle" if simplices else "quadrilateral")
            for mesh in scene.mesh
        ),
        discretisation=Discretisation(1 if method.startswith("P1") else 2),
        solver=dataclasses.replace(scene.solver, errors="all"),
    )


def radius(area: float) -> float:
    """Of the circle of an area."""
    return math.sqrt(area / math.pi)


def value_and_bar(
    quantity: str,
    quantities: Mapping[str, Any],
    errors: Mapping[str, Mapping[str, float | None]],
    without: tuple[str, ...],
) -> tuple[float, float | None]:
    """A quantity of the references and its estimated error, relative; None if there is none.

    Radii are those of the circle that has the area; ``stick_ratio`` is that of stick and contact.
    """

    def bar(name: str, size: float) -> float | None:
        found = [e for source, e in errors[name].items() if source not in (*without, "total")]
        known = [error for error in found if error is not None]
        return sum(known) / size if len(known) == len(found) else None

    if quantity.endswith("_radius"):
        name = quantity.replace("radius", "area")
        area = quantities[name]
        relative = bar(name, area)
        return radius(area), None if relative is None else relative / 2
    if quantity == "stick_ratio":
        stick, contact = quantities["stick_area"], quantities["contact_area"]
        parts = (bar("stick_area", stick), bar("contact_area", contact))
        known = [part for part in parts if part is not None]
        return math.sqrt(stick / contact), sum(known) / 2 if len(known) == 2 else None
    found = quantities[quantity]
    value = found[0] if quantity == "friction_force" else found
    return value, bar(quantity, abs(value))


# Hertz: formulas of the half-space. Friction: Q2 graded at 1/40 on 1000, with which 1/25 agrees to
# 1e-6 in force and 2e-5 in peak; radius and ratio are means of that and of an adaptive mesh, which
# differ by 6e-4. Incremental law: in the same 20 steps on 1000, at 1/20, 1/28 and 1/36, which agree
# to 1e-5 in force, 2e-5 in peak, 4e-4 in the radius and 7e-4 in the ratio. Slab: Q2 512 × 64, the
# energy extrapolated at second order from 256 × 32 and 512 × 64; the stick area is of 320 × 40,
# 9e-4 from that of 192 × 24. Ring: Q2 graded from cells of 3e-5 at the edges, extrapolated from
# 1e-4; off by 1e-5 in force and 5e-4 in the stick area.
_UNTIL: dict[str, tuple[int, int]] = {
    "P1 uniform": (-1, 2),
    "Q2 uniform": (-1, 2),
    "Q2 graded": (0, 4),
    ADAPTIVE: (0, 0),
}
CASES: tuple[Case, ...] = (
    Case(
        "hertz",
        "Hertz",
        hertz,
        _UNTIL,
        lambda accuracy: Accuracy(main=accuracy),
        {
            "normal_force": HERTZ.force,
            "max_contact_pressure": HERTZ.peak,
            "contact_radius": HERTZ.radius,
        },
    ),
    Case(
        "friction",
        f"Friction, static law, μ = {COEFFICIENT}",
        rough,
        _UNTIL,
        lambda accuracy: Accuracy(main=accuracy),
        {
            "normal_force": 4246.55,
            "max_contact_pressure": 268.412,
            "contact_radius": 2.7792,
            "stick_ratio": 0.7653,
        },
    ),
    Case(
        "incremental",
        f"Friction, incremental law, μ = {COEFFICIENT}, {STEPS} steps",
        in_steps,
        _UNTIL | {"P1 uniform": (-1, 1), "Q2 uniform": (-1, 1), "Q2 graded": (0, 3)},
        lambda accuracy: Accuracy(normal_force=accuracy, max_contact_pressure=accuracy),
        {
            "normal_force": 4212.10,
            "max_contact_pressure": 268.719,
            "contact_radius": 2.7942,
            "stick_ratio": 0.9759,
        },
        without=("step",),
    ),
    Case(
        "slab",
        "Slab",
        slab,
        {"P1 uniform": (0, 5), "Q2 uniform": (0, 4), ADAPTIVE: (1, 1)},
        lambda accuracy: Accuracy(strain_energy=accuracy / 10, friction_force=accuracy),
        {"friction_force": 209.9750961, "strain_energy": 352.713039, "stick_area": 6.404},
    ),
    Case(
        "annulus",
        "Ring with friction, μ = .3",
        ring,
        {"P1 uniform": (2, 5), "Q2 uniform": (2, 4), "Q2 graded": (3, 9), ADAPTIVE: (3, 3)},
        lambda accuracy: Accuracy(normal_force=accuracy),
        {"normal_force": 28.4474, "stick_area": 1.8595},
    ),
)
