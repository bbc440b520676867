"""What a case of error bars is: a model on several meshes and with several parameters.

The reference is a formula that is exact for what is modelled, or the same model on much finer
meshes with the smallest parameters, found in the same command twice: how far the two references
are apart says how good they are. A row is left out where that is not a tenth of its true or its
estimated error, whichever is larger: whether the bar holds cannot be said then. (A tenth of the
bar alone would leave out bars that are far too short.)
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from fenics_contact.contact.laws.normal import law_of
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.quantities import table
from fenics_contact.results.records.record import Quantities
from fenics_contact.scene.scene import Discretisation, Scene

Element = Literal["P1", "Q1", "P2", "Q2"]
Role = Literal["chosen", "tested"]

SOURCES = ("mesh", "penalty", "regularisation", "iteration", "step", "domain")
# Relative; what a quantity may be off by round-off where it is given, or zero by symmetry.
_ROUND_OFF = 1e-9
_DECISIVE = 0.1
# What says how good a run is, and is none of its results.
_DIAGNOSTICS = ("undecided_points", "energy_defect", "slip_since_pairing", "closed_gap")
# What the method adds, and is nothing in the limit ε₁ → 0: all of it is error, as its bar says.
# Left out where that is so, as bars that hold by themselves would make up for others.
_OF_PENALTIES = ("max_penetration", "penalty_energy")
# Nearly the same number as the normal force: counted where there is none, else it counted thrice.
_THE_SAME = ("pressure_integral", "contact_force")


@dataclass(frozen=True)
class Model:
    """A scene, and its mesh if the scene does not name one."""

    scene: Scene
    body: Body | None = None


@dataclass(frozen=True)
class Parameters:
    """ε and ε₁ of all contacts; ``None`` is the automatic one.

    Attributes:
        regularisation: ε (length).
        penalty: ε₁ (length/stress).
    """

    regularisation: float | None = None
    penalty: float | None = None


@dataclass(frozen=True)
class BarCase:
    """A model whose error bars are compared with its true errors.

    Attributes:
        name: For the command line.
        summary: One line.
        source: Where the reference comes from.
        role: Whether constants of the estimators were ``chosen`` by it, or are ``tested``.
        model: By element, number of cells along some length, and load.
        elements: To run.
        cells: By degree, coarse to fine.
        parameters: Small to large.
        loads: Each mesh takes another one with each of the parameters, so that the contact's edge
            is at different places in its cell.
        exact: Quantities by load, as a formula has them; or
        finer: the model by how fine (0 or 1) and load, with automatic parameters.
        left_out: Quantities that the reference has not.
        quick: Whether it is in ``--quick``.
    """

    name: str
    summary: str
    source: str
    role: Role
    model: Callable[[Element, int, float], Model]
    elements: tuple[Element, ...]
    parameters: tuple[Parameters, Parameters, Parameters]
    cells: Mapping[int, tuple[int, int, int]] = field(
        default_factory=lambda: {1: (2, 4, 8), 2: (1, 2, 4)}
    )
    loads: tuple[float, ...] = (1.0,)
    exact: Callable[[float], Quantities] | None = None
    finer: Callable[[int, float], Model] | None = None
    left_out: tuple[str, ...] = ()
    quick: bool = False

    def runs(self, quick: bool) -> list[Setting]:
        """All combinations of meshes and parameters; of the quick version four."""
        count = 2 if quick else 3
        return [
            Setting(
                element,
                self.cells[int(element[1])][mesh],
                level,
                self.loads[(mesh + level) % len(self.loads)],
            )
            for element in (self.elements[:1] if quick else self.elements)
            for mesh in range(count)
            for level in range(count)
        ]

    def model_of(self, setting: Setting) -> Model:
        """What is run."""
        model = self.model(setting.element, setting.cells, setting.load)
        scene = with_parameters(model.scene, self.parameters[setting.level])
        return dataclasses.replace(model, scene=scene)


@dataclass(frozen=True)
class Setting:
    """A run of a case: element, number of cells, which of the parameters, load."""

    element: Element
    cells: int
    level: int
    load: float


@dataclass(frozen=True)
class Reference:
    """What quantities should be, and how far each of them may be off."""

    quantities: Quantities
    doubt: Mapping[str, float]


@dataclass(frozen=True)
class Row:
    """A quantity of a run.

    Attributes:
        case: Its case.
        setting: Its run.
        quantity: Its name.
        error: The true one, ≥ 0 (the quantity's unit; of vectors the length of the difference).
        doubt: How far the reference may be off.
        size: Of the reference.
        sources: Estimated errors by source, and their ``total``; None where there is no estimate.
    """

    case: BarCase
    setting: Setting
    quantity: str
    error: float
    doubt: float
    size: float
    sources: Mapping[str, float | None]

    @property
    def total(self) -> float | None:
        """The estimated error, None where there is none."""
        return self.sources.get("total")

    @property
    def held(self) -> bool:
        """Whether the true error is within the bar."""
        return self.total is not None and self.error <= self.total

    @property
    def ratio(self) -> float:
        """Estimated over true error."""
        assert self.total is not None
        return self.total / self.error if self.error else float("inf")

    @property
    def is_given(self) -> bool:
        """Whether neither true nor estimated error are more than round-off."""
        return max(self.error, self.total or 0.0) <= _ROUND_OFF * self.size

    @property
    def is_decided(self) -> bool:
        """Whether the reference is good enough to tell."""
        return self.doubt <= _DECISIVE * max(self.error, self.total or 0.0)

    @property
    def counts(self) -> bool:
        """Whether it is among those that are counted."""
        return self.total is not None and self.is_decided and not self.is_given


def rows_of(
    case: BarCase,
    setting: Setting,
    quantities: Quantities,
    errors: Mapping[str, Mapping[str, float | None]],
    reference: Reference,
) -> list[Row]:
    """A row for every quantity that has both a bar and a reference."""
    known = reference.quantities
    force = size_of(known.get("normal_force") or known.get("pressure_integral") or 0.0)
    found = []
    for name, sources in errors.items():
        if name in case.left_out or name in _DIAGNOSTICS or name not in reference.quantities:
            continue
        if name in _THE_SAME and "normal_force" in known:
            continue
        expected = reference.quantities[name]
        if name in _OF_PENALTIES and not expected:
            continue
        # Components of forces that vanish by symmetry are measured in the largest.
        size = max(size_of(expected), force if table.is_vector(name) else 0.0)
        error = size_of(np.subtract(quantities[name], expected))
        doubt = reference.doubt.get(name, 0.0)
        found.append(Row(case, setting, name, error, doubt, size, sources))
    return found


def without_penalties(scene: Scene, quantities: Quantities) -> dict[str, Any]:
    """Those that a fine model has, with what penalties add set to none, as in the limit."""
    found = {name: value for name, value in quantities.items() if value is not None}
    if all(law_of(contact).has_penalty for contact in scene.contact):
        found |= dict.fromkeys(_OF_PENALTIES, 0.0)
    return found


def size_of(value: Any) -> float:
    """Of a number or a vector."""
    return float(np.linalg.norm(value))


def with_parameters(scene: Scene, parameters: Parameters) -> Scene:
    """The scene with other ε and ε₁ where it has them."""
    changed = []
    for contact in scene.contact:
        if contact.friction_coefficient != 0 and parameters.regularisation is not None:
            contact = dataclasses.replace(
                contact, regularisation_parameter=parameters.regularisation
            )
        if law_of(contact).has_penalty and parameters.penalty is not None:
            contact = dataclasses.replace(contact, penalty_parameter=parameters.penalty)
        changed.append(contact)
    return dataclasses.replace(scene, contact=tuple(changed))


def of_element(scene: Scene, element: Element) -> Scene:
    """The scene with another element; its meshes are plane and made from geometries."""
    cell: Literal["triangle", "quadrilateral"] = (
        "triangle" if element.startswith("P") else "quadrilateral"
    )
    degree = int(element[1])  # of degree 1 no cells may be curved
    meshes = (
        dataclasses.replace(mesh, cell=cell, order=min(mesh.order, degree)) for mesh in scene.mesh
    )
    return dataclasses.replace(scene, mesh=tuple(meshes), discretisation=Discretisation(degree))
