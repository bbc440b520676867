"""Names that methods of laws had earlier, kept for the classes that users derive."""

from __future__ import annotations

from collections.abc import Mapping


def keep_earlier_names(law: type, names: Mapping[str, str]) -> None:
    """Let a class answer, and override, by the earlier names of its methods, too.

    Args:
        law: A class, called with each one that is derived.
        names: Earlier name → present name.
    """
    own = vars(law)
    for earlier, name in names.items():
        if name in own:
            setattr(law, earlier, own[name])
        elif earlier in own:
            setattr(law, name, own[earlier])
