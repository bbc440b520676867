"""Every example of README.md and docs/: scenes load, Python runs, commands are what programs take.

A fragment of a scene says what it is of, in a comment before it:

- ``<!-- example: whole -->`` is a scene by itself; ``whole, beside FILE`` wants the page's other
  block, which the text asks to save as FILE;
- ``<!-- example: from demos/NAME.toml -->`` stands there like that;
- ``<!-- example: changes demos/NAME.toml -->`` replaces what it names; ``…, without KEY`` first
  takes KEY away.

A block of Python after ``<!-- example: saved as FILE -->`` is a file of that name for the others.
"""

from __future__ import annotations

import importlib
import re
import shlex
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

from fenics_contact import Run, load_scene
from fenics_contact.cli.program import parse
from fenics_contact.contact.laws import allowed
from tests.registered import nothing_stays_registered
from tests.scenes import ROOT

pytestmark = pytest.mark.serial

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [page for page in PAGES if not {"_build", "gallery"} & set(page.parts)]
COMMANDS = (
    *(
        "run",
        "sweep",
        "fit",
        "explore",
        "look",
        "check",
        "report",
        "compare",
        "verify",
        "new",
        "schema",
    ),
    *("materials", "completion"),
)
# Programs of others, whose words are not looked at.
OTHERS = {
    "alias",
    "apptainer",
    "cd",
    "docker",
    "exit",
    "export",
    "fc",
    "fi",
    "git",
    "if",
    "mkdir",
    "mpirun",
}
OTHERS |= {"pip", "rm", "sbatch", "scontrol", "sed", "source", "srun"}
# README has no comments: the first line of its fragments → what each is of.
README = {'kinematics = "plane stress"': "from demos/slab.toml"}


@dataclass(frozen=True)
class Block:
    """A block of code of a page: where it is, its language, its text, and the comment before."""

    page: Path
    line: int
    language: str
    text: str
    said: str

    def __str__(self):
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def blocks_of(page):
    """The blocks of a page; directives of Sphinx are none."""
    found, said = [], ""
    for token in MarkdownIt().parse(page.read_text(encoding="utf-8")):
        if token.type == "html_block":
            comment = re.match(r"<!-- example: (.+) -->", token.content)
            said = comment[1] if comment else ""
        elif token.type == "fence" and not token.info.startswith("{"):
            language, text = token.info.strip(), token.content
            if page.name == "README.md" and language == "toml":
                said = README.get(text.splitlines()[0], said)
            found.append(Block(page, token.map[0] + 1, language, text, said))
            said = ""
        elif token.type == "fence":
            said = ""
    return found


BLOCKS = [block for page in PAGES for block in blocks_of(page)]


# Files that pages ask to save.
SAVED = {block.said.removeprefix("saved as ") for block in BLOCKS if "saved as" in block.said}


def of_language(*languages):
    return [block for block in BLOCKS if block.language in languages]


@pytest.fixture
def copy_of_repository(tmp_path, monkeypatch):
    """An empty folder with links to what examples name by their paths in the repository."""
    for name in ("meshes", "demos", "docs"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "scenes").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(allowed, "_modules", {})  # laws of a page are no other test's
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    with nothing_stays_registered():
        yield tmp_path
    for name in SAVED:
        sys.modules.pop(name.removesuffix(".py"), None)


def merged(base, change):
    """A table with what another one says instead; of lists the entries in order."""
    if isinstance(base, list) and isinstance(change, dict):  # of the last [[contact]]
        return [*base[:-1], merged(base[-1], change)]
    if isinstance(base, list) and isinstance(change, list):
        if not all(isinstance(entry, dict) for entry in [*base, *change]):
            return change
        same = [merged(one, other) for one, other in zip(base, change, strict=False)]
        return same + change[len(base) :] + base[len(change) :]
    if isinstance(base, dict) and isinstance(change, dict):
        return base | {
            key: merged(base[key], value) if key in base else value for key, value in change.items()
        }
    return change


def difference(base, part, place=""):
    """Where a part says something else than the whole, in words; empty where it does not."""
    if isinstance(part, dict) and isinstance(base, list):
        base = base[-1]
    if isinstance(part, dict) and isinstance(base, dict):
        for key, value in part.items():
            if key not in base:
                return f"{place}{key} is not there"
            if words := difference(base[key], value, f"{place}{key}."):
                return words
        return ""
    if isinstance(part, list) and part and isinstance(part[0], dict):
        for entry in part:
            words = [difference(one, entry, place) for one in base]
            if all(words):
                return words[0]
        return ""
    return "" if base == part else f"{place} = {base!r}, not {part!r}"


def written(value):
    """A value as TOML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {written(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


@pytest.mark.parametrize("block", of_language("toml"), ids=str)
def test_scenes(block, copy_of_repository):
    if block.page.name == "scene.md":  # generated; a line of a contact
        tomllib.loads(block.text)
        return
    assert block.said, "say with <!-- example: … --> what this is of"
    kind, *rest = block.said.replace(",", "").split()
    data = tomllib.loads(block.text)
    if kind == "whole":
        if rest:
            (beside,) = [b for b in blocks_of(block.page) if b.language == "c"]
            (copy_of_repository / "scenes" / rest[-1]).write_text(beside.text)
    elif kind == "from":
        assert difference(tomllib.loads((ROOT / rest[0]).read_text(encoding="utf-8")), data) == ""
        return
    else:
        assert kind == "changes"
        base = tomllib.loads((ROOT / rest[0]).read_text(encoding="utf-8"))
        for key in rest[2:]:
            del base[key]
        before = set(names_of(base))
        data = merged(base, data)
        assert set(names_of(data)) <= before, "another group than the demo's"
    scene = copy_of_repository / "scenes" / "scene.toml"
    scene.write_text("\n".join(f"{key} = {written(value)}" for key, value in data.items()))
    loaded = load_scene(scene)
    if kind == "whole":
        Run(loaded)  # the mesh and its groups


def names_of(data):
    """Groups that a scene names."""
    for table in ("support", "load", "contact"):
        entries = data.get(table, [])
        for entry in entries if isinstance(entries, list) else [entries]:
            yield from (entry[key] for key in ("on", "against") if key in entry)


def with_errors_where_looked_at(blocks):
    """Cases of tests; estimating errors that nobody sees takes longer than all the rest."""
    sees = re.compile("errors|accuracy")
    marks = ([pytest.mark.errors] if sees.search(block.text) else [] for block in blocks)
    return [pytest.param(b, marks=m, id=str(b)) for b, m in zip(blocks, marks, strict=True)]


@pytest.mark.parametrize("block", with_errors_where_looked_at(of_language("python")))
def test_python(block, copy_of_repository):
    for other in blocks_of(block.page):
        if other.said.startswith("saved as "):
            (copy_of_repository / other.said.removeprefix("saved as ")).write_text(other.text)
    if block.said.startswith("saved as "):
        importlib.import_module(block.said.removeprefix("saved as ").removesuffix(".py"))
        return
    is_script = 'if __name__ == "__main__"' in block.text
    name = "__main__" if is_script else "__example__"
    exec(compile(block.text, str(block), "exec"), {"__name__": name})


def lines_of(block):
    """Commands of a block of shell, continued lines put together, without prompts and comments.

    And without what a command is given to read (``<<'END'``).
    """
    text = re.sub(r"<<'(\w+)'\n.*?\n\1\n", "<<\n", block.text, flags=re.DOTALL)
    text = re.sub(r"\\\n\s*", " ", text)
    for line in text.splitlines():
        line = line.removeprefix("$ ") if block.text.startswith("$ ") else line
        words = shlex.split(line, comments=True)
        if words and "<<" not in line:
            yield words
        if block.text.startswith("$ "):
            return  # what follows is output


@pytest.mark.parametrize("block", of_language("sh", "bash"), ids=str)
def test_commands(block):
    assert subprocess.run(["bash", "-n", "-c", block.text], check=False).returncode == 0
    for words in lines_of(block):
        understand(words)


def understand(words):
    """Fail unless a command is one that there is."""
    starts = [
        place + 1
        for place, word in enumerate(words[:-1])
        if word in ("fenics-contact", "fenics_contact") and words[place + 1] in COMMANDS
    ]
    if starts:
        arguments = words[starts[-1] :]
        options = parse([*cut(arguments)])
        scene = getattr(options, "scene", None)
        if scene is not None and (ROOT / scene).is_file():
            load_scene(ROOT / scene, options.overrides)
        return
    first = words[0]
    if first == "make":
        targets = (ROOT / "Makefile").read_text(encoding="utf-8")
        assert all(f"\n{target}:" in targets for target in words[1:] if "=" not in target), words
    elif first in ("./bootstrap", "python", "python3", "fc") or first.startswith("."):
        scripts = [word for word in words if word.endswith((".py", ".ci/run"))]
        scripts = [script for script in scripts if script not in SAVED]
        for script in scripts:
            assert (ROOT / script).is_file() or script == "script.py", script
            if script != "script.py":
                known = (ROOT / script).read_text(encoding="utf-8") + RUN_SCRIPT
                options = [word for word in words[words.index(script) :] if word[:2] == "--"]
                assert all(f'"{option}"' in known or option == "--help" for option in options)
        tests = [word for word in words if word.startswith("tests/")]
        assert all((ROOT / test.partition(":")[0]).is_file() for test in tests), words
    else:
        assert first in OTHERS or re.match(r"\w+=", first), f"{first}: which program is that?"


# What scripts take that leave their options to the package.
RUN_SCRIPT = (ROOT / "fenics_contact" / "cli" / "options.py").read_text(encoding="utf-8")


def cut(arguments):
    """The arguments up to what the shell takes for itself."""
    for word in arguments:
        if word in ("|", ">", "&&", "||", "&", ";"):
            return
        yield word


@pytest.mark.parametrize(
    "line",
    [
        "fenics-contact run scene.toml --output here",
        "fenics-contact run demos/slab.toml --set contact.0.presure=3",
        "make everything",
        "python docs/make_all.py",
        "./bootstrap python benchmarks/work_precision.py --fast",
        "frobnicate",
    ],
)
def test_a_wrong_command_is_noticed(line):
    with pytest.raises((AssertionError, SystemExit, Exception)):
        understand(shlex.split(line))


def test_a_wrong_fragment_is_noticed():
    base = {"contact": [{"on": "top", "pressure": 300}], "steps": {"number": 1}}
    assert difference(base, {"contact": [{"pressure": 300}]}) == ""
    assert difference(base, {"contact": [{"pressure": 200}]})
    assert difference(base, {"steps": {"end": 1}})


def test_there_are_examples():
    counts = [len(of_language(*names)) for names in (("toml",), ("python",), ("sh", "bash"))]
    assert all(count > 8 for count in counts), counts
    languages = {block.language for block in BLOCKS}
    assert languages <= {"", "toml", "python", "sh", "bash", "c"}, languages
