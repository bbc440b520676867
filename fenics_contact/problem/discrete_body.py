"""A body made ready for any conditions: what laws, obstacles, loads and values do not change.

The paper's K is here, and the dofs and surfaces that Γ_D and Γ_C stand for, but no energy of
contact, no load and no displacement that is prescribed: these are the problem's.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import numpy as np
from dolfinx import fem

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.finite.hyperelastic_body import HyperelasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import HeldDofs
from fenics_contact.common.arrays import Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.contact.choice_of_slaves import NamedSurfaces, choose_slaves
from fenics_contact.contact.mortar.cut_projection import CutProjection
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene

_T = TypeVar("_T")


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
        cut: The cut faces of a sector of a ring, or None.
        elastic: ½ a(·, ·): law, compiled forms, stress.
        sides: The surfaces of each contact, in scene order.
        found: What is worked out of it once, by name.
        is_kept: Whether it is for many problems, so that what each would work out is kept.

    Raises:
        InputError: Its groups or materials do not fit the mesh, or overlap.
    """

    def __init__(self, description: BodyDescription, body: Body) -> None:
        self.description = description
        self.spaces = Spaces(description, body)
        self.displacement = fem.Function(self.spaces.displacement_space, name="displacement")
        self.held = HeldDofs(description, self.spaces)
        self._refuse_overlaps()
        self._refuse_at_couplings()
        self.outer = self._outer_dofs()
        self.constrained = np.union1d(self.held.dofs, self.outer)
        sector = description.cyclic_symmetry
        self.cut: CutFaces | None = None
        if sector is not None:
            mortar = CutProjection(self.spaces, sector.on, sector.against).shares
            self.cut = CutFaces(sector, self.spaces, mortar)
        self.elastic = self._elastic()
        self.is_kept = False
        self.found: dict[Hashable, Any] = {}
        named = [
            NamedSurfaces(
                contact,
                f"contact[{number}]",
                self.spaces,
                self.held.flat_sides,
                self.held.walls,
                self.cut,
            )
            for number, contact in enumerate(description.contacts)
        ]
        self.sides = [
            ContactSides(surfaces, keeps, why, self.constrained)
            for surfaces, (keeps, why) in zip(named, choose_slaves(named), strict=True)
        ]

    def _elastic(self) -> ElasticBody:
        """The body's energy: linear elasticity, or that of finite strains."""
        known = self.description, self.spaces, self.displacement, self.held
        if self.description.strains == "finite":
            return HyperelasticBody(*known)
        return ElasticBody(*known, self.cut)

    def serve_many(self) -> None:
        """From now on keep what each problem would work out."""
        self.is_kept = True

    def once(self, name: Hashable, make: Callable[[], _T]) -> _T:
        """Return a value worked out of the body: once where it is kept, else at each call.

        Args:
            name: Of what is worked out.
            make: Works it out.
        """
        if not self.is_kept:
            return make()
        if name not in self.found:
            self.found[name] = make()
        kept: _T = self.found[name]
        return kept

    def take_temperatures(self, description: BodyDescription) -> None:
        """Take temperatures that vary in other ways in space; collective.

        Args:
            description: Of this body but for these fields.

        Raises:
            InputError: A function or a file of a temperature fails; the body is of no use then.
        """
        self.elastic.take_fields(description.heated)
        self.description = description

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

    def _refuse_at_couplings(self) -> None:
        """No point of a rigid face is held, sprung, moved or touched by anything else."""
        body, spaces, description = self.spaces.body, self.spaces, self.description
        groups = [(f"coupling[{i}].on", each.on) for i, each in enumerate(description.couplings)]
        others = [(f"support[{i}].on", each.on) for i, each in enumerate(description.held)]
        for number, contact in enumerate(description.contacts):
            names = {"on": contact.on, "against": contact.against}
            others += [(f"contact[{number}].{k}", name) for k, name in names.items() if name]
        others += [(f"half_space.on[{i}]", on) for i, on in enumerate(description.outer)]
        rigid = [each.is_rigid for each in description.couplings]
        for number, (key, on) in enumerate(groups):
            if not rigid[number]:
                continue
            nodes = spaces.nodes(body.boundary(on, key))
            elastic = [one for one, is_rigid in zip(groups, rigid, strict=True) if not is_rigid]
            before = [one for one in groups[:number] if one not in elastic]
            for other_key, other in [*others, *before, *elastic]:
                shared = np.intersect1d(nodes, spaces.nodes(body.group(other, other_key)))
                if total(spaces.comm, len(shared)):
                    raise InputError(
                        f"{key} = '{on}': shares points with {other_key} = '{other}'; a face that "
                        "moves as a rigid body must be free of supports, contacts and other "
                        "couplings"
                    )

    def _refuse_overlaps(self) -> None:
        """Contacts may not share facets with supports (Γ_C ∩ Γ_D = ∅), nor two with obstacles."""
        taken: dict[int, str] = {}
        description = self.description
        held = [(f"support[{i}].on", each.on) for i, each in enumerate(description.held)]
        held += [(f"half_space.on[{i}]", on) for i, on in enumerate(description.outer)]
        held += [(f"symmetry[{i}]", on) for i, on in enumerate(description.symmetry)]
        for key, on in held:
            group = self.spaces.body.group(on, key)
            if group.dimension == self.spaces.body.dimension - 1:
                taken |= dict.fromkeys(group.tags, f"the support on '{on}'")
        pressed: dict[int, str] = {}  # by obstacles
        for number, contact in enumerate(description.contacts):
            for side, name in (("on", contact.on), ("against", contact.against)):
                if name is None:
                    continue
                group = self.spaces.body.boundary(name, f"contact[{number}].{side}")
                forbidden = taken if contact.against else taken | pressed
                shared = [forbidden[tag] for tag in group.tags if tag in forbidden]
                if shared:
                    raise InputError(
                        f"contact[{number}].{side} = '{name}': shares boundary with {shared[0]}; "
                        "a contact surface must be free of both"
                    )
                if contact.against is None:
                    pressed |= dict.fromkeys(group.tags, f"the contact '{contact.label}'")
