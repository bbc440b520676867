"""Patch test: a linear displacement, prescribed around the body, is reproduced exactly.

Every kinematics × cell × degree × order of the geometry, on irregular meshes; and a
tensor without symmetry planes for good measure.
"""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Discretisation, Material, MeshSource, Run, Scene, Support

COMM = MPI.COMM_WORLD
E, NU = 1000.0, 0.3
# Unstructured: the patch test says little on parallelograms.
FLAT = """
Point(1) = {1, 0, 0}; Point(2) = {3, 0.2, 0}; Point(3) = {2.8, 1.1, 0}; Point(4) = {1, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
MeshSize{:} = 0.45;
"""
PLANE = FLAT + 'Physical Surface("body") = {1}; Physical Curve("around") = {1, 2, 3, 4};\n'
SPACE = (
    FLAT
    + """
out[] = Extrude {0.1, 0.05, 0.8} { Surface{1}; Layers{2}; RECOMBINE };
Physical Volume("body") = {out[1]};
Physical Surface("around") = {1, out[0], out[2], out[3], out[4], out[5]};
"""
)
GRADIENT = np.array([[0.03, -0.01, 0.02], [0.04, -0.02, 0.01], [-0.05, 0.02, 0.06]])


def body_of(folder, kinematics, cell, order):
    three = kinematics == "3D"
    text = SPACE.replace("RECOMBINE", "Recombine;" if cell == "hexahedron" else "")
    path = folder / "patch.geo"
    if cell in ("quadrilateral", "hexahedron"):  # irregular, since the outline is
        text, plane = (
            t.replace("MeshSize", "Transfinite Curve{1:4} = 4; Transfinite Surface{1};\nMeshSize")
            for t in (text, PLANE)
        )
    else:
        plane = PLANE
    if COMM.rank == 0:
        path.write_text(text if three else plane)
    COMM.barrier()
    flat_cell = {"hexahedron": "quadrilateral", "tetrahedron": "triangle"}.get(cell, cell)
    return MeshSource(str(path), cell=flat_cell, order=order)


def exact_strain(kinematics, material_nu):
    """Strain (3, 3) of the linear field, out of plane as the kinematics has it."""
    gradient = gradient_of(kinematics)
    strain = 0.5 * (gradient + gradient.T)
    if kinematics == "plane stress":
        strain[2, 2] = -material_nu / (1 - material_nu) * (strain[0, 0] + strain[1, 1])
    elif kinematics == "axisymmetric":
        strain[2, 2] = strain[0, 0]  # u_r = a r
    return strain


def gradient_of(kinematics):
    gradient = GRADIENT.copy()
    if kinematics != "3D":
        gradient[2, :] = gradient[:, 2] = 0
    if kinematics == "axisymmetric":  # σ_rz would need a body force σ_rz / r
        gradient[0, 1] = gradient[1, 0] = 0
    return gradient


def scene_of(source, kinematics, degree, material):
    gradient = gradient_of(kinematics)
    axes = "xyz"[: 3 if kinematics == "3D" else 2]
    values = {axis: (lambda x, row=row: gradient[row] @ x) for row, axis in enumerate(axes)}
    return Scene(
        kinematics=kinematics,
        mesh=source,
        material=material,
        discretisation=Discretisation(degree),
        support=(Support("around", values),),
    )


def volume_of(problem):
    from dolfinx import fem

    spaces = problem.spaces
    return COMM.allreduce(fem.assemble_scalar(fem.form(spaces.weight * spaces.bulk)))


def assert_exact(prepared, kinematics, energy_density):
    result = prepared.solve()
    assert result.passed
    problem = prepared.problem
    size = problem.spaces.components
    exact = (problem.spaces.coordinates @ gradient_of(kinematics).T)[:, :size]
    assert np.abs(prepared.solution.displacement - exact).max() < 1e-12
    expected = energy_density * volume_of(problem)
    assert result.quantities["strain_energy"] == pytest.approx(expected, rel=1e-10)


CASES = [
    (kinematics, cell)
    for kinematics, cells in {
        "plane strain": ("triangle", "quadrilateral"),
        "plane stress": ("triangle", "quadrilateral"),
        "axisymmetric": ("triangle", "quadrilateral"),
        "3D": ("tetrahedron", "hexahedron"),
    }.items()
    for cell in cells
]


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(("kinematics", "cell"), CASES)
def test_linear_displacement_is_exact(folder, kinematics, cell, degree, order):
    source = body_of(folder, kinematics, cell, order)
    prepared = Run(scene_of(source, kinematics, degree, Material(E, NU)), COMM)
    mesh = prepared.problem.body.mesh
    assert mesh.topology.cell_name() == cell
    assert mesh.ufl_domain().ufl_coordinate_element().degree == order
    e = exact_strain(kinematics, NU)
    shear = E / (2 * (1 + NU))
    lame = E * NU / ((1 + NU) * (1 - 2 * NU))
    assert_exact(prepared, kinematics, 0.5 * lame * np.trace(e) ** 2 + shear * np.sum(e * e))


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(("kinematics", "cell"), CASES)
def test_nearly_incompressible_keeps_the_patch(folder, kinematics, cell, degree):
    source = body_of(folder, kinematics, cell, 1)
    prepared = Run(scene_of(source, kinematics, degree, Material(E, 0.4999)), COMM)
    e = exact_strain(kinematics, 0.4999)
    shear = E / (2 * 1.4999)
    lame = E * 0.4999 / (1.4999 * 0.0002)
    energy = 0.5 * lame * np.trace(e) ** 2 + shear * np.sum(e * e)
    name = prepared.problem.terms[0].name
    assert ("nearly incompressible" in name) == (kinematics != "plane stress")
    result = prepared.solve()
    size = prepared.problem.spaces.components
    exact = (prepared.problem.spaces.coordinates @ gradient_of(kinematics).T)[:, :size]
    assert np.abs(prepared.solution.displacement - exact).max() < 1e-9
    expected = energy * volume_of(prepared.problem)
    assert result.quantities["strain_energy"] == pytest.approx(expected, rel=1e-5)


# Not axisymmetric: there σ_rr − σ_θθ would need a body force.
@pytest.mark.parametrize(
    ("kinematics", "cell"), [case for case in CASES if case[0] != "axisymmetric"]
)
def test_any_tensor_keeps_the_patch(folder, kinematics, cell):
    """A tensor without symmetry planes (in plane models: one, that of the model)."""
    stiffness = random_stiffness(plane=kinematics != "3D")
    source = body_of(folder, kinematics, cell, 1)
    prepared = Run(scene_of(source, kinematics, 2, Material(stiffness=stiffness)), COMM)
    gradient = gradient_of(kinematics)
    e = 0.5 * (gradient + gradient.T)
    vector = np.array([e[0, 0], e[1, 1], e[2, 2], 2 * e[1, 2], 2 * e[0, 2], 2 * e[0, 1]])
    if kinematics == "plane stress":  # σ_zz = 0 is one equation for e_zz
        vector[2] = -(stiffness[2] @ vector - stiffness[2, 2] * vector[2]) / stiffness[2, 2]
    assert_exact(prepared, kinematics, 0.5 * vector @ stiffness @ vector)


def random_stiffness(plane):
    rng = np.random.default_rng(7)
    root = rng.normal(size=(6, 6))
    matrix = 100 * (root @ root.T + 6 * np.eye(6))
    if plane:
        for shear in (3, 4):
            for other in (0, 1, 2, 5):
                matrix[shear, other] = matrix[other, shear] = 0
    return matrix
