"""Questions about rulebooks that are given by name or by their sources' paths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from rulec.analysis.difference import Difference, difference, setting_pairs
from rulec.analysis.findings import findings
from rulec.analysis.inheritance import read_with_inheritance
from rulec.diagnostics import Diagnostic
from rulec.rulebook.loader import read_rulebook


def compare_rulebooks(
    first: str | Path,
    second: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    patterns: Sequence[str] = (),
    step_s: Fraction | None = None,
    warn: Callable[[Sequence[Diagnostic]], object] = lambda _: None,
    tell: Callable[[float], object] = lambda _: None,
    most: int = 1,
) -> Difference:
    """Compare the rules of two rulebooks, given by name or by their sources' paths.

    ``warn`` is told what is odd in them, ``tell`` how many rules have been compared; the rest is
    as for ``rulec.analysis.difference.difference``. Raises RulecError.
    """
    (one, ours), (other, theirs) = (
        read_with_inheritance(each, search_path, at) for each in (first, second)
    )
    warn(list(dict.fromkeys((*one.warnings, *other.warnings))))
    found = difference(one.rulebook, other.rulebook, patterns, step_s, tell, most)
    # What rules that were not asked for depend on is not asked for either.
    return found if patterns else replace(found, settings=setting_pairs(ours, theirs))


def analyze_rulebook(
    reference: str | Path,
    search_path: Sequence[str | Path] = (),
    at: str = "",
    tell: Callable[[float], object] = lambda _: None,
) -> tuple[Diagnostic, ...]:
    """What the automata of its rules tell about a rulebook, given by name or by its source's path.

    ``tell`` is told how many rules have been looked at. ``at``: as for ``load_rulebook``. Raises
    RulecError.
    """
    folders = [Path(folder) for folder in search_path]
    loaded = read_rulebook(reference, folders, at)
    book = loaded.rulebook
    above = [one.span.source.name for one in loaded.books[-2:-1]]
    # On the same side of the road: a treaty's near side is that of the party's traffic.
    bases = [read_rulebook(Path(file), folders, book.at, book.traffic).rulebook for file in above]
    extends = loaded.books[-1].extends
    return findings(book, bases, tell, extends.span if extends else None)
