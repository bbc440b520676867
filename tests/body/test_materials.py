"""Elastic tensors: their conditions, groups, functions, and orthotropic closed forms."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Discretisation, InputError, Load, Material, Run, Scene, Support, run
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
# Orthotropic: Young's moduli, shear moduli and Poisson's ratios ν_ij = −e_j/e_i under σ_i.
EX, EY, EZ, GYZ, GXZ, GXY = 1000.0, 600.0, 300.0, 150.0, 220.0, 270.0
NXY, NXZ, NYZ = 0.3, 0.25, 0.2
COMPLIANCE = np.zeros((6, 6))
COMPLIANCE[:3, :3] = [
    [1 / EX, -NXY / EX, -NXZ / EX],
    [-NXY / EX, 1 / EY, -NYZ / EY],
    [-NXZ / EX, -NYZ / EY, 1 / EZ],
]
COMPLIANCE[3:, 3:] = np.diag([1 / GYZ, 1 / GXZ, 1 / GXY])
ORTHOTROPIC = np.linalg.inv(COMPLIANCE)
P = 7.0


def pulled(kinematics, material, **more):
    """A box on rollers pulled along x (axisymmetric: along the axis y)."""
    axes = "xyz" if kinematics == "3D" else "xy"
    along = "y" if kinematics == "axisymmetric" else "x"
    traction = tuple(P if axis == along else 0 for axis in axes)
    return Scene(
        kinematics=kinematics,
        material=material,
        support=tuple(Support(f"{axis}0", {axis: 0}) for axis in axes),
        load=(Load(f"{along}1", traction=traction),),
        **more,
    )


def box(kinematics):
    return box_body((2, 2, 2) if kinematics == "3D" else (3, 2), (2, 1, 0.5))


@pytest.mark.parametrize("kinematics", ["plane stress", "plane strain", "3D"])
def test_orthotropic_tension(kinematics):
    """e = S σ; in plane strain with the σ_zz that keeps e_zz = 0."""
    prepared = Run(pulled(kinematics, Material(stiffness=ORTHOTROPIC)), COMM, box(kinematics))
    assert prepared.solve().passed
    stress = np.array([P, 0, 0, 0, 0, 0])
    if kinematics == "plane strain":
        stress[2] = -COMPLIANCE[2, 0] * P / COMPLIANCE[2, 2]
    strain = COMPLIANCE @ stress
    points = prepared.problem.spaces.coordinates
    size = prepared.problem.spaces.components
    exact = (points * strain[:3])[:, :size]
    assert np.abs(prepared.solution.displacement - exact).max() < 1e-12


def test_orthotropic_tension_of_a_cylinder():
    """Axis y with its own moduli, x and z (hoop) alike: uniform axial stress."""
    compliance = np.zeros((6, 6))
    ea, er, nu_ar, nu_r = 900.0, 400.0, 0.28, 0.15
    compliance[:3, :3] = [
        [1 / er, -nu_ar / ea, -nu_r / er],
        [-nu_ar / ea, 1 / ea, -nu_ar / ea],
        [-nu_r / er, -nu_ar / ea, 1 / er],
    ]
    compliance[3:, 3:] = np.diag([1 / 200, 1 / 170, 1 / 200])
    material = Material(stiffness=np.linalg.inv(compliance))
    prepared = Run(pulled("axisymmetric", material), COMM, box("axisymmetric"))
    assert prepared.solve().passed
    points = prepared.problem.spaces.coordinates[:, :2]
    exact = points * P * np.array([-nu_ar / ea, 1 / ea])
    assert np.abs(prepared.solution.displacement - exact).max() < 1e-12


def test_isotropic_as_a_tensor_and_as_two_numbers():
    young, poisson = 1000.0, 0.3
    shear, lame = young / 2.6, young * poisson / (1.3 * 0.4)
    tensor = np.zeros((3, 3, 3, 3))
    one = np.eye(3)
    tensor += lame * np.einsum("ij,kl->ijkl", one, one)
    tensor += shear * (np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one))
    for kinematics in ("plane stress", "plane strain", "axisymmetric", "3D"):
        numbers = run(pulled(kinematics, Material(young, poisson)), COMM, box(kinematics))
        as_tensor = run(pulled(kinematics, Material(stiffness=tensor)), COMM, box(kinematics))
        assert as_tensor.quantities["strain_energy"] == pytest.approx(
            numbers.quantities["strain_energy"], rel=1e-10
        )


def test_tensor_without_its_symmetries_is_refused():
    tensor = np.zeros((3, 3, 3, 3))
    tensor[0, 1, 0, 1] = 1.0
    with refused("stiffness_lacks_minor_symmetry", ValueError):
        Material(stiffness=tensor)
    skew = ORTHOTROPIC.copy()
    skew[0, 1] *= 1.1
    with refused("stiffness_not_symmetric"):
        Run(pulled("3D", Material(stiffness=skew)), COMM, box("3D"))


def test_tensor_that_is_not_elliptic_is_refused():
    soft = ORTHOTROPIC.copy()
    soft[5, 5] = -1.0
    with refused("stiffness_not_positive_definite"):
        Run(pulled("3D", Material(stiffness=soft)), COMM, box("3D"))


@pytest.mark.parametrize("kinematics", ["plane stress", "plane strain", "axisymmetric"])
def test_tensor_that_warps_out_of_plane_is_refused_in_plane_models(kinematics):
    warping = ORTHOTROPIC.copy()
    warping[4, 0] = warping[0, 4] = 20.0
    with refused("stiffness_couples_shears"):
        Run(pulled(kinematics, Material(stiffness=warping)), COMM, box(kinematics))
    assert run(pulled("3D", Material(stiffness=warping)), COMM, box("3D")).converged


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "youngs_modulus_is_missing"),
        ({"youngs_modulus": 1.0}, "poissons_ratio_is_missing"),
        ({"youngs_modulus": 1.0, "poissons_ratio": 0.5}, "poissons_ratio_is_a_half"),
        ({"youngs_modulus": 1.0, "stiffness": np.eye(6)}, "moduli_and_stiffness"),
        ({"stiffness": np.eye(5)}, "stiffness_too_small_a_matrix"),
    ],
)
def test_material_that_is_not_one(arguments, message):
    with refused(message, ValueError):
        Material(**arguments)


def bimaterial(comm=COMM, cells=(4, 2), cell=None):
    """A box whose cells with x < 1 are the group 'left', the others 'right'."""
    from dolfinx import mesh as meshes

    from fenics_contact import Group

    body = box_body(cells, (2, 1), cell, comm=comm)
    cells = body.cell_tags.indices
    midpoints = meshes.compute_midpoints(body.mesh, 2, cells)
    tags = meshes.meshtags(
        body.mesh, 2, cells, np.where(midpoints[:, 0] < 1, 1, 2).astype(np.int32)
    )
    groups = dict(body.groups)
    groups |= {"left": Group(2, (1,)), "right": Group(2, (2,)), "body": Group(2, (1, 2))}
    return dataclasses.replace(body, cell_tags=tags, groups=groups)


@pytest.mark.parametrize("as_tensor", [False, True])
def test_two_materials_in_series(as_tensor):
    """Plane stress with ν = 0: end displacement P (1/E₁ + 1/E₂)."""
    right = Material(100, 0, on="right")
    if as_tensor:
        right = Material(stiffness=100 * np.diag([1, 1, 1, 0.5, 0.5, 0.5]), on="right")
    scene = pulled("plane stress", (Material(400, 0, on="left"), right))
    prepared = Run(scene, COMM, bimaterial())
    assert prepared.solve().passed
    points = prepared.problem.spaces.coordinates
    exact = P * (np.minimum(points[:, 0], 1) / 400 + np.maximum(points[:, 0] - 1, 0) / 100)
    assert np.abs(prepared.solution.displacement[:, 0] - exact).max() < 1e-12


@pytest.mark.parametrize(
    ("materials", "message"),
    [
        ((Material(1, 0, on="left"),), "cells_without_material"),
        ((Material(1, 0), Material(1, 0, on="left")), "material_shares_cells"),
        ((Material(1, 0, on="x0"),), "material_of_a_side"),
        ((Material(1, 0, on="centre"),), "material_of_no_group"),
        ((Material(lambda x: x[0] - 1, 0),), "youngs_modulus_is_negative_somewhere"),
        ((Material(1, lambda x: x[0]),), "poissons_ratio_out_of_range_somewhere"),
    ],
)
def test_materials_must_fill_the_body_once(materials, message):
    with refused(message):
        Run(pulled("plane stress", materials), COMM, bimaterial())


def test_modulus_as_a_function_of_position():
    """E = E₀ (1 + x): u(2) = P/E₀ ∫ dx/(1 + x) = P/E₀ ln 3; error of fourth order or better."""
    errors = []
    for cells in (4, 8):
        scene = pulled("plane stress", Material(lambda x: 100 * (1 + x[0]), 0))
        prepared = Run(scene, COMM, box_body((cells, 1), (2, 1)))
        prepared.solve()
        points = prepared.problem.spaces.coordinates
        end = prepared.solution.displacement[np.isclose(points[:, 0], 2), 0]
        error = np.abs(end - P / 100 * np.log(3)).max(initial=0.0)
        errors.append(COMM.allreduce(error, op=MPI.MAX))
    assert errors[1] < 1e-5
    assert np.log2(errors[0] / errors[1]) > 3.5


def test_thickness_scales_forces_and_may_vary():
    """Pulled along x at thickness t(x): uniform force, e_x = P t(2) / (E t(x)) with ν = 0."""
    plain = run(pulled("plane stress", Material(100, 0.3)), COMM, box("plane stress"))
    thick = run(
        pulled("plane stress", Material(100, 0.3), thickness=0.25), COMM, box("plane stress")
    )
    assert thick.quantities["reaction"] == pytest.approx(
        [0.25 * force for force in plain.quantities["reaction"]], abs=1e-12
    )
    # uniaxial stress needs thin tapers; energy of a bar: P² t₂² / (2 E) ∫ dx / t
    taper = pulled("plane stress", Material(100, 0), thickness=lambda x: 1 + 0.01 * x[0])
    result = run(taper, COMM, box_body((8, 2), (2, 1)))
    expected = (P * 1.02) ** 2 / (2 * 100) * np.log(1.02) / 0.01
    assert result.quantities["strain_energy"] == pytest.approx(expected, rel=1e-4)
    with refused("thickness_is_negative_somewhere"):
        run(
            pulled("plane stress", Material(100, 0), thickness=lambda x: x[0] - 1),
            COMM,
            box("plane stress"),
        )
    with refused("thickness_in_plane_strain", ValueError):
        pulled("plane strain", Material(100, 0), thickness=2.0)


@pytest.mark.parametrize("degree", [1, 2])
def test_jump_of_a_function_between_cells_stays_one(degree):
    """E = 1 for x < 1 and 1000 beyond, read at points inside the cells."""
    scene = pulled(
        "plane stress",
        Material(lambda x: np.where(x[0] < 1, 1.0, 1000.0), 0),
        discretisation=Discretisation(degree),
    )
    prepared = Run(scene, COMM, box_body((8, 2), (2, 1)))
    prepared.solve()
    points = prepared.problem.spaces.coordinates
    end = prepared.solution.displacement[np.isclose(points[:, 0], 2), 0]
    assert np.abs(end - P * (1 + 1 / 1000)).max(initial=0.0) < 1e-9


def test_jump_of_a_function_inside_cells_never_makes_energy_negative():
    """Either the interpolant stays positive where it is used, or it is refused."""
    for cell in (CellType.triangle, CellType.quadrilateral):
        scene = pulled("plane stress", Material(lambda x: np.where(x[0] < 0.9, 1.0, 1000.0), 0))
        try:
            result = run(scene, COMM, box_body((7, 2), (2, 1), cell))
        except InputError as error:
            assert "a jump needs materials of its own" in str(error)
        else:
            assert result.quantities["strain_energy"] > 0


def test_nearly_incompressible_tensors_are_refused():
    young, poisson = 1.0, 0.4999
    shear = young / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - 2 * poisson)
    tensor = lame * np.pad(np.ones((3, 3)), (0, 3)) + shear * np.diag([2, 2, 2, 1, 1, 1])
    with refused("stiffness_nearly_incompressible"):
        Run(pulled("plane strain", Material(stiffness=tensor)), COMM, box("plane strain"))
    beside = (
        Material(1, 0.4999, on="left"),
        Material(stiffness=np.diag([1, 1, 1, 0.5, 0.5, 0.5]), on="right"),
    )
    with refused("stiffness_nearly_incompressible"):
        Run(pulled("plane strain", beside), COMM, bimaterial())
    # stiff fibres are not incompressible
    fibres = np.diag([500.0, 1, 1, 0.5, 0.5, 0.5])
    assert run(pulled("plane strain", Material(stiffness=fibres)), COMM, box("plane strain")).passed


def test_tensor_as_nested_lists():
    tensor = np.einsum("ik,jl->ijkl", np.eye(3), np.eye(3))
    tensor = 0.5 * (tensor + tensor.transpose(1, 0, 2, 3))
    assert Material(stiffness=tensor.tolist()) == Material(stiffness=tensor)


def test_small_asymmetry_of_a_soft_tensor_is_seen_beside_a_stiff_material():
    soft = np.diag([1.0, 1, 1, 0.5, 0.5, 0.5])
    soft[0, 1] = 0.5
    materials = (Material(1e12, 0.3, on="left"), Material(stiffness=soft, on="right"))
    with refused("stiffness_not_symmetric"):
        Run(pulled("plane strain", materials), COMM, bimaterial())
