"""Phrases that messages share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache

_MOST_NAMED = 8
_SHORT_WORD = 3
_MOST_SEARCHED = 500
"""With more names the search takes too long; then only a name that differs in case is found."""


def nearest_name(
    name: str, known: Iterable[str], alike: float = 0.6, *, longer: bool = True
) -> str | None:
    """The known name closest to ``name``, ignoring case, or None.

    ``alike`` is the minimum similarity: the share of letters in common, in the same order. A short
    name is also more than half as long. With ``longer``, the only name with all its words, and
    more, is also close.
    """
    by_folded: dict[str, str] = {}
    for candidate in known:
        by_folded.setdefault(candidate.casefold(), candidate)
    same = by_folded.get(name.casefold())
    if same is not None or len(by_folded) > _MOST_SEARCHED:
        return same
    long_enough = tuple(
        folded
        for folded in by_folded
        if len(folded) > min(_SHORT_WORD, len(name) - 2) or 2 * len(folded) > len(name)
    )
    close = _closest(name.casefold(), long_enough, alike)
    if close:
        return by_folded[close[0]]
    return _longer_name(name, by_folded) if longer else None


def _longer_name(name: str, by_folded: Mapping[str, str]) -> str | None:
    """The only known name that contains all words of this one and more: `boarding_passengers`."""
    words = {*name.casefold().split("_")}
    longer = [folded for folded in by_folded if words < {*folded.split("_")}]
    return by_folded[longer[0]] if len(name) > _SHORT_WORD and len(longer) == 1 else None


@lru_cache(maxsize=64)  # the same mistake in each row of a file is searched for once
def _closest(name: str, known: tuple[str, ...], alike: float) -> list[str]:
    # 1 ms: only where a name is not known.
    from difflib import get_close_matches

    return get_close_matches(name, known, n=1, cutoff=alike)


def did_you_mean(name: str, known: Iterable[str], alike: float = 0.6) -> str:
    """A question with the nearest known name, as above; empty if none is close."""
    near = nearest_name(name, known, alike)
    return "" if near is None else f"did you mean `{near}`?"


def named(names: Sequence[str]) -> str:
    """Names in backquotes, separated by commas; only the first of many."""
    shown = [f"`{name}`" for name in names[:_MOST_NAMED]]
    return ", ".join([*shown, "…"] if len(names) > len(shown) else shown)


def first_of(names: Sequence[str], most: int, rest: str = "and") -> str:
    """``a, b, and 7 more``: the first ``most`` names, and how many more there are.

    ``rest`` is what stands before the number of the others: ``and``, or ``or one of``.
    """
    shown, more = ", ".join(names[:most]), len(names) - most
    if more <= 0:
        return shown
    return f"{shown}{' ' if most == 1 else ', '}{rest} {more:,} more"


def any_of(phrases: Sequence[str]) -> str:
    """``a, b, or c``."""
    if len(phrases) < 3:
        return " or ".join(phrases)
    return f"{', '.join(phrases[:-1])}, or {phrases[-1]}"


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
