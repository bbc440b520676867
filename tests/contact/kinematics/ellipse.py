"""An obstacle that is not the program's: an ellipse half as high as wide, all in one file."""

import numpy as np

from fenics_contact.analytic import obstacle_shapes
from fenics_contact.analytic.obstacle_shapes import Cylinder

RATIO = 2.0  # of the half-axes, the longer one along the surface


class Ellipse(Cylinder):
    """By its half-axis along the surface, as ``radius``; that across is half of it."""

    name = "ellipse"
    is_hertzian = False

    def gaps(self, offsets, rays, sizes):
        """Stretched across, it is a circle; a ray's length goes with it."""
        stretch = np.eye(3) + (RATIO - 1) * np.outer(sizes.normal, sizes.normal)
        return super().gaps(offsets @ stretch, rays @ stretch, sizes)


def register():
    """Make it known."""
    obstacle_shapes.register(Ellipse())


def unregister():
    """Make it unknown again."""
    obstacle_shapes.unregister(Ellipse.name)
