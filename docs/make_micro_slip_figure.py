"""Friction with micro-slip: ``python docs/make_micro_slip_figure.py``; some seconds.

Draws docs/pictures/micro_slip.png: friction over the slip of a block that is moved to and fro.
"""

import numpy as np
from make_figures import picture

from fenics_contact.report.drawing.figures import new_figure, style
from fenics_contact.report.drawing.style import COLUMN, LINES
from fenics_contact.verification.published.friction_bounds import block_of, to_and_fro

MOVED = 5e-3
SHARES = (0.05, 0.4, 1.0)


def main() -> None:
    """Solve and draw."""
    with style():
        figure, (panel,) = new_figure("A block to and fro", (COLUMN, 3.4))
        for share, (colour, dashes) in zip(SHARES, LINES, strict=False):
            steps = to_and_fro(block_of(2), MOVED, 40, share * MOVED).steps
            forces = [0.0, *(-step.quantities["friction_force"][0] for step in steps)]
            times = [0.0, *(step.load_factor for step in steps)]
            slips = np.interp(times, (0, 1, 2, 3), (0, 1, -1, 1))
            label = f"elastic slip {share:g} s"
            panel.plot(slips, np.divide(forces, 30.0), color=colour, ls=dashes, label=label)
        panel.set(xlabel="slip over its amplitude s", ylabel="friction over its bound")
        panel.set(xticks=(-1, 0, 1), yticks=(-1, 0, 1))
        figure.legend(loc="outside lower center", ncols=1)
        picture(figure, "micro_slip")


if __name__ == "__main__":
    main()
