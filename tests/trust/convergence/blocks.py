"""Blocks on their bases with an obstacle on their tops."""

from fenics_contact import Contact, Discretisation, Material, Obstacle, Scene, Support

GEOMETRY = """
Point(1) = {0, 0, 0, .1}; Point(2) = {1, 0, 0, .1};
Point(3) = {1, 1, 0, .1}; Point(4) = {0, 1, 0, .1};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Physical Curve("y0") = {1}; Physical Curve("y1") = {3}; Physical Surface("body") = {1};
"""


def pressed(obstacle: Obstacle, dimension: int = 2, **more) -> Scene:
    """Degree 1: all points are corners of cells."""
    low, high = "yz"[dimension - 2] + "0", "yz"[dimension - 2] + "1"
    return Scene(
        kinematics="plane strain" if dimension == 2 else "3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(Support(low, dict.fromkeys("xyz"[:dimension], 0)),),
        contact=(Contact(high, obstacle=obstacle),),
        **more,
    )
