"""Grid points of Nastran in systems of their own, which are inverted here by other formulas."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, bdf
from tests.mesh.readers.test_formats import write
from tests.messages import refused

COMM = MPI.COMM_WORLD


class System:
    """A system whose axes are the columns of a rotation."""

    def __init__(self, kind, origin, turn, reference=None):
        self.kind, self.origin, self.reference = kind, np.array(origin, dtype=float), reference
        first, second, third = np.radians(turn)
        around_z = np.array([[np.cos(first), -np.sin(first), 0], [np.sin(first), np.cos(first), 0]])
        around_z = np.vstack([around_z, [0, 0, 1]])
        around_x = np.eye(3)
        around_x[1:, 1:] = [[np.cos(second), -np.sin(second)], [np.sin(second), np.cos(second)]]
        last = np.eye(3)
        last[:2, :2] = [[np.cos(third), -np.sin(third)], [np.sin(third), np.cos(third)]]
        self.turn = around_z @ around_x @ last

    def local(self, at):
        """Coordinates of a point of the basic system in this one."""
        x, y, z = self.turn.T @ (np.asarray(at) - self.origin)
        if self.kind == "R":
            return x, y, z
        if self.kind == "C":
            return np.hypot(x, y), np.degrees(np.arctan2(y, x)), z
        radius = np.linalg.norm([x, y, z])
        return radius, np.degrees(np.arccos(z / radius)), np.degrees(np.arctan2(y, x))

    @property
    def points(self):
        """On its origin, on its z-axis, and beside that in the plane of x and z."""
        x, _, z = self.turn.T
        return [self.origin, self.origin + 2 * z, self.origin + 0.7 * x + 0.4 * z]


FIRST = System("R", (0.3, -0.2, 0.5), (20, 50, -30))
SECOND = System("C", (-0.4, 0.1, 0.2), (70, -35, 10), (5, FIRST))
THIRD = System("S", (1.2, -0.7, -0.6), (-15, 110, 40), (6, SECOND))
SYSTEMS = {5: FIRST, 6: SECOND, 7: THIRD}


def cord2(number, system):
    """A system by three points of the one that it refers to, or of the basic one."""
    reference, of = system.reference or (0, System("R", (0, 0, 0), (0, 0, 0)))
    values = [f"{value:.15g}" for at in system.points for value in of.local(at)]
    words = [f"CORD2{system.kind}", str(number), str(reference), *values]
    return ",".join(words[:9]) + "\n," + ",".join(words[9:]) + "\n"


def grid(number, at, system=None, name=""):
    """A grid point; ``name`` is what stands for the number of its system."""
    local = at if system is None else system.local(at)
    return f"GRID,{number},{name}," + ",".join(f"{value:.15g}" for value in local) + "\n"


def deck(points, before, default=""):
    """A block of hexahedra whose lines of grid points are these."""
    text = bdf(Block("hexahedron"), "CHEXA")
    head, rest = text.split("GRID*", 1)
    return head + default + before + "".join(points) + rest[rest.index("CHEXA") :]


def places(folder, text):
    """Coordinates of the mesh's nodes, sorted."""
    body = load_body(write(folder, text, "b.bdf"), 3, COMM)
    every = np.concatenate(COMM.allgather(np.round(body.mesh.geometry.x, 9)))
    return np.unique(every + 0.0, axis=0)


def test_points_in_systems_of_each_kind(folder):
    """Systems that refer to each other, listed from the last to the first."""
    points, names = Block("hexahedron").points, ["", "0", "5", "6", "7"]
    rows = [
        grid(number, at, SYSTEMS.get(int(name or 0)), name)
        for number, at in enumerate(points, 11)
        for name in [names[number % len(names)]]
    ]
    before = "".join(cord2(number, SYSTEMS[number]) for number in (7, 6, 5))
    found = places(folder, deck(rows, before))
    assert found == pytest.approx(np.unique(np.round(points, 9), axis=0), abs=1e-8)


def test_systems_by_grid_points_and_a_default(folder):
    """CORD1C and CORD1R on one another; GRDSET is of points without a system of their own."""
    points = Block("hexahedron").points
    system = System("C", FIRST.origin, (20, 50, -30))
    marks = [grid(901 + n, at, None, "0") for n, at in enumerate(system.points)]
    rows = [grid(number, at, system) for number, at in enumerate(points, 11)]
    rows[3] = grid(14, points[3], FIRST, "9")
    before = "CORD1C,8,901,902,903\nCORD1R,9,901,902,903,10,901,902,903\n"
    found = places(folder, deck([*rows, *marks], before, "GRDSET,,8\n"))
    assert found == pytest.approx(np.unique(np.round(points, 9), axis=0), abs=1e-8)


@pytest.mark.parametrize(
    ("before", "message"),
    [
        ("", "bdf_system_not_defined"),
        ("CORD2R,5,0,0.,0.,0.,0.,0.,1.\n,0.,0.,3.\n", "bdf_system_on_a_line"),
        ("CORD2R,5,6,0.,0.,0.,0.,0.,1.\n,1.,0.,3.\nCORD2R,6,5,0.,0.,0.,0.,0.,1.\n,1.,0.,3.\n",
         "bdf_system_by_itself"),
        ("CORD1R,5,901,902,903\n", "bdf_system_by_no_point"),
        (2 * "CORD2R,5,0,0.,0.,0.,0.,0.,1.\n,1.,0.,3.\n", "bdf_system_twice"),
    ],
)  # fmt: skip
def test_what_is_no_system(folder, before, message):
    rows = [grid(n, at, None, "5") for n, at in enumerate(Block("hexahedron").points, 11)]
    source = write(folder, deck(rows, before), "b.bdf")
    with refused(message):
        load_body(source, 3, COMM)
