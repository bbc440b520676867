"""The page of a run: all it has to say, in one file that needs nothing else to be shown."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from typing import Any

from fenics_contact.common.program import PAPER, PROGRAM, bibtex
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.page.html import (
    Html,
    bullets,
    data_uri,
    element,
    html,
    joined,
    paragraph,
    table,
)
from fenics_contact.report.page.tables import (
    checks_table,
    contact_table,
    errors_table,
    failures,
    model_table,
    plain_table,
    quantities_table,
    reactions_table,
    steps_table,
    timings_table,
    written,
)
from fenics_contact.results.accuracy_messages import level_rows
from fenics_contact.results.result import branch_rows

_OF_ERRORS = (
    "Absolute, in the units of the quantities, of vectors the length of the difference, by source: "
    "mesh, penalty ε₁, regularisation ε, what the iterations leave, load steps, and the piece of a "
    "half-space that is meshed. A ? was not estimated."
)
_OF_STEPS = (
    "The imbalance is the sum of all nodal forces that are out of balance, before the first Newton "
    "step and after the last, and the one that counts as none. Outer passes are those of the loop "
    "on the pressure; a pass multiplies differences by the contraction, and below 1 the loop "
    "settles by itself."
)
_TO_TRY = (
    "What the verdict above says comes first: it knows where the run ended.",
    "More load steps (steps.number), or steps.automatic = true, which cuts those that fail.",
    "An imbalance that still falls in the history below: a larger solver.max_iterations.",
    "One that goes to and fro: a finer mesh at the contact, or a larger regularisation_parameter.",
    "One that grows: supports, units, and signs of loads. fenics-contact check says what is held.",
)


@dataclass(frozen=True)
class Content:
    """What a page is made of.

    Attributes:
        name: Of the run's folder.
        result: The content of its ``result.json``.
        keeps_scene: Whether the folder's ``scene.toml`` is what was solved.
        pictures: What was drawn of the fields.
        convergence: What was drawn of the iterations.
        view: The interactive view, empty where there are no fields.
    """

    name: str
    result: dict[str, Any]
    keeps_scene: bool
    pictures: list[Picture]
    convergence: list[Picture]
    view: Html


def page(content: Content) -> str:
    """The whole page."""
    title = content.result["title"] or content.name
    sections = [section for section in _sections(content) if section[2]]
    links = joined(element("a", name, href=f"#{key}") for key, name, _ in sections)
    body = joined(
        element("section", joined([element("h2", name), inner]), id=key)
        for key, name, inner in sections
    )
    style = resources.files(__package__).joinpath("report.css").read_text(encoding="utf-8")
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html(title)}</title>
<link rel="icon" href="data:,">
<style>
{style}</style>
</head>
<body>
<header>
<h1>{html(title)}</h1>
{_verdict(content.result)}
</header>
<nav aria-label="Contents">
{links}
</nav>
<main>
{body}
</main>
</body>
</html>
"""


def _sections(content: Content) -> Iterator[tuple[str, str, Html]]:
    """Key, name and inner part of each section; those with nothing in them are left out."""
    result = content.result
    yield "advice", "What to try", _advice(result)
    yield "checks", "Checks", _checks(result)
    yield "quantities", "Quantities and errors", _quantities(result)
    yield "pictures", "Pictures", joined(_figure(picture) for picture in content.pictures)
    yield "view-3d", "Interactive view", content.view
    yield "scene", "Scene", element("pre", result["scene"], tabindex="0")
    yield "model", "Model", model_table(result["model"])
    yield "contacts", "Contacts", joined(contact_table(one) for one in result["contacts"])
    yield "iterations", "Iterations", _iterations(content)
    yield "timings", "Time", timings_table(result["timings"])
    yield "versions", "Versions", plain_table(result["versions"], "Versions")
    yield "cite", "How to cite", _citation()
    yield "reproduce", "How to reproduce", _reproduction(content)


def _verdict(result: dict[str, Any]) -> Html:
    """In large what came out, then in words; of checks that failed, each by itself."""
    trusted, wrong = result["passed"], failures(result)
    if trusted:
        said = f"✓ OK: converged, and all {len(result['checks'])} checks passed"
    elif not result["converged"]:
        said = "✗ Not converged"
    elif wrong:
        said = f"✗ Not to be trusted: {len(wrong)} of {len(result['checks'])} checks failed"
    else:
        said = "✗ Not as accurate as was asked for"
    parts = [element("strong", said), paragraph(result["verdict"]), bullets(wrong)]
    kind = f"verdict {'ok' if trusted else 'bad'}"
    return element("div", joined(part for part in parts if part), kind=kind, role="status")


def _advice(result: dict[str, Any]) -> Html:
    """Of a run that did not converge: what was tried, and what to try."""
    if result["converged"]:
        return Html()
    attempts = result["steps"][-1].get("attempts", []) if result["steps"] else []
    parts = [bullets(_TO_TRY)]
    if attempts:
        parts += [paragraph("The ways that were tried, and how each ended:"), bullets(attempts)]
    if result["checks"]:
        parts.append(
            paragraph("All that follows is of the last load step that was done, not of the end.")
        )
    return joined(parts)


def _checks(result: dict[str, Any]) -> Html:
    """The checks, other answers, and the meshes on the way to an accuracy."""
    parts = [checks_table(result)] if result["checks"] else []
    branches = branch_rows(result.get("branches", []))
    if branches:
        cells = [[written(cell) for cell in row] for row in branches]
        parts += [element("h3", "Answers from other starts"), table(cells, "Answers")]
    levels = level_rows(result.get("levels", []), result.get("accuracy", {}))
    if levels:
        parts += [element("h3", "Meshes and estimated errors"), table(levels, "Meshes")]
    return joined(parts)


def _quantities(result: dict[str, Any]) -> Html:
    """What came out, how far from the truth it may be, and why."""
    if not result["quantities"]:
        return Html()
    parts = [quantities_table(result, result["contacts"], "Quantities")]
    errors = errors_table(result)
    notes = [paragraph(note) for note in result.get("error_notes", [])]
    if errors:
        parts += [element("h3", "Where the errors come from"), paragraph(_OF_ERRORS), errors]
    parts += notes
    reactions = reactions_table(result)
    if reactions:
        parts += [element("h3", "Reactions of supports"), reactions]
    return joined(parts)


def _figure(picture: Picture) -> Html:
    name, address = html(picture.path.name), data_uri(picture.path)
    image = Html(f'<img src="{address}" alt="{html(picture.title)}" data-file="{name}">')
    words = joined([element("b", f"{picture.title}."), picture.caption], " ")
    return element("figure", joined([image, element("figcaption", words)]))


def _iterations(content: Content) -> Html:
    """Load steps, and how the imbalance went."""
    steps = content.result["steps"]
    if not steps:
        return Html()
    last = steps[-1].get("residual_history", [])
    numbers = element("pre", ", ".join(f"{x:.3e}" for x in last) or "none", tabindex="0")
    history = joined([element("summary", "Imbalance in the last load step, by numbers"), numbers])
    figures = [_figure(picture) for picture in content.convergence]
    return joined([paragraph(_OF_STEPS), steps_table(steps), *figures, element("details", history)])


def _citation() -> Html:
    said = [paragraph("Please cite the paper whose method this is, and the program:")]
    return joined([*said, bullets([PAPER, PROGRAM]), element("pre", bibtex(), tabindex="0")])


def _reproduction(content: Content) -> Html:
    """The command that makes the run again."""
    ranks = content.result["model"].get("ranks", 1)
    launched = f"mpirun -n {ranks} " if ranks > 1 else ""
    if content.result["scene"].startswith("# This file cannot be run"):
        return paragraph("A script made this run, of what a scene file cannot hold: run it again.")
    if content.keeps_scene:
        file, words = "scene.toml", "In the folder of this run, whose scene.toml is the scene above"
    else:
        file = "solved.toml"
        words = f"Save the scene above as {file} in the folder of this run, and there"
    words += (
        "; the meshes' files are where it says. Numbers are those of the versions above, but for "
        "round-off."
    )
    command = f"{launched}fenics-contact run {file} --out again"
    return joined([paragraph(words), element("pre", command, tabindex="0")])
