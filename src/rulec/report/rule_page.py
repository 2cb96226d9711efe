"""All about one rule: what it says, what it means, and what it does, as text and as data."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any

import click

from rulec.automata.compiled import CompiledRule
from rulec.logic.english import number_text, plural, spoken
from rulec.logic.printing import in_words
from rulec.logic.sentence import Phrase, sentence
from rulec.logic.sentence_lines import in_one_line, lines
from rulec.report import automaton_text
from rulec.report.automaton import Automaton, automaton_of
from rulec.report.conditions import Wording
from rulec.report.excerpt import visible
from rulec.report.formula_lines import formula_lines
from rulec.rulebook.model import Rule
from rulec.runtime.shortest import shortest_traces
from rulec.runtime.witness import Witness
from rulec.vocabulary import Vocabulary

INDENT = "  "

MOST_LISTED = 60
"""A page lists the transitions of an automaton if they are no more than these."""


@dataclass(frozen=True, slots=True)
class RulePage:
    """A rule with its automaton, and the states of a trace that it accepts and of one it rejects.

    A trace is None if there is none. ``remarks`` say what its states cannot.
    """

    rule: Rule
    automaton: Automaton
    accepted: tuple[str, ...] | None
    rejected: tuple[str, ...] | None
    remarks: tuple[str, ...] = ()


def page_of(rule: Rule, compiled: CompiledRule, vocabulary: Vocabulary) -> RulePage:
    """The page of a rule that has been compiled."""
    traces = shortest_traces(compiled, vocabulary)
    wording = Wording(compiled, vocabulary)
    named = (("accepted", traces.accepted), ("rejected", traces.rejected))
    accepted, rejected = (
        None if states is None else tuple(map(wording.state, states)) for _, states in named
    )
    return RulePage(
        rule,
        automaton_of(compiled, vocabulary),
        accepted,
        rejected,
        tuple(remark for name, states in named for remark in _remarks(name, states or ())),
    )


def _remarks(name: str, states: Sequence[Witness]) -> Iterator[str]:
    """The objects of the moment that a state needs besides those that the rule names."""
    for number, state in enumerate(states, 1):
        for count, size in state.counts:
            noun = spoken(count.type) if size == 1 else plural(spoken(count.type))
            yield (
                f"in state {number} of the {name} trace there {'is' if size == 1 else 'are'} "
                f"{size:,} {noun} {count.variable} for which {in_words(count.body)}"
            )


def phrase_of(rule: Rule, vocabulary: Vocabulary) -> Phrase:
    """The rule as a sentence."""
    return sentence(
        rule.formula,
        [(variable.name, variable.type) for variable in rule.variables],
        lambda one, other: vocabulary.is_subtype(one, other) or vocabulary.is_subtype(other, one),
    )


def head(rule: Rule, rulebook: str, width: int) -> str:
    """Who the rule is and where it comes from, its own sentence included."""
    lines = [click.style(_title(rule), bold=True)]
    facts = [(name, value) for name, value in _facts(rule, rulebook) if value]
    column = max((len(name) for name, _ in facts), default=0)
    for name, value in facts:
        first, *rest = wrap(visible(value), max(20, width - column - 4)) or [""]
        lines.append(f"{INDENT}{name:<{column}}  {first}")
        lines += [f"{INDENT}{'':<{column}}  {line}" for line in rest]
    return "\n".join(lines)


def _title(rule: Rule) -> str:
    variables = ", ".join(f"{one.name}: {one.type}" for one in rule.variables)
    return f"{rule.strength} rule {rule.name}{f' ({variables})' if variables else ''}"


def _facts(rule: Rule, rulebook: str) -> Iterator[tuple[str, str]]:
    yield "cite", rule.cite
    yield "says", rule.says
    yield "source", rule.source
    yield "certainty", rule.certainty
    yield "level", rule.level
    yield "weight", number_text(rule.weight) if rule.strength == "soft" or rule.weight != 1 else ""
    since = f"from {rule.in_force_from}" if rule.in_force_from else ""
    until = f"until {rule.in_force_until}" if rule.in_force_until else ""
    yield "in force", f"{since} {until}".strip()
    yield "rulebook", rule.book if rule.book != rulebook else ""


def in_english(phrase: Phrase, width: int) -> str:
    """The sentence with its lists, indented and broken to this width."""
    shown = []
    for line in lines(phrase):
        indent = INDENT
        if line.label:
            indent += "    " * (line.depth - 1) + f"  {line.label:<3} "
        blank = " " * len(indent)
        texts = wrap(visible(line.text), max(20, width - len(indent)), break_long_words=False)
        shown += [f"{indent if not n else blank}{text}" for n, text in enumerate(texts)]
    return "\n".join(shown)


def summary(rule: Rule, rulebook: str, vocabulary: Vocabulary, width: int) -> str:
    """The rule in brief."""
    return f"{head(rule, rulebook, width)}\n\n{in_english(phrase_of(rule, vocabulary), width)}"


def as_text(page: RulePage, rulebook: str, vocabulary: Vocabulary, width: int) -> str:
    """The whole page."""
    formula = formula_lines(visible(in_words(page.rule.formula)), width - len(INDENT))
    automaton = (
        automaton_text.as_text(page.automaton, width - len(INDENT))
        if len(page.automaton.transitions) <= MOST_LISTED
        else f"{len(page.automaton.fates):,} states and {len(page.automaton.transitions):,} "
        "transitions; --automaton text lists them"
    )
    sections = [
        ("in English", in_english(phrase_of(page.rule, vocabulary), width)),
        ("formula", _indented(formula)),
        ("automaton", _indented(automaton.split("\n"))),
        ("shortest traces", _indented(_examples(page))),
    ]
    blocks = [f"{click.style(title, bold=True)}\n{text}" for title, text in sections]
    return "\n\n".join([head(page.rule, rulebook, width), *blocks])


def _indented(texts: Sequence[str]) -> str:
    return "\n".join(f"{INDENT}{text}" for text in texts)


def _examples(page: RulePage) -> list[str]:
    found = []
    for word, states, never in (
        ("accept", page.accepted, "no trace is accepted: nothing can satisfy this rule"),
        ("reject", page.rejected, "no trace is rejected: nothing can violate this rule"),
    ):
        found.append(never if states is None else f"{word} {{ {'; '.join(states)} }}")
    return [*found, *page.remarks]


def as_json(
    rulebook: str, rules: Sequence[Rule], vocabulary: Vocabulary, page: RulePage | None
) -> str:
    """An object with the rules, and of the one that has a page all that is on it."""
    shown = [_as_data(rule, vocabulary) for rule in rules]
    if page is not None:
        shown[0] |= {
            "automaton": {
                "states": [
                    {"state": state, "fate": fate}
                    for state, fate in enumerate(page.automaton.fates)
                ],
                "transitions": [
                    {
                        "source": one.source,
                        "target": one.target,
                        "condition": one.condition,
                        "otherwise": one.otherwise,
                        "accepted": one.accepted,
                    }
                    for one in page.automaton.transitions
                ],
            },
            "accepts": page.accepted,
            "rejects": page.rejected,
            "remarks": page.remarks,
        }
    return json.dumps({"rulebook": rulebook, "rules": shown}, ensure_ascii=False, indent=2)


def _as_data(rule: Rule, vocabulary: Vocabulary) -> dict[str, Any]:
    return {
        "name": rule.name,
        "strength": rule.strength,
        "variables": [{"name": one.name, "type": one.type} for one in rule.variables],
        "cite": rule.cite,
        "says": rule.says,
        "source": rule.source,
        "certainty": rule.certainty,
        "level": rule.level,
        "weight": float(rule.weight),
        "in_force_from": rule.in_force_from,
        "in_force_until": rule.in_force_until,
        "book": rule.book,
        "sentence": in_one_line(phrase_of(rule, vocabulary)),
        "formula": in_words(rule.formula),
    }
