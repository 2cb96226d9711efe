"""Cases of an open verdict, merged into as few as possible.

Cases that differ only in one name, and cover all of its values, are merged into one without that
name (prime implicants as in Quine and McCluskey, for more than two values). From the results enough
are taken to cover all cases, those that cover most first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set

from rulec.monitoring.verdict import ConditionalOutcome, OutcomeName

Case = frozenset[tuple[str, bool | str]]


def fewest_cases(outcomes: Sequence[ConditionalOutcome]) -> list[ConditionalOutcome]:
    """Few cases that cover the given ones with their outcomes; violations come first."""
    by_outcome: dict[OutcomeName, list[Case]] = {}
    for outcome in outcomes:
        by_outcome.setdefault(outcome.outcome, []).append(frozenset(outcome.when.items()))
    order = sorted(by_outcome, key=lambda name: name != "violated")
    names = {name: place for place, name in enumerate(outcomes[0].when)} if outcomes else {}
    values = {name: {outcome_.when[name] for outcome_ in outcomes} for name in names}
    return [
        ConditionalOutcome(dict(sorted(case, key=lambda pair: names[pair[0]])), name)
        for name in order
        for case in _cover(by_outcome[name], values)
    ]


def _cover(cases: Sequence[Case], values: Mapping[str, Set[bool | str]]) -> list[Case]:
    primes, left, chosen = _primes(set(cases), values), set(cases), []
    while left:
        best = max(primes, key=lambda prime: (len(_within(prime, left)), -len(prime)))
        chosen.append(best)
        left -= _within(best, left)
    return chosen


def _within(prime: Case, cases: Set[Case]) -> set[Case]:
    return {case for case in cases if prime <= case}


def _primes(cases: Set[Case], values: Mapping[str, Set[bool | str]]) -> list[Case]:
    """The merged cases with the fewest conditions, in a reproducible order."""
    primes: set[Case] = set()
    while cases:
        merged: set[Case] = set()
        used: set[Case] = set()
        for case in cases:
            for name, value in case:
                without = case - {(name, value)}
                alike = {without | {(name, other)} for other in values[name]}
                if alike <= cases:
                    merged.add(without)
                    used |= alike
        primes |= cases - used
        cases = merged
    return sorted(primes, key=lambda case: sorted((name, str(value)) for name, value in case))
