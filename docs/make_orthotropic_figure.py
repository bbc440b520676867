"""Orthotropic friction: ``python docs/make_orthotropic_figure.py``; some seconds.

Draws docs/pictures/orthotropic.png: the ellipse that friction lies within, and the friction of a
block that is dragged in several directions.
"""

import numpy as np
from make_figures import picture

from fenics_contact.report.drawing.figures import new_figure, style
from fenics_contact.report.drawing.style import COLUMN, LINES
from fenics_contact.verification.published.torque import ACROSS, ALONG, AXES, PRESSING, dragged

ANGLES = (10, 45, 155, 190, 260, 335)


def main() -> None:
    """Solve and draw."""
    around = np.linspace(0, 2 * np.pi, 200)
    (own, dashes), (other, _) = LINES[:2]
    with style():
        figure, (panel,) = new_figure("A block that is dragged", (COLUMN, 3.6))
        panel.plot(ALONG * np.cos(around), ACROSS * np.sin(around), color=own, ls=dashes)
        panel.plot([], [], color=own, label="bound, μ₁ = .2 and μ₂ = .5")
        for number, angle in enumerate(np.radians(ANGLES)):
            way = np.array([np.cos(angle), np.sin(angle)])
            force = dragged(tuple(way @ AXES)).quantities["friction_force"][:2]
            on_block = AXES @ np.divide(force, PRESSING)
            arrow = {"angles": "xy", "scale_units": "xy", "scale": 1, "width": 0.008}
            panel.quiver(0, 0, *on_block, color=own, **arrow)
            panel.quiver(*on_block, *(-0.2 * way), color=other, **arrow)
            panel.plot(*on_block, "o", color=own, ms=4, label="friction" if number == 0 else None)
        panel.plot([], [], color=other, label="opposite to the slip")
        panel.set(xlabel="friction along the grain / p", ylabel="across it / p", aspect="equal")
        panel.set(xlim=(-0.5, 0.5), ylim=(-0.75, 0.75))
        figure.legend(loc="outside lower center", ncols=1)
        picture(figure, "orthotropic")


if __name__ == "__main__":
    main()
