"""GetFEM's model of a round body on a flat one; of ``getfem_multipliers``."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

from answers import Answer, cpu_seconds, crossing, sample_places
from problems import Pair

from programs.getfem_newton import solved

_RESIDUAL = 1e-9
_CONTACT, _AXIS, _HELD = 1, 2, 3
_BULK = "first*Div_{0}*Div_Test_{0}+2*shear*(Sym(Grad_{0}):Sym(Grad_Test_{0}))"


_DEEP = "((X+upper-[X(1);0]-Interpolate(lower,below)).Normal)"
_PRESSURE = f"pos_part(p+r*{_DEEP})"
_WORK = f"{_PRESSURE}*((Test_upper-Interpolate(Test_lower,below)).Normal)-(p-{_PRESSURE})*Test_p/r"


def solve_pair(
    problem: Pair, level: int, augmentation: float, version: Callable[[], str]
) -> Answer:
    """By multipliers, and what lies opposite by an interpolation between the meshes.

    Args:
        problem: The problem.
        level: Of the mesh.
        augmentation: Over E.
        version: Gives that of the program.
    """
    import getfem

    getfem.util_trace_level(0)
    getfem.util_warning_level(0)
    meshes = {"upper": _upper(problem, level), "lower": _lower(problem, level)}
    start = cpu_seconds()
    model, dofs, points = _model(problem, meshes, augmentation)
    newton = solved(model, _RESIDUAL)
    seconds = cpu_seconds() - start
    force = abs(getfem.asm_generic(points, 0, "p", _CONTACT, model))
    places = sample_places(problem.width, problem.size(level))
    found = _pressure(problem, places, meshes["upper"], model)
    # Beyond the edge it swings about nothing.
    end = next(number for number, pressure in enumerate(found) if pressure <= 0) + 1
    return Answer(
        version=version(),
        dofs=dofs,
        solve_seconds=seconds,
        newton=newton,
        factorisations=newton,
        values={
            "force": 2 * float(force),
            "peak pressure": float(max(found)),
            "half-width": float(crossing(places[:end], found[:end])),
        },
    )


def _upper(problem: Pair, level: int) -> Any:
    """Curved quadrilaterals of nine nodes."""
    import getfem
    import numpy as np

    mesh, (along, up) = getfem.Mesh("empty", 2), problem.upper_cells(level)
    cell = getfem.GeoTrans("GT_QK(2,2)")
    for i, j in product(range(along), range(up)):
        shares = [((i + a / 2) / along, (j + b / 2) / up) for b in range(3) for a in range(3)]
        mesh.add_convex(cell, np.array([problem.upper_place(*share) for share in shares]).T)
    close, wide, high = 1e-6, problem.width, problem.height
    low = problem.upper_place(1.0, 0.0)[1]
    mesh.set_region(_AXIS, mesh.outer_faces_in_box([-close, -close], [close, high + close]))
    top = mesh.outer_faces_in_box([-close, high - close], [wide + close, high + close])
    mesh.set_region(_HELD, top)
    faces = mesh.outer_faces_in_box([-close, -close], [wide + close, low + close])
    side = mesh.outer_faces_in_box([wide - close, -close], [wide + close, high + close])
    others = {tuple(face) for face in np.hstack((side, top)).T.tolist()}
    below = [face for face in faces.T.tolist() if tuple(face) not in others]
    mesh.set_region(_CONTACT, np.array(below).T)
    return mesh


def _lower(problem: Pair, level: int) -> Any:
    import getfem
    import numpy as np

    places = np.array(problem.lines(level))
    mesh, end, close = getfem.Mesh("cartesian", places, -places[::-1]), problem.extent, 1e-6
    faces = mesh.outer_faces_in_box
    mesh.set_region(_AXIS, faces([-close, -end - close], [close, close]))
    side = faces([end - close, -end - close], [end + close, close])
    bottom = faces([-close, -end - close], [end + close, close - end])
    mesh.set_region(_HELD, np.hstack((side, bottom)))
    mesh.set_region(_CONTACT, faces([-close, -close], [problem.width + close, close]))
    return mesh


def _model(problem: Pair, meshes: dict[str, Any], augmentation: float) -> tuple[Any, int, Any]:
    """The model, how many unknowns its displacements have, and points of the upper body."""
    import getfem

    model, dofs, points = getfem.Model("real"), 0, {}
    E, nu = problem.youngs_modulus, problem.poissons_ratio
    data = {"first": E * nu / (1 + nu) / (1 - 2 * nu), "shear": E / 2 / (1 + nu)}
    for name, value in (data | {"r": augmentation * E}).items():
        model.add_initialized_data(name, [value])
    for name, mesh in meshes.items():
        space = getfem.MeshFem(mesh, 2)
        space.set_fem(getfem.Fem("FEM_QK(2,2)"))
        points[name] = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,12)"))
        model.add_fem_variable(name, space)
        model.add_linear_term(points[name], _BULK.format(name))
        model.add_linear_term(points[name], f"{1e6 * E}*{name}(1)*Test_{name}(1)", _AXIS)
        dofs += space.nbdof()
    model.add_initialized_data("pushed", [0.0, -problem.pushed])
    held = model.add_Dirichlet_condition_with_simplification
    held("lower", _HELD)
    held("upper", _HELD, "pushed")
    multipliers = getfem.MeshFem(meshes["upper"], 1)
    multipliers.set_fem(getfem.Fem("FEM_QK(2,1)"))
    model.add_filtered_fem_variable("p", multipliers, _CONTACT)
    below = ("below", meshes["upper"], meshes["lower"], "[X(1);0]")
    model.add_interpolate_transformation_from_expression(*below)
    model.add_nonlinear_term(points["upper"], _WORK, _CONTACT)
    return model, dofs, points["upper"]


def _pressure(problem: Pair, places: list[float], mesh: Any, model: Any) -> list[float]:
    """Of the multiplier, just above the surface."""
    import numpy as np

    heights = [problem.upper_place(x / problem.width, 0.0)[1] + 1e-9 for x in places]
    line = np.vstack((places, heights))
    found = model.interpolation("p", line, mesh)
    return list(found)
