"""NGSolve's model of a rigid paraboloid on a block in 3D; of ``ngsolve_energies``."""

from __future__ import annotations

from itertools import product
from typing import Any

from answers import Answer, cpu_seconds
from problems import Block

# Corners of a square, one after the other.
_AROUND = ((0, 0), (1, 0), (1, 1), (0, 1))


def solve_block(problem: Block, level: int, setting: dict[str, Any], newton: Any) -> Answer:
    """All load steps.

    Args:
        problem: The problem.
        level: Of the mesh.
        setting: Order and penalties over E/h.
        newton: Newton's method from what is there, on a form with a solver; how many steps it took.
    """
    import ngsolve as ng

    model = _Model(problem, level, setting)
    start = cpu_seconds()
    form, steps = model.form(), 0
    for step in range(1, problem.steps + 1):
        model.reached.Set(problem.indentation * step / problem.steps)
        model.before.vec.data = model.now.vec
        steps += newton(form, model.now, "umfpack" if problem.friction else "sparsecholesky")
        if step < problem.steps:
            model.keep_traction()
    seconds = cpu_seconds() - start
    return Answer(
        version=ng.__version__,
        dofs=model.space.ndof,
        solve_seconds=seconds,
        newton=steps,
        factorisations=steps,
        values=model.values(),
    )


class _Model:
    def __init__(self, problem: Block, level: int, setting: dict[str, Any]):
        import ngsolve as ng
        from ngsolve.comp import IntegrationRuleSpaceSurface

        self.problem, self.size, order = problem, problem.size(level), setting["order"]
        self.mesh = ng.Mesh(_mesh(problem, level))
        self.space = ng.VectorH1(
            self.mesh,
            order=order,
            **{"dirichletx": "x0|outer", "dirichlety": "y0|outer", "dirichletz": "outer"},
        )
        self.now, self.before = ng.GridFunction(self.space), ng.GridFunction(self.space)
        points = IntegrationRuleSpaceSurface(self.mesh, order=2 * order)
        self.shear = [ng.GridFunction(points) for _ in range(2)]
        self.found = ng.GridFunction(points)
        self.rules = points.GetIntegrationRules()
        scale = problem.youngs_modulus / self.size
        self.stiffness, self.along = setting["penalty"] * scale, setting.get("along", 0.0) * scale
        self.reached = ng.Parameter(0.0)

    def pressure(self, u: Any) -> Any:
        """Of the penalty, where the body reaches into the obstacle."""
        import ngsolve as ng

        squares = ng.x**2 + ng.y**2
        overlap = u[2] - squares / (2 * self.problem.radius) + self.reached
        return self.stiffness * ng.IfPos(overlap, overlap, 0)

    def traction(self, u: Any) -> list[Any]:
        """Along the surface, on the obstacle: Coulomb's law by return mapping."""
        import ngsolve as ng

        trial = [self.shear[axis] + self.along * (u[axis] - self.before[axis]) for axis in range(2)]
        bound = self.problem.friction * self.pressure(u)
        size = ng.sqrt(trial[0] ** 2 + trial[1] ** 2 + 1e-20)
        share = ng.IfPos(size - bound, bound / size, 1)
        return [share * one for one in trial]

    def form(self) -> Any:
        """The residual, whose derivative is taken by NGSolve."""
        import ngsolve as ng

        problem, rough = self.problem, self.problem.friction > 0
        u, v = self.space.TnT()
        E, nu = problem.youngs_modulus, problem.poissons_ratio
        lame, shear = E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)
        strain = ng.Sym(ng.Grad(u))
        energy = lame / 2 * ng.Trace(strain) ** 2 + shear * ng.InnerProduct(strain, strain)
        form = ng.BilinearForm(self.space, symmetric=not rough)
        form += ng.Variation(energy.Compile() * ng.dx)
        on = ng.ds("contact", intrules=self.rules)
        if rough:
            held = self.traction(u)
            work = self.pressure(u) * v[2] + held[0] * v[0] + held[1] * v[1]
            form += work.Compile() * on
        else:
            overlap = self.pressure(u)
            form += ng.Variation((overlap**2 / (2 * self.stiffness)).Compile() * on)
        return form

    def keep_traction(self) -> None:
        """For the next load step."""
        on = self.mesh.Boundaries("contact")
        kept = []
        for one in self.traction(self.now):
            self.found.Interpolate(one, definedon=on)
            kept.append(self.found.vec.FV().NumPy().copy())
        for shear, values in zip(self.shear, kept, strict=True):
            shear.vec.FV().NumPy()[:] = values

    def values(self) -> dict[str, float]:
        """Force of all quarters, and the peak at integration points and nodes in the middle."""
        import ngsolve as ng
        import numpy as np

        pressure = self.pressure(self.now)
        on = ng.ds("contact", intrules=self.rules)
        places = self.size * (np.arange(20) + 0.5) / 20
        x, y = (grid.ravel() for grid in np.meshgrid(places, places))
        overlap = (
            self.problem.indentation
            + self.now.components[2]
            - (ng.x**2 + ng.y**2) / (2 * self.problem.radius)
        )
        found = overlap(self.mesh(x, y, np.full_like(x, -1e-12)))
        return {
            "force": 4 * float(ng.Integrate(pressure * on, self.mesh)),
            "peak pressure": float(self.stiffness * np.max(found)),
        }


def _mesh(problem: Block, level: int) -> Any:
    """Hexahedra between the problem's lines."""
    import netgen.meshing as netgen

    mesh, lines = netgen.Mesh(dim=3), problem.lines(level)
    count = len(lines) - 1
    points = {}
    for x, y, z in product(range(count + 1), repeat=3):
        place = netgen.Pnt(lines[x], lines[y], -lines[z])
        points[x, y, z] = mesh.Add(netgen.MeshPoint(place))

    def corners(axis: int, at: int, first: int, second: int) -> list[Any]:
        """Of a side of a cell, around it."""
        found = []
        for one, other in _AROUND:
            place = [first + one, second + other]
            place.insert(axis, at)
            found.append(points[tuple(place)])
        return found

    body = mesh.AddRegion("body", dim=3)
    for x, y, z in product(range(count), repeat=3):
        below, above = corners(2, z + 1, x, y), corners(2, z, x, y)
        mesh.Add(netgen.Element3D(body, [*below, *above]))
    numbers: dict[str, int] = {}

    def side(name: str, nodes: list[Any]) -> None:
        if name not in numbers:
            numbers[name] = mesh.AddRegion(name, dim=2)
        mesh.Add(netgen.Element2D(numbers[name], nodes))

    fine = level
    for first, second in product(range(count), repeat=2):
        side("x0", corners(0, 0, first, second))
        side("y0", corners(1, 0, first, second))
        top = "contact" if max(first, second) < fine else "free"
        side(top, corners(2, 0, first, second))
        for axis in range(3):
            side("outer", corners(axis, count, first, second))
    return mesh
