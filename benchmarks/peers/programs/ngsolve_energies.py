"""NGSolve: energies of the bulk and of the contact by penalty, Newton's method, a direct solver."""

from __future__ import annotations

import math
from typing import Any

from answers import Answer, cpu_seconds, crossing, sample_places
from problems import Indentation

NAME = "NGSolve"
INSTALL = ("pip", ("ngsolve==6.2.2608",))
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "indentation": {
        "order 2, penalty 30 E/h": {"order": 2, "penalty": 30.0},
        "order 2, penalty 300 E/h": {"order": 2, "penalty": 300.0},
        "order 3, penalty 100 E/h": {"order": 3, "penalty": 100.0},
    },
    "friction": {
        "order 2, penalty 30 E/h, along 10 E/h": {"order": 2, "penalty": 30.0, "along": 10.0},
        "order 2, penalty 100 E/h, along 10 E/h": {"order": 2, "penalty": 100.0, "along": 10.0},
    },
}
ABOUT = (
    "An energy of penalty on the boundary, as its tutorials on contact have it (a rigid obstacle "
    "has no second surface for `ContactBoundary`), with friction by return mapping at the "
    "integration points. Newton's method, stopped at 1e-9 of the displacement; every step "
    "assembles and factorises all unknowns: its sparse Cholesky without friction, UMFPACK "
    "with friction, since the matrix is not symmetric then. One thread."
)
_STEPS, _TOLERANCE = 60, 1e-9


def solve(problem: Indentation, level: int, setting: dict[str, Any]) -> Answer:
    """On the problem's lines."""
    import ngsolve

    return _Model(problem, level, setting, ngsolve.Mesh(_mesh(problem, level))).answer()


class _Model:
    """Of a rigid paraboloid on an axisymmetric body."""

    def __init__(self, problem: Indentation, level: int, setting: dict[str, Any], mesh: Any):
        import ngsolve as ng
        from ngsolve.comp import IntegrationRuleSpaceSurface

        self.problem, self.mesh, self.size = problem, mesh, problem.size(level)
        order = setting["order"]
        self.space = ng.VectorH1(mesh, order=order, dirichletx="axis|outer", dirichlety="outer")
        self.now, self.before = ng.GridFunction(self.space), ng.GridFunction(self.space)
        points = IntegrationRuleSpaceSurface(mesh, order=2 * order)
        self.shear, self.place = ng.GridFunction(points), ng.GridFunction(points)
        self.found = ng.GridFunction(points)
        self.rules = points.GetIntegrationRules()
        scale = problem.youngs_modulus / self.size
        self.stiffness, self.along = setting["penalty"] * scale, setting.get("along", 0.0) * scale
        self.reached = ng.Parameter(0.0)
        self.newton = 0

    def pressure(self, u: Any) -> Any:
        """Of the penalty, where the body reaches into the obstacle."""
        import ngsolve as ng

        overlap = u[1] - ng.x**2 / (2 * self.problem.radius) + self.reached
        return self.stiffness * ng.IfPos(overlap, overlap, 0)

    def traction(self, u: Any) -> Any:
        """Along the surface, on the obstacle: Coulomb's law by return mapping."""
        import ngsolve as ng

        trial = self.shear + self.along * (u[0] - self.before[0])
        bound = self.problem.friction * self.pressure(u)
        size = ng.IfPos(trial, trial, -trial)
        return ng.IfPos(size - bound, ng.IfPos(trial, bound, -bound), trial)

    def forms(self) -> Any:
        """The residual, whose derivative is taken by NGSolve."""
        import ngsolve as ng

        problem, rough = self.problem, self.problem.friction > 0
        u, v = self.space.TnT()
        E, nu = problem.youngs_modulus, problem.poissons_ratio
        lame, shear = E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)
        slope = ng.Grad(u)
        hoop, twice = u[0] / ng.x, slope[0, 1] + slope[1, 0]
        trace = slope[0, 0] + slope[1, 1] + hoop
        squares = slope[0, 0] ** 2 + slope[1, 1] ** 2 + hoop**2 + twice**2 / 2
        form = ng.BilinearForm(self.space, symmetric=not rough)
        form += ng.Variation(((lame / 2 * trace**2 + shear * squares) * ng.x * ng.dx).Compile())
        on = ng.ds("contact", intrules=self.rules)
        if rough:
            work = self.pressure(u) * v[1] + self.traction(u) * v[0]
            form += (work * ng.x).Compile() * on
        else:
            overlap = self.pressure(u)
            form += ng.Variation((overlap**2 / (2 * self.stiffness) * ng.x).Compile() * on)
        return form

    def answer(self) -> Answer:
        """All load steps."""
        import ngsolve as ng

        problem = self.problem
        start = cpu_seconds()
        form = self.forms()
        for step in range(1, problem.steps + 1):
            self.reached.Set(problem.indentation * step / problem.steps)
            self.before.vec.data = self.now.vec
            self._newton(form)
            traction = self.traction(self.now)
            self.found.Interpolate(traction, definedon=self.mesh.Boundaries("contact"))
            if step < problem.steps:
                self.shear.vec.data = self.found.vec
        seconds = cpu_seconds() - start
        return Answer(
            version=ng.__version__,
            dofs=self.space.ndof,
            solve_seconds=seconds,
            newton=self.newton,
            factorisations=self.newton,
            values=self._values(),
        )

    def _newton(self, form: Any) -> None:
        residual, change = self.now.vec.CreateVector(), self.now.vec.CreateVector()
        solver = "umfpack" if self.problem.friction else "sparsecholesky"
        for _ in range(_STEPS):
            form.Apply(self.now.vec, residual)
            form.AssembleLinearization(self.now.vec)
            change.data = form.mat.Inverse(self.space.FreeDofs(), inverse=solver) * residual
            self.now.vec.data -= change
            self.newton += 1
            if change.Norm() <= _TOLERANCE * self.now.vec.Norm():
                return
        raise RuntimeError(f"no convergence in {_STEPS} Newton steps")

    def _values(self) -> dict[str, float]:
        import ngsolve as ng
        import numpy as np

        problem = self.problem
        pressure = self.pressure(self.now)
        on = ng.ds("contact", intrules=self.rules)
        force = 2 * math.pi * ng.Integrate(pressure * ng.x * on, self.mesh)
        places = np.array(sample_places(problem.fine, self.size))
        gap = problem.indentation + self.now.components[1] - ng.x**2 / (2 * problem.radius)
        overlap = gap(self.mesh(places, np.full_like(places, -1e-12)))[:, 0]
        values = {
            "force": force,
            "peak pressure": self.stiffness * overlap.max(),
            "contact radius": crossing(list(places), list(overlap)),
        }
        if problem.friction:
            values["stick radius"] = self._stick_radius(pressure)
        return {name: float(value) for name, value in values.items()}

    def _stick_radius(self, pressure: Any) -> float:
        """Up to the last integration point whose friction is below its bound."""
        import ngsolve as ng
        import numpy as np

        on = self.mesh.Boundaries("contact")
        traction = np.abs(self.found.vec.FV().NumPy().copy())
        self.place.Interpolate(ng.x, definedon=on)
        radii = self.place.vec.FV().NumPy().copy()
        self.found.Interpolate(pressure, definedon=on)
        bound = self.problem.friction * self.found.vec.FV().NumPy()
        order = np.argsort(radii)
        order = order[bound[order] > 0]
        sticks = traction[order] < bound[order] * (1 - 1e-6)
        last = int(np.nonzero(sticks)[0].max())
        return float(radii[order[last : last + 2]].mean())


def _mesh(problem: Indentation, level: int) -> Any:
    """Quadrilaterals between the problem's lines."""
    import netgen.meshing as netgen

    places = problem.lines(level)
    last = len(places) - 1
    mesh = netgen.Mesh(dim=2)
    points = [[mesh.Add(netgen.MeshPoint(netgen.Pnt(x, -y, 0.0))) for x in places] for y in places]
    body = mesh.AddRegion("body", dim=2)
    contact, free, outer, axis = (
        mesh.AddRegion(name, dim=1) for name in ("contact", "free", "outer", "axis")
    )
    for below, above in zip(points[1:], points[:-1], strict=True):
        for i in range(last):
            corners = [below[i], below[i + 1], above[i + 1], above[i]]
            mesh.Add(netgen.Element2D(body, corners))
    for n in range(last):
        top = contact if places[n + 1] <= problem.fine * (1 + 1e-9) else free
        mesh.Add(netgen.Element1D([points[0][n + 1], points[0][n]], index=top))
        mesh.Add(netgen.Element1D([points[last][n], points[last][n + 1]], index=outer))
        mesh.Add(netgen.Element1D([points[n + 1][last], points[n][last]], index=outer))
        mesh.Add(netgen.Element1D([points[n][0], points[n + 1][0]], index=axis))
    return mesh
