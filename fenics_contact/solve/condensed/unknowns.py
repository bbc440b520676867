"""The unknowns of the condensed problem: jumps where bodies touch, else displacements.

Where a slave surface faces a master, its displacement is u = w + P u' with the jump w. With w as
the unknown a contact of two bodies has its tangent where that of a rigid obstacle has it, at the
points that touch, and couples no two dofs more; the bulk's part takes P once. P itself is applied
and never written out.

A dof of a slave that supports hold has no unknown for its jump, nor has one of two contacts that
share it, but for the first. Such jumps are *derived*: z = R y, one row of R each. R is full, so
its rows are never multiplied out into the tangent (``ContactTangent``), and only rank 0, which has
the tangent, writes them out at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.mortar.projection import NodalProjection, Projection
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix


@dataclass(frozen=True, eq=False)
class _Block:
    """A part of P between free dofs: displacements that a slave's are measured from.

    Attributes:
        rows: Dofs of the slave's surface, by their numbers there.
        slaves: Their numbers among the unknowns.
        masters: Likewise.
        projection: P, (slaves, masters).
    """

    rows: Integers
    slaves: Integers
    masters: Integers
    projection: NodalProjection

    def add_to_masters(self, stiffness: Array, factor: float) -> None:
        """Bᵀ S B of a symmetric S, B = 1 with a multiple of P from masters to slaves; in place."""
        rows = stiffness[self.slaves]
        columns = np.flatnonzero(rows.any(axis=0))  # those of other bodies have none
        # Written out: a product is far less than as many solves with the mass of the slave.
        written = factor * self.projection.written_rows(np.arange(len(self.slaves)))
        taken = written.T @ rows[:, columns]
        corner = (written.T @ rows[:, self.slaves]) @ written
        stiffness[np.ix_(self.masters, columns)] += taken
        stiffness[np.ix_(columns, self.masters)] += taken.T
        stiffness[np.ix_(self.masters, self.masters)] += corner

    def of_rows(self, chosen: Flags) -> _Block:
        """The jump at some dofs of the slave's surface, (dofs,)."""
        kept = chosen[self.rows]
        every = np.arange(len(self.masters))
        projection = self.projection.restricted(np.flatnonzero(kept), every)
        return _Block(self.rows[kept], self.slaves[kept], self.masters, projection)


class ContactVariables:
    """u = T y of the free contact dofs; T is 1 but for the rows whose unknown is a jump.

    A master's dof may be another contact's slave: T is then a product, in an order in which the
    displacements that a jump is measured from come first.

    Args:
        dofs: The contact dofs.
        surfaces: Of the contacts that exert forces.

    Attributes:
        count: Number of unknowns.
        derived_count: Number of jumps that are no unknowns.
        is_as_meshed: Whether all bodies are paired as meshed.
    """

    def __init__(self, dofs: ContactDofs, surfaces: Sequence[SurfaceMatrix]) -> None:
        self._dofs = dofs
        self.count = len(dofs.free)
        self._unknown_of = np.cumsum(dofs.is_free) - 1
        self._expansion = dofs.expansion()
        self._follows = np.zeros(len(dofs.numbers), dtype=bool)
        if dofs.follow is not None:
            self._follows[dofs.follow.rows] = True
        self._places = {surface: dofs.places(surface.dofs) for surface in surfaces}
        pairings = {
            surface: pairing
            for surface in surfaces
            if (pairing := surface.contact.kinematics.pairing) is not None
        }
        self.is_as_meshed = all(pairing.is_as_meshed for pairing in pairings.values())
        self._projections = {one: found.whole_projection() for one, found in pairings.items()}
        self._near = {one: dofs.near(one.contact.sides) for one in pairings}
        self._faced = {one: self._that_face(one, found) for one, found in pairings.items()}
        self._blocks = {surface: self._blocks_of(surface) for surface in surfaces}
        jumps = self._choose_jumps(surfaces)
        self._transform = [
            block.of_rows(jumps[surface])
            for surface in _dependencies_first(self._before(jumps))
            for block in self._blocks[surface]
        ]
        is_jump = np.zeros(self.count, dtype=bool)
        for block in self._transform:
            is_jump[block.slaves] = True
        self._units: dict[SurfaceMatrix, tuple[Integers, Integers]] = {}
        self._first_derived: dict[SurfaceMatrix, tuple[Integers, int]] = {}
        self.derived_count = 0
        for surface in surfaces:
            unit, others = self._rows(surface, jumps[surface], is_jump)
            self._units[surface] = unit, self._unknown_of[self._places[surface][unit]]
            self._first_derived[surface] = others, self.derived_count
            self.derived_count += len(others)

    @property
    def projections(self) -> list[Projection]:
        """Projections by which jumps are measured, contact by contact; the same objects."""
        return list(self._projections.values())

    @property
    def glue(self) -> list[tuple[Integers, Integers, NodalProjection]]:
        """Unknowns that are jumps, the ones that these are measured from, and P between them."""
        return [(block.slaves, block.masters, block.projection) for block in self._transform]

    @property
    def acted_on(self) -> Flags:
        """Unknowns that are the jump of a contact, of two bodies or not, (unknowns,)."""
        found = np.zeros(self.count, dtype=bool)
        for _, unknowns in self._units.values():
            found[unknowns] = True
        return found

    @property
    def has_jumps(self) -> bool:
        """Whether any unknown is the jump of two bodies."""
        return bool(self._transform)

    def _that_face(self, surface: SurfaceMatrix, pairing: Pairing) -> Flags:
        """Nodes of a slave that face the master and take part, (nodes,); collective."""
        near, faced = self._near[surface], pairing.whole_faced()
        return faced if near is None else faced & near.slaves

    def _blocks_of(self, surface: SurfaceMatrix) -> list[_Block]:
        """P of a contact by components, where it has entries; held slaves have no unknowns."""
        pairing = surface.contact.kinematics.pairing
        if pairing is None:
            return []
        near, free = self._near[surface], self._dofs.is_free
        parts = self._projections[surface].blocks()
        size = self._projections[surface].size
        slave, master = self._places[surface], self._dofs.places(pairing.dofs)
        found = []
        for every, columns_of, projection in parts:
            others = master[columns_of]
            moves = projection.nonzero_columns() & (
                near is None or near.masters[columns_of // size]
            )
            columns = np.flatnonzero((free | self._follows)[others] & moves)
            kept = projection.restricted(np.arange(projection.shape[0]), columns)
            masters = self._unknown_of[others[columns]]
            if self._follows[others[columns]].any():
                expansion = self._expansion[others[columns]]
                masters = np.unique(expansion.indices).astype(np.int64)
                kept = kept.times(expansion[:, masters])
            nodes = np.flatnonzero(
                kept.nonzero_rows() & (near is None or near.slaves[every // size])
            )
            rows = every[nodes]
            slaves = np.where(free[slave[rows]], self._unknown_of[slave[rows]], -1)
            kept = kept.restricted(nodes, np.arange(len(masters)))
            found.append(_Block(rows, slaves, masters, kept))
        return found

    def _has_jump(self, surface: SurfaceMatrix) -> Flags:
        """Return which dofs of a surface have a jump: against another body those that face it."""
        if surface not in self._projections:
            return np.ones(len(surface.dofs), dtype=bool)
        return np.repeat(self._faced[surface], self._projections[surface].size)

    def _choose_jumps(self, surfaces: Sequence[SurfaceMatrix]) -> dict[SurfaceMatrix, Flags]:
        """Choose which dofs of every surface have the jump as their unknown.

        Free slaves that face a master and that no contact before has claimed, unless what the jump
        is measured from followed from the jump itself.
        """
        chosen: dict[SurfaceMatrix, Flags] = {}
        claimed = np.zeros(self.count, dtype=bool)
        for surface in surfaces:
            chosen[surface] = np.zeros(len(surface.dofs), dtype=bool)
            if not self._blocks[surface]:
                continue
            barred = claimed.copy()
            for other in self._all_before(surface, chosen):
                barred[self._masters(other)] = True
            places = self._places[surface]
            rows = np.concatenate([block.rows for block in self._blocks[surface]])
            rows = rows[self._dofs.is_free[places[rows]]]
            chosen[surface][rows] = ~barred[self._unknown_of[places[rows]]]
            claimed[self._unknown_of[places[chosen[surface]]]] = True
        return chosen

    def _masters(self, surface: SurfaceMatrix) -> Integers:
        """The unknowns that jumps of a contact are measured from."""
        none = np.zeros(0, dtype=np.int64)
        return np.concatenate([none, *(block.masters for block in self._blocks[surface])])

    def _before(
        self, jumps: dict[SurfaceMatrix, Flags]
    ) -> dict[SurfaceMatrix, list[SurfaceMatrix]]:
        """Contacts on whose slaves' displacements the jumps of each contact depend."""
        slaves = {
            surface: self._unknown_of[self._places[surface][chosen]]
            for surface, chosen in jumps.items()
        }
        return {
            surface: [
                other
                for other, found in slaves.items()
                if other is not surface and np.isin(found, self._masters(surface)).any()
            ]
            for surface in jumps
        }

    def _all_before(
        self, surface: SurfaceMatrix, jumps: dict[SurfaceMatrix, Flags]
    ) -> list[SurfaceMatrix]:
        """A contact and all that its jumps follow from, if ``jumps`` are chosen so far."""
        before, found = self._before(jumps), [surface]
        for one in found:  # grows meanwhile
            found += [other for other in before[one] if other not in found]
        return found

    def _rows(
        self, surface: SurfaceMatrix, jumps: Flags, is_jump: Flags
    ) -> tuple[Integers, Integers]:
        """Dofs of a surface whose jump is an unknown; and those whose jump is derived.

        Those without a jump, and those that are held and measured from nothing that moves, are
        neither.
        """
        places = self._places[surface]
        free = self._dofs.is_free[places] & self._has_jump(surface)
        measured = np.zeros(len(places), dtype=bool)  # from displacements that are free
        follows = self._follows[places] & self._has_jump(surface)
        measured[follows] = np.diff(self._expansion[places[follows]].indptr) > 0
        for block in self._blocks[surface]:
            measured[block.rows] = True
        unknown = np.where(free, self._unknown_of[places], 0)
        own = free & ~measured & ~is_jump[unknown] if self.count else free
        unit = jumps | own
        return np.flatnonzero(unit), np.flatnonzero(~unit & (free | measured))

    def _relative(self, surface: SurfaceMatrix, rows: Integers) -> Array:
        """U − P u' of some dofs of a surface over the free contact dofs, (rows, dofs)."""
        found = np.asarray(self._expansion[self._places[surface][rows]].toarray())
        for block in self._blocks[surface]:
            mine, of_block = np.isin(rows, block.rows), np.isin(block.rows, rows)
            chosen = np.flatnonzero(of_block)
            found[np.ix_(mine, block.masters)] -= block.projection.written_rows(chosen)
        return found

    def _transformed(self, rows: Array) -> Array:
        """X T of rows over displacements, (rows, unknowns); in place."""
        for block in reversed(self._transform):
            rows[:, block.masters] += block.projection.transposed(rows[:, block.slaves].T).T
        return rows

    def stiffness(self, schur: Array) -> Array:
        """Tᵀ S T of a symmetric S, in place."""
        for block in reversed(self._transform):
            block.add_to_masters(schur, 1.0)
        return schur

    def nodal_stiffness(self, stiffness: Array) -> Array:
        """S of a symmetric Tᵀ S T, in place."""
        for block in self._transform:
            block.add_to_masters(stiffness, -1.0)
        return stiffness

    def forces(self, forces: Array) -> Array:
        """Product Tᵀ f."""
        return np.asarray(self._transformed(forces.copy()[None])[0])

    def nodal_forces(self, forces: Array) -> Array:
        """T⁻ᵀ f: forces on the displacements, of those on the unknowns."""
        found = forces.copy()
        for block in self._transform:
            found[block.masters] -= block.projection.transposed(found[block.slaves])
        return found

    def displacements(self, unknowns: Array) -> Array:
        """Product T y."""
        found = unknowns.copy()
        for block in self._transform:
            found[block.slaves] += block.projection.apply(found[block.masters])
        return found

    def unknowns(self, displacements: Array) -> Array:
        """Solution T⁻¹ u."""
        found = displacements.copy()
        for block in self._transform:
            found[block.slaves] -= block.projection.apply(displacements[block.masters])
        return found

    @cached_property
    def derived(self) -> Array:
        """R written out, (derived jumps, unknowns): for rank 0, the others apply it."""
        rows = [np.zeros((0, self.count))]
        for surface, (others, _) in self._first_derived.items():
            rows.append(self._transformed(self._relative(surface, others)))
        return np.concatenate(rows)

    def derived_jumps(self, unknowns: Array) -> Array:
        """Product R y."""
        if not self.derived_count:
            return np.zeros(0)
        free = self.displacements(unknowns)
        moved = self._expansion @ free
        found = []
        for surface, (others, _) in self._first_derived.items():
            jump = moved[self._places[surface]]
            for block in self._blocks[surface]:
                jump[block.rows] -= block.projection.apply(free[block.masters])
            found.append(jump[others])
        return np.concatenate(found)

    def own_unknowns(self, surface: SurfaceMatrix) -> tuple[Integers, Integers]:
        """Dofs of a surface that have a jump, and its number among (y, z)."""
        unit, unknown = self._units[surface]
        others, first = self._first_derived[surface]
        rows = np.concatenate([unit, others])
        return rows, np.concatenate([unknown, self.count + first + np.arange(len(others))])

    def held_part(self, surface: SurfaceMatrix, held: Array) -> Array:
        """The part of jumps that held displacements make, given at all contact dofs."""
        found = held[self._places[surface]].copy()
        pairing = surface.contact.kinematics.pairing
        if pairing is not None:
            opposite = held[self._dofs.places(pairing.dofs)]
            projection = self._projections[surface]
            opposite = opposite.reshape(-1, projection.size)
            found -= projection.apply(opposite).reshape(-1)
            found[~self._has_jump(surface)] = 0.0
        return found


def _dependencies_first(
    before: dict[SurfaceMatrix, list[SurfaceMatrix]],
) -> list[SurfaceMatrix]:
    """The contacts in an order in which those that others follow from come first."""
    order: list[SurfaceMatrix] = []
    while len(order) < len(before):
        order += [
            one for one in before if one not in order and all(b in order for b in before[one])
        ]
    return order
