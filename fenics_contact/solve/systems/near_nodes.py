"""The nodes of two facing surfaces that can come to touch; the others are no contact dofs.

What is condensed costs the cube of the contact dofs. Of a clamp on a shaft most of them are on a
bolt's shank in a wide hole, which touches nothing, and on the part of the shaft that no clamp
covers. Such nodes stay free. Whether a point there has closed is asked of each answer; where one
has, it is solved again with more nodes. So what is left out changes the cost and not the answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.problem.problem import Problem

# Contact dofs up to which all of them together cost little.
_FEW = 2500
# Of the shortest edge of the facets: a gap that strains of a thousandth may close.
_CLOSE = 0.1
# Of the gap at the start: a point with less of it left may close soon.
_LEFT = 0.5


@dataclass(frozen=True, eq=False)
class NearNodes:
    """Nodes of a slave that can come to touch, and those of the master that these may face.

    Attributes:
        slaves: Of the whole surface, on every rank, (nodes,).
        masters: Likewise.
    """

    slaves: Flags
    masters: Flags

    @property
    def is_empty(self) -> bool:
        """Whether no node can touch."""
        return not self.slaves.any()

    def joined(self, other: NearNodes) -> NearNodes:
        """The nodes of either."""
        return NearNodes(self.slaves | other.slaves, self.masters | other.masters)

    def has(self, other: NearNodes) -> bool:
        """Whether the nodes of another are among these."""
        return not ((other.slaves & ~self.slaves).any() or (other.masters & ~self.masters).any())

    def of_all(self) -> NearNodes:
        """All nodes of both surfaces."""
        return NearNodes(np.ones_like(self.slaves), np.ones_like(self.masters))


def near_nodes(problem: Problem) -> list[NearNodes | None]:
    """Nodes of each contact that exerts forces, in scene order; None for all; collective.

    Args:
        problem: At any time; its bodies as they are paired at present.
    """
    acting = [contact for contact in problem.contacts if contact.forces.terms]
    count = sum(len(surface.dofs) for contact in acting for surface in contact.sides.surfaces)
    if count <= _FEW or problem.inertia.moves:
        return [None] * len(acting)
    moved = largest(problem.comm, np.abs(problem.prescribed))
    moved += sum(one.brings for one in problem.body_scalars)
    return [_drawn_near(contact, moved) if _may_open(contact) else None for contact in acting]


def _may_open(contact: ContactSurface) -> bool:
    """Whether it is between two bodies that may leave each other."""
    return contact.sides.pairing is not None and contact.is_one_sided


def _drawn_near(contact: ContactSurface, moved: float) -> NearNodes:
    """Nodes that are close as drawn, or that supports may bring there; collective."""
    return nodes_of(contact, contact.kinematics.gap <= _reach(contact) + 2 * moved)


def _reach(contact: ContactSurface) -> float:
    """Gap that deformation may close (length); collective."""
    return _CLOSE * contact.facet_size


def coming_near(contact: ContactSurface, displacement: Array) -> NearNodes:
    """Nodes that are close at a displacement; collective.

    Args:
        contact: Between two bodies.
        displacement: At the body's nodes of this rank, (nodes, components) (length).
    """
    return nodes_of(contact, _gap_at(contact, displacement) <= _reach(contact))


def touching_at(contact: ContactSurface, displacement: Array) -> NearNodes:
    """Nodes that overlap at a displacement; collective.

    Args:
        contact: As of ``coming_near``.
        displacement: Likewise.
    """
    return nodes_of(contact, _gap_at(contact, displacement) < 0)


def _gap_at(contact: ContactSurface, displacement: Array) -> Array:
    """At the points, of the bodies displaced (length); collective."""
    kinematics = contact.kinematics
    moved = contact.trace.at_points(kinematics.relative(displacement))
    return np.asarray(kinematics.gap - kinematics.normal(moved))


def facing_near(contact: ContactSurface, near: NearNodes) -> NearNodes:
    """Masters that slaves of ``near`` face as bodies are paired at present; collective."""
    pairing = contact.sides.pairing
    assert pairing is not None
    return NearNodes(near.slaves, pairing.coupled_masters() & near.slaves.any())


def closed_near(contact: ContactSurface, near: NearNodes) -> NearNodes | None:
    """Further nodes, where a point that none of ``near`` moves has closed; collective.

    All facets join that have lost most of their gap, so that this is not asked again and again.

    Args:
        contact: In a state found without these points.
        near: Its contact dofs were those of these nodes.
    """
    gap, present = contact.kinematics.gap, _present_gap(contact)
    closed = (points_left_out(contact, near) & (present < 0)).any()
    if not contact.spaces.comm.allreduce(int(closed)):
        return None
    finite = np.isfinite(gap)
    return nodes_of(contact, finite & (present <= _LEFT * np.where(finite, gap, 0.0)))


def _present_gap(contact: ContactSurface) -> Array:
    """At the points, with the present jump (length)."""
    kinematics = contact.kinematics
    return np.asarray(kinematics.gap - kinematics.normal(kinematics.jump_at_points()))


def points_left_out(contact: ContactSurface, near: NearNodes) -> Flags:
    """Points of this rank that some node moves which is not among the contact dofs, (points,)."""
    trace, surface = contact.trace, contact.trace.surface
    absent = ~near.slaves[surface.numbers]
    centres = np.zeros(0, bool) if trace.nodal else absent[surface.facet_nodes].any(axis=1)
    return np.concatenate([absent[trace.numbers], centres])


def nodes_of(contact: ContactSurface, points: Flags) -> NearNodes:
    """The nodes of all facets with some of the points, and what they may face; collective.

    Args:
        contact: Between two bodies.
        points: Of its points on this rank.
    """
    trace, surface = contact.trace, contact.trace.surface
    at_node = np.zeros(len(surface.coordinates), dtype=bool)
    at_node[trace.numbers] = points[: len(trace.numbers)]
    facets = at_node[surface.facet_nodes].any(axis=1)
    if not trace.nodal:
        facets |= points[len(trace.numbers) :]
    nodes = np.zeros((len(surface.coordinates), 1))
    nodes[surface.facet_nodes[facets]] = 1.0
    slaves = surface.gathered(surface.summed(nodes)[:, 0] > 0)
    pairing = contact.sides.pairing
    assert pairing is not None
    return NearNodes(slaves, _faced(pairing) & slaves.any())


def _faced(pairing: Pairing) -> Flags:
    """Nodes of the master that any slave faces, and of the facets around these; collective.

    The projection couples each slave to all of them. The facets around spare another
    factorisation where the bodies slide a little.
    """
    coupled = pairing.coupled_masters()
    facets = pairing.master_as_meshed.nodes
    found = coupled.copy()
    found[facets[coupled[facets].any(axis=1)]] = True
    return found
