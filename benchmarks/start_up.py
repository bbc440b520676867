"""Seconds of the slab demo beyond ``import dolfinx``, from a warm cache, without pictures.

Each is the least of several runs of a process of its own, interleaved, since machines are
shared. ``python benchmarks/start_up.py [--repeat N] [--json FILE]``
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# mpi4py first: on the wheel, dolfinx does not find MPI by itself.
IMPORT = [sys.executable, "-c", "from mpi4py import MPI; import dolfinx"]


def seconds(command: list[str]) -> float:
    """Wall time of a process."""
    started = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, stdin=subprocess.DEVNULL)
    return time.perf_counter() - started


def main() -> None:
    """Measure and print; at most 2 s apart is what the project asks of itself."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        script = str(ROOT / "demos" / "demo_slab.py")
        demo = [sys.executable, script, "--out", folder, "--no-pictures"]
        seconds(demo)  # fills the cache of compiled forms
        pairs = [(seconds(IMPORT), seconds(demo)) for _ in range(options.repeat)]
        inside = json.loads((Path(folder) / "result.json").read_text())["timings"]
    imports, demos = (min(column) for column in zip(*pairs, strict=True))
    row = {"import": imports, "demo": demos, "difference": demos - imports, "inside": inside}
    print(f"import dolfinx {imports:.2f} s, slab demo {demos:.2f} s: {demos - imports:.2f} s more")
    if options.json:
        options.json.write_text(json.dumps(row, indent=2) + "\n")


if __name__ == "__main__":
    main()
