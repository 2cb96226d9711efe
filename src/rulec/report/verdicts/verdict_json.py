"""Verdicts on traces with their explanations as JSON, a line for each (see docs/traces.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

from msgspec import UNSET, UnsetType
from msgspec.structs import replace

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.verdict import (
    ConditionalOutcome,
    NotJudged,
    OpenVerdict,
    RuleNotJudged,
    Verdict,
    Violation,
)
from rulec.report.json_document import (
    Filled,
    JsonDocument,
    JsonPart,
    Number,
    as_line,
    filled,
)
from rulec.report.verdicts.violation_table import repaired_states
from rulec.vocabulary.partial_values import Interval, OneOf, PartialValue, UnknownValue


class BoundsData(JsonPart, frozen=True, kw_only=True, rename={"low": "from", "high": "to"}):
    """A number known only within bounds."""

    low: float
    high: float


Value = bool | int | float | str | BoundsData | None
Result: TypeAlias = Violation | OpenVerdict | RuleNotJudged


class FactData(JsonPart, frozen=True, kw_only=True):
    """Something that the rule reads, with its value or bounds in each state, null if unknown.

    ``unit`` is that of a quantity; ``objects`` are, for a count, the objects counted in each state.
    """

    reads: str
    values: Sequence[Value]
    changed: bool
    decides: bool
    unit: str | UnsetType = UNSET
    objects: Sequence[Sequence[str]] | UnsetType = UNSET


class FormulaPart(JsonPart, frozen=True, kw_only=True):
    """A part ``depth`` operators inside the rule's formula, with its truth values."""

    formula: str
    depth: int
    values: Sequence[bool]
    changed: bool
    decides: bool


class RepairData(JsonPart, frozen=True, kw_only=True):
    """A change of a state with which the rule would be kept."""

    state: int
    says: str


class ExplanationData(JsonPart, frozen=True, kw_only=True):
    """Explanation of a violation; null ``repair``: no trace of the same length complies.

    ``looked_at``, for a long trace: the first and last state of the part that was searched for a
    repair, without finding one.
    """

    book: str
    cite: str
    says: str
    states: Sequence[int]
    decisive: int
    facts: Sequence[FactData]
    parts: Sequence[FormulaPart]
    repair: Sequence[RepairData] | None
    looked_at: tuple[int, int] | UnsetType = UNSET


class ErrorData(JsonPart, frozen=True, kw_only=True):
    """An error in a trace or a state, with its place."""

    code: str
    message: str
    file: str | None
    line: int | None


class MarginData(JsonPart, frozen=True, kw_only=True):
    """A comparison that decides: ``value`` stands in ``relation`` to ``limit``, in ``unit``.

    Both may be wrong by their errors; a number known no better than to half of its value has bounds
    and no error. They differ ``by`` this much, and for certain by ``at_least``; with bounds both
    are certain.
    """

    text: str
    value: float | BoundsData
    relation: str
    limit: float | BoundsData
    unit: str
    value_error: float
    limit_error: float
    by: float
    at_least: float


class DrivePlaceData(JsonPart, frozen=True, kw_only=True):
    """The position of ego's middle (m, as recorded), and the lanelet of its lane there."""

    x: float
    y: float
    lanelet: str


class EvidenceData(JsonPart, frozen=True, kw_only=True):
    """What a violation in recorded traffic rests on.

    The names that the rule reads were ``measured``, ``assumed`` by the user, taken ``by_default``,
    or ``unknown`` in some state without making a difference. ``from_s`` and ``to_s`` are times of
    the recording; ``place`` is ego's position when the rule is lost, at ``time_s`` of the
    violation. ``whom`` are the participants that cause a word's value, such as the one overtaking
    ego, if the rule itself names none.
    """

    measured: Sequence[str]
    assumed: Sequence[str]
    by_default: Sequence[str]
    unknown: Sequence[str]
    from_s: float
    to_s: float
    margins: Sequence[MarginData]
    place: DrivePlaceData | None
    whom: Sequence[str] | UnsetType = UNSET


class ViolationData(JsonPart, frozen=True, kw_only=True):
    """A violated rule and binding; ``step`` is null if only the end decides.

    In recorded traffic, ``time_s`` is the time of the step, and ``by_default`` are the names that
    the rule reads and no source supplies. ``inherited_from`` names the rulebook that the rule comes
    from, if this one has not confirmed it as its law; without it the rule is this one's own law.
    """

    rule: str
    binding: Mapping[str, str]
    step: int | None
    strength: Literal["hard", "soft"]
    level: str | None
    weight: Number
    inherited_from: str | UnsetType = UNSET
    explanation: ExplanationData | UnsetType = UNSET
    time_s: float | UnsetType | None = UNSET
    by_default: Sequence[str] | UnsetType = UNSET
    evidence: EvidenceData | UnsetType = UNSET


class OpenData(JsonPart, frozen=True, kw_only=True):
    """A rule and binding whose outcome is not settled.

    ``depends_on`` is the smallest set of names that decides; ``exact`` is false if there were too
    many cases to examine.
    """

    rule: str
    binding: Mapping[str, str]
    strength: Literal["hard", "soft"]
    because: Sequence[Literal["not told", "tolerance", "not over", "began before"]]
    depends_on: Sequence[str]
    outcomes: Sequence[ConditionalOutcome]
    exact: bool
    inherited_from: str | UnsetType = UNSET


class NotJudgedRule(JsonPart, frozen=True, kw_only=True):
    """A rule that cannot be found violated from this source, as ``untold`` names are missing."""

    rule: str
    strength: Literal["hard", "soft"]
    untold: Sequence[str]
    why: str
    inherited_from: str | UnsetType = UNSET


class LawData(JsonPart, frozen=True, kw_only=True):
    """The law that is judged by: the text of the day ``as_of``, asked for the day ``at``.

    ``rulebook_hash`` is the SHA-256 of all that decides its verdicts.
    """

    law: str
    as_of: str
    at: str
    rulebook_hash: str


class TraceVerdict(JsonDocument, frozen=True, kw_only=True):
    """The verdict on a trace: whether it keeps every hard rule.

    ``satisfied`` is null if no hard rule is violated, but one is open or not judged. ``judged`` are
    the rules that are neither; of these, ``kept_regardless`` read names that the source lacks, and
    are kept whatever these are. ``presumed`` names hold by presumption, as no source supplies them.
    ``faults`` of rulec came meanwhile; rules that they cost are ``not_judged``.
    """

    trace: str
    rulebook: str
    law: LawData
    satisfied: bool | None
    violations: Sequence[ViolationData]
    judged: Sequence[str] = ()
    open: Sequence[OpenData] = ()
    not_judged: Sequence[NotJudgedRule] = ()
    kept_regardless: Sequence[str] = ()
    presumed: Sequence[str] = ()
    faults: Sequence[ErrorData] | UnsetType = UNSET


class TraceNotJudged(JsonDocument, frozen=True, kw_only=True):
    """A trace that could not be judged; ``trace`` is null without an id."""

    trace: str | None
    rulebook: str
    error: ErrorData


def as_json(
    verdict: Verdict,
    rulebook: CompiledRulebook,
    explained: Sequence[Explanation] = (),
) -> str:
    """Write a verdict; ``explained`` are explanations of its first violations."""
    violations = violations_data(verdict, rulebook, explained)
    about = verdict_fields(verdict, rulebook)
    return as_line(filled(TraceVerdict, verdict, violations=violations, **about))


def not_judged_as_json(answer: NotJudged, rulebook: str) -> str:
    """Write why a trace has no verdict."""
    error = error_data(answer.error)
    return as_line(TraceNotJudged(trace=answer.trace, rulebook=rulebook, error=error))


def verdict_fields(verdict: Verdict, rulebook: CompiledRulebook) -> dict[str, Any]:
    """The fields that name the law, each rule once, as judged, open or not judged, and faults."""
    doubtful = {one.rule for one in verdict.open} | {one.rule for one in verdict.not_judged}
    return {
        "rulebook": rulebook.name,
        "law": edition_of(rulebook),
        "judged": [rule.name for rule in rulebook.rules if rule.name not in doubtful],
        "open": with_rules(OpenData, verdict.open, rulebook),
        "not_judged": with_rules(NotJudgedRule, verdict.not_judged, rulebook),
        "faults": [error_data(fault) for fault in verdict.faults] or None,
    }


def with_rules(
    kind: type[Filled], results: Sequence[Result], rulebook: CompiledRulebook
) -> list[Filled]:
    """Parts made of results and of their rules."""
    rules = {rule.name: rule for rule in rulebook.rules} if results else {}
    # A rule that is too large at the recording's step is not among the compiled rules.
    return [filled(kind, result, rules.get(result.rule)) for result in results]


def violations_data(
    verdict: Verdict, rulebook: CompiledRulebook, explained: Sequence[Explanation]
) -> list[ViolationData]:
    """The violations, the first ones with their explanations."""
    violations = with_rules(ViolationData, verdict.violations, rulebook)
    for number, explanation in enumerate(explained[: len(violations)]):
        data = explanation_data(explanation)
        violations[number] = replace(violations[number], explanation=data)
    return violations


def error_data(error: RulecError) -> ErrorData:
    """The first diagnostic of an error."""
    diagnostic = error.diagnostics[0]
    return filled(ErrorData, diagnostic, diagnostic.place or SourceLocation(""))


def explanation_data(explanation: Explanation) -> ExplanationData:
    """The explanation with all its facts, parts and states."""
    repair = repaired_states(explanation) if explanation.repair is not None else None
    return filled(
        ExplanationData,
        explanation,
        explanation.rule,
        facts=[
            filled(FactData, fact, reads=fact.text, values=[*map(_value_data, fact.values)])
            for fact in explanation.facts
        ],
        parts=[filled(FormulaPart, part, formula=part.text) for part in explanation.parts],
        repair=repair and [RepairData(state=number, says=says) for number, says in repair],
    )


def _value_data(value: PartialValue | None) -> Value:
    if isinstance(value, Interval):
        return BoundsData(low=value.low, high=value.high)
    return None if isinstance(value, UnknownValue | OneOf) else value
