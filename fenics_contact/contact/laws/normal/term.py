"""Pressure as a term of the balance: how a solver uses the law across a contact.

The law says what its forces are; here is what a solver makes of them on its way: whether they
follow the jump, or given pressures act in their place (paper, Step 3).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import ufl

from fenics_contact.body.forms import CompiledForm
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.energies import prescribed_pressure_energy
from fenics_contact.contact.laws.force import ContactForce
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.surface.trace_function import TraceFunction


class NormalTerm(ContactForce):
    """Forces of the law across a contact, or pressures that are held in their place.

    Attributes:
        law: The law across the contact.

    Args:
        law: The law across the contact.
    """

    def __init__(self, law: NormalLaw) -> None:
        self.law, self.site = law, law.site
        self.follow_law()

    @property
    def name(self) -> str:
        """Name of the law and of its contact, for results."""
        return self.law.name

    def follow_law(self) -> None:
        """Follow the jump as the law has it."""
        self._held: Array | None = None
        self._held_force: Array | None = None

    def hold(self, pressure: Array) -> None:
        """Press with a given pressure from now on, whatever the jump.

        Args:
            pressure: At the points, (points,) (stress).
        """
        self._held, self._held_force = pressure, None

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """The law's compiled forms."""
        return self.law.forms

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent at present."""
        return self.law.tangents if self._held is None else ()

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        if self._held is None:
            return self.law.force()
        if self._held_force is None:
            function, work = self._pressures
            function.set(self._held)
            self._held_force = self.site.trace.surface.assemble(work)
        return self._held_force

    @cached_property
    def _pressures(self) -> tuple[TraceFunction, CompiledForm]:
        """Pressures at the points and −∫ p v_n, compiled when asked."""
        trace = self.site.trace
        function = trace.function(np.zeros(len(trace.weights)))
        test = ufl.TestFunction(trace.surface.space)
        work = prescribed_pressure_energy(
            test, trace.normal, function.ufl, trace.weight, trace.measure
        )
        return function, form_cache.form(-work)

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress)."""
        if self._held is None:
            return self.law.at_points()
        return -self._held[:, None] * self.site.trace.normals

    def tangent_at_points(self) -> Array:
        """Minus its derivative in the jump, (points, components, components) (stress/length)."""
        return self.law.tangent_at_points() if self._held is None else super().tangent_at_points()
