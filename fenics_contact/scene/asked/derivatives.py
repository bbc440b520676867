"""The part of a scene that asks what its answer depends on."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

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
