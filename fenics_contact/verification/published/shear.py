"""A paraboloid pressed on a half-space, then pushed sideways: half of the body, in 3D.

The contact radius is small against the obstacle's, so that this moves by little of the contact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import sqrt

from fenics_contact.analyses.derivatives.table import DerivativeRequest
from fenics_contact.analytic import contact as formulas
from fenics_contact.common.program import mesh_file
from fenics_contact.results.records.record import Quantities
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.obstacle import HalfSpace, Obstacle
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.published.point import JOHNSON, YOUNGS_MODULUS

# Pressing then makes hardly any friction, as the solution assumes.
_POISSONS_RATIO = 0.49
_SHEAR_MODULUS = YOUNGS_MODULUS / (2 * (1 + _POISSONS_RATIO))
_COEFFICIENT = 0.3
_RADIUS = 50.0
HERTZ = formulas.paraboloid(
    formulas.plane_strain_modulus(YOUNGS_MODULUS, _POISSONS_RATIO), _RADIUS, 1 / _RADIUS
)
_MESH = {"fine": 1.25, "size": 0.25, "extent": 10.0, "cells_outside": 5}
_QUICK_MESH = {"fine": 1.5, "size": 0.375, "extent": 10.0, "cells_outside": 3}


def shift(share: float) -> float:
    """δ at a share Q/μP of the shear that makes all of the contact slip (length)."""
    return formulas.partial_slip_shift(HERTZ, _COEFFICIENT, share, _SHEAR_MODULUS, _POISSONS_RATIO)


def shear_share(quantities: Quantities) -> float:
    """Q/μP of a load step, of the half body."""
    return float(2 * abs(quantities["friction_force"][0]) / (_COEFFICIENT * HERTZ.force))


def loss(share: float) -> float:
    """What a cycle between ± this share of μP dissipates (energy)."""
    return formulas.partial_slip_loss(HERTZ, _COEFFICIENT, share, _SHEAR_MODULUS, _POISSONS_RATIO)


def sheared_scene(*shares: float, **mesh: float) -> Scene:
    """Pressed in the first step, then moved to where these shares of μP are expected."""
    shifts = [shift(share) for share in shares]
    ends = tuple(1.0 + number for number in range(1 + len(shares)))
    obstacle = Obstacle(
        "paraboloid",
        radius=_RADIUS,
        force=HERTZ.force / 2,
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
    slope = HERTZ.force * (share - 1.5 * left * (1 - left**2))
    value = float("nan") if found is None else 2 * abs(found)
    return Finding(f"friction by its coefficient, Q = {share:.2f} μP", value, slope, 0.02)


CASES: tuple[Case, ...] = (
    Case(
        "mindlin",
        "paraboloid pressed, then pushed sideways, in 3D",
        f"R. D. Mindlin, J. Appl. Mech. 16 (1949) 259-268; {JOHNSON}, section 7.2",
        _mindlin,
    ),
)
