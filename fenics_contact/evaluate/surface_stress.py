"""Stress of the body on a part of its boundary."""

from __future__ import annotations

import ufl

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.body.spaces import Spaces
from fenics_contact.mesh.tagged_mesh import Group


def stress_on(spaces: Spaces, elastic: ElasticBody, group: Group) -> ufl.Form:
    """∫ σ n · v over a group of facets, in UFL: over a constant v, a resultant (force).

    Args:
        spaces: Those of the body.
        elastic: Its stress.
        group: The facets.
    """
    size, test = spaces.components, ufl.TestFunction(spaces.displacement_space)
    cauchy, normal = elastic.stress(), ufl.FacetNormal(spaces.body.mesh)
    traction = [sum(cauchy[i, j] * normal[j] for j in range(size)) for i in range(size)]
    measure = spaces.boundary(group)
    return spaces.weight * ufl.dot(ufl.as_vector(traction), test) * measure
