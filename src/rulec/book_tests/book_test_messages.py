"""Messages about examples of rules."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatchcase

from rulec.diagnostics import Diagnostic, did_you_mean, named
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rule, Rulebook

EXAMPLE_FAILED = Code("R0406")

NOTHING_TO_RUN = Code("R0460")

RULE_NOT_EXERCISED = Code("R0408")


def unexercised(rule: Rule, missing: set[bool], *, any_examples: bool) -> Diagnostic:
    kept, broken = True in missing, False in missing
    if not any_examples:
        message = f"rule `{rule.name}` has no example"
        notes: tuple[str, ...] = ()
    else:
        message = f"no example {'keeps' if kept else 'breaks'} rule `{rule.name}`"
        less = "forbade everything" if kept else "required nothing"
        notes = (f"all of its examples would also pass if it {less}",)
    wanted = [word for word, is_wanted in (("accept", kept), ("reject", broken)) if is_wanted]
    clauses = " and ".join(f"`{word} {{ … }}`" for word in wanted)
    return RULE_NOT_EXERCISED.at(
        rule.span,
        message,
        expected=f"expected {clauses}",
        help=f"`rulec show` proposes {'both' if len(wanted) == 2 else 'one'}; "
        "whether the law agrees, you know",
        notes=notes,
        severity="warning",
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
