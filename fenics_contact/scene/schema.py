"""The JSON schema of a scene file, by which editors complete it and mark what is wrong.

It is read off the classes: keys, types, ranges, words that are accepted, defaults, meanings. What
keys say about each other, such as that a load is of exactly one kind, only reading a scene finds.
"""

from __future__ import annotations

from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import PydanticOmit

from fenics_contact.common.program import VERSION
from fenics_contact.scene.quantity_names import pattern_of_quantities
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import Profile

# The newest that editors of TOML know.
_DIALECT = "http://json-schema.org/draft-07/schema#"
_NAMED = "NamedShares"


def scene_schema() -> dict[str, Any]:
    """The schema, as a dictionary for ``json.dumps``."""
    schema = TypeAdapter(Scene).json_schema(schema_generator=_OfFiles)
    said = _descriptions(Scene)
    for name, table in schema["$defs"].items():
        _describe(table, said[name])
    _describe(schema, said[Scene.__name__])
    schema["title"] = f"Scene of fenics_contact {VERSION}"
    schema["required"] = [*schema["required"], "mesh"]  # which only Python may leave out
    _take_names(schema["$defs"])
    return {"$schema": _DIALECT, **schema}


class _OfFiles(GenerateJsonSchema):
    """Schema generator for files: they hold no functions, and no key without a value."""

    def callable_schema(self, schema: Any) -> JsonSchemaValue:
        raise PydanticOmit

    def nullable_schema(self, schema: Any) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: Any) -> JsonSchemaValue:
        found = super().default_schema(schema)
        if found.get("default", "") in (None, [], {}, ""):
            found.pop("default", None)
        return found

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False  # the key says as much


def _descriptions(table: type) -> dict[str, dict[str, str]]:
    """Return the descriptions of the keys of a class and its tables, by class and key."""
    keys = keys_of(table)
    found = {table.__name__: {key.name: key.description for key in keys}}
    for inner in {inner for key in keys for inner in key.tables} | {Profile}:
        found |= _descriptions(inner) if inner is not table else {}
    return found


def _describe(table: dict[str, Any], said: dict[str, str]) -> None:
    """The first paragraph of a class and sentences of its keys, instead of all its docstring."""
    paragraph = table.get("description", "").partition("\n\n")[0]
    table["description"] = " ".join(paragraph.split())
    for name, key in table.get("properties", {}).items():
        words = said[name]
        if words:
            key["description"] = f"{words[0].upper()}{words[1:]}."
        for limit in ("min", "max"):  # of one table, or a list of them
            if "anyOf" in key and f"{limit}Length" in key:
                key[f"{limit}Items"] = key.pop(f"{limit}Length")
        if "enum" in key.get("propertyNames", {}):  # which editors do not complete
            entry = key.pop("additionalProperties")
            key["properties"] = dict.fromkeys(key.pop("propertyNames")["enum"], entry)
            key["additionalProperties"] = False


def _take_names(definitions: dict[str, Any]) -> None:
    """Quantities by their names among the keys of an accuracy, in quotes or with dots."""
    accuracy = definitions["Accuracy"]
    of = accuracy["properties"]["of"]
    share = of["additionalProperties"]
    reference = {"$ref": f"#/$defs/{_NAMED}"}
    table = {"type": "object", "minProperties": 1, "additionalProperties": reference}
    definitions[_NAMED] = {"title": _NAMED, "anyOf": [share, table]}
    of["additionalProperties"] = reference
    accuracy["patternProperties"] = {pattern_of_quantities(): reference}
    accuracy["additionalProperties"] = table
