"""One answer of one program, in its own Python: ``worker.py PROGRAM PROBLEM LEVEL SETTING``.

Its last line is the answer as JSON, or that of the error.
"""

from __future__ import annotations

import dataclasses
import json
import sys

from problems import problem_named
from programs import program_in


def main() -> None:
    """Solve and print."""
    file, wanted, level, label = sys.argv[1:]
    program = program_in(file)
    setting = program.SETTINGS[wanted][label]
    answer = program.solve(problem_named(wanted), int(level), setting)
    print(json.dumps(dataclasses.asdict(answer)))


if __name__ == "__main__":
    main()
