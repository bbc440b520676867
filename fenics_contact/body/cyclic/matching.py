"""Which nodes of the cut faces of a sector are each other's, once one face is turned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.scene.loading.cyclic_symmetry import CyclicSymmetry

# Of the extent of the faces: how far nodes of turned copies may be apart.
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class FaceNodes:
    """The nodes of a cut face, on every rank.

    Attributes:
        numbers: Over all ranks, (nodes,).
        places: (nodes, 3) (length).
        parts: The connected part of the body that each belongs to, (nodes,).
    """

    numbers: Integers
    places: Array
    parts: Integers


@dataclass(frozen=True, eq=False)
class NodeShares:
    """How nodes of a cut face follow from those of the other.

    Attributes:
        on: Numbers of its nodes over all ranks, (nodes,).
        against: Those of the other.
        shares: Shares of these, (nodes of on, nodes of against).
        off: How far the faces are apart beyond what facets miss of a curved one; infinite where
            one does not cover the other (length).
    """

    on: Integers
    against: Integers
    shares: csr_matrix
    off: float


# Gives the shares between faces on meshes that do not match, by the turn (3, 3) and a point of the
# axis, (3,); collective.
Mortar = Callable[[Array, Array], NodeShares]


def matched_nodes(
    given: CyclicSymmetry,
    axis: Array,
    centre: Array,
    faces: tuple[FaceNodes, FaceNodes],
    mortar: Mortar,
) -> tuple[Array, NodeShares]:
    """The turn that takes ``against`` to ``on``, and how nodes follow; collective.

    Args:
        given: What the scene says.
        axis: Unit vector, (3,).
        centre: A point of the axis, (3,) (length).
        faces: The nodes of ``on`` and ``against``.
        mortar: Finds shares where no node is another's.

    Returns:
        R, (3, 3), and the shares.

    Raises:
        InputError: No turn by 2π/sectors takes one face to the other.
    """
    on, against = (face.places for face in faces)
    extent = float(np.linalg.norm(np.ptp(np.concatenate([on, against]), axis=0)))
    tries = []
    for sign in (1.0, -1.0):
        turn = turned(axis, sign * 2 * np.pi / given.sectors)
        moved = centre + (against - centre) @ turn.T
        tries.append((*_nearest((on, faces[0].parts), (moved, faces[1].parts), extent), turn))
    apart, pairs, turn = min(tries, key=lambda one: one[0])
    if apart <= _SAME * extent and len(np.unique(pairs)) == len(on) == len(against):
        places = np.arange(len(on)), pairs
        ones = coo_matrix((np.ones(len(on)), places), shape=(len(on), len(on)))
        return turn, NodeShares(faces[0].numbers, faces[1].numbers, csr_matrix(ones), apart)
    found = mortar(turn, centre)
    if found.off > _SAME * extent:
        off = found.off if np.isfinite(found.off) else apart
        raise InputError(
            f"cyclic_symmetry.against = '{given.against}': turned by {given.angle:.6g} degrees, it "
            f"is up to {off:.3g} away from '{given.on}', which stands "
            f"{_apart(axis, centre, on, against):.6g} degrees from it; the two cut faces must be "
            "turned copies of each other"
        )
    return turn, found


# Places, (nodes, 3), and the connected part of each node, (nodes,).
_Nodes = tuple[Array, Integers]


def _nearest(one: _Nodes, other: _Nodes, extent: float) -> tuple[float, Integers]:
    """The nearest node of another set to each of one, in the same part of the body if there is.

    Bodies that touch have nodes at the same place. A body that the cut parts twice goes on in
    another part than it ends in.

    Args:
        one: Nodes.
        other: Those to look among.
        extent: Of both (length).

    Returns:
        How far a node of either set is from the other at most (length), and places in the other.
    """
    from scipy.spatial import cKDTree  # takes long to load, and few scenes need it

    found, farthest = np.zeros(len(one[0]), dtype=np.int64), 0.0
    for part in np.unique(one[1]):
        mine = np.flatnonzero(one[1] == part)
        tries = []
        for beyond in parts_in_order(part, other[1]):
            theirs = np.flatnonzero(other[1] == beyond)
            away, nearest = cKDTree(other[0][theirs]).query(one[0][mine])
            back, _ = cKDTree(one[0][mine]).query(other[0][theirs])
            tries.append((max(float(away.max()), float(back.max())), theirs[nearest]))
            if tries[-1][0] <= _SAME * extent:
                break
        apart, found[mine] = min(tries, key=lambda each: each[0])
        farthest = max(farthest, apart)
    return farthest, found


def parts_in_order(part: int, others: Integers) -> list[int]:
    """The parts of the body in which a part may go on beyond the cut, itself first.

    Args:
        part: Number of a part.
        others: Those that end in the other face, each any number of times.
    """
    return sorted(np.unique(others).tolist(), key=lambda other: (other != part, other))


def turned(axis: Array, angle: float) -> Array:
    """Rotation about an axis, (3, 3) (O. Rodrigues).

    Args:
        axis: Unit vector, (3,).
        angle: Counterclockwise about it (radian).
    """
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def _apart(axis: Array, centre: Array, on: Array, against: Array) -> float:
    """Angle between the centroids of two sets of points about an axis (degrees)."""
    arms = [places.mean(axis=0) - centre for places in (on, against)]
    one, other = (arm - (arm @ axis) * axis for arm in arms)
    return float(np.degrees(abs(np.arctan2(axis @ np.cross(one, other), one @ other))))
