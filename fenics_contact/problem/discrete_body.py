"""A body made ready for any conditions: what laws, obstacles, loads and values do not change.

The paper's K is here, and the dofs and surfaces that Γ_D and Γ_C stand for, but no energy of
contact, no load and no displacement that is prescribed: these are the problem's.
"""

from __future__ import annotations

import numpy as np
from dolfinx import fem

from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.held_dofs import HeldDofs
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Integers
from fenics_contact.common.errors import InputError
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene


class DiscreteBody:
    """Spaces, stiffness, held dofs and candidate contact surfaces of a body; collective.

    Several problems may be solved on one, each in its turn: the displacement, the mean stress and
    what faces what are those of the last.

    Attributes:
        description: What of a scene it is made from, besides the mesh.
        spaces: Of the displacement.
        displacement: The unknown, a dolfinx function.
        held: Dofs that supports and symmetry hold.
        outer: Those of the outer boundary of a half-space, sorted.
        constrained: Both, sorted (local indices, owned and ghost).
        elastic: ½ a(·, ·): law, compiled forms, stress.
        sides: The surfaces of each contact, in scene order.

    Raises:
        InputError: Its groups or materials do not fit the mesh, or overlap.
    """

    def __init__(self, description: BodyDescription, body: Body) -> None:
        self.description = description
        self.spaces = Spaces(description, body)
        self.displacement = fem.Function(self.spaces.displacement_space, name="displacement")
        self.held = HeldDofs(description, self.spaces)
        self._refuse_overlaps()
        masters = self._surfaces_of_several()
        self.outer = self._outer_dofs()
        self.constrained = np.union1d(self.held.dofs, self.outer)
        self.elastic = ElasticBody(description, self.spaces, self.displacement)
        self.sides = [
            ContactSides(
                contact,
                f"contact[{number}]",
                self.spaces,
                self.held.flat_sides,
                self.constrained,
                masters,
            )
            for number, contact in enumerate(description.contacts)
        ]

    def require_fit(self, scene: Scene) -> None:
        """Refuse a scene of another body.

        Raises:
            InputError: It has other materials, supports or contact surfaces.
        """
        differences = self.description.differences(BodyDescription.of(scene))
        if differences:
            raise InputError(
                "the scene is of another body than the one that was made ready: other "
                + ", ".join(differences)
            )

    def _outer_dofs(self) -> Integers:
        """All dofs of the outer boundary of a half-space (local indices, owned and ghost)."""
        spaces = self.spaces
        found = [np.zeros(0, dtype=np.int64)]
        for number, on in enumerate(self.description.outer):
            group = spaces.body.boundary(on, f"half_space.on[{number}]")
            found.append(spaces.nodes(group).astype(np.int64))
        nodes = np.unique(np.concatenate(found))
        return (nodes[:, None] * spaces.components + np.arange(spaces.components)).ravel()

    def _surfaces_of_several(self) -> list[str]:
        """Names of groups that several contacts act on, or that share facets with such."""
        sides = [
            (number, name)
            for number, contact in enumerate(self.description.contacts)
            for name in (contact.on, contact.against)
            if name is not None
        ]
        body = self.spaces.body
        tags = {name: set(found.tags) for _, name in sides if (found := body.find(name))}
        return [
            name
            for number, name in sides
            for other, its_name in sides
            if number != other and tags.get(name, set()) & tags.get(its_name, set())
        ]

    def _refuse_overlaps(self) -> None:
        """Contacts may not share facets with supports, nor two with obstacles (Γ_C ∩ Γ_D = ∅)."""
        taken: dict[int, str] = {}
        description = self.description
        held = [(f"support[{i}].on", each.on) for i, each in enumerate(description.held)]
        held += [(f"half_space.on[{i}]", on) for i, on in enumerate(description.outer)]
        held += [(f"symmetry[{i}]", on) for i, on in enumerate(description.symmetry)]
        for key, on in held:
            group = self.spaces.body.group(on, key)
            if group.dimension == self.spaces.body.dimension - 1:
                taken |= dict.fromkeys(group.tags, f"the support on '{on}'")
        # Those of two bodies may share a side with each other, but not with an obstacle's.
        contacts = sorted(enumerate(description.contacts), key=lambda item: bool(item[1].against))
        for number, contact in contacts:
            for side, name in (("on", contact.on), ("against", contact.against)):
                if name is None:
                    continue
                group = self.spaces.body.boundary(name, f"contact[{number}].{side}")
                shared = [taken[tag] for tag in group.tags if tag in taken]
                if shared:
                    raise InputError(
                        f"contact[{number}].{side} = '{name}': shares boundary with {shared[0]}; "
                        "a contact surface must be free of both"
                    )
                if contact.against is None:
                    taken |= dict.fromkeys(group.tags, f"the contact '{contact.label}'")
