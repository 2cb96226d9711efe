"""The page about a rule as text and as JSON: its sentence, formula, automaton and traces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from msgspec import UNSET, UnsetType

from rulec.analysis.believable_states import declarations_read
from rulec.analysis.rule_traces import rule_traces
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.trace_display import special_types, state_literals
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics.diagnostic import at
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.logic.free_names import names_in
from rulec.logic.printing import formula_text
from rulec.logic.sentences.sentence import Phrase
from rulec.logic.sentences.sentence_layout import in_one_line, lines
from rulec.logic.sentences.wording import amount, number_text, spoken
from rulec.report.automata import automaton_model
from rulec.report.automata.automaton_model import Automaton, Fate, Transition, automaton_of
from rulec.report.json_document import JsonDocument, JsonPart, filled
from rulec.report.rulebooks.spoken_rules import sentences_of
from rulec.report.text.formula_lines import formula_lines, plain_clauses, plain_text
from rulec.report.text.terminal_text import broken, fact_lines, styled, visible
from rulec.rulebook.rulebook_model import Axiom, Certainty, Rule, Rulebook, Strength, Variable
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary

INDENT = "  "

NARROW = 70
"""The columns below which parts of sentences are indented less."""

MOST_LISTED = 60
"""A page lists an automaton's transitions if there are at most this many."""


@dataclass(frozen=True, slots=True)
class ShortestTrace:
    """A trace as an example: further objects, states, and what the rule language cannot express."""

    objects: tuple[Variable, ...]
    states: tuple[str, ...]
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RulePage:
    """A rule with its automaton, and an accepted and a rejected trace if there are any.

    The automaton is for traces with steps of ``step_s``; None if it is the same for all steps.
    ``undecided`` says why no traces are shown, if that is so.
    """

    rule: Rule
    automaton: Automaton
    accepted: ShortestTrace | None
    rejected: ShortestTrace | None
    step_s: Fraction | None
    undecided: str


def page_of(rule: Rule, compiled: CompiledRulebook) -> RulePage:
    """The page of a rule in a compiled rulebook."""
    machine = next(own for own in compiled.rules if own.name == rule.name)
    axioms = tuple(Axiom(axiom.variables, axiom.formula) for axiom in compiled.axioms)
    traces = rule_traces(AnalyzedRule(replace(compiled, rules=()), axioms, machine, 0))
    return RulePage(
        rule=rule,
        automaton=automaton_of(machine, compiled.vocabulary, at(rule.span)),
        accepted=_shown(traces.accepted, machine, compiled.vocabulary),
        rejected=_shown(traces.rejected, machine, compiled.vocabulary),
        step_s=machine.step_s,
        undecided=traces.undecided,
    )


def _shown(
    trace: Trace | None, machine: CompiledRule, vocabulary: Vocabulary
) -> ShortestTrace | None:
    if trace is None:
        return None
    own = {variable.name for variable in machine.variables}
    further = [Variable(name, kind) for name, kind in trace.objects.items() if name not in own]
    states = map(visible, state_literals(trace, declarations_read(machine), vocabulary))
    types = special_types(trace, [machine]).items()
    return ShortestTrace(
        tuple(further), tuple(states), tuple(f"{name} is a {spoken(kind)}" for name, kind in types)
    )


def _sentences(rule: Rule, rulebook: Rulebook, width: int) -> str:
    return "\n".join(in_english(said, width) for said in sentences_of(rule, rulebook).every)


def _formula(rule: Rule, width: int) -> list[str]:
    whole = formula_lines(visible(plain_text(rule.formula)), width)
    if rule.required is None:
        return whole
    clauses = sorted(plain_clauses(rule), key=lambda clause: clause[0] != "require")
    parts = [text if word == "require" else f"{word} {text}" for word, text in clauses]
    written = [line for part in parts for line in formula_lines(visible(part), width)]
    return [*written, "that is", *whole]


def head(rule: Rule, rulebook: str, width: int) -> str:
    """Title, origin and own sentence of the rule."""
    variables = ", ".join(f"{variable.name}: {variable.type}" for variable in rule.variables)
    title = f"{rule.strength} rule {rule.name}{f' ({variables})' if variables else ''}"
    facts = [(name, value) for name, value in _facts(rule, rulebook) if value]
    shown = (styled(line, "bold") for line in broken(visible(title), width, later="  "))
    return "\n".join([*shown, *fact_lines(facts, width)])


def _facts(rule: Rule, rulebook: str) -> Iterator[tuple[str, str]]:
    yield "cite", rule.cite
    yield "says", rule.says
    yield "topic", ", ".join(rule.topics)
    yield "source", rule.source
    yield "certainty", rule.certainty
    yield "level", rule.level
    yield "weight", number_text(rule.weight) if rule.strength == "soft" or rule.weight != 1 else ""
    since = f"from {rule.in_force_from}" if rule.in_force_from else ""
    until = f"until {rule.in_force_until}" if rule.in_force_until else ""
    yield "in force", f"{since} {until}".strip()
    yield "rulebook", rule.book if rule.book != rulebook else ""
    law = f"inherited, not confirmed: that of {rule.inherited_from}" if rule.inherited_from else ""
    yield "law", law
    yield "not told", _untold(rule)


def _untold(rule: Rule) -> str:
    """The words that no format of recordings provides; empty if that holds for none or for all."""
    tellable = frozenset[str]().union(*TELLABLE_WORDS.values())
    names = dict.fromkeys(names_in(rule.formula))
    untold = [name for name in names if name not in tellable]
    if not untold or len(untold) == len(names):
        return ""
    by_none = "by no format of recordings (rulec show --audit --source says which do)"
    return f"{', '.join(untold)}: {by_none}"


def in_english(phrase: Phrase, width: int) -> str:
    """The sentence with its lists, indented and wrapped to a width."""
    shown = []
    step = "    " if width > NARROW else "  "
    for line in lines(phrase):
        indent = INDENT
        if line.label:
            indent += step * (line.depth - 1) + f"  {line.label:<3} "
        shown += broken(visible(line.text), width, indent, " " * len(indent))
    return "\n".join(shown)


def summary(rule: Rule, rulebook: Rulebook, width: int) -> str:
    """The rule in brief."""
    return f"{head(rule, rulebook.name, width)}\n\n{_sentences(rule, rulebook, width)}"


def as_text(page: RulePage, rulebook: Rulebook, width: int) -> str:
    """The whole page."""
    formula = _formula(page.rule, width - len(INDENT))
    automaton = (
        automaton_model.as_text(page.automaton, width - len(INDENT))
        if len(page.automaton.transitions) <= MOST_LISTED
        else f"{len(page.automaton.fates):,} states and {len(page.automaton.transitions):,} "
        "transitions; --automaton text lists them"
    )
    if page.step_s is not None:
        automaton = f"for traces with steps of {amount(page.step_s, 's')}:\n{automaton}"
    sections = [
        ("in English", _sentences(page.rule, rulebook, width)),
        ("formula", _indented(formula)),
        ("automaton", _indented(automaton.split("\n"))),
        (
            "a shortest rejected trace, and an accepted one close to it",
            "\n".join(_examples(page, width)),
        ),
    ]
    blocks = [f"{styled(title, 'bold')}\n{text}" for title, text in sections]
    return "\n\n".join([head(page.rule, rulebook.name, width), *blocks])


def _indented(texts: Sequence[str]) -> str:
    return "\n".join(f"{INDENT}{text}" for text in texts)


def _examples(page: RulePage, width: int) -> Iterator[str]:
    for word, trace, never in (
        ("accept", page.accepted, "no trace is accepted: nothing can satisfy this rule"),
        ("reject", page.rejected, "no trace is rejected: nothing can violate this rule"),
    ):
        if trace is None:
            yield f"{INDENT}{f'{word} not decided: {page.undecided}' if page.undecided else never}"
            continue
        objects = ", ".join(f"{object_.name}: {object_.type}" for object_ in trace.objects)
        example = f"{word}{f' ({objects})' if objects else ''} {{ {'; '.join(trace.states)} }}"
        yield from broken(example, width, INDENT, 2 * INDENT)
        for remark in trace.remarks:
            yield from broken(f"# where {remark}", width, 2 * INDENT, f"{2 * INDENT}# ")


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
    said, details = sentences_of(rule, rulebook), {}
    if page is not None:
        states = [
            StateData(state=state, fate=fate) for state, fate in enumerate(page.automaton.fates)
        ]
        automaton = AutomatonData(states=states, transitions=page.automaton.transitions)
        details = {"automaton": automaton, "accepts": page.accepted, "rejects": page.rejected}
    return filled(
        RuleData,
        rule,
        weight=float(rule.weight),
        step_s=UNSET if page is None else page.step_s and float(page.step_s),
        sentence=in_one_line(said.requirement),
        restrictions=[*map(in_one_line, said.restrictions)],
        definitions=[*map(in_one_line, said.definitions)],
        formula=formula_text(rule.formula),
        **details,
    )
