"""Names of command options as arguments of Python functions.

Messages name options as the commands do, but callers of a function pass arguments instead.
"""

from __future__ import annotations

import os
import re
from contextlib import AbstractContextManager

from rulec.resources import variable_set

_VARIABLE = "RULEC_NAMES_OPTIONS"

_ARGUMENTS = {
    "adjacency": "adjacency",
    "after": "after",
    "at-time": "at_s",
    "bounds": "bounds",
    "by": "by",
    "congested-below": "congested_below_kmh",
    "ego": "ego",
    "engine": "engine",
    "extent": "extent",
    "frame-rate": "frame_rate",
    "horizon": "horizon_s",
    "input-format": "form",
    "map": "map_path",
    "objects": "objects",
    "prediction": "prediction",
    "prove": "prove",
    "reference": "reference",
    "rulebook": "rulebook",
    "scenario": "scenario_id",
    "step": "step_s",
    "use": "vocabulary",
}
_OPTION = rf"--({'|'.join(_ARGUMENTS)})(?![\w.-])"
_PLAIN = re.compile(_OPTION + "(?: FILE)?")
_QUOTED = re.compile(_OPTION + "(?: (.+))?")
_FORMAT_OF_TRACES = re.compile(r"add `--input-format (\w+)`")


def naming_options() -> AbstractContextManager[None]:
    """Keep option names in messages in a block, and in processes started in it."""
    return variable_set(_VARIABLE, "1")


def for_caller(text: str) -> str:
    """A message, or part of one, for its reader: options for commands, arguments for Python."""
    if "--" not in text or _VARIABLE in os.environ:
        return text
    text = _FORMAT_OF_TRACES.sub(r"let its name end in `.\1`", text)
    parts = text.split("`")
    # Every second part was in backquotes; if it is e.g. a whole command, it stays unchanged.
    parts[::2] = [_PLAIN.sub(lambda found: f"`{_argument(found)}`", part) for part in parts[::2]]
    parts[1::2] = [
        _argument(found) if (found := _QUOTED.fullmatch(part)) else part for part in parts[1::2]
    ]
    return "`".join(parts)


def _argument(option: re.Match[str]) -> str:
    name = _ARGUMENTS[option[1]]
    value = option[2] if option.re is _QUOTED else None
    if value is None:
        return name
    is_text = not re.fullmatch(r"[A-Z]+|[0-9./]+", value)
    return f'{name}="{value}"' if is_text else f"{name}={value}"
