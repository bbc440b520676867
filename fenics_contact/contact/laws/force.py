"""Forces at a contact that depend on the displacement jump, and their tangents, for solvers."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import CompiledForm
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.contact.surface.averaging import SurfaceAverage


class ContactForce:
    """Forces at a contact that follow the jump; this one is 0, and others say what they are.

    Attributes:
        follows_jump: Whether there are any, so that it has forms.
        site: Where they act.
    """

    follows_jump: ClassVar[bool] = False
    site: LawSite

    @property
    def forms(self) -> tuple[CompiledForm, ...]:
        """Compiled forms of the forces that follow the jump; none where nothing does.

        They are compiled when they are first asked for.
        """
        return ()

    @property
    def tangents(self) -> tuple[CompiledForm, ...]:
        """Forms of the tangent at present."""
        return ()

    def force(self) -> Array:
        """Forces on the body at all nodes of the surface, (nodes, components); collective."""
        trace = self.site.trace
        return np.zeros((len(trace.all_nodes), trace.surface.components))

    def at_points(self) -> Array:
        """Traction on the body at the points, (points, components) (stress).

        Of the same energy as ``force``: on nodal points, what that gives over their areas.
        """
        return np.zeros_like(self.site.trace.normals)

    def tangent_at_points(self) -> Array:
        """Minus its derivative in the jump, as the forms of ``tangents`` have it.

        Shape (points, components, components) (stress/length).
        """
        normals = self.site.trace.normals
        return np.zeros((*normals.shape, normals.shape[1]))

    @property
    def neighbours(self) -> SurfaceAverage | None:
        """Average over neighbouring points by which forces depend on their jumps, too; or None."""
        return None

    def tangent_between_points(self) -> Array:
        """Minus the derivative of its traction in the jump at other points; collective.

        Of each pair of ``neighbours``, beside ``tangent_at_points``, (pairs, components,
        components) (stress/length).
        """
        size = self.site.trace.normals.shape[1]
        return np.zeros((0, size, size))
