"""Run the demos and write the pages of the gallery: ``python docs/make_gallery.py [NAME …]``.

Every demo's scene is solved as users solve it, by a process of its own. A run is used
again while neither the scene, nor the meshes, nor the package changed. A demo that fails, or gives
other numbers than ``gallery_entries`` expects, ends this with an error: so it fails the build of
the documentation, which calls ``make_all``.

Drawing takes longer than solving. Where the environment variable ``DRAWN`` names demos, as
``DRAWN="slab sphere"`` does, the pages of the others have their numbers, and no pictures.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path

from fenics_contact.report.report import write_report
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.run import RunRecord
from fenics_contact.results.result import read_result
from fenics_contact.results.rounding import rounded
from fenics_contact.verification.case import Finding

sys.path.insert(0, str(Path(__file__).resolve().parent))
from gallery_entries import ENTRIES, Entry, Solved, Variant

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
RUNS = DOCS / "_build" / "runs"
PAGES = DOCS / "gallery"
REPORTS = DOCS / "_build" / "extra" / "reports"
TIME_LIMIT = 600  # seconds a demo
NOT_DRAWN = "Pictures, and the report of the run, were left out of this build."


class GalleryError(Exception):
    """A demo failed, or its numbers are not what they should be."""


def demos() -> list[str]:
    """Names of the demos, in the order of the gallery.

    Raises:
        GalleryError: A demo has no entry, or an entry no demo.
    """
    found = {path.stem for path in (ROOT / "demos").glob("*.toml")}
    if found != set(ENTRIES):
        raise GalleryError(
            f"docs/gallery_entries.py and demos/ differ: {sorted(found ^ set(ENTRIES))}"
        )
    return list(ENTRIES)


def drawn() -> set[str]:
    """Names of the demos whose pages have pictures: by default all.

    Raises:
        GalleryError: ``DRAWN`` names what is no demo.
    """
    asked = set(os.environ.get("DRAWN", "").split())
    if unknown := asked - set(ENTRIES):
        raise GalleryError(f"DRAWN: no demos: {', '.join(sorted(unknown))}")
    return asked or set(ENTRIES)


def fingerprint(files: Iterable[Path]) -> str:
    """Of what a run depends on: the package, the meshes, and some files."""
    digest = sha256()
    for path in [*_package(), *sorted((ROOT / "meshes").glob("*")), *files]:
        if path.is_file():
            digest.update(path.relative_to(ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _package() -> list[Path]:
    """The package's own files, the page's style and script among them; not what Python makes."""
    every = sorted((ROOT / "fenics_contact").rglob("*"))
    return [path for path in every if "__pycache__" not in path.parts]


def run(name: str, folder: Path, overrides: Sequence[str], with_report: bool) -> None:
    """Solve a demo's scene into a folder, unless that holds the same run already.

    Args:
        name: Of the demo.
        folder: For the run, and its report.
        overrides: As for ``--set``.
        with_report: Whether to make its report.

    Raises:
        GalleryError: It did not end with exit code 0.
    """
    scene = ROOT / "demos" / f"{name}.toml"
    mark = folder / "fingerprint"
    wanted = "\n".join([fingerprint([scene]), *overrides, *(["report"] if with_report else [])])
    if mark.is_file() and mark.read_text(encoding="utf-8") == wanted:
        return
    shutil.rmtree(folder, ignore_errors=True)
    settings = [part for override in overrides for part in ("--set", override)]
    command = [sys.executable, "-m", "fenics_contact"]
    _call([*command, "run", str(scene), *settings, "--out", str(folder)])
    if with_report:
        _call([sys.executable, str(Path(__file__)), "--draw", str(folder)])
    mark.write_text(wanted, encoding="utf-8")


def draw(folder: Path) -> None:
    """Write the report of a run, and what its pictures show to ``pictures.json``."""
    said = [
        {"file": picture.path.name, "title": picture.title, "caption": picture.caption}
        for picture in write_report(folder)
    ]
    (folder / "pictures.json").write_text(json.dumps(said), encoding="utf-8")


def _call(command: list[str]) -> None:
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=TIME_LIMIT,
        env=environment,
        check=False,
    )
    if done.returncode != 0:
        raise GalleryError(
            f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        )


def make_all(names: Sequence[str] = ()) -> None:
    """Run demos, two at a time, and write their pages.

    Raises:
        GalleryError: One of them failed.
    """
    every = demos()
    names = names or every
    shutil.rmtree(PAGES, ignore_errors=True)
    PAGES.mkdir()
    runs: list[tuple[str, Path, Sequence[str], bool]] = []
    pictured = drawn()
    for name in names:
        runs.append((name, RUNS / name, (), name in pictured))
        for number, variant in enumerate(ENTRIES[name].variants):
            runs.append((name, RUNS / f"{name}_{number}", variant.overrides, False))
        if ENTRIES[name].film and name in pictured:
            runs.append((name, RUNS / f"{name}_film", ENTRIES[name].film, True))
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda one: run(*one), runs))
    for name in names:
        text = page(name, ENTRIES[name], name in pictured)
        (PAGES / f"{name}.md").write_text(text, encoding="utf-8")
    (PAGES / "index.md").write_text(overview(names), encoding="utf-8")


def page(name: str, entry: Entry, with_pictures: bool) -> str:
    """The page of a demo, in Markdown.

    Args:
        name: Of the demo.
        entry: Its numbers.
        with_pictures: Whether it has pictures, and its report; copies these beside it.
    """
    solved = _read(RUNS / name)
    first, others = _pictures(name, entry) if with_pictures else ([NOT_DRAWN, ""], [])
    lines = [problem(name), "", *first]
    lines += ["## Expected and obtained", "", _table(entry.findings(solved), f"demos/{name}.toml")]
    lines += ["", f"Expected values: {entry.source}.", ""]
    for number, variant in enumerate(entry.variants):
        lines += _variant(name, variant, _read(RUNS / f"{name}_{number}"))
    return "\n".join([*lines, *_how_it_went(solved.result), *others, *_scene(name)])


def _pictures(name: str, entry: Entry) -> tuple[list[str], list[str]]:
    """A demo's first picture, and its report with all others, in Markdown."""
    folder, shown = RUNS / name, PAGES / name
    pictures = json.loads((folder / "pictures.json").read_text(encoding="utf-8"))
    shown.mkdir()
    for picture in pictures:
        shutil.copy(folder / picture["file"], shown)
    (REPORTS / name).mkdir(parents=True, exist_ok=True)
    shutil.copy(folder / "report.html", REPORTS / name)
    others = [
        f'<p><a href="../reports/{name}/report.html">The report of this run</a>: checks, errors by '
        "source, an interactive view, reactions, timings.</p>",
        "",
        "## Pictures",
        "",
        *(line for picture in pictures[1:] for line in _figure(name, picture)),
        *_film(name, entry.film),
    ]
    return _figure(name, pictures[0]), others


def _film(name: str, overrides: Sequence[str]) -> list[str]:
    """The animations of a run with more load steps, and how to make it."""
    if not overrides:
        return []
    folder = RUNS / f"{name}_film"
    lines = ["## As the loads grow", ""]
    for picture in json.loads((folder / "pictures.json").read_text(encoding="utf-8")):
        if picture["file"].startswith("animation"):
            shutil.copy(folder / picture["file"], PAGES / name)
            lines += _figure(name, picture)
    run_it = f"fenics-contact run demos/{name}.toml{_set(overrides)} --out results/{name}_film"
    return [*lines, "```sh", run_it, f"fenics-contact report results/{name}_film", "```", ""]


def _set(overrides: Sequence[str]) -> str:
    """Values for the command line."""
    return "".join(f" --set '{override}'" for override in overrides)


def _scene(name: str) -> list[str]:
    """The scene of a demo, and how to run it."""
    return [
        "## The scene",
        "",
        "```sh",
        f"fenics-contact run demos/{name}.toml --out results/{name}",
        f"fenics-contact report results/{name}",
        "```",
        "",
        f"```{{literalinclude}} ../../demos/{name}.toml",
        ":language: toml",
        "```",
        "",
        f"The same in Python, `demos/demo_{name}.py`:",
        "",
        f"```{{literalinclude}} ../../demos/demo_{name}.py",
        ":language: python",
        "```",
        "",
    ]


def problem(name: str) -> str:
    """The problem of a demo in words, with its formulas, in Markdown; a heading first."""
    return (DOCS / "problems" / f"{name}.md").read_text(encoding="utf-8").strip()


def _figure(name: str, picture: dict[str, str]) -> list[str]:
    """A picture, or an animation, with what it shows."""
    return [
        f"```{{figure}} {name}/{picture['file']}",
        f":alt: {_one_line(picture['title'])}",
        "",
        f"**{picture['title']}.** {picture['caption']}",
        "```",
        "",
    ]


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _read(folder: Path) -> Solved:
    return Solved(read_result(folder), ContactTable.read(folder / "contact.csv"))


def _variant(name: str, variant: Variant, solved: Solved) -> list[str]:
    scene = f"demos/{name}.toml{_set(variant.overrides)}"
    return [
        f"**{variant.title}**: `fenics-contact run {scene}`",
        "",
        _table(variant.findings(solved), scene),
        "",
    ]


def _table(findings: Iterable[Finding], said_of: str) -> str:
    """Expected and obtained, side by side.

    Raises:
        GalleryError: They differ by more than the entry allows.
    """
    rows = ["| quantity | expected | obtained | error | error bar |", "|---|---|---|---|---|"]
    for found in findings:
        if not found.passed:
            raise GalleryError(
                f"{said_of}: {found.quantity} is {found.value:g}, but should be "
                f"{found.reference:g} within {found.tolerance:g}"
            )
        error = f"{found.error:.2g}" if found.absolute else f"{100 * found.error:.2g} %"
        value, bar = rounded(found.value, {"total": found.bar})
        bar = bar if found.bar is None or not bar else f"± {bar}"
        rows.append(f"| {found.quantity} | {found.reference:.6g} | {value} | {error} | {bar} |")
    return "\n".join(rows)


def _how_it_went(result: RunRecord) -> list[str]:
    model, timings = result.model, result.timings
    newton = sum(step.newton_iterations for step in result.steps)
    steps = len(result.steps)
    return [
        result.verdict,
        "",
        "| unknowns | contact points | load steps | Newton steps | seconds, of which solving |",
        "|---|---|---|---|---|",
        f"| {model.dofs} | {model.contact_points} | {steps} | {newton} | "
        f"{timings.total:.1f}, {timings.solve + timings.factorise:.1f} |",
        "",
        "Seconds are those of the machine that built this page, on one core; forms that have to be "
        "compiled first take a few more.",
        "",
    ]


def overview(names: Sequence[str]) -> str:
    """The first page of the gallery."""
    lines = [
        "# Gallery",
        "",
        "Every demo of the repository, solved when these pages were built: the problem, the scene, "
        "pictures, and what came out beside what should. A number beyond its tolerance would have "
        "stopped the build.",
        "",
        "| | problem | unknowns | seconds |",
        "|---|---|---|---|",
    ]
    for name in names:
        result, title = _read(RUNS / name).result, problem(name).splitlines()[0].strip("# ")
        pictures = sorted((PAGES / name).glob("*.png"), key=lambda path: path.stem != "deformed")
        shown = f"![{title}]({name}/{pictures[0].name})" if pictures else ""
        lines.append(
            f"| {shown} | [{title}]({name}.md) | "
            f"{result.model['dofs']} | {result.timings['total']:.1f} |"
        )
    lines += ["", "```{toctree}", ":hidden:", "", *names, "```", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--draw"]:
        draw(Path(sys.argv[2]))
    else:
        make_all(sys.argv[1:])
