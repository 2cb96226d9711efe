"""What a witness is spared although no definition excludes it: nobody would believe it.

The rulebook ``believable`` beside the vocabulary ``road`` says it: its facts of each state, its
hard rules of states that follow each other, and its soft rules what is only a wish.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from functools import cache
from typing import NamedTuple

from rulec.analysis.shared_compilation import AnalyzedRule, compile_shared
from rulec.logic.formula import Unary
from rulec.logic.free_names import names_in
from rulec.resources import rulebooks_folder
from rulec.rulebook.loader import load_rulebook
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook
from rulec.vocabulary import Vocabulary


class Belief(NamedTuple):
    """What is believed of each state, of what follows what, and what is wished of each state."""

    facts: tuple[Axiom, ...]
    rules: tuple[AnalyzedRule, ...]
    wishes: tuple[Axiom, ...]


def believed(names: Set[str], vocabulary: Vocabulary) -> Belief:
    """What is believed of traces in these words of a vocabulary, if it has them from `road`."""
    book, compiled = _book()
    declared = book.vocabulary.declarations
    known = {name for name in names if vocabulary.declarations[name] == declared.get(name)}
    facts = tuple(axiom for axiom in book.axioms if known.issuperset(names_in(axiom.formula)))
    rules = [rule for rule in book.rules if known.issuperset(names_in(rule.formula))]
    return Belief(
        facts,
        tuple(compiled[rule.name] for rule in rules if rule.strength == "hard"),
        tuple(
            Axiom(rule.variables, rule.formula.operand)
            for rule in rules
            if rule.strength == "soft" and isinstance(rule.formula, Unary)
        ),
    )


@cache
def _book() -> tuple[Rulebook, Mapping[str, AnalyzedRule]]:
    book = load_rulebook(rulebooks_folder() / "vocabulary" / "believable.rules")
    rules: Mapping[str, Rule] = {rule.name: rule for rule in book.rules}
    return book, compile_shared([book], [rules])[0]
