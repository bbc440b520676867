"""Tables of a run's page, from its ``result.json``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from markupsafe import Markup

from fenics_contact.quantities.names import REACTION, REACTION_MOMENT
from fenics_contact.quantities.table import (
    MEASURED_BY_PRELOADS,
    OF_SUPPORTS,
    QuantityValue,
    has_true_value,
    measured_by,
    resultants_of_contacts,
)
from fenics_contact.report.page.templates import bar, table, verdict
from fenics_contact.results.check_messages import WORDS, compares, failure, title
from fenics_contact.results.quantities import (
    coupling_rows,
    idle_quantities,
    measured_by_parameter,
    without_value,
)
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import ErrorRow, UnitsRecord
from fenics_contact.results.records.run import Model, Outcome, Seconds
from fenics_contact.results.records.steps import CheckRecord, StepRecord
from fenics_contact.results.result import check_of
from fenics_contact.results.rounding import rounded, sizes_of
from fenics_contact.results.tables import (
    error_rows,
    headed,
    motion_words,
    share_words,
)
from fenics_contact.scene.quantity_names import OF_PRELOADS

_OF_A_CONTACT = ("slave", "master", "slave_reason", "uniqueness_limit")
_MOST_STEPS = 60  # in a table; of more, the first, the last and the hardest


def checks_table(result: Outcome) -> Markup:
    """Every check with its value, its limit and how much of this it uses."""
    rows: list[list[str]] = [
        ["check", "", "value", "limit", "use of the limit", "what is compared"]
    ]
    for name, check in result.checks.items():
        numbers = [_short(check.value), _short(check.limit)]
        rows.append([title(name), verdict(check.passed), *numbers, _use(check), compares(name)])
    return table(rows, "Checks of the physics")


def _use(check: CheckRecord) -> Markup:
    """The value over its limit; a value that is not a number is null in the file."""
    value, limit = check.value, check.limit
    if value is None or not limit:
        return bar(0.0 if check.passed else 1.0, "", not check.passed)
    share = value / limit
    said = _percent(share) if 1e-4 <= share < 10 else f"{share:.1g} times"
    return bar(share, "below 0.01 %" if share < 1e-4 else said, not check.passed)


def failures(result: Outcome) -> list[str]:
    """Return for each failed check what is wrong, by how much, and where."""
    return [
        said for name, check in result.checks.items() if not check.passed
        for said in [_failure(name, check)]
    ]  # fmt: skip


def _failure(name: str, check: CheckRecord) -> str:
    found = check_of(check)
    if name not in WORDS or (WORDS[name].kinds and found.kind not in WORDS[name].kinds):
        return f"{title(name)}: {written(found.value)} exceeds the limit, {written(found.limit)}"
    return f"{failure(name, found)} (limit: {written(found.limit)})"


def quantities_table(
    found: Outcome | ContactRecord,
    contacts: list[ContactRecord],
    caption: str,
    run: Outcome,
) -> Markup:
    """Quantities with their error bars where there are some, without those that say nothing.

    Args:
        found: A result or a contact.
        contacts: That it is of.
        caption: Of the table.
        run: That all is of.
    """
    idle, errors = idle_quantities(contacts), found.errors
    quantities = found.quantities
    units, sizes = run.units, sizes_of(run.quantities, run.contacts)
    if len(contacts) > 1:  # each has its own table
        idle |= set(resultants_of_contacts())
    head = ["value", *(["unit"] if units else []), *(_BARS if errors else ())]
    rows: list[list[str]] = [["quantity", *head]]
    for name in [name for name in quantities if name not in idle]:
        value = quantities[name]
        cells = [without_value(name)]
        if value is not None and errors and (name in errors or has_true_value(name)):
            cells = _with_bar(value, errors.get(name), sizes[measured_by(name)])
        elif value is not None:
            cells = [written(value)]
        if units:
            cells.insert(1, "" if value is None else units.of(measured_by(name)))
        rows.append([words(name), *cells, *[""] * (len(head) - len(cells))])
    return table(rows, caption)


_BARS = ("± estimated error", "relative")
_MOMENT = measured_by(REACTION_MOMENT)


def _with_bar(value: float | list[float], row: ErrorRow | None, size: float) -> list[str]:
    """A value, its error bar, and what share that is of the value, of vectors of their length."""
    said, width = rounded(value, row, size)
    if row is None or row["total"] is None or not width:
        return [said, width, width]
    length = math.hypot(*value) if isinstance(value, list) else abs(value)
    share = _percent(row["total"] / length) if length else ""
    return [said, f"± {width}", share]


def _percent(share: float) -> str:
    """With two digits, and no powers of ten where there are more."""
    percent = 100 * share
    return f"{percent:.2g} %" if percent < 99.5 else f"{percent:.0f} %"


def errors_table(result: Outcome) -> Markup:
    """Where the errors come from; nothing where none were estimated.

    With those of each contact and each support where there are several; without what was given, or
    is 0 by symmetry, which has no error but round-off.
    """
    idle, units = idle_quantities(result.contacts), result.units
    sizes = sizes_of(result.quantities, result.contacts)

    def named(key: str, of: str = "") -> str:
        return headed(words(key) + of, measured_by(key), units)

    found: list[tuple[str, str, QuantityValue | None, ErrorRow]] = [
        (key, "", result.quantities.get(key), row)
        for key, row in result.errors.items()
        if key not in idle
    ]
    for contact in result.contacts if len(result.contacts) > 1 else ():
        of = f" of {contact.name}"
        for key in (
            key for key in resultants_of_contacts() if key in contact.errors and key not in idle
        ):
            found.append((key, of, contact.quantities.get(key), contact.errors[key]))
    sizes = {**sizes, _MOMENT: max(sizes[_MOMENT], _largest_moment(result))}
    for name, reaction in result.reactions.items():
        for key, row in reaction.errors.items():
            if key != REACTION or len(result.reactions) > 1:
                found.append((key, f" of {name}", reaction.quantities.get(key), row))
    errors = {
        named(key, of): row
        for key, of, value, row in found
        if value is None or rounded(value, row, sizes[measured_by(key)])[1]
    }
    rows = error_rows(errors)
    return table(rows, "Estimated errors by source") if rows else Markup()


def reactions_table(result: Outcome) -> Markup:
    """Resultants and moments of the supports of each name, with error bars; nothing without any."""
    every = result.reactions.values()
    has_bars = any(of.errors.get(REACTION) is not None for of in every)
    sizes = {
        REACTION: sizes_of(result.quantities, result.contacts)["force"],
        REACTION_MOMENT: _largest_moment(result),
    }
    names = [key for key in OF_SUPPORTS if any(key in of.quantities for of in every)]
    cells = 3 if has_bars else 1
    rows: list[list[str]] = [["support"]]
    for key in names:
        rows[0] += [headed(words(key), measured_by(key), result.units), *_BARS[: cells - 1]]
    for name, of in result.reactions.items():
        row = [name]
        for key in names:
            row += _with_bar(of.quantities[key], of.errors.get(key), sizes[key])[:cells]
        rows.append(row)
    return table(rows, "Reactions of supports") if result.reactions else Markup()


def _largest_moment(result: Outcome) -> float:
    """Largest component of the moments of reactions (force times length)."""
    return sizes_of({}, result.reactions.values())[_MOMENT]


def preloads_table(result: Outcome) -> Markup:
    """Force and elongation of every preload, with error bars; nothing without any."""
    has_bars = any(preload.errors for preload in result.preloads.values())
    names = [headed(name, MEASURED_BY_PRELOADS[name], result.units) for name in OF_PRELOADS]
    bars = [cell for name in names for cell in (name, *(_BARS[:1] if has_bars else ()))]
    rows: list[list[str]] = [["preload", *bars, "locked"]]
    for name, preload in result.preloads.items():
        row = [name]
        for quantity in OF_PRELOADS:
            said = rounded(preload[quantity], preload.errors.get(quantity))
            row += said[: 2 if has_bars else 1]
        rows.append([*row, written(preload.locked)])
    return table(rows, "Preloads") if result.preloads else Markup()


def couplings_table(result: Outcome) -> Markup:
    """Motion of every coupling, and the force and moment on it; nothing without any."""
    bars = 1 if any(one.errors for one in result.couplings) else 0
    units = 1 if result.units else 0
    rows = [["", "value", *_BARS[:bars], *(["unit"] * units)]]
    for row in coupling_rows(result):
        rows.append([row.name, row.value, *([row.bar] * bars), *([row.unit] * units)])
    return table(rows, "Couplings") if result.couplings else Markup()


def model_table(model: Model) -> Markup:
    """The model, with its free rigid motions and how near to the limit it is in words."""
    motions = [motion_words(motion) for motion in model.rigid_motions]
    said = {
        **model,
        "rigid_motions": "; ".join(motions) or "none",
        "used_share_of_limit_load": share_words(model.used_share_of_limit_load),
    }
    return plain_table(said, "The model")


def contact_table(contact: ContactRecord, units: UnitsRecord | None) -> Markup:
    """A contact's own parameters.

    Args:
        contact: The contact.
        units: Of the run, if any.
    """
    kind = {"contact": contact.contact, "friction law": contact.law}
    kind |= {key: contact[key] for key in _OF_A_CONTACT if key in contact}
    used = {
        headed(words(name), measured_by_parameter(name), units): value
        for name, value in contact.parameters.items()
    }
    return plain_table({**kind, **used}, f"Contact '{contact.name}'")


def steps_table(steps: list[StepRecord], units: UnitsRecord | None) -> Markup:
    """Load steps with their iterations and the imbalance that was left.

    Args:
        steps: All of them.
        units: Of the run, if any.
    """
    rows = [["step", "time", "Newton steps", "passes of the loop on the pressure"]]
    imbalances = ("imbalance before", "at the end", "accepted")
    rows[0] += ["contraction", *(headed(name, "force", units) for name in imbalances)]
    rows += [row for _, row in _shown(steps)]
    return table(rows, "Load steps")


def _shown(steps: list[StepRecord]) -> Iterator[tuple[int, list[str]]]:
    """Rows of the load steps, of very many only some."""
    numbers = range(len(steps))
    if len(steps) > _MOST_STEPS:
        hardest = sorted(numbers, key=lambda n: -steps[n].newton_iterations)[:20]
        numbers = sorted({*numbers[:20], *numbers[-20:], *hardest})  # type: ignore[assignment]
    for number in numbers:
        step = steps[number]
        history = step.residual_history or [None]
        limit, contraction = step.imbalance_limit, step.outer_contraction
        yield (
            number,
            [
                str(number + 1),
                written(step.load_factor),
                str(step.newton_iterations),
                str(step.outer_iterations),
                "" if contraction is None else f"{contraction:.2g}",
                *("" if x is None else f"{x:.2e}" for x in (history[0], history[-1], limit)),
            ],
        )


def timings_table(timings: Seconds) -> Markup:
    """Seconds by phase, with bars of their shares."""
    rows: list[list[str]] = [["phase", "seconds", "share"]]
    total = timings.total
    for name, seconds in timings.items():
        share = seconds / total if total else 0.0
        said = "" if name == "total" else bar(share, f"{100 * share:.0f} %")
        rows.append([words(name), f"{seconds:.3g}", said])
    return table(rows, "Seconds by phase")


def plain_table(values: Mapping[str, object], caption: str) -> Markup:
    """Names and values."""
    return table([[words(key), written(value)] for key, value in values.items()], caption, False)


def plain_rows(rows: Sequence[Sequence[object]], caption: str) -> Markup:
    """Rows of values, the first of which names the columns."""
    return table([[written(cell) for cell in row] for row in rows], caption)


def words(name: str) -> str:
    """A key as text."""
    return name.replace("_", " ")


def _short(value: float | None) -> str:
    return "not a number" if value is None else f"{value:.3g}"


def written(value: object) -> str:
    """A value as text."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(written(entry) for entry in value) or "none"
    return str(value)
