"""Put the built documentation on the branch ``gh-pages``: a folder a version, with a list of all.

    make docs
    python distribution/publish.py 0.2.0           # then: git push origin gh-pages
    python distribution/publish.py latest --push   # as what / leads to, and pushed to origin

Folders of other versions stay as they are. The checkout and its branch are not touched.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BRANCH = "gh-pages"


def main() -> int:
    """Publish, or say what is missing.

    Returns:
        Exit code: 2 where there is nothing to publish, 1 where git fails.
    """
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("version", help="a version, or latest")
    options.add_argument("--pages", type=Path, default=ROOT / "docs" / "_build" / "html")
    options.add_argument("--root", type=Path, default=ROOT, help="the checkout")
    options.add_argument("--push", action="store_true", help="to origin")
    given = options.parse_args()
    if not re.fullmatch(r"latest|v?\d+(\.\d+)*\w*", given.version):
        print(f"publish: '{given.version}' is neither a version nor latest", file=sys.stderr)
        return 2
    if not (given.pages / "index.html").is_file():
        print(f"publish: {given.pages} has no pages; make docs builds them", file=sys.stderr)
        return 2
    try:
        publish(given.root, given.pages, given.version, given.push)
    except subprocess.CalledProcessError as error:
        print(f"publish: {' '.join(error.cmd)}: {error.stderr.strip()}", file=sys.stderr)
        return 1
    return 0


def publish(root: Path, pages: Path, version: str, push: bool) -> None:
    """Commit the pages to the branch.

    Args:
        root: Folder of the checkout.
        pages: That of the pages.
        version: Name of their folder on the branch.
        push: Whether to push the branch to ``origin``.

    Raises:
        CalledProcessError: Of git.
    """
    with tempfile.TemporaryDirectory(prefix="pages-") as parent:
        site = Path(parent) / "site"
        _check_out(root, site)
        try:
            shutil.rmtree(site / version, ignore_errors=True)
            shutil.copytree(pages, site / version, ignore=shutil.ignore_patterns(".doctrees"))
            (site / ".nojekyll").touch()  # else folders that begin with _ are left out
            (site / "index.html").write_text(front_page(site), encoding="utf-8")
            _git(site, "add", "--all", "--force")
            _git(site, "commit", "--quiet", "--allow-empty", "-m", f"Documentation of {version}")
            if push:
                _git(site, "push", "origin", BRANCH)
        finally:
            _git(root, "worktree", "remove", "--force", str(site))
    print(f"{version}: on the branch {BRANCH}" + (", pushed to origin" if push else ""))


def _check_out(root: Path, site: Path) -> None:
    """The branch as a work tree: that of origin where there is one, else a new one."""
    branches = _git(root, "branch", "--all", "--list", BRANCH, f"*/{BRANCH}").split()
    if BRANCH in branches:
        _git(root, "worktree", "add", "--quiet", str(site), BRANCH)
    elif any(name.endswith(f"origin/{BRANCH}") for name in branches):
        start = f"origin/{BRANCH}"
        _git(root, "worktree", "add", "--quiet", "-b", BRANCH, str(site), start)
    else:
        _git(root, "worktree", "add", "--quiet", "--detach", str(site))
        _git(site, "checkout", "--quiet", "--orphan", BRANCH)
        _git(site, "rm", "--quiet", "-r", "-f", ".")


def front_page(site: Path) -> str:
    """A page that leads to the latest version, or the newest one, and lists all of them.

    Args:
        site: Folder with a folder a version.
    """
    names = sorted(
        (path.parent.name for path in site.glob("*/index.html")),
        key=lambda name: (name == "latest", [int(part) for part in re.findall(r"\d+", name)]),
        reverse=True,
    )
    links = "".join(f'<li><a href="{escape(name)}/">{escape(name)}</a></li>' for name in names)
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>fenics_contact</title>'
        f'<meta http-equiv="refresh" content="2; url={escape(names[0])}/">'
        f"<h1>fenics_contact</h1><p>Documentation of</p><ul>{links}</ul></html>\n"
    )


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", *arguments]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    sys.exit(main())
