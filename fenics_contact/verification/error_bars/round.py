"""Paraboloids and parabolas on half-spaces: contacts with a moving edge."""

from __future__ import annotations

import dataclasses
from functools import partial
from math import pi

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.results.records.record import Quantities
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import MeshSource, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.error_bars.case import (
    BarCase,
    Element,
    Model,
    Parameters,
    of_element,
)
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.indenters import (
    JOHNSON,
    MATERIAL,
    MODULUS,
    RADIUS,
    half_space_scene,
)

FINER = "the same on much finer meshes and a larger domain"
# Of a part of a half-space these depend on where it is cut off.
_OF_THE_PART = ("strain_energy", "external_work")
# Penetration over indentation of about 1e-4 to 1e-2 at the peak; ε over the slip likewise.
_SMOOTH = (Parameters(), Parameters(None, 4e-6), Parameters(None, 4e-5))
_ROUGH = (Parameters(1e-5, None), Parameters(1e-4, 4e-6), Parameters(1e-3, 4e-5))
_LOADS = (0.83, 1.0, 1.19)
_PRESSED = 20  # load steps of the incremental law


def _paraboloid(indentation: float) -> Obstacle:
    return Obstacle("paraboloid", radius=RADIUS, indentation=indentation)


def _on_half_space(
    coefficient: float, element: Element, cells: int, load: float, extent: float = 60
) -> Model:
    """The demo sphere's mesh with cells of .4 over ``cells``."""
    scene = half_space_scene(
        _paraboloid(load), fine=5, size=0.4 / cells, extent=extent, cells_outside=8 * cells
    )
    scene = with_friction(scene, coefficient) if coefficient else scene
    return Model(of_element(scene, element))


def _finer_sphere(coefficient: float, level: int, load: float) -> Model:
    """Cells of 1/25 and 1/40, on 1000 in place of 60."""
    size = (0.04, 0.025)[level]
    scene = half_space_scene(
        _paraboloid(load), fine=4, size=size, extent=1000, cells_outside=(50, 80)[level]
    )
    return Model(with_friction(scene, coefficient) if coefficient else scene)


def hertz(load: float) -> Quantities:
    """Hertz' formulas by the indentation."""
    found = formulas.paraboloid(MODULUS, RADIUS, load)
    return {
        "normal_force": found.force,
        "reaction": [0.0, found.force],
        "friction_force": [0.0, 0.0],
        "max_contact_pressure": found.peak,
        "contact_area": pi * found.radius**2,
        "max_penetration": 0.0,
        "penalty_energy": 0.0,
        "indentation": load,
    }


def hertz_model(element: Element, cells: int, load: float) -> Model:
    """Other meshes than the demo's: cells of 1/2 over ``cells``, on 30."""
    scene = half_space_scene(
        _paraboloid(load), fine=4, size=0.5 / cells, extent=30, cells_outside=7 * cells
    )
    return Model(of_element(scene, element))


def _line_model(element: Element, cells: int, load: float) -> Model:
    scene = Scene(
        kinematics="plane strain",
        mesh=(
            MeshSource(
                mesh_file("half_space.geo"),
                parameters={
                    "fine": 4,
                    "size": 0.5 / cells,
                    "extent": 40,
                    "cells_outside": 8 * cells,
                },
            ),
        ),
        material=MATERIAL,
        symmetry=("axis",),
        half_space=HalfSpace(("outer",)),
        contact=(
            Contact("contact", obstacle=Obstacle("parabola", radius=RADIUS, force=_half(load))),
        ),
    )
    return Model(of_element(scene, element))


def _half(load: float) -> float:
    """Force on half of the model for a half-width of √8 times the load's root."""
    return load * formulas.line_force(MODULUS, RADIUS, 8**0.5) / 2


def _line(load: float) -> Quantities:
    found = formulas.line_contact(MODULUS, RADIUS, 2 * _half(load))
    return {
        "normal_force": _half(load),
        "friction_force": [0.0, 0.0],
        "max_contact_pressure": found.peak,
        "contact_area": found.radius,
        "max_penetration": 0.0,
        "penalty_energy": 0.0,
    }


def _in_steps(model: Model, number: int) -> Model:
    """The same by the incremental law, in equal steps."""
    (contact,) = model.scene.contact
    scene = dataclasses.replace(
        model.scene,
        contact=(dataclasses.replace(contact, law="incremental"),),
        steps=Steps(number),
        solver=SolverSettings(strategy="monolithic"),
    )
    return Model(scene, model.body)


def _incremental(element: Element, cells: int, load: float) -> Model:
    return _in_steps(_on_half_space(0.6, element, cells, load), _PRESSED)


def _finer_incremental(level: int, load: float) -> Model:
    """Cells of 1/12 and 1/16 in 80 and 160 steps."""
    scene = half_space_scene(
        _paraboloid(load),
        fine=3.5,
        size=(1 / 12, 1 / 16)[level],
        extent=1000,
        cells_outside=(24, 32)[level],
    )
    return _in_steps(Model(with_friction(scene, 0.6)), (80, 160)[level])


def strip_scene(size: float, cells_outside: int, moved: float, over: Path) -> Scene:
    """A parabola pressed on a strip until pseudo-time 1, then pushed sideways.

    Args:
        size: Of cells at the contact (length).
        cells_outside: From there to the ends.
        moved: Sideways (length).
        over: Factor of that over pseudo-time.
    """
    obstacle = Obstacle(
        "parabola",
        radius=400,
        force=formulas.line_force(formulas.plane_strain_modulus(1000, 0.45), 400, 1),
        displacement=(moved, 0),
        displacement_path=over,
    )
    return Scene(
        kinematics="plane strain",
        mesh=(
            MeshSource(
                mesh_file("strip.geo"),
                cell="quadrilateral",
                parameters={"fine": 1.5, "size": size, "cells_outside": cells_outside},
            ),
        ),
        material=(Material(1000, 0.45),),
        support=(Support("bottom", {"x": 0, "y": 0}),),
        contact=(
            Contact("contact", obstacle=obstacle, friction_coefficient=0.5, law="incremental"),
        ),
        solver=SolverSettings(strategy="monolithic"),
    )


def _strip(size: float, cells_outside: int, shear_steps: int) -> Scene:
    """The same in one step, then in others."""
    times = [1.0 + step / shear_steps for step in range(shear_steps + 1)]
    over = Path(time=(1.0, 2.0), factor=(0.0, 1.0))
    scene = strip_scene(size, cells_outside, 0.00336, over)
    return dataclasses.replace(scene, steps=Steps(times=tuple(times)))


def _cattaneo(element: Element, cells: int, load: float) -> Model:
    return Model(of_element(_strip(0.3 / cells, 6 * cells, 4), element))


def _finer_cattaneo(level: int, load: float) -> Model:
    return Model(_strip((1 / 40, 1 / 60)[level], (32, 48)[level], (24, 48)[level]))


ROUND_CASES: tuple[BarCase, ...] = (
    BarCase(
        name="sphere_0",
        summary="demo sphere without friction",
        source=f"{JOHNSON}, (4.22)-(4.24)",
        role="chosen",
        model=partial(_on_half_space, 0.0),
        elements=("Q2",),
        parameters=_SMOOTH,
        exact=hertz,
    ),
    *(
        BarCase(
            name=f"sphere_{coefficient}",
            summary=f"demo sphere, static law, μ = {coefficient}",
            source=FINER,
            role="chosen",
            model=partial(_on_half_space, coefficient),
            elements=("Q2",),
            parameters=_ROUGH,
            finer=partial(_finer_sphere, coefficient),
            left_out=_OF_THE_PART,
        )
        for coefficient in (0.1, 0.6)
    ),
    BarCase(
        name="hertz",
        summary="paraboloid, three loads",
        source=f"{JOHNSON}, (4.22)-(4.24)",
        role="tested",
        model=hertz_model,
        elements=("Q2", "P2", "Q1", "P1"),
        parameters=_SMOOTH,
        loads=_LOADS,
        exact=hertz,
        quick=True,
    ),
    BarCase(
        name="line",
        summary="parabola in plane strain by force, three loads",
        source=f"{JOHNSON}, (4.43), (4.45)",
        role="tested",
        model=_line_model,
        elements=("Q2", "P2", "Q1", "P1"),
        parameters=_SMOOTH,
        loads=_LOADS,
        exact=_line,
        quick=True,
    ),
    BarCase(
        name="friction",
        summary="paraboloid, static law, μ = .3",
        source=FINER,
        role="tested",
        model=partial(_on_half_space, 0.3),
        elements=("P2", "Q1", "P1"),
        parameters=_ROUGH,
        loads=(0.9,),
        finer=partial(_finer_sphere, 0.3),
        left_out=_OF_THE_PART,
    ),
    BarCase(
        name="incremental",
        summary=f"paraboloid, incremental law, μ = .6, {_PRESSED} steps",
        source=f"{FINER}, with 160 steps",
        role="chosen",
        model=_incremental,
        elements=("Q2",),
        parameters=_ROUGH,
        finer=_finer_incremental,
        left_out=_OF_THE_PART,
    ),
    BarCase(
        name="cattaneo",
        summary="parabola pressed on a strip, then pushed sideways in 4 steps",
        source="the same on much finer meshes, in 48 steps",
        role="tested",
        model=_cattaneo,
        elements=("Q2", "P2"),
        parameters=(Parameters(1e-8, None), Parameters(1e-7, 1e-8), Parameters(1e-6, 1e-7)),
        finer=_finer_cattaneo,
    ),
)
