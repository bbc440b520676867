"""Release a version: write its number and date everywhere, commit, tag, and build wheel and image.

    python distribution/release.py 0.2.0 --try   # what would change; nothing is written
    python distribution/release.py 0.2.0         # commit, tag v0.2.0, wheel in dist/, image
    git push --follow-tags                       # left to you

It refuses where something is not committed, where the version is not newer than the last tag, and
where ``CHANGELOG.md`` has nothing unreleased.
"""

from __future__ import annotations

import argparse
import datetime
import re
import shutil
import subprocess
import sys
from pathlib import Path

from packaging.version import InvalidVersion, Version

ROOT = Path(__file__).resolve().parent.parent
# File → the lines that bear the version, as patterns whose second group is it.
PLACES = {
    "pyproject.toml": r'(?m)^(version = ")([^"]+)(")',
    "fenics_contact/common/program.py": r'(?m)^(VERSION = ")([^"]+)(")',
    "CITATION.cff": r"(?m)^(version: )(\S+)()",
    "distribution/recipe.yaml": r'(?m)^(  version: ")([^"]+)(")',
}
_UNRELEASED = re.compile(r"(?m)^## (\S+) \(unreleased\)$")


class RefusedError(Exception):
    """In one sentence, what stands against a release."""


def main() -> int:
    """Release, or say what stands against it."""
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("version", help="such as 0.2.0")
    options.add_argument("--try", action="store_true", dest="only_try", help="write nothing")
    options.add_argument("--root", type=Path, default=ROOT, help="the checkout")
    given = options.parse_args()
    try:
        released(given.root, given.version, datetime.date.today(), given.only_try)
    except RefusedError as error:
        print(f"release: {error}", file=sys.stderr)
        return 2
    return 0


def released(root: Path, version: str, date: datetime.date, only_try: bool) -> None:
    """Do all of it in a checkout.

    Args:
        root: Its folder.
        version: The new one.
        date: Of the release.
        only_try: Whether to say only what would change.

    Raises:
        RefusedError: Something stands against it; nothing has been written.
    """
    new = texts(root, version, date)
    for name in new:
        print(f"{name}: version {version}")
    if only_try:
        return
    for name, text in new.items():
        (root / name).write_text(text, encoding="utf-8")
    _git(root, "commit", "--quiet", "--message", f"Version {version}", "--", *new)
    _git(root, "tag", "--annotate", f"v{version}", "--message", f"Version {version}")
    pip = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--wheel-dir", "dist", "."]
    subprocess.run(pip, cwd=root, check=True)
    if shutil.which("docker"):
        image = ["docker", "build", "-t", f"fenics-contact:{version}", "."]
        subprocess.run(image, cwd=root, check=True)
    else:
        print("no docker here: the image was not built")
    print(f"tagged v{version}; publish it with: git push --follow-tags")


def texts(root: Path, version: str, date: datetime.date) -> dict[str, str]:
    """The files as the release has them.

    Args:
        root: Folder of the checkout.
        version: The new one.
        date: Of the release.

    Returns:
        Name of each file that changes → its new text.

    Raises:
        RefusedError: Something stands against it.
    """
    try:
        wanted = Version(version)
    except InvalidVersion:
        raise RefusedError(f"'{version}' is no version, such as 0.2.0") from None
    if _git(root, "status", "--porcelain"):
        raise RefusedError("there are changes that are not committed")
    tags = [Version(tag[1:]) for tag in _git(root, "tag", "--list", "v*").split()]
    if tags and wanted <= max(tags):
        raise RefusedError(f"version {version} is not newer than {max(tags)}, the last tag")
    found = {name: (root / name).read_text(encoding="utf-8") for name in [*PLACES, "CHANGELOG.md"]}
    if not _UNRELEASED.search(found["CHANGELOG.md"]):
        raise RefusedError("CHANGELOG.md has no section '## VERSION (unreleased)'")
    for name, pattern in PLACES.items():
        found[name], count = re.subn(pattern, rf"\g<1>{version}\g<3>", found[name])
        if count != 1:
            raise RefusedError(f"{name} has {count} lines with the version, not one")
    heading = f"## {version} ({date.isoformat()})"
    found["CHANGELOG.md"] = _UNRELEASED.sub(heading, found["CHANGELOG.md"], count=1)
    return found


def _git(root: Path, *arguments: str) -> str:
    done = subprocess.run(
        ["git", *arguments], cwd=root, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise RefusedError(f"git {arguments[0]}: {done.stderr.strip()}")
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
