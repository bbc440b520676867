"""Flat contacts: the paper's slabs and its annulus, punches, cylinders under a given strain."""

from __future__ import annotations

import dataclasses
from functools import partial
from math import pi

import numpy as np

from fenics_contact.analytic import contact as formulas
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.results.records.record import Quantities
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Point
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.verification.error_bars.case import (
    BarCase,
    Element,
    Model,
    Parameters,
    of_element,
)
from fenics_contact.verification.hard.scenes import box
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.indenters import MODULUS, annulus_scene
from fenics_contact.verification.published.shear import slab_scene, winkler_scene

FINER = "the same on much finer meshes"
E, NU = 1000.0, 0.3
_AUTOMATIC = Parameters()


def _with_mesh(scene: Scene, **parameters: float) -> Scene:
    (mesh,) = scene.mesh
    changed = dataclasses.replace(mesh, parameters=dict(mesh.parameters) | parameters)
    return dataclasses.replace(scene, mesh=(changed,))


def slab(element: Element, cells: int, load: float) -> Model:
    """The paper's example 1, ``cells`` across."""
    scene = slab_scene(load, cells=(8 * cells, cells))
    scene = dataclasses.replace(scene, point=(Point("end", (8.0, 0.5)),))
    return Model(of_element(scene, element))


def finer_slab(level: int, load: float) -> Model:
    """Its reference."""
    return slab("Q2", (24, 40)[level], load)


def _winkler(element: Element, cells: int, load: float) -> Model:
    scene = with_friction(winkler_scene(100), 1.0)
    scene = _with_mesh(scene, cells_along=20 * cells, cells_across=2 * cells)
    scene = dataclasses.replace(scene, point=(Point("middle", (0.0, 0.0)),))
    return Model(of_element(scene, element))


def _finer_winkler(level: int, load: float) -> Model:
    return _winkler("Q2", (12, 20)[level], load)


def _annulus(
    coefficient: float, element: Element, cells: int, load: float, extent: float = 200
) -> Model:
    growth = {1: 2.0, 2: 1.6, 4: 1.3, 8: 1.15}[cells]
    scene = _with_mesh(annulus_scene(), extent=extent, size=0.04 / cells, growth=growth)
    scene = with_friction(scene, coefficient) if coefficient else scene
    return Model(of_element(scene, element))


def _finer_annulus(coefficient: float, level: int, load: float) -> Model:
    scene = _with_mesh(
        annulus_scene(), extent=1000, size=(1e-3, 1e-4)[level], growth=(1.15, 1.12)[level]
    )
    return Model(with_friction(scene, coefficient))


def _ring(load: float) -> Quantities:
    """Frictionless, by the integral equation of ring loads."""
    force = formulas.annular_punch_force(MODULUS, 0.5, 1.0, 0.01)
    return {
        "normal_force": force,
        "reaction": [0.0, force],
        "friction_force": [0.0, 0.0],
        "contact_area": pi * 0.75,
        "penalty_energy": 0.0,
    }


def _punch_scene(coefficient: float, degree: int) -> Scene:
    """Right half of a block 4 × 1, held at its foot, under a flat punch of half-width 1."""
    return Scene(
        kinematics="plane strain",
        material=(Material(E, NU),),
        discretisation=Discretisation(degree),
        symmetry=("left",),
        support=(Support("bottom", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "patch",
                obstacle=Obstacle(indentation=0.01),
                friction_coefficient=coefficient,
            ),
        ),
        point=(Point("beside", (1.5, 1.0)),),
    )


def _under_the_punch(points: Array) -> Flags:
    return np.asarray(points[:, 0] < 1.0)


def punch(coefficient: float, element: Element, cells: int, load: float) -> Model:
    """Its mesh is uniform, with ``4 * cells`` in depth."""
    body = box(
        (8 * cells, 4 * cells),
        (2, 1),
        patches={"patch": ("top", _under_the_punch)},
        simplices=element.startswith("P"),
    )
    return Model(_punch_scene(coefficient, int(element[1])), body)


def _towards_the_edge(points: Array) -> Array:
    """Cells that shrink with the cube of the distance from the punch's edge, (1, 1)."""
    moved = points.copy()
    across = points[:, 0] - 1
    moved[:, 0] = 1 + np.sign(across) * np.abs(across) ** 3
    moved[:, 1] = 1 - (1 - points[:, 1]) ** 3
    return moved


def finer_punch(coefficient: float, level: int, load: float) -> Model:
    """Its reference, on cells that shrink towards the edge."""
    cells = (32, 56)[level]
    body = box(
        (2 * cells, cells),
        (2, 1),
        move=_towards_the_edge,
        patches={"patch": ("top", _under_the_punch)},
    )
    return Model(_punch_scene(coefficient, 2), body)


_INNER, _OUTER, _HEIGHT, _PUSHED = 1.0, 2.0, 0.5, 1e-3


def cylinder(element: Element, cells: int, load: float) -> Model:
    """A thick cylinder in plane strain that a smooth rigid bolt widens by ``_PUSHED``."""
    scene = Scene(
        kinematics="axisymmetric",
        material=(Material(E, NU),),
        discretisation=Discretisation(int(element[1])),
        support=(Support("bottom", {"y": 0}), Support("top", {"y": 0})),
        contact=(Contact("left", obstacle=Obstacle(gap=-_PUSHED)),),
        point=(Point("outside", (_OUTER, 0.2)), Point("within", (1.3, 0.2))),
    )
    body = box(
        (4 * cells, 2 * cells),
        (_OUTER - _INNER, _HEIGHT),
        move=lambda points: points + np.array([_INNER, 0.0]),
        simplices=element.startswith("P"),
    )
    return Model(scene, body)


def lame(load: float) -> Quantities:
    """u_r = A r + B/r with u_r(1) given and no stress at r = 2."""
    lame_lambda, shear_modulus = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
    # σ_rr = 2 (λ + G) A − 2 G B / r² vanishes at the outside.
    ratio = shear_modulus / (lame_lambda + shear_modulus) / _OUTER**2
    b = _PUSHED / (ratio * _INNER + 1 / _INNER)
    a = ratio * b
    pressure = -2 * (lame_lambda + shear_modulus) * a + 2 * shear_modulus * b / _INNER**2
    area = 2 * pi * _INNER * _HEIGHT
    return {
        "pressure_integral": pressure * area,
        "max_contact_pressure": pressure,
        "contact_area": area,
        "strain_energy": pressure * area * _PUSHED / 2,
        "max_penetration": 0.0,
        "penalty_energy": 0.0,
        "displacement_outside": [a * _OUTER + b / _OUTER, 0.0],
        "displacement_within": [a * 1.3 + b / 1.3, 0.0],
    }


def _pressed_block(element: Element, cells: int, load: float) -> Model:
    """Uniaxial strain, which every mesh has: what is left are the parameters."""
    scene = Scene(
        kinematics="plane strain",
        material=(Material(E, NU),),
        discretisation=Discretisation(int(element[1])),
        support=(
            Support("bottom", {"y": 0}),
            Support("left", {"x": 0}),
            Support("right", {"x": 0}),
        ),
        contact=(Contact("top", obstacle=Obstacle(indentation=0.01)),),
        point=(Point("inside", (0.3, 0.4)),),
    )
    return Model(scene, box((4 * cells, 2 * cells), (2, 1), simplices=element.startswith("P")))


def _uniaxial(load: float) -> Quantities:
    pressure = E * (1 - NU) / (1 + NU) / (1 - 2 * NU) * 0.01
    return {
        "normal_force": 2 * pressure,
        "max_contact_pressure": pressure,
        "contact_area": 2.0,
        "strain_energy": pressure * 0.01,
        "max_penetration": 0.0,
        "penalty_energy": 0.0,
        "displacement_inside": [0.0, -0.004],
    }


FLAT_CASES: tuple[BarCase, ...] = (
    BarCase(
        name="block",
        summary="block under uniform pressure",
        source="uniaxial strain, exact",
        role="chosen",
        model=_pressed_block,
        elements=("Q2", "P1"),
        parameters=(_AUTOMATIC, Parameters(None, 1e-6), Parameters(None, 1e-5)),
        exact=_uniaxial,
        quick=True,
    ),
    BarCase(
        name="lame",
        summary="thick cylinder widened by a bolt",
        source="G. Lamé; S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970, section 28",
        role="chosen",
        model=cylinder,
        elements=("Q2", "P2", "Q1", "P1"),
        parameters=(_AUTOMATIC, Parameters(None, 1e-7), Parameters(None, 1e-6)),
        exact=lame,
        quick=True,
    ),
    BarCase(
        name="slab",
        summary="paper's example 1, three end loads",
        source=FINER,
        role="tested",
        model=slab,
        elements=("Q2", "P2", "Q1", "P1"),
        parameters=(_AUTOMATIC, Parameters(1e-4), Parameters(1e-3)),
        loads=(300.0, 400.0, 600.0),
        finer=finer_slab,
        quick=True,
    ),
    BarCase(
        name="winkler",
        summary="paper's example 2, μ = 1",
        source=FINER,
        role="chosen",
        model=_winkler,
        elements=("Q2", "Q1"),
        parameters=(_AUTOMATIC, Parameters(1e-5), Parameters(1e-4)),
        finer=_finer_winkler,
    ),
    BarCase(
        name="annulus_0",
        summary="flat ring without friction",
        source="integral equation of ring loads (Johnson 1985, section 3.8)",
        role="chosen",
        model=partial(_annulus, 0.0),
        elements=("Q2", "Q1"),
        parameters=(_AUTOMATIC, Parameters(None, 1e-7), Parameters(None, 1e-6)),
        exact=_ring,
        quick=True,
    ),
    BarCase(
        name="annulus_0.3",
        summary="paper's example 4, μ = .3",
        source=FINER,
        role="chosen",
        model=partial(_annulus, 0.3),
        elements=("Q2", "P2"),
        parameters=(_AUTOMATIC, Parameters(1e-6, 1e-7), Parameters(1e-5, 1e-6)),
        finer=partial(_finer_annulus, 0.3),
        # Of the part of the half-space; and infinite at the ring's edges.
        left_out=("strain_energy", "external_work", "max_contact_pressure", "max_penetration"),
    ),
    *(
        BarCase(
            name=f"punch_{coefficient:g}",
            summary=f"flat punch on a block, μ = {coefficient:g}",
            source=f"{FINER}, graded towards its edge",
            role="tested",
            model=partial(punch, coefficient),
            elements=elements,  # type: ignore[arg-type]
            parameters=(_AUTOMATIC, Parameters(1e-6, 1e-7), Parameters(1e-5, 1e-6)),
            finer=partial(finer_punch, coefficient),
            left_out=("max_contact_pressure", "max_penetration"),  # infinite at its edge
        )
        for coefficient, elements in ((0.0, ("Q2", "P1")), (0.2, ("Q2",)))
    ),
)
