"""docs/method.md: every equation of the paper has a row, and every link leads to what it names."""

import ast
import functools
import re

import pytest

from tests.scenes import ROOT

PAGE = ROOT / "docs" / "method.md"
SECTION = "## The paper's equations, and where they are"

# What the paper numbers: (1.1) … (4.7), but (3.7) to (3.12), the steps of a proof, in one row.
NUMBERS = [f"(1.{i})" for i in range(1, 10)]
NUMBERS += [f"(2.{i})" for i in range(1, 13)]
NUMBERS += [f"(3.{i})" for i in range(1, 13)]
NUMBERS += [f"(4.{i})" for i in range(1, 8)]
STATEMENTS = [
    *(f"Theorem 2.{i}" for i in range(1, 5)),
    *(f"Lemma 2.{i}" for i in range(1, 3)),
    *(f"Theorem 3.{i}" for i in range(1, 3)),
    *(f"Step {i}" for i in range(1, 5)),
]

LINK = re.compile(r"\[(`?)([^]`]+)`?\]\(([^)#]+)\)")


@functools.cache
def defined(path):
    """Functions, classes and Class.method of a Python file."""
    found = set()

    def visit(node, prefix):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.FunctionDef | ast.ClassDef):
                found.add(prefix + child.name)
                if isinstance(child, ast.ClassDef):
                    visit(child, f"{prefix}{child.name}.")

    visit(ast.parse(path.read_text(encoding="utf-8")), "")
    return found


def wrong_links(text):
    """Links of a text in docs/ whose file or name does not exist, in words."""
    wrong = []
    for code, name, target in LINK.findall(text):
        path = (PAGE.parent / target).resolve()
        if not path.is_file():
            wrong.append(f"{target}: no such file")
        elif path.suffix == ".py" and code and name not in defined(path):
            wrong.append(f"{target}: does not define {name}")
    return wrong


def rows(text):
    """Cells of the rows of the section's table."""
    section = text.partition(SECTION)[2]
    lines = [line for line in section.splitlines() if line.startswith("|")][2:]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]] for line in lines]


def numbers(cell):
    """What a row is about: its numbers, a range in full, theorems and steps."""
    if cell.startswith(("remark", "conditions")):
        return set()
    found = set(re.findall(r"\(\d\.\d+\)|(?:Theorem|Lemma) \d\.\d|Step \d", cell))
    for chapter, first, last in re.findall(r"\((\d)\.(\d+)\)-\(\1\.(\d+)\)", cell):
        found |= {f"({chapter}.{i})" for i in range(int(first), int(last) + 1)}
    return found


@pytest.fixture(scope="module")
def page():
    return PAGE.read_text(encoding="utf-8")


def test_every_link_leads_to_what_it_names(page):
    assert wrong_links(page) == []
    assert len(LINK.findall(page)) > 80


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("[`friction_energy`]", "[`friction_energies`]"),
        (
            "[`friction_energy`](../fenics_contact/contact/laws/energies.py)",
            "[`friction_energy`](energies.py)",
        ),
        ("[`RegularisedFriction.traction`]", "[`RegularisedFriction.smoothed_norm`]"),
        ("[`test_surface_shift`]", "[`surface_shifted`]"),
    ],
)
def test_a_wrong_link_is_noticed(page, old, new):
    assert old in page
    assert wrong_links(page.replace(old, new)) != []


def test_every_equation_of_the_paper_has_a_row(page):
    table = rows(page)
    assert all(len(row) == 3 for row in table)
    listed = set().union(*(numbers(row[0]) for row in table))
    assert sorted({*NUMBERS, *STATEMENTS} - listed) == []
    assert sorted(listed - {*NUMBERS, *STATEMENTS}) == []


def test_every_row_says_where_or_why_not(page):
    for number, formula, where in rows(page):
        assert formula, number
        links = LINK.findall(where)
        assert links or where.startswith("not used, because "), number
        assert all(code for code, _, _ in links), f"{number}: a link without a name"


def test_every_inequality_has_a_test(page):
    """Bounds and theorems that say something about answers are shown by a test."""
    proven = ["(1.9)", "(2.4)", "(2.5)", "(3.5)", "Lemma 2.1", "Lemma 2.2"]
    proven += ["Theorem 2.2", "Theorem 2.3", "Theorem 2.4", "Theorem 3.1", "Theorem 3.2"]
    for name in proven:
        found = " ".join(row[2] for row in rows(page) if name in numbers(row[0]))
        assert "](../tests/" in found, name


def test_files_that_the_page_names_exist():
    text = PAGE.read_text(encoding="utf-8")
    folders = (ROOT / "fenics_contact", ROOT / "tests")
    files = {path.as_posix() for folder in folders for path in folder.rglob("*.py")}
    named = set(re.findall(r"`([a-z_/]+\.py)`", text))
    assert len(named) > 8
    assert [name for name in named if not any(file.endswith("/" + name) for file in files)] == []
    # In brackets after a statement stands the file that it lives in, or a key of a scene.
    modules = {file.rsplit("/", 1)[1].removesuffix(".py") for file in files}
    brackets = set(re.findall(r"\(`([a-z_]+)`\)", text)) - {"against"}
    assert len(brackets) > 8
    assert brackets <= modules
