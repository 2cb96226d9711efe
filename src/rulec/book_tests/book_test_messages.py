"""Messages about examples of rules."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatchcase

from rulec.diagnostics import Diagnostic, did_you_mean, named
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rulebook

NOTHING_TO_RUN = Code(
    "R0460",
    title="no rule and no example matches `--rule`",
    why="With `--rule PATTERN`, `rulec test` runs the examples whose `RULE` or `RULE/LABEL` "
    "matches the pattern. If none matches, or those that match are not in force, nothing is tested "
    "and nothing is covered. Each of several patterns has to match something.",
    bad="rulec test esterle2019 --rule R7",
    good="rulec test esterle2019 --rule R1",
    kind="command",
)


def untested(book: Rulebook, name: str, patterns: Sequence[str]) -> str:
    """A sentence on the rules that are not tested, since they are not in force; empty for none.

    ``name`` is the book's in reports. With ``patterns`` the sentence is about the rules that one of
    them names, or whose examples.
    """
    names = [
        rule
        for rule in book.not_in_force
        if not patterns or any(fnmatchcase(rule, pattern.partition("/")[0]) for pattern in patterns)
    ]
    if not names:
        return ""
    rules, verb, their = ("rule", "is", "its") if len(names) == 1 else ("rules", "are", "their")
    return (
        f"{rules} {named(names)} of {name} {verb} not in force on {book.at}, so {their} "
        "examples are not run"
    )


def nothing_to_run(
    patterns: Sequence[str], rules: Sequence[str], left_out: Sequence[str]
) -> Diagnostic:
    """R0460: the patterns match none of these rules and none of their examples.

    ``left_out`` are the sentences on rules that they match, and that are not in force.
    """
    if left_out:
        return NOTHING_TO_RUN.at(
            None,
            "; ".join(left_out),
            help="`--at DATE` tests the law of another day",
        )
    name = patterns[0].partition("/")[0]
    known = f"rules are {named(rules)}" if rules else "there is no rule"
    return NOTHING_TO_RUN.at(
        None,
        f"no rule and no example matches {named(patterns)}",
        help=did_you_mean(name, [rule for rule in rules if rule != name])
        or f"write RULE or RULE/LABEL, with `*` for anything: {known}",
    )
