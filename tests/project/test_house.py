"""The packages stand in one order: each imports only from those before it, and none is crowded."""

import ast
import functools
from collections import Counter
from collections.abc import Collection
from pathlib import Path

import pytest
from mpi4py import MPI

from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of files; one rank will do")

PACKAGE = ROOT / "fenics_contact"
ORDER = (
    *(
        "common",
        "quantities",
        "analytic",
        "scene",
        "results",
        "mesh",
        "body",
        "contact",
        "problem",
        "solve",
    ),
    *("evaluate", "trust", "simulation", "report", "explore", "verification", "cli"),
)
# Parts of analyses stand where those of other packages of their kind do; what is computed, last.
ANALYSES = {
    **dict.fromkeys(("analysis", "registry", "__init__"), "common"),
    "table": "scene",
    **dict.fromkeys(("record", "words"), "results"),
    **dict.fromkeys(("page", "pictures", "worn_history"), "report"),
}
# These know no analysis, and not the list of them.
CORE = ("body", "contact", "problem", "solve", "evaluate", "trust")
# These have fields whose types are tables or records of analyses.
FIELDS_OF_ANALYSES = (
    *("scene/scene.py", "scene/loading/cycles.py"),
    *("results/records/run.py", "results/records/steps.py", "results/result.py"),
)
BESIDE = ("analyses", "verification")
# A package that holds others, or modules that others stand on: from the ground up.
INSIDE = {
    "contact": ("surface", "mortar", "kinematics", "laws"),
    "report": ("drawing", "contacts", "bodies", "page"),
    "solve": (
        *("systems", "condensed", "glued", "iterative", "exact", "at_points", "finite"),
        *("newton_failure", "initial_guess", "snes_solve", "newton"),
        *("coulomb", "load_steps"),
    ),
    "simulation": (
        *("fingerprint", "row_tables", "state_file", "sensitivities", "studies"),
        *("adaptive", "output", "sweeps", "fits"),
    ),
}
# These are read where there is no FEniCSx and no MPI, or before it is loaded.
WITHOUT_FENICSX = ("quantities", "analytic", "scene", "results", "report")
HEAVY = {"dolfinx", "ufl", "basix", "petsc4py", "mpi4py"}
MOST = 14  # modules of a folder


@functools.cache
def imports(path: Path) -> frozenset[str]:
    """Modules of a file's imports; what only a type checker sees counts as well."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    return frozenset(found)


def place(path: Path) -> tuple[str, ...]:
    """The package that a module counts to, and where it is in there."""
    room, *rest = path.with_suffix("").parts
    if room != "analyses":
        return room, *rest
    part = next((part for part in rest if part in ANALYSES), "__init__" if len(rest) < 2 else "")
    return ANALYSES.get(part, "simulation"), "analyses", *rest


def upwards(path: Path, names: Collection[str]) -> list[str]:
    """The imports of a file that do not go to the left.

    Args:
        path: Within the package.
        names: Of the modules that it imports.
    """
    room, *rest = place(path)
    found = []
    for name in sorted(names):
        of, _, target = name.partition(".")
        if of != "fenics_contact" or not target:
            continue
        there, *inner = place(Path(*target.split(".")))
        if there in ORDER and ORDER.index(there) > ORDER.index(room):
            found.append(f"{path} imports {name}")
        order = INSIDE.get(room, ())
        both = there == room and rest and inner and {rest[0], inner[0]} <= set(order)
        if both and order.index(inner[0]) > order.index(rest[0]):
            found.append(f"{path} imports {name}")
    return found


def files() -> list[Path]:
    return [path for path in sorted(PACKAGE.rglob("*.py")) if path.parent != PACKAGE]


def test_every_package_has_its_place() -> None:
    found = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}
    assert found == {*ORDER, "analyses"}
    assert len(files()) > 250
    for room, inside in INSIDE.items():
        there = {path.stem for path in (PACKAGE / room).iterdir()}
        assert set(inside) <= there, room


def test_imports_go_to_the_left_only() -> None:
    wrong = [
        words for path in files() for words in upwards(path.relative_to(PACKAGE), imports(path))
    ]
    assert wrong == []


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("scene/values.py", "fenics_contact.mesh.loading"),
        ("solve/newton.py", "fenics_contact.solve.coulomb.strategies"),
    ],
)
def test_an_import_to_the_right_is_noticed(path: str, name: str) -> None:
    assert upwards(Path(path), {name}) == [f"{path} imports {name}"]


def test_there_is_no_circle_of_imports() -> None:
    """Not of imports inside of functions either, or of those that only a type checker sees."""
    names = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in files()}
    left = {name: imports(path) & names.keys() - {name} for name, path in names.items()}
    while free := [name for name, needed in left.items() if not needed & left.keys()]:
        for name in free:
            del left[name]
    assert sorted(left) == []


def test_what_is_read_without_fenicsx_does_not_load_it() -> None:
    """At the top of a module, that is; a function may load it where it is called."""
    for room in WITHOUT_FENICSX:
        for path in (PACKAGE / room).rglob("*.py"):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            top = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
            names = {
                name.split(".")[0]
                for node in top
                for name in (
                    [node.module or ""]
                    if isinstance(node, ast.ImportFrom)
                    else [alias.name for alias in node.names]
                )
            }
            assert not names & HEAVY, path


@pytest.mark.parametrize("room", CORE)
def test_the_core_knows_no_analysis(room: str) -> None:
    """Not even the list of them, which scene, run, results, page and files go through."""
    for path in (PACKAGE / room).rglob("*.py"):
        assert not any(name.startswith("fenics_contact.analyses") for name in imports(path)), path


def analyses_named_in(path: Path) -> set[str]:
    """Folders of analyses from which a file imports."""
    folders = {folder.name for folder in (PACKAGE / "analyses").iterdir() if folder.is_dir()}
    parts = [name.split(".") for name in imports(path)]
    return {
        of[2] for of in parts if of[:2] == ["fenics_contact", "analyses"] and len(of) > 2
    } & folders


def test_others_name_an_analysis_only_in_the_types_of_fields() -> None:
    """Those of a scene and of a record; and a study, whose methods users call by name."""
    others = [path for path in files() if path.relative_to(PACKAGE).parts[0] not in BESIDE]
    named = {str(path.relative_to(PACKAGE)) for path in others if analyses_named_in(path)}
    assert named == {*FIELDS_OF_ANALYSES, "simulation/studies/study.py"}


def test_no_analysis_needs_another_one() -> None:
    for folder in (path for path in (PACKAGE / "analyses").iterdir() if path.is_dir()):
        names = {name for path in folder.glob("*.py") for name in imports(path)}
        others = {
            name.split(".")[2] for name in names if name.startswith("fenics_contact.analyses.")
        }
        assert others <= {"analysis", "registry", folder.name}, folder


def test_no_folder_is_crowded() -> None:
    counted = Counter(path.parent for path in files() if path.name != "__init__.py")
    assert {str(folder): number for folder, number in counted.items() if number > MOST} == {}


def test_every_package_says_what_it_is_for() -> None:
    for path in PACKAGE.rglob("__init__.py"):
        text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
        assert text and len(text) > 20, path
