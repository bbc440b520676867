"""Base class of the objects of ``result.json``: a frozen dataclass that also has keys."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from typing import Any, ClassVar, TypeVar

import numpy as np

from fenics_contact.scene.units.dimensions import UnitNames

Class = TypeVar("Class", bound=type)
# By name: a number, a list for a vector, None where there is no value.
Quantities = Mapping[str, Any]
# Source → estimated absolute error, and their ``total``; None where it was not estimated.
ErrorRow = Mapping[str, float | None]
Errors = Mapping[str, ErrorRow]


@dataclass(frozen=True, eq=False)
class Record(Mapping[str, Any]):
    """An object of ``result.json``: its attributes are the keys.

    Scripts may as well read it by the keys that stand in the file, ``contact["quantities"]``;
    those that are left out there are not among them.

    Attributes:
        LEFT_OUT: Keys that are left out of the file where their value is None or empty.
    """

    LEFT_OUT: ClassVar[frozenset[str]] = frozenset()

    def is_written(self, name: str) -> bool:
        """Whether an attribute stands in the file."""
        return name not in self.LEFT_OUT or getattr(self, name) not in (None, "", [], (), {})

    def __iter__(self) -> Iterator[str]:
        return (field.name for field in fields(self) if self.is_written(field.name))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __getitem__(self, key: str) -> Any:
        if key not in self:
            raise KeyError(key)
        return getattr(self, key)

    def __contains__(self, key: object) -> bool:
        return key in _attributes(type(self)) and self.is_written(str(key))

    def as_dict(self) -> dict[str, Any]:
        """With all that is in it, as dictionaries and lists."""
        return {key: plain(value) for key, value in self.items()}


@cache
def _attributes(record: type[Record]) -> frozenset[str]:
    """The names of a record's attributes; not of its class's, which dataclasses list with them."""
    return frozenset(field.name for field in fields(record))


def plain(value: Any) -> Any:
    """Records and all that is in them as dictionaries, lists and Python's own numbers.

    JSON has no others: of NumPy's it would refuse all but floating-point numbers.

    Args:
        value: A record, or what may stand in one.

    >>> plain({"passed": np.bool_(True), "force": np.array([1.0, 2.0]), "steps": np.int64(3)})
    {'passed': True, 'force': [1.0, 2.0], 'steps': 3}
    """
    if isinstance(value, Mapping):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def meanings(record: type) -> dict[str, str]:
    """Return the meaning of each attribute of a record, from its docstring and those of its bases.

    Args:
        record: Its class.
    """
    found: dict[str, str] = {}
    for one in reversed(record.__mro__):
        text = inspect.cleandoc(one.__doc__ or "").partition("\nAttributes:\n")[2]
        entries = re.findall(r"^    (\w+): (.*(?:\n {5,}.*)*)", text, re.MULTILINE)
        found |= {name: " ".join(words.split()) for name, words in entries}
    return {field.name: found[field.name] for field in fields(record) if field.name in found}


def described(record: Class) -> Class:
    """Have a record's docstring say what all its attributes are, those of its bases as well."""
    summary = inspect.cleandoc(record.__doc__ or "").partition("\nAttributes:\n")[0]
    lines = [f"    {name}: {words}" for name, words in meanings(record).items()]
    record.__doc__ = "\n".join([summary, "Attributes:", *lines])
    return record


@dataclass(frozen=True, eq=False, kw_only=True)
class UnitsRecord(Record):
    """Units of all numbers of a run's files.

    Attributes:
        length: Such as `mm`.
        force: Such as `N`.
        stress: Such as `MPa`.
        energy: Such as `mJ`.
        per_unit_thickness: Whether forces, areas and energies are per length, as in plane models
            without a thickness.
        quantities: Quantity → its unit in this run; without those that are pure numbers.
        temperature: `K` or `°C`.
    """

    length: str
    force: str
    stress: str
    energy: str
    per_unit_thickness: bool = False
    quantities: Mapping[str, str] = field(default_factory=dict)
    temperature: str = "K"

    def of(self, words: str) -> str:
        """The unit of what is measured, such as ``stress/length``; empty of a pure number."""
        if not self.length:
            return ""
        own = self.length, self.force, self.stress, self.energy
        return UnitNames(*own, self.per_unit_thickness, self.temperature).of(words)


#: Where a scene has none: nothing is said.
NO_UNITS = UnitsRecord(length="", force="", stress="", energy="")
