"""Rules as JSON, one with automaton and shortest traces."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import UNSET, UnsetType
from msgspec.structs import replace

from rulec.logic.printing import formula_text
from rulec.logic.sentences.sentence_layout import in_one_line
from rulec.report.automata.automaton_model import Fate, Transition
from rulec.report.json_document import JsonDocument, JsonPart, filled
from rulec.report.rulebooks.rule_page import RulePage, ShortestTrace
from rulec.report.rulebooks.spoken_rules import sentences_of
from rulec.rulebook.rulebook_model import Certainty, Rule, Rulebook, Strength, Variable


class StateData(JsonPart, frozen=True, kw_only=True):
    """A state of the automaton, with the verdict if it is final there."""

    state: int
    fate: Fate


class AutomatonData(JsonPart, frozen=True, kw_only=True):
    """The rule's automaton; traces start in state 0."""

    states: Sequence[StateData]
    transitions: Sequence[Transition]


class RuleData(JsonPart, frozen=True, kw_only=True):
    """A rule, in English and as a formula.

    If it is the only one, it has its automaton, for steps of ``step_s`` unless that is null, and a
    shortest trace that it rejects and a similar one that it accepts, null if there is none.
    ``inherited_from`` names the rulebook that it comes from, if this one has not confirmed it.
    """

    name: str
    strength: Strength
    variables: Sequence[Variable]
    cite: str
    says: str
    source: str
    certainty: Certainty
    level: str
    weight: float
    in_force_from: str
    in_force_until: str
    book: str
    inherited_from: str
    topics: Sequence[str]
    sentence: str
    restrictions: Sequence[str]
    definitions: Sequence[str]
    formula: str
    automaton: AutomatonData | UnsetType = UNSET
    step_s: float | UnsetType | None = UNSET
    accepts: ShortestTrace | UnsetType | None = UNSET
    rejects: ShortestTrace | UnsetType | None = UNSET


class RulesDocument(JsonDocument, frozen=True, kw_only=True):
    """Rules of a rulebook."""

    rulebook: str
    rules: Sequence[RuleData]


def as_document(rulebook: Rulebook, rules: Sequence[Rule], page: RulePage | None) -> RulesDocument:
    """The rules, with automaton and traces if there is only one."""
    data = [_rule(rule, rulebook, page) for rule in rules]
    return RulesDocument(rulebook=rulebook.name, rules=data)


def _rule(rule: Rule, rulebook: Rulebook, page: RulePage | None) -> RuleData:
    said = sentences_of(rule, rulebook)
    data = filled(
        RuleData,
        rule,
        weight=float(rule.weight),
        step_s=UNSET,
        sentence=in_one_line(said.requirement),
        restrictions=[*map(in_one_line, said.restrictions)],
        definitions=[*map(in_one_line, said.definitions)],
        formula=formula_text(rule.formula),
    )
    if page is None:
        return data
    states = [StateData(state=state, fate=fate) for state, fate in enumerate(page.automaton.fates)]
    return replace(
        data,
        automaton=AutomatonData(states=states, transitions=page.automaton.transitions),
        step_s=None if page.step_s is None else float(page.step_s),
        accepts=page.accepted,
        rejects=page.rejected,
    )
