"""The friction laws beside Coulomb's: ``python docs/make_friction_law_figures.py``; a minute.

Draws docs/pictures/friction_laws.png: the bound over the pressure, and the friction traction of a
parabola that slides on a stiff block by normal compliance; and the friction force on the way there.
"""

import numpy as np
from make_figures import picture

from fenics_contact import Obstacle, Path, Result, Steps, run
from fenics_contact.report.drawing.figures import new_figure, style
from fenics_contact.report.drawing.style import DOUBLE, LINES
from fenics_contact.verification.published.friction_bounds import block_of, stiff_pad

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
    "slip dependent": {
        "friction_coefficient": 0.4,
        "friction_law": {"kind": "slip dependent", "slips": (0.002, 0.008), "shares": (1, 0.5)},
    },
}
WAY, INCREMENTS = 0.01, 25


def slid(keys: dict[str, object]) -> Result:
    """A parabola that is pressed in, and then slides in small load steps."""
    obstacle = Obstacle(
        "parabola",
        radius=0.5,
        indentation=0.01,
        position=(0, 0.2),
        displacement=(WAY, 0),
        displacement_path=Path(time=(1, 2), factor=(0, 1)),
    )
    contact = {"obstacle": obstacle, "normal_law": NORMAL, "law": "incremental", **keys}
    times = tuple(1 + np.arange(INCREMENTS + 1) / INCREMENTS)
    steps = {"steps": Steps(times=times), "solver": {"errors": "none"}}
    return run(stiff_pad(contact, **steps), body=block_of(100))


def main() -> None:
    """Solve and draw."""
    with style():
        figure, (left, right, last) = new_figure("Friction laws", (DOUBLE, 2.6), ncols=3)
        for (name, keys), (colour, dashes) in zip(LAWS.items(), LINES, strict=False):
            result = slid(keys)
            points = result.points
            traction = np.linalg.norm(points.friction_traction, axis=1)
            order = np.argsort(points.contact_pressure)
            looks = {"color": colour, "ls": dashes, "label": name}
            left.plot(points.contact_pressure[order], traction[order], **looks)
            right.plot(points.coordinates[:, 0], traction, **looks)
            forces = [step.quantities["friction_force"][0] for step in result.steps]
            ways = WAY * (np.array([step.load_factor for step in result.steps]) - 1)
            last.plot(ways, np.abs(forces), **looks)
        left.set(xlabel="contact pressure", ylabel="friction traction where it slips")
        right.set(xlabel="x", ylabel="friction traction", xlim=(-0.12, 0.12))
        last.set(xlabel="way of the parabola", ylabel="friction force", ylim=(0, None))
        last.set_xticks([0, WAY / 2, WAY])
        figure.legend(*left.get_legend_handles_labels(), loc="outside upper center", ncols=4)
        picture(figure, "friction_laws")


if __name__ == "__main__":
    main()
