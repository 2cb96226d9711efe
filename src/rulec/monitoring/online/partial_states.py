"""Letters that partly known states may have, read by the rules one by one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import SourceLocation
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import LetterClass
from rulec.monitoring.online.rule_group import PreparedRule
from rulec.monitoring.uncertainty.possible_letters import PossibleLetters
from rulec.trace import State, Trace


def possible_classes(
    rules: Sequence[tuple[PreparedRule, Sequence[Items]]],
    state: State,
    rulebook: CompiledRulebook,
    objects: Mapping[str, str],
    where: tuple[str, SourceLocation | None],
) -> dict[str, list[LetterClass]]:
    """The classes that rules may read in a checked state, for each of their bindings.

    ``where`` are what messages call the state, and where it was read. Raises RulecError R0504 if a
    value without default is missing, R0508 if the state cannot be.
    """
    name, place = where
    trace = Trace("", 1.0, objects, (state,), place=place)
    reader = PossibleLetters(trace, rulebook, rulebook.vocabulary, lambda _: name)
    found: dict[str, list[LetterClass]] = {}
    for prepared, bindings in rules:
        classes = found[prepared.name] = []
        for items in bindings:
            bound = prepared.bound(items)
            (letters,) = reader.word(prepared.rule, bound, 0, 0).states
            letter_class = prepared.uncertain.letter_class(letters)
            if letter_class is None:
                raise reader.impossible(prepared.rule, bound, 0)
            classes.append(letter_class)
    return found
