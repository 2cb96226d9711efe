"""Why a table is not proved, and exact numbers as spelled in a compiled file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fractions import Fraction


class UnprovableError(Exception):
    """The reason why a table is not proved.

    ``word`` is a shortest word that shows it, if there is one: for each state, what is read of it.
    """

    def __init__(self, reason: str, word: Sequence[Mapping[str, str]] = ()) -> None:
        super().__init__(reason)
        self.reason = reason
        self.word = tuple(word)


def require(condition: bool, reason: str) -> None:
    """Raise UnprovableError unless a condition holds."""
    if not condition:
        raise UnprovableError(reason)


_FRACTION = re.compile(r"-?[0-9]{1,1000}(?:/[0-9]{1,1000})?")


def exact(text: str) -> Fraction:
    """The fraction that a text spells in lowest terms. Raises UnprovableError for other texts."""
    require(bool(_FRACTION.fullmatch(text)), f"{text[:40]!a} is not a number")
    number = Fraction(text)
    require(str(number) == text, f"{text[:40]!a} is not in lowest terms")
    return number
