"""Whether stress has a bound at the tip of a wedge, one face of which a rigid obstacle presses.

Near the tip displacements go like r^λ, and stress like r^(λ−1): it grows without end where some λ
lies below 1 (M. L. Williams, J. Appl. Mech. 19 (1952) 526-528; with friction J. Dundurs, M. S. Lee,
J. Elasticity 2 (1972) 109-112, and E. E. Gdoutos, P. S. Theocaris, J. Appl. Mech. 42 (1975)
688-692). The other face is free.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array

# λ from which growth is too slow for any mesh to show it: 1 % from one to the next half its size.
_BOUNDED = 0.985
# Where λ is looked for beside that, and how finely.
_LEAST, _HEIGHT, _POINTS = 0.2, 1.0, 400


def is_singular(angle: float, friction: float | None, kolosov: float) -> bool:
    """Whether stress has no bound at the tip.

    Args:
        angle: Between the faces, through the wedge (radian).
        friction: Friction traction on the wedge along the pressed face, away from the tip, over the
            pressure; None where the face sticks.
        kolosov: 3 − 4ν in plane strain and beside an axis, (3 − ν)/(1 + ν) in plane stress.
    """
    return _zeros(angle, friction, kolosov) > 0


def _zeros(angle: float, friction: float | None, kolosov: float) -> int:
    """How many λ lie left of the bound: as often the determinant goes round zero about them."""
    along = np.linspace(0.0, 1.0, _POINTS, endpoint=False)
    corners = [
        complex(x, y)
        for x, y in (
            (_LEAST, -_HEIGHT),
            (_BOUNDED, -_HEIGHT),
            (_BOUNDED, _HEIGHT),
            (_LEAST, _HEIGHT),
        )
    ]
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    path = np.concatenate([begin + (end - begin) * along for begin, end in sides])
    values = np.linalg.det(_conditions(path, angle, friction, kolosov))
    turned = np.angle(np.roll(values, -1) / values)
    return round(float(turned.sum()) / (2 * np.pi))


def _conditions(powers: Array, angle: float, friction: float | None, kolosov: float) -> Array:
    """Return both faces' conditions on the four coefficients of each power, (powers, 4, 4).

    Of Airy's function r^(λ+1) F(θ) with F of cosines and sines of (λ ± 1) θ.
    """
    hoop, shear, outward, across = _fields(powers, 0.0, kolosov)
    along = outward if friction is None else shear - friction * hoop
    free_hoop, free_shear, _, _ = _fields(powers, angle, kolosov)
    return np.stack([across, along, free_hoop, free_shear], axis=1)


def _fields(powers: Array, at: float, kolosov: float) -> tuple[Array, Array, Array, Array]:
    """Hoop and shear stress and displacements along and across a ray, but for their powers of r.

    Each as rows of the four coefficients, (powers, 4).
    """
    more, less = powers + 1, powers - 1
    c, s, d, t = np.cos(more * at), np.sin(more * at), np.cos(less * at), np.sin(less * at)
    hoop = np.stack([c, s, d, t], axis=1) * more[:, None]
    shear = -np.stack([-more * s, more * c, -less * t, less * d], axis=1)
    give, turn = kolosov - powers, kolosov + powers
    outward = np.stack([-more * c, -more * s, give * d, give * t], axis=1)
    across = np.stack([more * s, -more * c, turn * t, -turn * d], axis=1)
    return hoop, shear, outward, across
