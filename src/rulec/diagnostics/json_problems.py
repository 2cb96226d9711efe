"""Mistakes in JSON documents, in the reader's terms."""

from __future__ import annotations


def json_words(problem: Exception) -> str:
    """Msgspec's message in the reader's terms; its path ``$.states[3]`` becomes ``states[3]``."""
    text, _, path = str(problem).partition(" - at `$")
    path = path.rstrip("`").lstrip(".")
    text = text[:1].lower() + text[1:]
    if "field `" not in text:  # a field's name may be the same as a type's
        for theirs, ours in _JSON_WORDS.items():
            text = text.replace(theirs, ours)
    return f"{text} (in `{path}`)" if path else text


_JSON_WORDS = {
    "jSON": "JSON",
    "`bool | float | str | object`": "true, false, a number, a string or an object",
    "`array`": "a list",
    "`array | null`": "a list",
    "invalid enum value": "there is no such value as",
    "`object`": "an object",
    "`str`": "a string",
    "`int | str`": "a string",
    "`float`": "a number",
    "`int`": "a whole number",
    "`bool`": "true or false",
    "`null`": "null",
}
