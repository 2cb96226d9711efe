"""Phrases that messages share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rulec.diagnostics.nearest import nearest_name

_MOST_NAMED = 8


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Question that names the nearest known name; empty if none is close."""
    near = nearest_name(name, known)
    return "" if near is None else f"did you mean `{near}`?"


def named(names: Sequence[str]) -> str:
    """Names in backquotes, in a row; of many only the first ones."""
    shown = [f"`{name}`" for name in names[:_MOST_NAMED]]
    return ", ".join([*shown, "…"] if len(names) > len(shown) else shown)


def any_of(phrases: Sequence[str]) -> str:
    """``a, b, or c``."""
    if len(phrases) < 3:
        return " or ".join(phrases)
    return f"{', '.join(phrases[:-1])}, or {phrases[-1]}"
