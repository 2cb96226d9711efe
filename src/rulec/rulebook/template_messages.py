"""Mistakes in the name of a new rulebook."""

from __future__ import annotations

import re

from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code

NO_NAME = Code(
    "R0738",
    title="a rulebook cannot have this name",
    why="A rulebook's name is used in its first line and in rulebooks that extend it: it consists "
    "of letters, digits, `_` and `-`, begins with a letter, and is not a word of the language.",
    bad="rulec new 'Belgium 2'",
    good="rulec new belgium_2",
    kind="command",
)


def no_name(name: str) -> RulecError:
    """``name`` cannot be a rulebook's."""
    plain = re.sub(r"\W+", "_", name).strip("_").lower()
    offered = plain if plain[:1].isalpha() and plain != name.lower() else f"my_{plain or 'rules'}"
    return NO_NAME.error(
        None,
        f"`{name}` cannot be the name of a rulebook",
        expected="expected letters, digits, `_`, `-`, a letter first, and no word of the language",
        help=f"such as `{offered[:60]}`",
    )
