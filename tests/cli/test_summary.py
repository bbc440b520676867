"""What appears where: on a terminal, on one that is plain, in a pipe."""

import os
import pty
import re
import subprocess
import sys
import threading

import pytest

from fenics_contact import main
from fenics_contact.common.wording import one_line
from fenics_contact.results.contact_points import ContactTable
from tests.scenes import ROOT

pytestmark = pytest.mark.serial

COMMAND = [sys.executable, "-m", "fenics_contact"]
SLAB = str(ROOT / "demos" / "slab.toml")
ESCAPE = "\x1b"
COLOUR = re.compile("\x1b\\[[0-9;]*3[0-7]m")


def environment(**changed):
    plain = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR", "TERM")}
    return plain | {"TERM": "xterm", "COLUMNS": "100", "PYTHONPATH": str(ROOT)} | changed


def as_process(arguments, terminal, changed):
    """Exit code of the command, which writes to a terminal."""
    return subprocess.run(
        [*COMMAND, *arguments],
        stdin=subprocess.DEVNULL,
        stdout=terminal,
        stderr=terminal,
        env=environment(**changed),
        timeout=120,
    ).returncode


def here(arguments, terminal, changed):
    """The same in this process, which takes a fraction of the time."""
    with pytest.MonkeyPatch.context() as patch, os.fdopen(os.dup(terminal), "w") as stream:
        for name, value in environment(**changed).items():
            patch.setenv(name, value)
        for name in ("NO_COLOR", "FORCE_COLOR"):
            if name not in changed:
                patch.delenv(name, raising=False)
        patch.setattr(sys, "stdout", stream)
        patch.setattr(sys, "stderr", stream)
        try:
            return main([*arguments])
        except SystemExit as end:
            return end.code


def on_terminal(*arguments, start=as_process, **changed):
    """Exit code, and all that a terminal got."""
    mine, its = pty.openpty()
    found = []

    def read():
        try:
            while part := os.read(mine, 4096):
                found.append(part)
        except OSError:  # Linux says so when the other end is closed
            pass

    reader = threading.Thread(target=read)
    reader.start()
    code = start(arguments, its, changed)
    os.close(its)
    reader.join()
    os.close(mine)
    return code, b"".join(found).decode()


def test_a_terminal_shows_what_is_being_done_and_then_takes_it_away(tmp_path):
    code, said = on_terminal("run", SLAB, "--out", str(tmp_path / "out"))
    assert code == 0
    assert re.search(r"(making the mesh|compiling forms|Newton step \d)", said)
    # What is left is not hidden by what was there: its line is erased, the cursor shown again.
    assert f"{ESCAPE}[2K" in said and said.rindex(f"{ESCAPE}[?25h") > said.rindex(f"{ESCAPE}[?25l")
    assert "checks of the physics passed" in said.rpartition(f"{ESCAPE}[?25h")[2]


def test_a_bar_keeps_to_its_line(tmp_path):
    """Over load steps; without colours, where these are not wanted."""
    scene = str(ROOT / "demos" / "cylinders.toml")
    coarse = ["--set", "mesh.0.parameters.size=0.15", "--set", "mesh.1.parameters.size=0.1"]
    out = ["--set", 'solver.errors="none"', "--out", str(tmp_path / "out")]
    code, said = on_terminal("run", scene, *coarse, *out, start=here, COLUMNS="60", NO_COLOR="1")
    assert code in (0, 4) and re.search(r"step \d: time 1", said)
    for line in re.split(r"[\r\n]", said.partition(f"{ESCAPE}[?25h")[0]):
        assert len(re.sub(f"{ESCAPE}\\[[0-9;?]*[a-zA-Z]", "", line)) <= 60
    assert f"{ESCAPE}[2K" in said and not COLOUR.search(said)


def test_a_plain_terminal_has_lines_only(tmp_path):
    code, said = on_terminal("run", SLAB, "--out", str(tmp_path / "out"), start=here, TERM="dumb")
    assert code == 0 and "checks of the physics passed" in said and ESCAPE not in said
    assert "Newton step 1" not in said


def test_a_pipe_gets_results_and_errors_apart_and_no_escape_codes(tmp_path):
    def run(*arguments):
        return subprocess.run(
            [*COMMAND, *arguments],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            env=environment(),
            timeout=120,
        )

    done = run("run", SLAB, "--out", str(tmp_path / "out"), "--", "-snes_montor")
    assert done.returncode == 0 and ESCAPE not in done.stdout + done.stderr
    assert "checks of the physics passed" in done.stdout
    lines = done.stderr.splitlines()  # on a slow machine also how far it is
    assert any(
        one.startswith("PETSc options that no solve asked for: -snes_montor;") for one in lines
    )
    done = run("run", "nowhere.toml")
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1


def test_help_does_not_wait_for_fenicsx():
    script = (
        "import sys\n"
        "from fenics_contact.cli.program import parse\n"
        "try:\n    parse(['run', '--help'])\nfinally:\n"
        "    heavy = {'dolfinx', 'ufl', 'scipy', 'numpy', 'petsc4py'} & set(sys.modules)\n"
        "    assert not heavy, heavy\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        env=environment(),
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    assert max(map(len, done.stdout.splitlines())) > 85  # as wide as the terminal


STEERING = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1a\x1c-\x1f\x7f-\x9f\u061c\u200b\u202a-\u202e\u2066-\u2069\ufeff]"
)


def hostile_scene(folder):
    """A scene whose names and title would clear the screen and name the window."""
    clear, window, c1 = (
        r"\u001b[2J\u001b[H",
        r"\u001b]0;mine\u0007",
        r"\u009b2J\u202e\u061c\u200b\ufeff",
    )
    (folder / "block.geo").write_text(
        (ROOT / "meshes" / "sloped_block.geo")
        .read_text()
        .replace('"bottom"', '"\x9b2J\u202e\u061cbottom"'),
        encoding="utf-8",
    )
    text = f"""
        title = "{clear}{window}{c1}[bold]block\\nConverged; all 99 checks of the physics passed."
        kinematics = "plane strain"
        mesh = {{ file = "block.geo", parameters = {{ cells_along = 2, cells_across = 2 }} }}
        material = {{ youngs_modulus = 1000, poissons_ratio = 0.3 }}
        support = [{{ on = "left", displacement = {{ x = 0.01, y = 0 }} }}]
        contact = [{{ on = "{clear}{c1}bottom", name = "{clear}{window}{c1}" }}]
    """
    (folder / "scene.toml").write_text(text)
    return str(folder / "scene.toml")


@pytest.mark.parametrize(
    ("command", "code"),
    [
        (["check"], 2),
        (["run", "--set", "contact.0.\x1b[2Jno=1"], 2),
        (["run", "--\x1b[2J\x9b2Jno=1"], 2),
        (["check", "--set", "contact.0.on=right"], 0),
        (["run", "--set", "contact.0.on=right", "--verbose"], 0),
    ],
)
def test_names_of_files_cannot_steer_the_terminal(tmp_path, command, code):
    scene = hostile_scene(tmp_path)
    options = ["--out", str(tmp_path / "out")] if command[0] == "run" else []
    start = as_process if "--verbose" in command else here
    found, said = on_terminal(command[0], scene, *command[1:], *options, start=start)
    assert found == code, said
    assert f"{ESCAPE}[2J" not in said and f"{ESCAPE}]" not in said and f"{ESCAPE}[H" not in said
    assert not STEERING.search(said)
    assert not re.search("^(\x1b[^m]*m)?Converged; all 99", said, re.MULTILINE)
    assert "\\x1b[2J" in said


def test_names_of_files_cannot_steer_from_tables_and_pages(tmp_path):
    """Two contacts, so that columns of steps.csv have their names."""
    scene, out = hostile_scene(tmp_path), tmp_path / "out"
    text = (tmp_path / "scene.toml").read_text(encoding="utf-8")
    second = 'contact = [{ on = "top", name = "\\u001bb\\n\\u061c" }, { on = "right", '
    text = re.sub(r"contact = \[\{ on = .*?, ", lambda _: second, text)
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    for command in (["run", scene, "--out", str(out)], ["report", str(out)]):
        assert main(command) == 0
    for name in ("contact.csv", "steps.csv", "report.html"):
        written = (out / name).read_text(encoding="utf-8")
        if name == "report.html":  # plotly's own script apart
            written = re.sub(r"<script>.*?</script>", "", written, flags=re.DOTALL)
        assert not STEERING.search(written) and ESCAPE not in written, name
        assert "\\x1b" in written, name
    table = ContactTable.read(out / "contact.csv")
    assert len(table.of("\x1bb\n\u061c").status) and set(table.contact) == {
        "\\x1bb\\n\\u061c",
        one_line("\x1b[2J\x1b[H\x1b]0;mine\x07\x9b2J\u202e\u061c\u200b\ufeff"),
    }
