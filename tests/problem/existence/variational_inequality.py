"""Frictionless contact without penalty: PETSc's solver of variational inequalities.

Minimise ½ a(u, u) under u_n ≤ s at the nodes of a flat surface: bounds on single dofs. Nothing
of the program is used but the mesh; the forms are written here again.
"""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact import Body
from tests.random.scenes import RandomScene


def normal_force(random: RandomScene, body: Body) -> float:
    """Of the obstacle on the body, ≥ 0, for a ``frictionless`` scene; collective."""
    scene, mesh = random.scene, body.mesh
    space = fem.functionspace(mesh, ("Lagrange", scene.discretisation.degree, (scene.dimension,)))
    trial, test = ufl.TrialFunction(space), ufl.TestFunction(space)
    stiffness = fem.form(_work(scene, mesh, trial, test))
    axis = scene.dimension - 1
    clamped = _dofs(space, body, "body." + "xyz"[axis] + "0")
    held = [fem.dirichletbc(np.zeros(scene.dimension), clamped, space)]
    if scene.kinematics == "axisymmetric":  # u_r = 0 on the axis
        held.append(fem.dirichletbc(0.0, _on_axis(space, mesh), space.sub(0)))
    matrix = petsc.assemble_matrix(stiffness, bcs=held)
    matrix.assemble()
    free = petsc.assemble_matrix(stiffness)
    free.assemble()
    nodes = _dofs(space, body, "body." + "xyz"[axis] + "1")
    places = space.tabulate_dof_coordinates()[nodes]
    upper = fem.Function(space)
    upper.x.array[:] = PETSc.INFINITY
    bounded = np.ones(len(nodes), dtype=bool)
    if scene.kinematics == "axisymmetric" and scene.discretisation.degree == 2:
        bounded = places[:, 0] > 0  # the shape function of the axis has no integral
    upper.x.array[nodes[bounded] * scene.dimension + axis] = gap(scene, places[bounded])
    found = fem.Function(space)
    _solve(matrix, found, upper)
    forces = found.x.petsc_vec.duplicate()
    free.mult(found.x.petsc_vec, forces)
    owned = nodes[nodes < space.dofmap.index_map.size_local]
    pushed = -forces.array_r[owned * scene.dimension + axis].sum()
    return float(mesh.comm.allreduce(pushed))


def _work(scene, mesh, u, v):
    """∫ σ(u) : e(v), over the volume or the full revolution."""
    material = scene.material[0]
    young, poisson = material.youngs_modulus, material.poissons_ratio
    shear = young / (2 * (1 + poisson))
    lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    if scene.kinematics == "plane stress":
        lame = 2 * shear * lame / (lame + 2 * shear)
    x = ufl.SpatialCoordinate(mesh)
    strain, other = ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))
    trace, other_trace = ufl.tr(strain), ufl.tr(other)
    product = ufl.inner(strain, other)
    weight = 1.0
    if scene.kinematics == "axisymmetric":
        hoop, other_hoop = u[0] / x[0], v[0] / x[0]
        trace, other_trace = trace + hoop, other_trace + other_hoop
        product, weight = product + hoop * other_hoop, 2 * np.pi * x[0]
    return weight * (lame * trace * other_trace + 2 * shear * product) * ufl.dx(mesh)


def gap(scene, places) -> np.ndarray:
    """From a flat top at places (nodes, 3) to the obstacle, driven (length)."""
    obstacle, axis = scene.contact[0].obstacle, scene.dimension - 1
    apex = np.zeros(3)
    apex[: scene.dimension] = obstacle.position
    across = np.delete(places - apex, axis, axis=1)
    height = apex[axis] - places[:, axis] - obstacle.indentation
    if obstacle.shape == "plane":
        return height
    return height + np.sum(across**2, axis=1) / (2 * obstacle.radius)


def _dofs(space, body, group: str) -> np.ndarray:
    tags = np.concatenate([body.facet_tags.find(tag) for tag in body.groups[group].tags])
    dimension = body.mesh.topology.dim - 1
    body.mesh.topology.create_connectivity(dimension, dimension + 1)
    return fem.locate_dofs_topological(space, dimension, np.sort(tags))


def _on_axis(space, mesh) -> np.ndarray:
    at = np.abs(space.tabulate_dof_coordinates()[:, 0])
    size = mesh.comm.allreduce(at.max(initial=0.0), op=MPI.MAX)
    nodes = np.flatnonzero(at < 1e-12 * size)
    return (nodes * space.dofmap.index_map_bs).astype(np.int32)


def _solve(matrix, found, upper) -> None:
    """Newton's method on the active set, with a reduced space."""
    state = found.x.petsc_vec
    lower = state.duplicate()
    lower.set(PETSc.NINFINITY)
    snes = PETSc.SNES().create(matrix.comm)
    snes.setType("vinewtonrsls")
    snes.setFunction(lambda _, x, r: matrix.mult(x, r), state.duplicate())
    snes.setJacobian(lambda *_: None, matrix)
    snes.setVariableBounds(lower, upper.x.petsc_vec)
    solver = snes.getKSP()
    solver.setType("preonly")
    solver.getPC().setType("lu")
    solver.getPC().setFactorSolverType("mumps")
    snes.setOptionsPrefix("variational_inequality_")
    PETSc.Options()["variational_inequality_snes_linesearch_type"] = "basic"
    snes.setFromOptions()
    # Nothing to push is solved at once: no force is below 0.
    snes.setTolerances(rtol=1e-10, atol=1e-300, stol=0.0, max_it=100)
    snes.solve(None, state)
    assert snes.getConvergedReason() > 0, snes.getConvergedReason()
    found.x.scatter_forward()
    snes.destroy()
