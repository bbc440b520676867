"""NGSolve: energies of the bulk and of the contact by penalty, Newton's method, a direct solver."""

from __future__ import annotations

import math
from typing import Any

from answers import Answer, cpu_seconds, crossing, sample_places
from problems import Block, Indentation, Pair, Problem, Slab

from programs.ngsolve_block import solve_block
from programs.ngsolve_mesh import rectangle
from programs.ngsolve_pair import solve_pair

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
    "block": {
        "order 2, penalty 30 E/h": {"order": 2, "penalty": 30.0},
        "order 2, penalty 300 E/h": {"order": 2, "penalty": 300.0},
    },
    "rough block": {
        "order 2, penalty 100 E/h, along 10 E/h": {"order": 2, "penalty": 100.0, "along": 10.0},
    },
    "pair": {
        "order 2, penalty 30 E/h": {"order": 2, "penalty": 30.0},
        "order 2, penalty 300 E/h": {"order": 2, "penalty": 300.0},
    },
    "slab": {
        "order 2, penalty 10 E/h": {"order": 2, "penalty": 10.0},
        "order 2, penalty 1000 E/h": {"order": 2, "penalty": 1e3},
        "order 3, penalty 100 E/h": {"order": 3, "penalty": 100.0},
    },
}
ABOUT = (
    "An energy of penalty on the boundary, as its tutorials on contact have it (a rigid obstacle "
    "has no second surface for `ContactBoundary`), with friction by return mapping at the "
    "integration points. Newton's method, stopped at 1e-9 of the displacement; for the slab "
    "`NewtonMinimization` with its line search. Every step assembles and factorises all unknowns: "
    "by its sparse Cholesky, with Coulomb friction by UMFPACK, since the matrix is not symmetric "
    "then. One thread."
)
_STEPS, _TOLERANCE, _ENERGY = 60, 1e-9, 1e-8


def solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    """On the problem's lines."""
    if isinstance(problem, Slab):
        return _slab(problem, level, setting)
    if isinstance(problem, Block):
        return solve_block(problem, level, setting, _newton)
    if isinstance(problem, Pair):
        return solve_pair(problem, level, setting, _newton)
    return _Model(problem, level, setting).answer()


class _Model:
    """Of a rigid paraboloid on an axisymmetric body."""

    def __init__(self, problem: Indentation, level: int, setting: dict[str, Any]):
        import ngsolve as ng
        from ngsolve.comp import IntegrationRuleSpaceSurface

        mesh = ng.Mesh(_mesh(problem, level))
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
            solver = "umfpack" if problem.friction else "sparsecholesky"
            self.newton += _newton(form, self.now, solver)
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
    places = problem.lines(level)
    fine = sum(place < problem.fine * (1 - 1e-9) for place in places)
    outwards = len(places) - 1 - fine
    sides = {
        "top": ["contact"] * fine + ["free"] * outwards,
        **{"bottom": ["outer"], "right": ["outer"], "left": ["axis"]},
    }
    return rectangle(places, [-place for place in reversed(places)], sides)


def _slab(problem: Slab, level: int, setting: dict[str, Any]) -> Answer:
    """Friction with a given bound has an energy, quadratic up to the bound."""
    import ngsolve as ng
    import numpy as np

    sides = {name: [name] for name in ("top", "bottom", "right", "left")}
    mesh = ng.Mesh(rectangle(*problem.lines(level), sides))
    start = cpu_seconds()
    size, order = problem.size(level), setting["order"]
    space = ng.VectorH1(mesh, order=order, dirichletx="left", dirichlety="bottom")
    stiffness = setting["penalty"] * problem.youngs_modulus / size
    now = ng.GridFunction(space)
    newton = _minimise(_slab_form(problem, space, stiffness), now)
    seconds = cpu_seconds() - start
    places = np.array(sample_places(problem.length, size))
    slip = now.components[0](mesh(places, np.full_like(places, problem.height)))[:, 0]
    bound = problem.friction * problem.pressure
    held = _held(stiffness * now.components[0], bound)
    force = ng.Integrate(held, mesh, ng.BND, order=2 * order, definedon=mesh.Boundaries("top"))
    return Answer(
        version=ng.__version__,
        dofs=space.ndof,
        solve_seconds=seconds,
        newton=newton,
        factorisations=newton,
        values={
            "friction force": -force,
            "strain energy": ng.Integrate(_slab_energy(problem, now) * ng.dx, mesh),
            "stick length": float(crossing(places, bound - np.abs(stiffness * slip))),
        },
    )


def _slab_form(problem: Slab, space: Any, stiffness: float) -> Any:
    """All energies."""
    import ngsolve as ng

    u = space.TrialFunction()
    form = ng.BilinearForm(space, symmetric=True)
    form += ng.Variation(_slab_energy(problem, u).Compile() * ng.dx)
    held = _held(stiffness * u[0], problem.friction * problem.pressure)
    rubbing = held * u[0] - held**2 / (2 * stiffness)
    form += ng.Variation((rubbing + problem.pressure * u[1]).Compile() * ng.ds("top"))
    form += ng.Variation(problem.pressure * u[0] * ng.ds("right"))
    return form


def _slab_energy(problem: Slab, u: Any) -> Any:
    """Of plane stress, a unit of area."""
    import ngsolve as ng

    E, nu = problem.youngs_modulus, problem.poissons_ratio
    slope = ng.Grad(u)
    trace, twice = slope[0, 0] + slope[1, 1], slope[0, 1] + slope[1, 0]
    squares = slope[0, 0] ** 2 + slope[1, 1] ** 2 + twice**2 / 2
    return E * nu / (1 - nu**2) / 2 * trace**2 + E / 2 / (1 + nu) * squares


def _held(drawn: Any, bound: float) -> Any:
    """What friction holds of what draws at it."""
    import ngsolve as ng

    return ng.IfPos(drawn - bound, bound, ng.IfPos(-drawn - bound, -bound, drawn))


def _minimise(form: Any, now: Any) -> int:
    """NGSolve's own Newton's method for energies, with its line search; how many steps it took."""
    from ngsolve.solvers import NewtonMinimization

    failed, steps = NewtonMinimization(
        form,
        now,
        maxit=_STEPS,
        maxerr=_ENERGY,
        inverse="sparsecholesky",
        linesearch=True,
        printing=False,
    )
    if failed:
        raise RuntimeError(f"no convergence in {_STEPS} Newton steps")
    return int(steps)


def _newton(form: Any, now: Any, solver: str) -> int:
    """Newton's method from what is there; how many steps it took."""
    space = form.space
    residual, change = now.vec.CreateVector(), now.vec.CreateVector()
    for step in range(1, _STEPS + 1):
        form.Apply(now.vec, residual)
        form.AssembleLinearization(now.vec)
        change.data = form.mat.Inverse(space.FreeDofs(), inverse=solver) * residual
        now.vec.data -= change
        if change.Norm() <= _TOLERANCE * now.vec.Norm():
            return step
    raise RuntimeError(f"no convergence in {_STEPS} Newton steps")
