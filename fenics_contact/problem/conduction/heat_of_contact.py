"""Heat across a contact between two bodies, by a conductance that may grow with the pressure.

It flows with the step of temperature from one body to the other. The temperature opposite is
projected onto the slave's surface by the mortar integrals, as displacements are: it is an unknown
of its own at the slave's nodes, held by D τ = M T.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import SuperLU, splu

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, of_every_rank, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.kinematics import ContactKinematics
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.problem.conduction.heat_of_bodies import HeatOfBodies
from fenics_contact.scene.loading.heat import Conductance


@dataclass(frozen=True, eq=False)
class PairedHeat:
    """What of a pair of surfaces takes part in conduction, the same on every rank.

    Attributes:
        slave: Numbers among all nodes of the slave's nodes that face the master.
        master: Those of all nodes of the master.
        mass: D between these slave's nodes (area).
        coupling: M, (these slave's nodes, master's nodes) (area).
        points: From these slave's nodes to points of all ranks, (points, slave's nodes).
        active: Which nodes of the whole slave these are, (all nodes of the slave,).
    """

    slave: Integers
    master: Integers
    mass: csr_matrix
    coupling: csr_matrix
    points: csr_matrix
    active: Flags

    @cached_property
    def _factor(self) -> SuperLU:
        return splu(csc_matrix(self.mass))

    def opposite(self, rise: Array) -> Array:
        """What the slave's nodes face: D⁻¹ M T.

        Args:
            rise: T of all nodes (temperature).
        """
        if not len(self.slave):
            return np.zeros(0)
        return np.asarray(self._factor.solve(self.coupling @ rise[self.master]))

    @cached_property
    def opposites(self) -> Array:
        """D⁻¹ M, dense (these slave's nodes, master's nodes)."""
        if not len(self.slave):
            return np.zeros(self.coupling.shape)
        return np.asarray(self._factor.solve(self.coupling.toarray()))

    def onto_master(self, flows: Array) -> Array:
        """Mᵀ D⁻ᵀ q, at the master's nodes.

        Args:
            flows: At the slave's nodes (power).
        """
        if not len(self.slave):
            return np.zeros(len(self.master))
        return np.asarray(self.coupling.T @ self._factor.solve(flows, "T"))


class HeatOfContact:
    """Conduction across a contact; collective.

    Attributes:
        contact: The contact.
        faces: Which points of this rank face the other body, so that heat may cross there.

    Args:
        contact: Between two bodies, with a conductance.
        bodies: Conduction in these.
    """

    def __init__(self, contact: ContactSurface, bodies: HeatOfBodies) -> None:
        self.contact, self._bodies = contact, bodies
        assert contact.sides.pairing is not None
        self._pairing: Pairing = contact.sides.pairing
        self._paired_at: Array | None = None
        self._found: PairedHeat | None = None
        self.faces: Flags = np.zeros(0, dtype=bool)

    @cached_property
    def nodes(self) -> Integers:
        """Nodes of both surfaces, over all ranks; collective when first asked for."""
        numbers, sides = self._bodies.numbers, (self.contact.trace.surface, self._pairing.master)
        return np.concatenate([one.gathered(numbers[one.body_nodes]) for one in sides])

    @property
    def paired(self) -> PairedHeat:
        """Both surfaces as they face each other at present; collective where that has changed."""
        kinematics: ContactKinematics = self.contact.kinematics
        if self._found is None or kinematics.paired_at is not self._paired_at:
            self._paired_at = kinematics.paired_at
            self._found = self._find()
        return self._found

    def _find(self) -> PairedHeat:
        trace, pairing = self.contact.trace, self._pairing
        comm, surface, numbers = trace.spaces.comm, trace.surface, self._bodies.numbers
        integrals = pairing.whole_integrals()
        faced = pairing.whole_faced() & (integrals.mass.diagonal() > 0)
        active = np.flatnonzero(faced)
        slave = surface.gathered(numbers[surface.body_nodes])[active]
        master = pairing.master.gathered(numbers[pairing.master.body_nodes])
        place = np.full(len(faced), -1)
        place[active] = np.arange(len(active))
        rows, columns, shares = trace.point_rows
        columns = place[surface.numbers[columns]]
        known = np.ones(len(trace.weights), dtype=bool)
        np.logical_and.at(known, rows, columns >= 0)
        self.faces = self.contact.kinematics.reached & known
        own = self._own
        chosen = own[rows]
        first = sum(of_every_rank(comm, int(own.sum()))[: comm.rank])
        of_all = first + np.cumsum(own) - 1
        entries = np.column_stack([of_all[rows[chosen]], columns[chosen], shares[chosen]])
        row, column, share = gather_rows(comm, entries).T
        count = int(total(comm, int(own.sum())))
        places = row.astype(np.int64), column.astype(np.int64)
        return PairedHeat(
            slave=slave,
            master=master,
            mass=csr_matrix(integrals.mass[active][:, active]),
            coupling=csr_matrix(integrals.coupling[active]),
            points=csr_matrix((share, places), shape=(count, len(active))),
            active=faced,
        )

    @property
    def _own(self) -> Flags:
        """Points that face the other body, and that this rank owns."""
        return np.asarray(self.contact.trace.owned & self.faces)

    @property
    def grows(self) -> bool:
        """Whether it conducts the better, the more it is pressed."""
        given = self.contact.contact.conductance
        return isinstance(given, Conductance) and max(given.values) > given.values[0]

    @property
    def varies(self) -> bool:
        """Whether the conductance depends on the pressure, and not only on touching."""
        given = self.contact.contact.conductance
        return isinstance(given, Conductance) and max(given.values) > min(given.values)

    @property
    def highest(self) -> float:
        """Highest conductance of the contact at any pressure (power/area/temperature)."""
        given = self.contact.contact.conductance
        return max(given.values) if isinstance(given, Conductance) else float(given or 0.0)

    @property
    def highest_pressure(self) -> float:
        """The highest pressure of which its conductance says anything; 0 of a number (stress)."""
        given = self.contact.contact.conductance
        return given.pressures[-1] if isinstance(given, Conductance) else 0.0

    def conductances(self, pressure: Array) -> Array:
        """Conductance at the points of this rank by the contact pressure, 0 where none crosses.

        Args:
            pressure: At the points (stress).
        """
        given = self.contact.contact.conductance
        if given is None:
            return np.zeros(len(pressure))
        if isinstance(given, float | int):
            touches = np.ones(len(pressure)) if not self.contact.is_one_sided else pressure > 0
            return np.asarray(float(given) * touches)
        return given.at(pressure)

    def conductance_slopes(self, pressure: Array) -> Array:
        """Slope of the conductance over the pressure at the points of this rank.

        Args:
            pressure: At the points (stress).
        """
        given = self.contact.contact.conductance
        found = given.slope_at(pressure) if isinstance(given, Conductance) else 0.0 * pressure
        return np.asarray(found)

    def weighted(self, conductance: Array) -> Array:
        """Conductance times area at the points of all ranks, in their order; collective."""
        own = (conductance * self.contact.trace.weights)[self._own]
        return gather_rows(self.contact.trace.spaces.comm, own)
