"""The friction laws beside Coulomb's: ``python docs/make_friction_law_figures.py``; a minute.

Draws docs/pictures/friction_laws.png: the bound over the pressure, and the friction traction of a
parabola that slides on a stiff block by normal compliance.
"""

import numpy as np
from make_figures import picture

from fenics_contact import Obstacle, run
from fenics_contact.report.drawing.figures import new_figure, style
from fenics_contact.report.drawing.style import DOUBLE, LINES
from fenics_contact.verification.laws.stiff_block import block_of, stiff_pad

NORMAL = {"kind": "normal compliance", "coefficient": 4e4, "exponent": 2}
# Name → what the contact has.
LAWS = {
    "Coulomb, μ = .4": {"friction_coefficient": 0.4},
    "compliance, m_t = 1.5": {
        "friction_law": {"kind": "compliance", "coefficient": 600.0, "exponent": 1.5}
    },
    "pressure dependent": {
        "friction_coefficient": 0.4,
        "friction_law": {"kind": "pressure dependent", "pressures": (0, 4), "shares": (1, 0.4)},
    },
}


def main() -> None:
    """Solve and draw."""
    obstacle = Obstacle(
        "parabola", radius=0.5, indentation=0.01, position=(0, 0.2), displacement=(0.01, 0)
    )
    with style():
        figure, (left, right) = new_figure("Friction laws", (DOUBLE, 3.0), ncols=2)
        for (name, keys), (colour, dashes) in zip(LAWS.items(), LINES, strict=False):
            contact = {"obstacle": obstacle, "normal_law": NORMAL, **keys}
            points = run(stiff_pad(contact), body=block_of(200)).points
            traction = np.linalg.norm(points.friction_traction, axis=1)
            order = np.argsort(points.contact_pressure)
            looks = {"color": colour, "ls": dashes, "label": name}
            left.plot(points.contact_pressure[order], traction[order], **looks)
            right.plot(points.coordinates[:, 0], traction, **looks)
        left.set(xlabel="contact pressure", ylabel="friction traction where it slips")
        right.set(xlabel="x", ylabel="friction traction", xlim=(-0.12, 0.12))
        left.legend()
        picture(figure, "friction_laws")


if __name__ == "__main__":
    main()
