"""Tables of Protocol Buffers' fields, from a short form of their schemas.

A message is ``Name: 1 field Type, 2 other_field Type*``: numbers, names and types, with ``*`` for a
repeated field, and ``-`` for the name of a field that belongs to the message itself. The name of a
message alone stands for its fields. An enumeration is ``Name = word word``, numbered from 0 with
``-`` for unused numbers, or ``Name = 3 word, 7 word``. Indented lines go on with the one before.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import get_args

from rulec.recordings.encodings.wire_format import Field, Kind, Table, Words

_ENTRY = re.compile(r"(\w+)(:| =) ?(.*)", re.DOTALL)


def tables_of(schema: str, other: str, more: Mapping[str, Words]) -> Mapping[str, Table]:
    """The messages of a schema by name.

    ``other`` is the word for numbers that an enumeration lacks, empty if these are errors; ``more``
    are enumerations that the schema refers to. Raises ValueError or KeyError for a faulty schema.
    """
    types: dict[str, Kind | Words | Table] = {kind: kind for kind in get_args(Kind)}
    types |= more
    messages: dict[str, dict[int, Field]] = {}
    contents = {}
    for entry in re.split(r"\n(?=\S)", schema.strip()):
        match = _ENTRY.fullmatch(entry)
        if match is None:
            raise ValueError(entry)
        name, mark, content = match.groups()
        if mark == ":":
            contents[name], types[name] = content, messages.setdefault(name, {})
        else:
            types[name] = words_of(content, other)
    for name, content in contents.items():
        for part in content.split(","):
            match part.split():
                case [number, field, kind]:
                    holds, many = types[kind.removesuffix("*")], kind.endswith("*")
                    messages[name][int(number)] = Field(field.strip("-"), holds, many)
                case [included]:
                    messages[name] |= messages[included]
                case [_, *_]:
                    raise ValueError(part)
    return messages


def words_of(content: str, other: str) -> Words:
    """An enumeration from what stands behind its name."""
    if content[:1].isdigit():
        pairs = (pair.split() for pair in content.split(","))
        return Words({int(number): word for number, word in pairs}, other)
    words = enumerate(content.split())
    return Words({number: word for number, word in words if word != "-"}, other)
