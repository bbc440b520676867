"""Each program's own Python: a virtual environment in a cache folder, or Debian's packages."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

_DEBIAN_PYTHON = "/usr/bin/python3"
_OLDER = ("python3.12", "python3.11")


class MissingError(Exception):
    """A program cannot be had on this machine; the sentence says what to do."""


def cache() -> Path:
    """Where virtual environments are kept."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(home) / "fenics_contact" / "peers"


def python_of(name: str, install: tuple[str, tuple[str, ...]]) -> str:
    """The Python that has a program, installed if need be.

    Args:
        name: Of the program's file.
        install: Its ``INSTALL``.

    Raises:
        MissingError: It cannot be installed here.
    """
    how, packages = install
    ways = {"here": _here, "pip": _with_pip, "pip, older Python": _with_older, "apt": _with_apt}
    return ways[how](name, packages)


def _here(name: str, packages: tuple[str, ...]) -> str:
    return sys.executable


def _with_older(name: str, packages: tuple[str, ...]) -> str:
    """Of packages whose files for the newest Python are damaged."""
    for version in _OLDER:
        found = shutil.which(version)
        if found and subprocess.run([found, "--version"], capture_output=True).returncode == 0:
            return _with_pip(name, packages, found)
    raise MissingError(f"{' or '.join(_OLDER)} is needed for {', '.join(packages)}")


def _with_pip(name: str, packages: tuple[str, ...], by: str = sys.executable) -> str:
    folder = cache() / name
    python, done = folder / "bin" / "python", folder / "installed.txt"
    wanted = "\n".join(packages)
    if done.exists() and done.read_text(encoding="utf-8") == wanted:
        return str(python)
    shutil.rmtree(folder, ignore_errors=True)
    print(f"installing {', '.join(packages)} into {folder}", flush=True)
    _run([by, "-m", "venv", str(folder)])
    _run([str(python), "-m", "pip", "install", "--quiet", *packages])
    done.write_text(wanted, encoding="utf-8")
    return str(python)


def _with_apt(name: str, packages: tuple[str, ...]) -> str:
    lacking = [package for package in packages if not _has_package(package)]
    command = ["apt-get", "install", "--yes", "--no-install-recommends", *lacking]
    if not lacking:
        return _DEBIAN_PYTHON
    if shutil.which("apt-get") is None or os.geteuid() != 0:
        raise MissingError(f"as root, on Debian: {' '.join(command)}")
    print(f"installing {', '.join(lacking)} with apt", flush=True)
    _run(command)
    return _DEBIAN_PYTHON


def _has_package(package: str) -> bool:
    if shutil.which("dpkg-query") is None:
        return False
    command = ["dpkg-query", "--show", "--showformat=${db:Status-Status}", package]
    return subprocess.run(command, capture_output=True, text=True).stdout == "installed"


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        last = (done.stderr.strip() or done.stdout.strip()).splitlines()[-1:]
        raise MissingError(f"{' '.join(command)}: {' '.join(last)}")
