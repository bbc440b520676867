"""Where Newton's method begins a solve: at the start of all, or where the last load step ended."""

from __future__ import annotations

import logging

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.newton.initial_guess import starting_point
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.systems.system import System

logger = logging.getLogger(__name__)

# Slip over the size of a contact from which two bodies are paired anew: it moves the pressure by
# about as much.
_SLID = 1e-3


class Beginning:
    """The state that a solve begins from.

    Attributes:
        continues: Whether it is an answer of the load step before.
        paired_anew: Whether it was found anew what faces what since the last load step.

    Args:
        problem: The problem.
        system: Its unknowns.
        timings: Seconds so far.
    """

    def __init__(self, problem: Problem, system: System, timings: Timings) -> None:
        self._problem, self._system, self._timings = problem, system, timings
        self.continues = False
        self.paired_anew = False

    def anew(self) -> None:
        """Nothing has slipped, supports stand at their values, loose parts touch; collective."""
        self.continues = False
        displacement, indentations = starting_point(self._problem)
        for contact, indentation in zip(self._problem.contacts, indentations, strict=True):
            contact.kinematics.move(contact.kinematics.relative(displacement), indentation)
        self._system.begin(displacement)
        self._problem.stick_all()

    def where_it_flies(self, displacement: Array) -> None:
        """From where bodies would be if nothing acted on them; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        self.continues = True
        self._system.begin(displacement)
        self._system.follow_supports()
        self._problem.stick_all()

    def at(self, position: Array, scalars: Array) -> None:
        """Take a state, at the present loads; collective.

        Args:
            position: Displacements as ``System.position`` gives them (length).
            scalars: Values of the scalar unknowns.
        """
        self._system.begin_at(position)
        self._system.set_scalars(scalars)
        self._system.set_mean_stress()
        self._system.follow_supports()

    def from_last_step(self) -> None:
        """From the state of the last load step, supports at their new values; collective.

        What only contact holds, and nothing touches, is brought into contact as at the start; so
        are bodies that were paired anew, of which none may be touched then.
        """
        is_doubtful = self.paired_anew or self.is_out_of_touch()
        if is_doubtful and RigidMotions(self._problem).count > 0:
            self.anew()
            return
        self.continues = True
        self._system.follow_supports()
        self._problem.stick_all()

    def update_pairing(self, last: Solution) -> None:
        """Follow bodies that slid along each other in the last load step; collective.

        Args:
            last: Of the step, whose state is the present one.
        """
        slid = [c for c in self._problem.contacts if c.relative_sliding() > _SLID]
        self.paired_anew = bool(slid)
        moved = self._system.at_contacts(last.find_body) if slid else None
        for contact in slid:
            logger.debug("  '%s': finding anew what faces what", contact.label)
            contact.update_pairing(moved)
        if slid:
            self.follow_pairing()

    def follow_pairing(self) -> None:
        """Take what faces what as the contacts know it now; collective."""
        with self._timings.phase("assemble"):
            self._system.update_pairing()

    def is_out_of_touch(self) -> bool:
        """Whether nothing presses on an obstacle that a force drives, or nowhere; collective."""
        pushing = [contact for contact in self._problem.contacts if contact.is_one_sided]
        touched = [largest(self._problem.comm, contact.pressure()) > 0 for contact in pushing]
        loose = [contact.has_unknown_position for contact in pushing]
        apart = any(f and not t for f, t in zip(loose, touched, strict=True))
        return apart or (bool(pushing) and not any(touched))
