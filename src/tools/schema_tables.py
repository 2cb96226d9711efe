"""The fields of JSON outputs as tables for the documentation, from the schemas."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from rulec.report.text.markdown import table
from tools.json_schemas import SCHEMAS, schema_text


def schema_tables() -> str:
    """A section for each schema, with a table for each kind of object in it."""
    return "\n\n".join(
        f"## `{name}`\n\n{_kinds(json.loads(schema_text(name)))}" for name in SCHEMAS
    )


def _kinds(schema: Mapping[str, Any]) -> str:
    return "\n\n".join(
        part for name, kind in schema["$defs"].items() for part in _kind(name, kind) if part
    )


def _kind(name: str, kind: Mapping[str, Any]) -> tuple[str, str]:
    """What an object is, and its fields."""
    about = " ".join(kind.get("description", "").split())
    fields = ((f"`{field}`", _of(value)) for field, value in kind.get("properties", {}).items())
    return f"**{name}.** {about}".rstrip(), table(("field", "values"), fields)


def _of(value: Mapping[str, Any]) -> str:
    """What values a schema allows, in a few words."""
    match value:
        case {"$ref": str(reference)}:
            return reference.rpartition("/")[2]
        case {"anyOf": [*kinds]}:
            return " or ".join(map(_of, kinds))
        case {"enum": [*values]}:
            return ", ".join(f"`{json.dumps(one)}`" for one in values)
        case {"type": "array", "items": Mapping() as items}:
            return f"list of {_of(items)}"
        case {"type": "object", "additionalProperties": Mapping() as values}:
            return f"object whose values are {_of(values)}"
        case {"type": str(kind)}:
            return kind
    return "any"
