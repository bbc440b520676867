"""GetFEM: contact by multipliers, augmented Lagrangian, in its language of weak forms; MUMPS."""

from __future__ import annotations

import math
import subprocess
from typing import Any

from answers import Answer, cpu_seconds, crossing, sample_places
from problems import Block, Indentation, Pair, Problem, Slab

from programs.getfem_block import solve_block
from programs.getfem_newton import pressed, solved
from programs.getfem_pair import solve_pair

NAME = "GetFEM"
INSTALL = ("apt", ("python3-getfem", "libopenblas0-serial"))
_TRIED = {f"r = {r:g} E": {"augmentation": r} for r in (1.0, 10.0)}
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    "indentation": _TRIED,
    "friction": _TRIED,
    "block": _TRIED,
    "rough block": _TRIED,
    "pair": _TRIED,
    "slab": _TRIED,
}
ABOUT = (
    "Quadratic displacements and linear multipliers, augmented Lagrangian after Alart and Curnier "
    "with the projections of its language of weak forms (its bricks for rigid obstacles are not "
    "axisymmetric), Newton's method with its line search; every step factorises all unknowns by "
    "MUMPS. The bulk is assembled once. One thread, with OpenBLAS."
)
_CONTACT, _OUTER, _AXIS = 1, 2, 3
_BULK = (
    "X(1)*(first*(Div_u+u(1)/X(1))*(Div_Test_u+Test_u(1)/X(1))"
    "+2*shear*(Sym(Grad_u):Sym(Grad_Test_u)+u(1)*Test_u(1)/sqr(X(1))))"
)
# The obstacle's surface is at sqr(x)/(2 curvature) - d; p and t are what it does to the body.
_PRESSED = "(p+r*(u(2)-sqr(X(1))/(2*curvature)+d))"
_PRESSURE = f"pos_part{_PRESSED}"
_TRIAL, _BOUND = "(t+r*(u(1)-old(1)))", f"(mu*{_PRESSURE})"
_FRICTION = f"max(min({_TRIAL},{_BOUND}),-{_BOUND})"


def solve(problem: Problem, level: int, setting: dict[str, Any]) -> Answer:
    """On the problem's lines."""
    if isinstance(problem, Slab):
        return _slab(problem, level, setting["augmentation"])
    if isinstance(problem, Block):
        return solve_block(problem, level, setting["augmentation"], _version)
    if isinstance(problem, Pair):
        return solve_pair(problem, level, setting["augmentation"], _version)
    return _Model(problem, level, setting["augmentation"]).answer()


class _Model:
    """Of a rigid paraboloid on an axisymmetric body."""

    def __init__(self, problem: Indentation, level: int, augmentation: float):
        import getfem
        import numpy as np

        getfem.util_trace_level(0)
        getfem.util_warning_level(0)
        self.problem, self.size, self.getfem = problem, problem.size(level), getfem
        self.augmentation = augmentation
        places = np.array(problem.lines(level))
        self.mesh = getfem.Mesh("cartesian", places, -places[::-1])
        self._name_sides()

    def _name_sides(self) -> None:
        import numpy as np

        end, fine, close = self.problem.extent, self.problem.fine * (1 + 1e-9), 1e-6
        faces = self.mesh.outer_faces_in_box
        self.mesh.set_region(_CONTACT, faces([-close, -close], [fine, close]))
        side = faces([end - close, -end - close], [end + close, close])
        bottom = faces([-close, -end - close], [end + close, close - end])
        self.mesh.set_region(_OUTER, np.hstack((side, bottom)))
        self.mesh.set_region(_AXIS, faces([-close, -end - close], [close, close]))

    def _model(self) -> Any:
        getfem, problem = self.getfem, self.problem
        space, multipliers = getfem.MeshFem(self.mesh, 2), getfem.MeshFem(self.mesh, 1)
        space.set_fem(getfem.Fem("FEM_QK(2,2)"))
        multipliers.set_fem(getfem.Fem("FEM_QK(2,1)"))
        points = getfem.MeshIm(self.mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,4)"))
        model = getfem.Model("real")
        model.add_fem_variable("u", space)
        model.add_fem_data("old", space)
        E, nu = problem.youngs_modulus, problem.poissons_ratio
        data = {"first": E * nu / (1 + nu) / (1 - 2 * nu), "shear": E / 2 / (1 + nu), "d": 0.0}
        data |= {"r": self.augmentation * E, "curvature": problem.radius, "mu": problem.friction}
        for name, value in data.items():
            model.add_initialized_data(name, [value])
        model.add_linear_term(points, _BULK)
        model.add_Dirichlet_condition_with_simplification("u", _OUTER)
        model.add_linear_term(points, f"{1e6 * E}*u(1)*Test_u(1)", _AXIS)
        for name in ("p", "t") if problem.friction else ("p",):
            model.add_filtered_fem_variable(name, multipliers, _CONTACT)
        work = f"{_PRESSURE}*Test_u(2)-(p-{_PRESSURE})*Test_p/r"
        if problem.friction:
            work += f"+{_FRICTION}*Test_u(1)-(t-{_FRICTION})*Test_t/r"
        model.add_nonlinear_term(points, f"X(1)*({work})", _CONTACT)
        self.space, self.points = space, points
        return model

    def answer(self) -> Answer:
        """All load steps."""
        start = cpu_seconds()
        model = self._model()
        newton = pressed(model, self.problem)
        return Answer(
            version=_version(),
            dofs=self.space.nbdof(),
            solve_seconds=cpu_seconds() - start,
            newton=newton,
            factorisations=newton,
            values=self._values(model),
        )

    def _values(self, model: Any) -> dict[str, float]:
        import numpy as np

        places = sample_places(self.problem.fine, self.size)
        line = np.vstack((places, np.full(len(places), -1e-12)))

        def along(expression: str) -> Any:
            """On the contact's line, from the values in the cells."""
            return model.interpolation(expression, line, self.mesh)

        total = self.getfem.asm_generic(self.points, 0, f"X(1)*{_PRESSURE}", _CONTACT, model)
        pressure = along(_PRESSURE)
        values = {
            "force": 2 * math.pi * total,
            "peak pressure": max(pressure),
            "contact radius": crossing(places, along(_PRESSED)),
        }
        if self.problem.friction:
            margin = along(f"{_BOUND}-abs({_TRIAL})")
            values["stick radius"] = crossing(places, margin)
        return {name: float(value) for name, value in values.items()}


def _version() -> str:
    """Of Debian's package; the module does not say its own."""
    query = ["dpkg-query", "--show", "--showformat=${source:Upstream-Version}", "python3-getfem"]
    return subprocess.run(query, capture_output=True, text=True, check=True).stdout.split("+")[0]


_TOP, _BOTTOM, _RIGHT, _LEFT = 1, 2, 3, 4
_RUBBED = "max(min(t+r*u(1),g),-g)"


def _slab(problem: Slab, level: int, augmentation: float) -> Answer:
    """Friction with a given bound: a multiplier that stays below it."""
    import getfem
    import numpy as np

    getfem.util_trace_level(0)
    getfem.util_warning_level(0)
    mesh = _slab_mesh(problem, level)
    start = cpu_seconds()
    points = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,4)"))
    model, dofs = _slab_model(problem, mesh, points, augmentation)
    newton = solved(model)
    seconds = cpu_seconds() - start
    places = sample_places(problem.length, problem.size(level))
    line = np.vstack((places, np.full(len(places), problem.height - 1e-12)))
    margin = model.interpolation("g-abs(t+r*u(1))", line, mesh)
    energy = "(first/2*sqr(Div_u)+shear*(Sym(Grad_u):Sym(Grad_u)))"
    values = {
        "friction force": -getfem.asm_generic(points, 0, _RUBBED, _TOP, model),
        "strain energy": getfem.asm_generic(points, 0, energy, -1, model),
        "stick length": crossing(places, margin),
    }
    return Answer(
        version=_version(),
        dofs=dofs,
        solve_seconds=seconds,
        newton=newton,
        factorisations=newton,
        values={name: float(value) for name, value in values.items()},
    )


def _slab_mesh(problem: Slab, level: int) -> Any:
    import getfem
    import numpy as np

    mesh = getfem.Mesh("cartesian", *(np.array(places) for places in problem.lines(level)))
    end, roof, close = problem.length, problem.height, 1e-6
    for region, low, high in (
        (_TOP, (0.0, roof), (end, roof)),
        (_BOTTOM, (0.0, 0.0), (end, 0.0)),
        (_RIGHT, (end, 0.0), (end, roof)),
        (_LEFT, (0.0, 0.0), (0.0, roof)),
    ):
        faces = mesh.outer_faces_in_box([c - close for c in low], [c + close for c in high])
        mesh.set_region(region, faces)
    return mesh


def _slab_model(problem: Slab, mesh: Any, points: Any, augmentation: float) -> tuple[Any, int]:
    """The model, and how many unknowns its displacement has."""
    import getfem

    space, multipliers = getfem.MeshFem(mesh, 2), getfem.MeshFem(mesh, 1)
    space.set_fem(getfem.Fem("FEM_QK(2,2)"))
    multipliers.set_fem(getfem.Fem("FEM_QK(2,1)"))
    model = getfem.Model("real")
    model.add_fem_variable("u", space)
    model.add_filtered_fem_variable("t", multipliers, _TOP)
    E, nu = problem.youngs_modulus, problem.poissons_ratio
    data = {"first": E * nu / (1 - nu**2), "shear": E / 2 / (1 + nu), "r": augmentation * E}
    data |= {"pressed": problem.pressure, "g": problem.friction * problem.pressure}
    for name, value in data.items():
        model.add_initialized_data(name, [value])
    model.add_linear_term(points, "first*Div_u*Div_Test_u+2*shear*(Sym(Grad_u):Sym(Grad_Test_u))")
    model.add_linear_term(points, f"{1e6 * E}*u(2)*Test_u(2)", _BOTTOM)
    model.add_linear_term(points, f"{1e6 * E}*u(1)*Test_u(1)", _LEFT)
    model.add_source_term(points, "-pressed*Test_u(1)", _RIGHT)
    model.add_source_term(points, "-pressed*Test_u(2)", _TOP)
    model.add_nonlinear_term(points, f"{_RUBBED}*Test_u(1)-(t-{_RUBBED})*Test_t/r", _TOP)
    return model, space.nbdof()
