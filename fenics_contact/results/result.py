"""What a run found: plain data, global, the same on any number of ranks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from fenics_contact.common.errors import StoppedError
from fenics_contact.results.contact_answers import carries_shear, pressure_is_given
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.scene.quantity_names import OF_ONE_CONTACT

# Those that have a true value to be apart from; others count points, or say how a run went.
QUANTITIES = (
    "normal_force",
    "pressure_integral",
    "friction_force",
    "contact_force",
    "reaction",
    "indentation",
    "max_contact_pressure",
    "max_penetration",
    "contact_area",
    "stick_area",
    "slip_area",
    "contact_radius",
    "stick_radius",
    "max_slip",
    "strain_energy",
    "external_work",
    "friction_work",
    "penalty_energy",
)

# Of a quantity: a number, or the components of a vector.
QuantityValue = float | Sequence[float]


def has_true_value(name: str) -> bool:
    """Whether a quantity has a true value to be apart from: then an error bar, or a ``?``."""
    return name in QUANTITIES or name.startswith("displacement_")


# Those that say something only with friction, or where contact is found.
_OF_FRICTION = {
    *("friction_force", "stick_area", "slip_area", "stick_radius", "max_slip", "friction_work")
}
_OF_CONTACT_FOUND = {"indentation", "max_penetration"}


def idle_quantities(contacts: Sequence[Mapping[str, Any]]) -> set[str]:
    """Names of the quantities that say nothing about some contacts, and are not shown.

    Args:
        contacts: As in ``result.json``.
    """
    idle = set()
    if all(not carries_shear(contact) for contact in contacts):
        idle |= _OF_FRICTION
    if all(pressure_is_given(contact) for contact in contacts):
        idle |= _OF_CONTACT_FOUND
    return idle


@dataclass(frozen=True)
class Check:
    """A physics check: passed while the value stays at or below its limit.

    Attributes:
        value: Dimensionless.
        limit: What a right solution keeps.
        contact: The contact that comes nearest to failing; empty where it is of the whole.
        place: The point there, undeformed, (3,) (length); empty where it is of no point.
        kind: Which of several comparisons it is, by its name in ``check_messages``.
        part: The connected part of the body that it is of.
        parts: The check of every part, where there are several.

    >>> Check(value=1e-12, limit=1e-9).passed, Check(value=float("nan"), limit=1).passed
    (True, False)
    """

    value: float
    limit: float
    contact: str = ""
    place: tuple[float, ...] = ()
    kind: str = ""
    part: str = ""
    parts: tuple[Check, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether it holds; a value that is not a number fails."""
        return bool(self.value <= self.limit)

    def as_dict(self) -> dict[str, Any]:
        """For ``result.json``; what it compares and where it comes nearest is told once it fails.

        While it passes, that is often round-off, here or there.
        """
        found: dict[str, Any] = {"value": self.value, "limit": self.limit, "passed": self.passed}
        if self.parts:
            found["parts"] = {part.part: part.as_dict() for part in self.parts}
        if not self.passed:
            said = {"kind": self.kind, "contact": self.contact, "part": self.part}
            where = {**said, "place": list(self.place)}
            found |= {key: value for key, value in where.items() if value}
        return found


def reactions_by_name(supports: list[dict[str, Any]]) -> dict[str, list[float]]:
    """Resultant of the supports of each name.

    Args:
        supports: As in ``result.json``, where several may have the same; in older ones they have
            that of their group.
    """
    found: dict[str, list[float]] = {}
    for support in supports:
        name, reaction = support.get("name", support["on"]), support["reaction"]
        before = found.get(name, [0.0] * len(reaction))
        found[name] = [a + b for a, b in zip(before, reaction, strict=True)]
    return found


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """A run's outcome; its attributes are the keys of ``result.json``.

    There ``scene`` stands besides, the text of the scene that was solved, and ``passed``.

    Numbers are global: the same on every rank, and on any number of ranks.

    Attributes:
        title: That of the scene.
        converged: Whether Newton's method and the loop on friction came to an end.
        verdict: In words: whether to trust it, or what went wrong and what to try.
        model: What was solved: kinematics, degree, dofs, solver, energy terms, …
        contacts: Of each contact, in scene order: name, kind, law, parameters as they were used,
            and ``quantities`` of this contact alone.
        quantities: By name: resultants (force; vectors as lists, in the mesh's axes), areas,
            largest pressure (stress), lengths and energies. In plane models forces and areas are
            per thickness, in axisymmetric ones of a full turn. None where there is none, as of
            the forces of several contacts together.
        steps: Of each load step: its time, iterations, history of the force imbalance (force), and
            quantities.
        checks: Name → check of the physics.
        supports: Of each support: its name, its group, its reaction (force), the mean displacement
            of what it holds (length), and ``errors``.
        reactions: Name → ``reaction`` of all supports of that name together (force), and its
            ``errors``.
        timings: Phase → seconds.
        versions: Program or library → version.
        branches: All answers that were found, where the scene asks for others.
        levels: Meshes on the way, where the scene asks for an accuracy.
        accuracy: What it asked for, whether that was reached and, if not, why.
        errors: Quantity → source → estimated absolute error, and their ``total``; None where it
            was not estimated.
        error_notes: Sentences that say what was not, and why.
        points: The rows of ``contact.csv``; None if no load step was accepted.
        interrupted: Whether the user stopped the run; not among the keys.
    """

    title: str
    converged: bool
    verdict: str
    model: Mapping[str, Any]
    contacts: list[dict[str, Any]]
    quantities: Mapping[str, Any]
    steps: list[dict[str, Any]]
    checks: Mapping[str, Check]
    supports: list[dict[str, Any]] = field(default_factory=list)
    reactions: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    branches: list[dict[str, Any]] = field(default_factory=list)
    errors: Mapping[str, Any] = field(default_factory=dict)
    levels: list[dict[str, Any]] = field(default_factory=list)
    accuracy: Mapping[str, Any] = field(default_factory=dict)
    error_notes: list[str] = field(default_factory=list)
    timings: Mapping[str, float] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    points: ContactPoints | None = None
    interrupted: bool = False

    def __repr__(self) -> str:
        from fenics_contact.results.short_forms import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        """What notebooks show."""
        from fenics_contact.results.short_forms import as_html

        return as_html(self)

    @property
    def passed(self) -> bool:
        """Whether it converged, to the accuracy asked for, and every check holds."""
        return (
            self.is_accurate
            and self.converged
            and all(check.passed for check in self.checks.values())
        )

    @property
    def is_accurate(self) -> bool:
        """Whether the accuracy was reached, if one was asked for."""
        return bool(self.accuracy.get("reached", True))

    @property
    def exit_code(self) -> int:
        """0 passed, 3 not converged (or not to an accuracy), 4 a check failed, 130 interrupted."""
        if self.interrupted:
            return StoppedError.exit_code
        if not (self.converged and self.is_accurate):
            return 3
        return 0 if self.passed else 4

    def as_dict(self) -> dict[str, Any]:
        """For ``result.json``."""
        return {
            "title": self.title,
            "converged": self.converged,
            "passed": self.passed,
            "verdict": self.verdict,
            "model": dict(self.model),
            "contacts": self.contacts,
            "supports": self.supports,
            "reactions": dict(self.reactions),
            "quantities": dict(self.quantities),
            "steps": self.steps,
            "checks": {name: check.as_dict() for name, check in self.checks.items()},
            "branches": self.branches,
            "errors": dict(self.errors),
            **({"levels": self.levels, "accuracy": dict(self.accuracy)} if self.accuracy else {}),
            "error_notes": self.error_notes,
            "timings": dict(self.timings),
            "versions": dict(self.versions),
        }


# What answers of one scene are told apart by.
_OF_BRANCHES = ("normal_force", "friction_force", "stick_area", "slip_area")


def branch_rows(branches: list[dict[str, Any]]) -> list[list[Any]]:
    """A table of all answers that were found, its head first; empty where there is but one.

    Args:
        branches: Those of ``result.json``.
    """
    if len(branches) < 2:
        return []
    names = [name.replace("_", " ") for name, _ in _of_branch(branches[0])]
    rows: list[list[Any]] = [["answer from the start", *names, "checks"]]
    for branch in branches:
        numbers = [value for _, value in _of_branch(branch)]
        rows.append([branch["start"], *numbers, "ok" if branch["passed"] else "FAILED"])
    return rows


def _of_branch(branch: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Name and value of each number, resultants of several contacts contact by contact."""
    for key in _OF_BRANCHES:
        contacts = branch.get("contacts", [])
        if key in OF_ONE_CONTACT and len(contacts) > 1:
            for contact in contacts:
                yield f"{key} of '{contact['name']}'", contact["quantities"][key]
        else:
            yield key, branch["quantities"][key]


def without_value(name: str, quantities: Mapping[str, Any]) -> str:
    """Why a quantity of a contact has no value, in words.

    Args:
        name: Of the quantity.
        quantities: All of the contact, or of the whole model with this contact alone.
    """
    if quantities.get("pressure_integral") is None:
        return "not known"  # an earlier version of the program has not written it
    return {
        "normal_force": "none, the surface wraps around",
        "contact_radius": "none, no contact at the axis",
        "stick_radius": "none, no stick at the axis",
    }.get(name, "none")


def motion_words(motion: dict[str, Any]) -> str:
    """A rigid motion of ``model.rigid_motions``, and what may resist it."""
    return f"{motion['motion']}: resisted by {', '.join(motion['resisted_by']) or 'nothing'}"


def share_words(share: float) -> str:
    """The used share of a limit load: no scene at the limit is run, so none is said to be."""
    words = f"{share:.6g}"
    return "just below 1, the limit" if words == "1" else words


# In place of an error that was not estimated.
UNKNOWN = "?"


def error_bar(row: Mapping[str, float | None] | None) -> str:
    """The total of a row of ``errors``; ``?`` where it was not estimated, or not in full.

    Args:
        row: Source → error, and ``total``; None for a quantity that has none.
    """
    total = None if row is None else row["total"]
    return UNKNOWN if total is None else f"{total:.1e}"


def error_rows(errors: Mapping[str, Mapping[str, float | None]]) -> list[list[str]]:
    """A table of estimated errors by source, its head first; empty where there are none.

    Args:
        errors: By quantity, in words.
    """
    if not errors:
        return []
    sources = list(next(iter(errors.values())))
    rows = [["quantity", *sources]]
    for name, row in errors.items():
        cells = [UNKNOWN if value is None else f"{value:.1e}" for value in row.values()]
        rows.append([name, *cells])
    return rows
