"""A kind of load that is not the program's: a shear along a plane boundary, all in one file."""

from typing import Annotated

import ufl
from pydantic import Field

from fenics_contact.common.errors import InputError
from fenics_contact.problem import loads
from fenics_contact.problem.loads import Traction
from fenics_contact.quantities.names import MAX_CONTACT_PRESSURE
from fenics_contact.scene.loading.load_kinds import LoadKind
from fenics_contact.scene.units.dimensions import STRESS
from fenics_contact.scene.values import Value

SHEAR = Annotated[
    Value | None,
    STRESS,
    LoadKind("shear", MAX_CONTACT_PRESSURE),
    Field(description="along a straight boundary in the plane; > 0 to the left of its normal"),
]


class Shear(Traction):
    """A force over the length of a straight boundary, along it."""

    kind = "shear"

    @property
    def force(self):
        """Along the normal, turned to the left."""
        return self.value * ufl.perp(ufl.FacetNormal(self.spaces.body.mesh))

    @staticmethod
    def place(group, key, spaces):
        """A boundary in the plane."""
        if spaces.body.dimension != 2:
            raise InputError(f"{key} = '{group}': a shear needs a plane model")
        return Traction.place(group, key, spaces)


def register():
    """Make it known."""
    loads.register(Shear, SHEAR)


def unregister():
    """Make it unknown again."""
    loads.unregister(Shear.kind)
