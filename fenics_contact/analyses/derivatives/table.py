"""The parts of a scene that ask what its answer depends on, and say how sure its numbers are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from fenics_contact.quantities import table
from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.settings import flat_names
from fenics_contact.scene.values import Text, scene_class

_Names = tuple[Text, ...]


@scene_class
class DerivativeRequest:
    """Derivatives of quantities in numbers of the scene, which a run is to find.

    >>> DerivativeRequest(of=("normal_force",)).by is None
    True
    """

    of: Annotated[
        _Names,
        Field(
            min_length=1,
            description="quantities by their names, as in `[accuracy]`: `normal_force`, "
            "`left.reaction_x`, `displacement_tip_y`",
        ),
    ]
    by: Annotated[
        _Names | None,
        Field(
            description="keys of numbers as of `--set`, such as `contact.0.friction_coefficient`; "
            "by default all numbers of the scene that have a derivative"
        ),
    ] = None

    def __post_init__(self) -> None:
        for key in ("of", "by"):
            names = getattr(self, key) or ()
            twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
            if twice:
                raise ValueError(f"{key}: '{twice[0]}' is given twice")


def as_tolerances(value: Any) -> Any:
    """Keys, in quotes or dotted, and how far each number may be off either way.

    >>> as_tolerances({"contact": {"0": {"friction_coefficient": 0.05}}})
    {'contact.0.friction_coefficient': 0.05}
    """
    if not isinstance(value, Mapping):
        raise ValueError("must be a table of keys, such as 'contact.0.friction_coefficient' = 0.05")
    found: dict[str, Any] = {}
    for name, tolerance in flat_names(value):
        if name in found:
            raise ValueError(f"'{name}' is given twice")
        found[name] = tolerance
    return found


class _AskingForDerivatives(CoreScene):
    """A scene with one of these tables."""

    derivatives: DerivativeRequest | None


def require(scene: _AskingForDerivatives) -> None:
    """Refuse tolerances alone, and quantities that are none of the scene, or vectors.

    Raises:
        ValueError: In words.
    """
    if scene.derivatives is None:
        raise ValueError(
            "tolerances: say in [derivatives] of which quantities, such as of = ['normal_force']"
        )
    for name in scene.derivatives.of:
        try:
            found = scene.names.find(name)
        except ValueError as error:
            raise ValueError(f"derivatives.of: {error}") from None
        if table.is_vector(found.quantity, scene.dimension) and found.axis is None:
            raise ValueError(
                f"derivatives.of: '{name}' is a vector; ask for its components, as {name}_x"
            )
