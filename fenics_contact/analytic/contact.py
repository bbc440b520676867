"""Closed solutions of contact with a half-space, also where fretting has worn the body.

Closed solutions of contact with a half-space, in user's units. E* is the plane strain modulus E /
(1 − ν²) of the half-space; the obstacles are rigid. Sources:

- K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, chapters 3 to 5.
- I. N. Sneddon, The relation between load and penetration in the axisymmetric Boussinesq
  problem for a punch of arbitrary profile, Int. J. Engng Sci. 3 (1965) 47-57.

Where wear by fretting ends: a paraboloid that is rubbed to and fro at a height that stays. What
sticks never wears. Around it wear goes on until the pressure there is gone, so that in the end the
circle that sticks carries all. By the reduction to one dimension the rigid profile is then x²/R
for x < c, and all of the depth d beyond (V. L. Popov, Philosophical Magazine 94 (2014) 2887; A. V.
Dimaki, A. I. Dmitriev, Y. S. Chai, V. L. Popov, Int. J. Solids Struct. 51 (2014) 4215-4220).
Lengths are over the contact radius a₀ = √(R d) of the surface before it wears, ξ = c/a₀.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk, ellipkm1

from fenics_contact.common.arrays import Array


@dataclass(frozen=True)
class HertzContact:
    """A contact's size and load.

    Attributes:
        force: Normal force; per thickness in a line contact.
        radius: Contact radius, or half-width of a line contact (length).
        peak: Largest pressure (stress).
    """

    force: float
    radius: float
    peak: float


def plane_strain_modulus(youngs_modulus: float, poissons_ratio: float) -> float:
    """E* = E / (1 − ν²) (stress)."""
    return youngs_modulus / (1 - poissons_ratio**2)


def paraboloid(modulus: float, radius: float, indentation: float) -> HertzContact:
    """Point contact with a paraboloid (Johnson, (4.22) to (4.24)).

    F = 4/3 E* √R d^(3/2), a = √(R d), p₀ = 2/π E* √(d/R).

    Args:
        modulus: E* (stress).
        radius: R, of curvature at the apex (length).
        indentation: d (length).
    """
    return HertzContact(
        force=4 / 3 * modulus * sqrt(radius) * indentation**1.5,
        radius=sqrt(radius * indentation),
        peak=2 / pi * modulus * sqrt(indentation / radius),
    )


def axis_stress(contact: HertzContact, depth: Array, poissons_ratio: float) -> tuple[Array, Array]:
    """Axial and radial stress on the axis below a point contact (Johnson, (3.45)).

    With s = z/a, σ_zz = −p₀ / (1 + s²), σ_rr = −p₀ [(1 + ν)(1 − s arctan 1/s) − 1 / (2 (1 + s²))].

    Args:
        contact: The contact, with a and p₀.
        depth: z, below the surface (length).
        poissons_ratio: ν.
    """
    s = depth / contact.radius
    fading = 1 / (1 + s**2)
    radial = (1 + poissons_ratio) * (1 - s * np.arctan2(1, s)) - fading / 2
    return -contact.peak * fading, -contact.peak * radial


def sphere(modulus: float, radius: float, indentation: float) -> tuple[float, float]:
    """Force and contact radius of a sphere that is no paraboloid (Sneddon 1965).

    d = (a/2) ln((R + a)/(R − a)) gives a; F = E*/2 [(a² + R²) ln((R + a)/(R − a)) − 2 a R].
    The arguments are those of ``paraboloid``; a is less than R.
    """

    def logarithm(a: float) -> float:
        return log((radius + a) / (radius - a))

    a = brentq(
        lambda a: a / 2 * logarithm(a) - indentation, 0.0, radius * (1 - 1e-12), xtol=1e-14 * radius
    )
    force = modulus / 2 * ((a**2 + radius**2) * logarithm(a) - 2 * a * radius)
    return force, a


def line_contact(modulus: float, radius: float, force: float) -> HertzContact:
    """A cylinder, by its force per thickness (Johnson, (4.43) and (4.45)).

    a = √(4 P R / (π E*)), p₀ = 2 P / (π a). The other arguments are those of ``paraboloid``.
    """
    half_width = sqrt(4 * force * radius / (pi * modulus))
    return HertzContact(force=force, radius=half_width, peak=2 * force / (pi * half_width))


def line_force(modulus: float, radius: float, half_width: float) -> float:
    """Force per thickness of a line contact of a given half-width: P = π E* a² / (4 R)."""
    return pi * modulus * half_width**2 / (4 * radius)


def partial_slip(contact: HertzContact, coefficient: float, stick: float, x: Array) -> Array:
    """Tangential traction of a line contact, pressed, then sheared (Johnson, (7.24)-(7.28)).

    q = μ p₀ (√(1 − x²/a²) − c/a √(1 − x²/c²)), the second term where |x| < c.

    Args:
        contact: Its half-width a and p₀.
        coefficient: μ.
        stick: Half-width c of what sticks (length).
        x: From the middle (length).
    """

    def ellipse(half_width: float) -> Array:
        return np.sqrt(np.maximum(1 - (x / half_width) ** 2, 0.0))

    inner = stick / contact.radius * ellipse(stick)
    return np.asarray(coefficient * contact.peak * (ellipse(contact.radius) - inner))


def partial_slip_shift(
    contact: HertzContact,
    coefficient: float,
    share: float,
    shear_modulus: float,
    poissons_ratio: float,
) -> float:
    """How far a sphere moves sideways that is pressed, then sheared (Johnson, section 7.2).

    δ = 3 μ P (2 − ν)/(16 G a) (1 − (1 − Q/μP)^(2/3)), on one elastic half-space.

    Args:
        contact: Its force P and radius a.
        coefficient: μ.
        share: Q/μP, below 1.
        shear_modulus: G (stress).
        poissons_ratio: ν.
    """
    most = 3 * coefficient * contact.force * (2 - poissons_ratio)
    return float(most / (16 * shear_modulus * contact.radius) * (1 - (1 - share) ** (2 / 3)))


def flat_punch_force(modulus: float, radius: float, indentation: float) -> float:
    """Flat circular punch: F = 2 E* a d (Johnson, section 3.4; Sneddon 1965)."""
    return 2 * modulus * radius * indentation


def annular_punch_force(
    modulus: float, inner: float, outer: float, indentation: float, terms: int = 20
) -> float:
    """Flat annular punch: the integral equation of its pressure p, solved by product integration.

    Rings of Boussinesq's point forces (Johnson, sections 3.2 and 3.8) move the surface by
    w(r) = 4/(π E*) ∫ p(s) s/(r + s) K(m) ds, with the complete elliptic integral K and
    1 − m = ((r − s)/(r + s))²; under the punch w is the indentation. With s = middle + half cos t,
    p √(half² − (s − middle)²) is smooth in t, and the logarithm in
    K(m) = −(2/π) K(1 − m) ln|cos t − cos t′| + smooth is integrated exactly. The force converges
    spectrally: ten points give 14 digits where the outer radius is twice the inner.

    Args:
        modulus: E* (stress).
        inner: Inner radius (length).
        outer: Outer radius (length).
        indentation: d (length).
        terms: Chebyshev points.
    """
    middle, half = (outer + inner) / 2, (outer - inner) / 2
    angle = (np.arange(terms) + 0.5) * np.pi / terms
    cosine = np.cos(angle)
    r = middle + half * cosine
    sums = r[:, None] + r
    complement = ((r[:, None] - r) / sums) ** 2
    factor = -2 / np.pi * ellipk(complement)
    distance = np.abs(cosine[:, None] - cosine)
    np.fill_diagonal(complement, 1.0)
    np.fill_diagonal(distance, 1.0)
    smooth = ellipkm1(complement) - factor * np.log(distance)
    np.fill_diagonal(smooth, np.log(8 * r / half))  # K(m) → ln(4 / √(1 − m))
    # ∫ ln|cos t − cos s| cos ks ds over (0, π) is −π/k cos kt, and −π ln 2 for k = 0.
    orders = np.arange(1, terms)
    waves = np.cos(np.outer(angle, orders))
    logarithm = -(np.pi * np.log(2) + 2 * (waves * (np.pi / orders)) @ waves.T) / terms
    kernel = 4 / np.pi * (factor * logarithm + smooth * np.pi / terms) / sums
    pressure = np.linalg.solve(kernel, np.full(terms, indentation))  # times s √(…) / E*
    return float(2 * np.pi * modulus * pressure.sum() * np.pi / terms)


def partial_slip_loss(
    contact: HertzContact,
    coefficient: float,
    share: float,
    shear_modulus: float,
    poissons_ratio: float,
) -> float:
    """What a cycle of the shear between ±Q dissipates (Mindlin & Deresiewicz 1953).

    W = 9/10 (μP)² (2 − ν)/(G a) (1 − x^(5/3) − 5/6 q (1 + x^(2/3))), q = Q/μP and x = 1 − q: the
    area between ``partial_slip_shift`` and its way back, δ(Q) − 2 δ((Q − Q')/2), on one elastic
    half-space; two alike dissipate twice as much. The arguments are those of
    ``partial_slip_shift``.
    """
    most = 0.9 * (coefficient * contact.force) ** 2 * (2 - poissons_ratio)
    x = 1 - share
    shape = 1 - x ** (5 / 3) - 5 / 6 * share * (1 + x ** (2 / 3))
    return float(most / (shear_modulus * contact.radius) * shape)


def pressing_loss(coefficient: float, poissons_ratio: float) -> float:
    """Return the loss of pressing a paraboloid and taking it back, over the work of pressing.

    6/π (π/4 − 2/3) (1 − 2ν)/(1 − ν) μ, for so little friction that all of the contact slips and
    moves as without: ∫∫ μ p |∂u_r/∂a| 2πr dr da with Hertz's pressure p and radial displacement
    u_r (Johnson, (3.41b)), there and back, over ∫ F dd = 8/15 E* a⁵/R². With more friction
    much of the contact sticks, and less is lost; nothing if all of it does.

    Args:
        coefficient: μ, ≪ 1.
        poissons_ratio: ν.
    """
    lateral = (1 - 2 * poissons_ratio) / (1 - poissons_ratio)
    return 6 / pi * (pi / 4 - 2 / 3) * lateral * coefficient


def elliptic_pressure(contact: HertzContact, distance: Array) -> Array:
    """Hertz's pressure p₀ √(1 − r²/a²) of a point or line contact (Johnson, (3.39), (4.44)).

    Args:
        contact: Its a and p₀.
        distance: r, from the middle (length).
    """
    return np.asarray(contact.peak * np.sqrt(np.maximum(1 - (distance / contact.radius) ** 2, 0)))


def punch_pressure(contact: HertzContact, line: bool, distance: Array) -> Array:
    """Pressure of a flat punch without friction (Johnson, (2.64), (3.34)).

    Circular: P/(2 π a √(a² − r²)); a strip: P/(π √(a² − x²)). It is infinite at the edge, and 0
    outside.

    Args:
        contact: Its force P and radius or half-width a.
        line: Whether it is a strip.
        distance: r or x, from the middle (length).
    """
    a = contact.radius
    across = pi if line else 2 * pi * a
    inside = np.abs(distance) < a
    root = np.sqrt(np.where(inside, a**2 - distance**2, 1.0))
    return np.where(inside, contact.force / (across * root), 0.0)


def line_axis_stress(contact: HertzContact, depth: Array) -> tuple[Array, Array]:
    """Normal and lateral stress below the middle of a line contact (Johnson, (4.46)).

    With s = z/a, σ_z = −p₀/√(1 + s²), σ_x = −p₀ ((1 + 2 s²)/√(1 + s²) − 2 s).

    Args:
        contact: Its a and p₀.
        depth: z, below the surface (length).
    """
    s = depth / contact.radius
    root = np.sqrt(1 + s**2)
    return -contact.peak / root, -contact.peak * ((1 + 2 * s**2) / root - 2 * s)


# The worn surface begins where the body's own is reached again, which is nearer than this.
_FAR = 1.5


def force_left(stick: float) -> float:
    """Normal force over that before wear, N_∞/N₀ = (3/2) ξ (1 − ξ²/3).

    Args:
        stick: ξ, between 0 and 1.
    """
    return 1.5 * stick * (1 - stick**2 / 3)


def worn_depth(radius: Array, stick: float) -> Array:
    """Depth over d; none where it sticks, and none beyond the worn surface.

    Args:
        radius: From the axis, over a₀.
        stick: ξ, between 0 and 1.
    """
    r = np.maximum(radius, stick)
    profile = (r**2 * np.arcsin(stick / r) - stick * np.sqrt(r**2 - stick**2)) / pi
    profile += 2 / pi * np.arccos(stick / r)
    return np.maximum(profile - r**2 / 2, 0.0) * (radius > stick)


def worn_radius(stick: float) -> float:
    """Radius of the surface that is worn, a_∞/a₀.

    Args:
        stick: ξ, between 0 and 1.
    """

    def depth(r: float) -> float:
        profile = (r**2 * np.arcsin(stick / r) - stick * sqrt(r**2 - stick**2)) / pi
        return float(profile + 2 / pi * np.arccos(stick / r) - r**2 / 2)

    return float(brentq(depth, 1.0, _FAR))
