"""The order in which two processes take the files of tests: those that take longest first.

pytest-xdist takes files of many tests first, and those of few long tests last: one of them, begun
when all others are done, leaves the other process without work.
"""

from __future__ import annotations

from xdist.scheduler import LoadFileScheduling

# Files that take more than 20 s, although they have few tests.
LONGEST = (
    "tests/cli/test_clamp_page.py",
    "tests/solve/newton/test_closing_by_turns.py",
    "tests/project/test_demos.py",
    "tests/simulation/sweeps/test_processes.py",
    "tests/simulation/adaptive/test_goals.py",
    "tests/solve/test_memory.py",
    "tests/verification/test_command.py",
)


class LongestFirst(LoadFileScheduling):
    """Files by two or more processes, with those of ``LONGEST`` at the beginning."""

    def _assign_work_unit(self, node):
        waiting = next((file for file in LONGEST if file in self.workqueue), None)
        if waiting is not None:
            self.workqueue.move_to_end(waiting, last=False)
        super()._assign_work_unit(node)
