"""GetFEM's model of a rigid paraboloid on a block in 3D; of ``getfem_multipliers``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from answers import Answer, cpu_seconds
from problems import Block

from programs.getfem_newton import pressed

_CONTACT, _OUTER, _SIDES = 1, 2, (3, 4)
_BULK = "first*Div_u*Div_Test_u+2*shear*(Sym(Grad_u):Sym(Grad_Test_u))"
# The obstacle's surface is at (x² + y²)/(2 curvature) - d; p and t are what it does to the body.
_PRESSURE = "pos_part(p+r*(u(3)-(sqr(X(1))+sqr(X(2)))/(2*curvature)+d))"
_TRIAL = "(t+r*([u(1);u(2)]-[old(1);old(2)]))"
_FRICTION = f"(min(1,mu*{_PRESSURE}/max(Norm({_TRIAL}),1e-12))*{_TRIAL})"


def solve_block(
    problem: Block, level: int, augmentation: float, version: Callable[[], str]
) -> Answer:
    """All load steps.

    Args:
        problem: The problem.
        level: Of the mesh.
        augmentation: Over E.
        version: Gives that of the program.
    """
    import getfem

    getfem.util_trace_level(0)
    getfem.util_warning_level(0)
    mesh = _mesh(problem, level)
    start = cpu_seconds()
    points = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(3,4)"))
    model, dofs = _model(problem, mesh, points, augmentation)
    newton = pressed(model, problem)
    return Answer(
        version=version(),
        dofs=dofs,
        solve_seconds=cpu_seconds() - start,
        newton=newton,
        factorisations=newton,
        values=_values(problem, level, mesh, points, model),
    )


def _mesh(problem: Block, level: int) -> Any:
    import getfem
    import numpy as np

    places = np.array(problem.lines(level))
    mesh = getfem.Mesh("cartesian", places, places, -places[::-1])
    end, fine, close = problem.extent, problem.fine, 1e-6

    def between(low: list[float], high: list[float]) -> Any:
        moved = [c - close for c in low], [c + close for c in high]
        return mesh.outer_faces_in_box(*moved)

    mesh.set_region(_CONTACT, between([0, 0, 0], [fine, fine, 0]))
    far = [
        between([end, 0, -end], [end, end, 0]),
        between([0, end, -end], [end, end, 0]),
        between([0, 0, -end], [end, end, -end]),
    ]
    mesh.set_region(_OUTER, np.hstack(far))
    mesh.set_region(_SIDES[0], between([0, 0, -end], [0, end, 0]))
    mesh.set_region(_SIDES[1], between([0, 0, -end], [end, 0, 0]))
    return mesh


def _model(problem: Block, mesh: Any, points: Any, augmentation: float) -> tuple[Any, int]:
    """The model, and how many unknowns its displacement has."""
    import getfem

    space = getfem.MeshFem(mesh, 3)
    space.set_fem(getfem.Fem("FEM_QK(3,2)"))
    model = getfem.Model("real")
    model.add_fem_variable("u", space)
    model.add_fem_data("old", space)
    E, nu = problem.youngs_modulus, problem.poissons_ratio
    data = {"first": E * nu / (1 + nu) / (1 - 2 * nu), "shear": E / 2 / (1 + nu), "d": 0.0}
    data |= {"r": augmentation * E, "curvature": problem.radius, "mu": problem.friction}
    for name, value in data.items():
        model.add_initialized_data(name, [value])
    model.add_linear_term(points, _BULK)
    model.add_Dirichlet_condition_with_simplification("u", _OUTER)
    for axis, side in enumerate(_SIDES, start=1):
        model.add_linear_term(points, f"{1e6 * E}*u({axis})*Test_u({axis})", side)
    work = f"{_PRESSURE}*Test_u(3)-(p-{_PRESSURE})*Test_p/r"
    if problem.friction:
        work += f"+{_FRICTION}.[Test_u(1);Test_u(2)]-(t-{_FRICTION}).Test_t/r"
    for name, size in (("p", 1), ("t", 2)) if problem.friction else (("p", 1),):
        multipliers = getfem.MeshFem(mesh, size)
        multipliers.set_fem(getfem.Fem("FEM_QK(3,1)"))
        model.add_filtered_fem_variable(name, multipliers, _CONTACT)
    model.add_nonlinear_term(points, work, _CONTACT)
    return model, space.nbdof()


def _values(problem: Block, level: int, mesh: Any, points: Any, model: Any) -> dict[str, float]:
    """Force of all quarters, and the peak in the cell in the middle."""
    import getfem
    import numpy as np

    places = problem.size(level) * (np.arange(20) + 0.5) / 20
    x, y = (grid.ravel() for grid in np.meshgrid(places, places))
    found = model.interpolation(_PRESSURE, np.vstack((x, y, np.full_like(x, -1e-12))), mesh)
    return {
        "force": 4 * float(getfem.asm_generic(points, 0, _PRESSURE, _CONTACT, model)),
        "peak pressure": float(max(found)),
    }
