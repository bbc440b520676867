"""Build the wheel, and go from a scene to its first picture with it in an empty environment.

``make wheel`` runs it. What is fetched is what users fetch; nothing of this checkout is seen. It
prints how long the first picture takes once all is installed.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def main() -> int:
    """Do so.

    Returns:
        Exit code; 1 where a step fails, whose output is then there to be read.
    """
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the wheel")
    out = options.parse_args().out
    with tempfile.TemporaryDirectory(prefix="fenics-contact-") as folder:
        try:
            return _tried(out, Path(folder))
        except subprocess.CalledProcessError as error:
            print(f"{' '.join(map(str, error.cmd))}: exit code {error.returncode}", file=sys.stderr)
            return 1


def _tried(out: Path, folder: Path) -> int:
    wheel = built(out, folder / "wheel")
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB")
    _run([sys.executable, "-m", "venv", str(folder / "venv")], folder)
    commands = folder / "venv" / "bin"
    wanted = f"fenics-contact[wheel,pictures] @ {wheel.as_uri()}"
    _run([str(commands / "pip"), "install", "-q", "--disable-pip-version-check", wanted], folder)
    program = str(commands / "fenics-contact")
    started = time.monotonic()
    _run([program, "new", "hertz"], folder)
    _run([program, "run", "hertz.toml"], folder)
    _run([program, "report", "results/hertz"], folder)
    pictures = sorted((folder / "results" / "hertz").rglob("*.png"))
    result = json.loads((folder / "results" / "hertz" / "result.json").read_text(encoding="utf-8"))
    if not pictures or not result["passed"]:
        print("no picture, or a check failed", file=sys.stderr)
        return 1
    took = time.monotonic() - started
    print(f"from an empty folder to {len(pictures)} pictures and a report: {took:.0f} s")
    return 0


def built(out: Path, folder: Path) -> Path:
    """Make the wheel.

    Args:
        out: Where it is kept.
        folder: That does not exist yet.

    Returns:
        The file in ``out``.
    """
    folder.mkdir()
    pip = [sys.executable, "-m", "pip", "wheel", "-q", "--disable-pip-version-check", "--no-deps"]
    _run([*pip, "--wheel-dir", str(folder), str(ROOT)], ROOT)
    (made,) = folder.glob("*.whl")
    out.mkdir(parents=True, exist_ok=True)
    kept = out.resolve() / made.name
    kept.write_bytes(made.read_bytes())
    return kept


def _run(command: list[str], folder: Path) -> None:
    hidden = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "FENICS_CONTACT_PYTHON")
    environment = {key: value for key, value in os.environ.items() if key not in hidden}
    subprocess.run(command, cwd=folder, env=environment, check=True)


if __name__ == "__main__":
    sys.exit(main())
