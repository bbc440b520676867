"""Pictures and a page from the files of a run (``fenics-contact report``)."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path
from typing import Any

from fenics_contact.accuracy_words import level_rows
from fenics_contact.check_words import compares
from fenics_contact.errors import InputError
from fenics_contact.pictures import draw_pictures
from fenics_contact.result import (
    branch_rows,
    error_bar,
    error_rows,
    motion_words,
    reactions_by_group,
    share_words,
)
from fenics_contact.writing import replace_file

_OF_A_CONTACT = ("slave", "master", "slave_reason", "uniqueness_limit")
_OF_ERRORS = (
    "Absolute, in the units of the quantities, of vectors the length of the difference, by source: "
    "mesh, penalty ε₁, regularisation ε, what the iterations leave, load steps, and the piece of a "
    "half-space that is meshed. A ? was not estimated."
)
_PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font-family: sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }}
table {{ border-collapse: collapse; margin: 1rem 0; }}
td, th {{ padding: .2rem .8rem; border-bottom: 1px solid #ddd; text-align: left; }}
img {{ max-width: 100%; }}
.failed {{ color: #b00; font-weight: bold; }}
</style>
<h1>{title}</h1>
<p class="{verdict_class}">{verdict}</p>
<h2>Checks</h2>
{checks}
{branches}
{levels}
<h2>Quantities</h2>
{quantities}
{errors}
<h2>Reactions of supports</h2>
{supports}
<h2>Contacts</h2>
{contacts}
<h2>Pictures</h2>
{pictures}
<h2>Model</h2>
{model}
<h2>Time</h2>
{timings}
</html>
"""


def write_report(folder: Path) -> list[Path]:
    """Draw the pictures of a run and write ``report.html`` beside them.

    Args:
        folder: Output folder of a run.

    Returns:
        The files written.

    Raises:
        InputError: The folder holds no result, or one without an answer to draw.
    """
    result = read_result(folder)
    if not result["converged"]:
        raise InputError(f"{folder}: this run did not converge, so there is nothing to draw")
    pictures = [picture.path for picture in draw_pictures(folder, result)]
    page = folder / "report.html"
    replace_file(page, _page(result, pictures).encode())
    return [*pictures, page]


def read_result(folder: Path) -> dict[str, Any]:
    """The content of a run's ``result.json``.

    Raises:
        InputError: There is none, or it is not one of this program.
    """
    path = folder / "result.json"
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
        if not isinstance(result, dict) or "converged" not in result:
            raise ValueError("it lacks the key 'converged'")
        return result
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise InputError(f"{path}: not a result of this program: {error}") from None


def _page(result: dict[str, Any], pictures: list[Path]) -> str:
    checks = [["check", "value", "limit", "", "what is compared"]]
    for name, check in result["checks"].items():
        verdict = "ok" if check["passed"] else "FAILED"
        row = [_words(name), _written(check["value"]), _written(check["limit"]), verdict]
        checks.append([*row, compares(name)])
    passed = all(check["passed"] for check in result["checks"].values())
    passed &= result.get("accuracy", {}).get("reached", True)
    return _PAGE.format(
        title=escape(result["title"] or "Result"),
        verdict=escape(result["verdict"]),
        verdict_class="passed" if passed else "failed",
        checks=_table(checks),
        branches=_branches(result),
        levels=_levels(result),
        quantities=_table(_with_bars(result)),
        errors=_errors(result),
        supports=_table(_reactions(result["supports"])),
        contacts="\n".join(_contact(contact) for contact in result["contacts"]),
        pictures="\n".join(f'<p><img src="{p.name}" alt="{_words(p.stem)}"></p>' for p in pictures),
        model=_table(_rows(_model(result["model"]))),
        timings=_table(_rows(result["timings"])),
    )


def _branches(result: dict[str, Any]) -> str:
    """All answers that were found, where there are several."""
    rows = branch_rows(result.get("branches", []))
    if not rows:
        return ""
    cells = [[_written(cell) for cell in row] for row in rows]
    return f"<h2>Answers from other starts</h2>\n{_table(cells)}"


def _levels(result: dict[str, Any]) -> str:
    """Meshes and estimated errors on the way to an accuracy."""
    rows = level_rows(result.get("levels", []), result.get("accuracy", {}))
    return f"<h2>Meshes and estimated errors</h2>\n{_table(rows)}" if rows else ""


def _with_bars(found: dict[str, Any]) -> list[list[str]]:
    """Quantities of a result or a contact, each with its error bar where there are some."""
    errors, rows = found.get("errors"), _rows(found["quantities"])
    if not errors:
        return rows
    bars = [
        f"± {bar}" if (bar := error_bar(errors.get(name))) else "" for name in found["quantities"]
    ]
    return [[*row, bar] for row, bar in zip(rows, bars, strict=True)]


def _errors(result: dict[str, Any]) -> str:
    """Where the errors come from."""
    rows = error_rows(result.get("errors", {}))
    if not rows:
        return ""
    notes = "\n".join(f"<p>{escape(note)}</p>" for note in result.get("error_notes", []))
    return f"<h2>Estimated errors</h2>\n<p>{escape(_OF_ERRORS)}</p>\n{_table(rows)}\n{notes}"


def _model(model: dict[str, Any]) -> dict[str, Any]:
    """The model, with its free rigid motions and how near to the limit it is in words."""
    motions = [motion_words(motion) for motion in model.get("rigid_motions", [])]
    share = share_words(model.get("used_share_of_limit_load", 0.0))
    return model | {
        "rigid_motions": "; ".join(motions) or "none",
        "used_share_of_limit_load": share,
    }


def _reactions(supports: list[dict[str, Any]]) -> list[list[str]]:
    return [[name, _written(found)] for name, found in reactions_by_group(supports).items()]


def _contact(contact: dict[str, Any]) -> str:
    """A contact's own parameters and numbers."""
    kind = {"contact": contact["contact"], "friction law": contact["law"]}
    kind |= {key: contact[key] for key in _OF_A_CONTACT if key in contact}
    rows = [*_rows({**kind, **contact["parameters"]}), *_with_bars(contact)]
    return f"<h3>{escape(contact['name'])}</h3>\n{_table(rows)}"


def _rows(values: dict[str, Any]) -> list[list[str]]:
    return [[_words(key), _written(value)] for key, value in values.items()]


def _words(name: str) -> str:
    return name.replace("_", " ")


def _written(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        return ", ".join(_written(entry) for entry in value) or "none"
    return str(value)


def _table(rows: list[list[str]]) -> str:
    body = "\n".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table>\n{body}\n</table>"
