"""From the trees of a rulebook and its vocabularies to the rulebook as meant."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label
from rulec.rulebook.declared import declare
from rulec.rulebook.model import Rule, Rulebook, SourceFile
from rulec.rulebook.translate import translate_rule
from rulec.syntax import tree
from rulec.vocabulary import Vocabulary


def resolve(
    file: tree.File,
    vocabularies: Sequence[tree.File] = (),
    *,
    sources: tuple[SourceFile, ...] = (),
    opaque: bool = False,
) -> tuple[Rulebook | None, tuple[Diagnostic, ...]]:
    """The rulebook as meant, and what is wrong with it.

    Args:
        file: a rulebook's tree; what could not be read in it is not complained about again.
        vocabularies: the trees of the vocabularies that it uses, in the order of its lines.
        sources: the files read, for the record.
        opaque: a vocabulary could not be read, so that any name may be missing for that reason.

    Returns:
        The rulebook, None if there is an error in it or if its tree is not whole; errors and
        warnings.
    """
    declared = declare([*vocabularies, file], opaque=opaque)
    mistakes = list(declared.mistakes)
    rules: list[Rule | None] = []
    first: dict[str, tree.RuleItem] = {}
    for item in file.items:
        if not isinstance(item, tree.RuleItem):
            continue
        if first.setdefault(item.name.text, item) is not item:
            mistakes.append(_rule_twice(item, first[item.name.text]))
        rule, found = translate_rule(item, declared)
        mistakes += found
        rules.append(rule)
    good = [rule for rule in rules if rule is not None]
    wrong = any(one.severity == "error" for one in mistakes)
    whole = all(_is_whole(one) for one in (*vocabularies, file))
    if file.name is None or wrong or not whole or len(good) < len(rules):
        return None, tuple(mistakes)
    rulebook = Rulebook(
        file.name.text,
        declared.vocabulary(file.name.text),
        tuple(good),
        file.title.text.value if file.title else "",
        file.law.text.value if file.law else "",
        file.law.as_of if file.law else "",
        sources,
    )
    return rulebook, tuple(mistakes)


def resolve_vocabulary(file: tree.File) -> tuple[Vocabulary | None, tuple[Diagnostic, ...]]:
    """A vocabulary by itself, and what is wrong with it."""
    declared = declare([file])
    if file.name is None or declared.mistakes:
        return None, tuple(declared.mistakes)
    return declared.vocabulary(file.name.text), ()


def _is_whole(file: tree.File) -> bool:
    broken = any(
        isinstance(item, tree.BrokenItem) or (isinstance(item, tree.RuleItem) and not item.complete)
        for item in file.items
    )
    return file.complete and not broken


def _rule_twice(again: tree.RuleItem, first: tree.RuleItem) -> Diagnostic:
    return Diagnostic(
        "R0205",
        f"there are two rules `{again.name.text}`",
        again.name.span.place,
        expected="named again here",
        help="give each rule a name of its own",
        labels=(Label(first.name.span.place, "first named here"),),
    )
