"""Messages about a lock, about comments that allow, and about a new rulebook's name."""

from __future__ import annotations

import re

from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code

NOT_AS_LOCKED = Code("R0725")

WRONG_LOCK = Code("R0726")


UNFIT_ALLOWANCE = Code("R0219")


NO_NAME = Code("R0738")


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
