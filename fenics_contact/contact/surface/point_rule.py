"""The rule whose points are the contact points, and the factor of integrals by it.

Elements of degree 1 use the vertices, intervals and quadrilaterals of degree 2 Simpson's
rule (the paper's J): the points are the nodes of the trace. On triangles of degree 2 a rule
on the nodes that integrates their shape functions has no weight at the vertices; a seventh
point at the centre gives all of them a positive one (exact to degree 3).
"""

from __future__ import annotations

import ufl
from dolfinx import fem

from fenics_contact.body.forms import CompiledForm, Expr, Measure, Rule
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.contact.surface.facet_centres import SIX_NODES
from fenics_contact.contact.surface.space import SurfaceSpace

# Radius over the largest coordinate, up to which a point lies on the axis of revolution.
_ON_AXIS = 1e-12


def needs_centres(spaces: Spaces) -> bool:
    """Whether facets have a point at their centre, which is no node."""
    return spaces.degree == 2 and spaces.body.mesh.topology.cell_name() == "tetrahedron"


def nodal_rule(spaces: Spaces) -> Rule:
    """A rule with positive weights on the nodes alone."""
    if needs_centres(spaces):
        return SIX_NODES
    triangles = spaces.body.mesh.topology.cell_name() == "tetrahedron"
    degree = 1 if spaces.degree == 1 else 3
    return {"quadrature_rule": "vertex" if triangles else "GLL", "quadrature_degree": degree}


def node_form(surface: SurfaceSpace, weight: Expr | float, measure: Measure) -> CompiledForm:
    """∫ N_i of the shape function of every node, in each component."""
    test = ufl.TestFunction(surface.space)
    along = ufl.as_vector([1.0] * surface.components)
    return form_cache.form(weight * ufl.dot(along, test) * measure)


def node_integrals(surface: SurfaceSpace, weight: Expr | float, measure: Measure) -> Array:
    """∫ N_i of the shape function of every node, (nodes,); collective.

    Args:
        surface: The surface.
        weight: Factor of the integral.
        measure: Of the surface.
    """
    return surface.assemble(node_form(surface, weight, measure))[:, 0]


def point_weight(surface: SurfaceSpace) -> Expr | float:
    """The integrals' factor at the points; collective.

    On linear facets of an axisymmetric model it is that which gives every vertex its
    part of the area, ∫ 2πr N_i: the vertex rule with 2πr itself would leave none to the
    axis, and its first neighbour would carry the axis' load too (+8 % pressure there).

    On other ones it is 2πr, and exactly 0 on the axis: what is no point has no obstacle either,
    and round-off of r would press it.
    """
    spaces = surface.spaces
    if spaces.kinematics != "axisymmetric":
        return surface.weight
    if spaces.degree != 1:
        least = fem.Constant(surface.mesh, _ON_AXIS * surface.farthest())
        return ufl.conditional(ufl.gt(surface.position[0], least), surface.weight, 0.0)
    measure = surface.measure()
    area = node_integrals(surface, surface.weight, measure)
    return surface.scalar_function(area / node_integrals(surface, 1.0, measure), "weight")
