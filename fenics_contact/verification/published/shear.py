"""Slabs that are pressed and sheared on rigid ground, against closed solutions.

A paraboloid pressed on a half-space, then pushed sideways: half of the body, in 3D. The contact
radius is small against the obstacle's, so that this moves by little of the contact.

The paper's slabs: example 1 (prescribed pressure) and 2 (Winkler foundation). Parts of the
examples' data are lost in the paper; they are reconstructed as the meshes and the numbers below
say. The references are those of a separate FEniCSx prototype of the same data.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import sqrt

from fenics_contact.analyses.derivatives.table import DerivativeRequest
from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.published.indenters import JOHNSON, YOUNGS_MODULUS

# End load → position of the last contact point that sticks, on 16 × 1 elements.
_LAST_STICKING = {100.0: 8.0, 200.0: 7.75, 300.0: 6.25, 400.0: 5.25, 600.0: 3.0, 700.0: 1.75}
# Stiffness of the foundation → deflection in the middle, on 160 × 16 elements.
_DEFLECTION = {100.0: 0.0718, 20.0: 0.2578, 1000.0: 0.00968}
_CONTACT_END = 2.36  # at a stiffness of 100
_LOAD = 10.0

_PAPER = "L. T. Campos, J. T. Oden, N. Kikuchi, CMAME 34 (1982) 821-845"
_PROTOTYPE = "data reconstructed; values of a separate prototype"


def slab_scene(end_load: float = 300.0, cells: tuple[int, int] = (16, 1)) -> Scene:
    """Example 1: a slab pushed at its end against friction under a given pressure.

    Args:
        end_load: Pressure on its right end (stress).
        cells: Along and across.
    """
    return Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(
                mesh_file("slab.geo"),
                cell="quadrilateral",
                parameters={"cells_along": cells[0], "cells_across": cells[1]},
            ),
        ),
        material=(Material(1000, 0.3),),
        support=(Support("bottom", {"y": 0}), Support("left", {"x": 0})),
        load=(Load("right", traction=(-end_load, 0)),),
        contact=(Contact("top", pressure=300, friction_coefficient=0.3),),
    )


def _slab(quick: bool) -> Iterator[Finding]:
    for end_load, expected in _LAST_STICKING.items():
        result = solved(slab_scene(end_load))
        if end_load == 300.0:
            quantities = result.quantities
            for quantity, reference in (("friction_force", 209.98), ("reaction", 90.02)):
                value = quantities[quantity][0]
                yield Finding(f"{quantity} x", value, reference, 0.1, absolute=True)
        label = f"last sticking point, end load {end_load:g}"
        yield Finding(label, _last_sticking(result), expected, 1e-9, absolute=True)


def _last_sticking(result: Result) -> float:
    """Position of the last contact point that sticks (length)."""
    points = result.points
    assert points is not None
    return float(points.coordinates[points.status == "STICK", 0].max(initial=0.0))


def winkler_scene(stiffness: float) -> Scene:
    """Example 2 without friction: half a slab on springs, with a patch of pressure on top."""
    return Scene(
        kinematics="plane stress",
        mesh=(
            MeshSource(
                mesh_file("foundation_slab.geo"),
                cell="quadrilateral",
                parameters={"cells_along": 160, "cells_across": 16},
            ),
        ),
        material=(Material(1000, 0.3),),
        symmetry=("left",),
        load=(Load("patch", traction=(0, -_LOAD)),),
        contact=(Contact("bottom", foundation_stiffness=stiffness),),
    )


def _winkler(quick: bool) -> Iterator[Finding]:
    deflections = {100.0: _DEFLECTION[100.0]} if quick else _DEFLECTION
    for stiffness, expected in deflections.items():
        result = solved(winkler_scene(stiffness))
        assert result.points is not None
        yield Finding(f"w(0), k = {stiffness:g}", -float(result.points.gap[0]), expected, 1e-2)
        if stiffness == 100.0:
            end = result.quantities["contact_area"]
            yield Finding("contact end, k = 100", end, _CONTACT_END, 0.05, absolute=True)
            yield of_quantity(result, "normal_force", _LOAD, 1e-6, ", k = 100")


SLAB_CASES: tuple[Case, ...] = (
    Case("slab", "slab with friction", f"{_PAPER}, example 1; {_PROTOTYPE}", _slab),
    Case("winkler", "slab on a Winkler foundation", f"{_PAPER}, example 2; {_PROTOTYPE}", _winkler),
)


# Pressing then makes hardly any friction, as the solution assumes.
_POISSONS_RATIO = 0.49
_SHEAR_MODULUS = YOUNGS_MODULUS / (2 * (1 + _POISSONS_RATIO))
_COEFFICIENT = 0.3
_RADIUS = 50.0
SPHERE = formulas.paraboloid(
    formulas.plane_strain_modulus(YOUNGS_MODULUS, _POISSONS_RATIO), _RADIUS, 1 / _RADIUS
)
_MESH = {"fine": 1.25, "size": 0.25, "extent": 10.0, "cells_outside": 5}
_QUICK_MESH = {"fine": 1.5, "size": 0.375, "extent": 10.0, "cells_outside": 3}


def shift(share: float) -> float:
    """δ at a share Q/μP of the shear that makes all of the contact slip (length)."""
    return formulas.partial_slip_shift(SPHERE, _COEFFICIENT, share, _SHEAR_MODULUS, _POISSONS_RATIO)


def shear_share(quantities: Quantities) -> float:
    """Q/μP of a load step, of the half body."""
    return float(2 * abs(quantities["friction_force"][0]) / (_COEFFICIENT * SPHERE.force))


def loss(share: float) -> float:
    """What a cycle between ± this share of μP dissipates (energy)."""
    return formulas.partial_slip_loss(SPHERE, _COEFFICIENT, share, _SHEAR_MODULUS, _POISSONS_RATIO)


def sheared_scene(*shares: float, **mesh: float) -> Scene:
    """Pressed in the first step, then moved to where these shares of μP are expected."""
    shifts = [shift(share) for share in shares]
    ends = tuple(1.0 + number for number in range(1 + len(shares)))
    obstacle = Obstacle(
        "paraboloid",
        radius=_RADIUS,
        force=SPHERE.force / 2,
        displacement=(shifts[-1], 0, 0),
        displacement_path=Path(time=ends, factor=(0.0, *(by / shifts[-1] for by in shifts))),
    )
    parameters = {"half": 1, "hexahedra": 1} | _QUICK_MESH | mesh
    contact = Contact(
        "contact", obstacle=obstacle, friction_coefficient=_COEFFICIENT, law="incremental"
    )
    return Scene(
        kinematics="3D",
        mesh=(MeshSource(mesh_file("quarter_space.geo"), parameters=parameters),),
        material=(Material(YOUNGS_MODULUS, _POISSONS_RATIO),),
        discretisation=Discretisation(2),
        symmetry=("symmetry_y",),
        half_space=HalfSpace(("outer",)),
        contact=(contact,),
        steps=Steps(len(ends), ends[-1]),
        solver=SolverSettings(strategy="monolithic"),
    )


def _mindlin(quick: bool) -> Iterator[Finding]:
    """δ and the stick radius that belong to the shear Q found, P given, a that of Hertz."""
    shares = (0.6,) if quick else (0.3, 0.6, 0.9)
    result = solved(sheared_scene(*shares, **(_QUICK_MESH if quick else _MESH)))
    for expected, step in zip(shares, result.steps[1:], strict=True):
        quantities = step["quantities"]
        share = shear_share(quantities)
        at = f"Q = {share:.2f} μP"
        yield Finding(f"displacement, {at}", shift(expected), shift(share), 1e-2)
        ratio = sqrt(quantities["stick_area"] / quantities["contact_area"])
        stick = (1 - share) ** (1 / 3)
        yield Finding(f"stick / radius, {at}", ratio, stick, 0.04, absolute=True)
    if not quick:
        yield _slope(0.6)


def _slope(share: float) -> Finding:
    """What the shear grows by with the coefficient of friction, as the shift stays.

    δ is in proportion to μ g, g = 1 − (1 − q)^(2/3) with q = Q/μP: so dQ/dμ = P (q − g/g').
    """
    key, cells = "contact.0.friction_coefficient", {"fine": 1.25, "size": 0.125, "cells_outside": 5}
    scene = sheared_scene(share, **cells)
    solver = replace(scene.solver, errors="none")
    asked = DerivativeRequest(("friction_force_x",), (key,))
    result = solved(replace(scene, solver=solver, derivatives=asked))
    found = result.derivatives["friction_force_x"][key].value
    left = (1 - share) ** (1 / 3)
    slope = SPHERE.force * (share - 1.5 * left * (1 - left**2))
    value = float("nan") if found is None else 2 * abs(found)
    return Finding(f"friction by its coefficient, Q = {share:.2f} μP", value, slope, 0.02)


SHEAR_CASES: tuple[Case, ...] = (
    Case(
        "mindlin",
        "paraboloid pressed, then pushed sideways, in 3D",
        f"R. D. Mindlin, J. Appl. Mech. 16 (1949) 259-268; {JOHNSON}, section 7.2",
        _mindlin,
    ),
)
