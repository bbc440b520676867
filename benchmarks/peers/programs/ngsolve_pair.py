"""NGSolve's model of a round body on a flat one; of ``ngsolve_energies``."""

from __future__ import annotations

from typing import Any

from answers import Answer, cpu_seconds, crossing
from problems import Pair

from programs.ngsolve_mesh import add_rectangle

# Points of each facet at which displacements are looked at.
_POINTS = 400


def solve_pair(problem: Pair, level: int, setting: dict[str, Any], newton: Any) -> Answer:
    """With its ``ContactBoundary``, by an energy of penalty.

    Args:
        problem: The problem.
        level: Of the mesh.
        setting: Order, and penalty over E/h.
        newton: Newton's method from what is there, on a form with a solver; how many steps it took.
    """
    import ngsolve as ng

    mesh = ng.Mesh(_mesh(problem, level))
    _bend(problem, mesh)
    start = cpu_seconds()
    order = setting["order"]
    space = ng.VectorH1(mesh, order=order, dirichletx="axis|far|top", dirichlety="far|top")
    now = ng.GridFunction(space)
    now.Set(ng.CF((0, -problem.pushed)), definedon=mesh.Boundaries("top"))
    stiffness = setting["penalty"] * problem.youngs_modulus / problem.size(level)
    contact = ng.ContactBoundary(mesh.Boundaries("upper"), mesh.Boundaries("lower"))
    u, place = space.TrialFunction(), ng.CF((ng.x, ng.y))
    deep = (place + u - (place.Other() + u.Other())) * contact.normal
    contact.AddEnergy(ng.IfPos(deep, stiffness / 2 * deep**2, 0))
    form = ng.BilinearForm(space, symmetric=True)
    form += ng.Variation(_energy(problem, u).Compile() * ng.dx)
    contact.Update(now, form, 2 * order, problem.width)
    steps = newton(form, now, "sparsecholesky")
    seconds = cpu_seconds() - start
    reaction = now.vec.CreateVector()
    form.Apply(now.vec, reaction)
    pushed = ng.GridFunction(space)
    pushed.Set(ng.CF((0, 1)), definedon=mesh.Boundaries("top"))
    places, deep = _overlap(problem, mesh, now, _evenly())
    # The penalty acts at the integration points alone.
    _, at_points = _overlap(problem, mesh, now, ng.IntegrationRule(ng.SEGM, 2 * order).points)
    return Answer(
        version=ng.__version__,
        dofs=space.ndof,
        solve_seconds=seconds,
        newton=steps,
        factorisations=steps,
        values={
            "force": -2 * float(ng.InnerProduct(reaction, pushed.vec)),
            "peak pressure": float(stiffness * at_points.max()),
            "half-width": float(crossing(places, deep)),
        },
    )


def _energy(problem: Pair, u: Any) -> Any:
    """Of plane strain, a unit of area."""
    import ngsolve as ng

    E, nu = problem.youngs_modulus, problem.poissons_ratio
    lame, shear = E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)
    strain = ng.Sym(ng.Grad(u))
    return lame / 2 * ng.Trace(strain) ** 2 + shear * ng.InnerProduct(strain, strain)


def _mesh(problem: Pair, level: int) -> Any:
    """Quadrilaterals of two rectangles; the upper one is bent afterwards."""
    import netgen.meshing as netgen

    mesh, lines = netgen.Mesh(dim=2), problem.lines(level)
    along, up = problem.upper_cells(level)
    lower = {"top": ["lower"], "bottom": ["far"], "right": ["far"], "left": ["axis"]}
    upper = {"top": ["top"], "bottom": ["upper"], "right": ["free"], "left": ["axis"]}
    numbers: dict[str, int] = {}
    add_rectangle(mesh, "lower body", lines, [-y for y in reversed(lines)], lower, numbers)
    across = [problem.width * n / along for n in range(along + 1)]
    high = [problem.height * n / up for n in range(up + 1)]
    add_rectangle(mesh, "upper body", across, high, upper, numbers)
    return mesh


def _bend(problem: Pair, mesh: Any) -> None:
    """The parabola, in the elements' own order 2."""
    import ngsolve as ng

    bent = ng.GridFunction(ng.VectorH1(mesh, order=2))
    low = ng.x**2 / (2 * problem.radius)
    raised = ng.CF((0, low * (1 - ng.y / problem.height)))
    bent.Set(raised, definedon=mesh.Materials("upper body"))
    mesh.SetDeformation(bent)


def _evenly() -> list[tuple[float]]:
    return [((number + 0.5) / _POINTS,) for number in range(_POINTS)]


def _overlap(problem: Pair, mesh: Any, now: Any, points: Any) -> tuple[Any, Any]:
    """Places along the upper surface, and how deep it lies in the lower one, along its normal."""
    import numpy as np

    up = _surface(mesh, now, "upper", points)
    low = _surface(mesh, now, "lower", _evenly())
    x, height = up[:, 0], up[:, 1]
    moved = [up[:, 2 + axis] - np.interp(x, low[:, 0], low[:, 2 + axis]) for axis in range(2)]
    slope = x / problem.radius
    return x, (slope * moved[0] - height - moved[1]) / np.sqrt(1 + slope**2)


def _surface(mesh: Any, now: Any, name: str, points: Any) -> Any:
    """x, y and displacement of points of a side, in order of x, (points, 4)."""
    import numpy as np

    rows = []
    for element in mesh.Boundaries(name).Elements():
        mapping = mesh.GetTrafo(element)
        for point in points:
            at = mapping(*point[:1])
            rows.append([*at.point, *now(at)])
    found = np.array(rows)
    return found[np.argsort(found[:, 0])]
