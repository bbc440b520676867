"""The Dockerfile and its entry script, without an engine; `.ci/debian` builds the image."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.scenes import ROOT

pytestmark = pytest.mark.serial

DOCKERFILE = re.sub(r"\\\n\s*", " ", (ROOT / "Dockerfile").read_text())
SHARE = "-p no:cacheprovider --one-case-in 8"
# Says how it was called, and from where; fails if its name is in $FAIL.
STUB = r"""#!/bin/sh
name=${0##*/}
printf '%s' "$name" >>"$CALLS"
printf '|%s' "$@" >>"$CALLS"
printf '|in %s\n' "$PWD" >>"$CALLS"
case " ${FAIL:-} " in *" $name "*) exit 7 ;; esac
"""


def instruction(name: str) -> str:
    found = re.search(rf"^{name} (.*)$", DOCKERFILE, re.MULTILINE)
    assert found, name
    return found[1]


class Image:
    """The entry script in a folder of its own, with stubs for the programs that it starts."""

    def __init__(self, folder: Path) -> None:
        self.project = folder / "the project"
        self.warm = folder / "warm"
        self.cache = folder / "home/cache"
        self.caller = folder / "caller"
        self.calls_file = folder / "calls"
        for made in (self.project / "docker", folder / "bin", self.caller, self.warm / "fenics"):
            made.mkdir(parents=True)
        (self.warm / "fenics/form.so").write_text("compiled")
        source = (ROOT / "docker/entrypoint").read_text()
        assert "=/var/cache/fenics_contact\n" in source
        script = self.project / "docker/entrypoint"
        script.write_text(source.replace("=/var/cache/fenics_contact\n", f"={self.warm}\n"))
        shutil.copymode(ROOT / "docker/entrypoint", script)
        for name in ("python3", "mpirun"):
            stub = folder / "bin" / name
            stub.write_text(STUB)
            stub.chmod(0o755)
        self.path = f"{folder / 'bin'}:{os.environ['PATH']}"

    def run(self, *arguments: str, fail: str = "") -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [self.project / "docker/entrypoint", *arguments],
            env={
                "PATH": self.path,
                "XDG_CACHE_HOME": str(self.cache),
                "CALLS": str(self.calls_file),
                "FAIL": fail,
            },
            cwd=self.caller,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
        )

    def calls(self) -> list[str]:
        return self.calls_file.read_text().splitlines()

    def call(self, command: str) -> str:
        """The record of a call, made in the project's folder."""
        return "|".join([*command.split(), f"in {self.project}"])


@pytest.fixture
def image(tmp_path: Path) -> Image:
    return Image(tmp_path)


def test_image_has_the_packages_that_bootstrap_installs() -> None:
    bootstrap = re.search(r"^debian_packages='([^']*)'", (ROOT / "bootstrap").read_text(), re.M)
    installed = re.search(r"apt-get install ([^&]*)&&", DOCKERFILE)
    assert bootstrap and installed
    packages = {word for word in installed[1].split() if not word.startswith("-")}
    assert packages == set(bootstrap[1].split())


def test_nothing_that_git_ignores_gets_into_the_image() -> None:
    def patterns(name: str) -> set[str]:
        lines = (ROOT / name).read_text().split()
        return {line.removeprefix("**/").strip("/") for line in lines}

    assert patterns(".gitignore") | {".git"} <= patterns(".dockerignore")


def test_entry_script_is_where_the_image_looks_for_it() -> None:
    folder = instruction("WORKDIR")
    assert instruction("ENTRYPOINT") == f'["{folder}/docker/entrypoint"]'
    assert f" PYTHONPATH={folder} " in instruction("ENV")
    assert os.access(ROOT / "docker/entrypoint", os.X_OK)


@pytest.mark.parametrize("arguments", [(), ("demo",), ("demo", "--quiet")])
def test_demo_is_the_default(image: Image, arguments: tuple[str, ...]) -> None:
    done = image.run(*arguments)
    assert done.returncode == 0, done.stderr
    options = " ".join(arguments[1:])
    assert image.calls() == [
        image.call(f"python3 demos/demo_slab.py --out /results/slab {options}")
    ]


def test_exit_code_of_the_demo_is_passed_on(image: Image) -> None:
    assert image.run(fail="python3").returncode == 7


@pytest.mark.parametrize(
    ("fail", "code", "message"),
    [
        ("", 0, ""),
        ("python3", 1, "test: FAILED on one rank (exit code 7)\n"),
        ("mpirun", 1, "test: FAILED on two ranks (exit code 7)\n"),
    ],
)
def test_tests_run_on_one_and_two_ranks(image: Image, fail: str, code: int, message: str) -> None:
    done = image.run("test", "-k", "slab", fail=fail)
    assert (done.returncode, done.stderr) == (code, message)
    assert image.calls() == [
        image.call(
            f"python3 -m pytest -n 2 --dist loadfile {SHARE} --quarters 2 --quarters-of-serial 3"
            " -k slab"
        ),
        image.call(f"mpirun -n 2 python3 -m mpi4py -m pytest {SHARE} --quarters 1 -k slab"),
    ]


def test_other_commands_run_as_they_are(image: Image) -> None:
    done = image.run("mpirun", "-n", "2", "a program", "", fail="mpirun")
    assert done.returncode == 7
    assert image.calls() == [f"mpirun|-n|2|a program||in {image.caller}"]


def test_compiled_forms_are_copied_once(image: Image) -> None:
    form = image.cache / "fenics/form.so"
    image.run("true")
    assert form.read_text() == "compiled"
    form.write_text("compiled by the user")
    image.run("true")
    assert form.read_text() == "compiled by the user"
