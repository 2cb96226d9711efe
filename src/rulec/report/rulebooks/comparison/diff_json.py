"""The difference of two rulebooks as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from msgspec import UNSET, UnsetType

from rulec.analysis.diff.rule_comparison import RuleRelation
from rulec.analysis.diff.rulebook_comparison import OneSided, RulebookDiff, RulePair, SettingPair
from rulec.logic.printing import number_in_words
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.rulebook.rulebook_model import Certainty, Strength, Variable
from rulec.trace import Trace
from rulec.trace.trace_model import Ending


class BookData(JsonPart, frozen=True, kw_only=True):
    """A rulebook, and the day whose law it is."""

    name: str
    title: str
    at: str


class RuleSide(JsonPart, frozen=True, kw_only=True):
    """A rule as in one rulebook, with its exact weight."""

    strength: Strength
    variables: Sequence[Variable]
    level: str | None
    weight: str
    cite: str
    says: str
    certainty: Certainty
    book: str


class TraceData(JsonPart, frozen=True, kw_only=True):
    """A trace, as docs/traces.md describes it."""

    id: str
    step_s: float
    objects: Mapping[str, str]
    states: Sequence[Mapping[str, Any]]
    present: Mapping[str, tuple[int, int]] | UnsetType = UNSET
    ends: Ending | UnsetType = UNSET
    told: Sequence[str] | UnsetType | None = UNSET


class RulePairData(JsonPart, frozen=True, kw_only=True):
    """A rule of both rulebooks; the relation is that of the first to the second.

    If they refer to different types of objects, they are compared on the common ones; with an empty
    list of them no object is of the types of both.
    """

    rule: str
    second_rule: str
    relation: RuleRelation
    undecided: str | None
    first: RuleSide
    second: RuleSide
    common_types: Sequence[str] | None
    on_common_types: RuleRelation | None
    first_forbids: Sequence[TraceData]
    second_forbids: Sequence[TraceData]


class OneSidedRule(JsonPart, frozen=True, kw_only=True):
    """A rule of one rulebook, with the other one's remark on it."""

    rule: str
    strength: Strength
    variables: Sequence[Variable]
    level: str | None
    weight: str
    cite: str
    says: str
    certainty: Certainty
    book: str
    remark: Literal["dropped", "silent", "softened"] | None
    because: str | None
    alike: Sequence[str]


class DiffDocument(JsonDocument, frozen=True, kw_only=True):
    """The rules of two rulebooks side by side."""

    first: BookData
    second: BookData
    rules: Sequence[RulePairData]
    only_first: Sequence[OneSidedRule]
    only_second: Sequence[OneSidedRule]
    settings: Sequence[SettingPair]


def as_json(diff: RulebookDiff) -> str:
    """Write one object."""
    return as_indented(
        filled(
            DiffDocument,
            diff,
            rules=list(map(_pair, diff.pairs)),
            only_first=list(map(_one_sided, diff.only_first)),
            only_second=list(map(_one_sided, diff.only_second)),
        )
    )


def _pair(pair: RulePair) -> RulePairData:
    comparison = pair.comparison
    return filled(
        RulePairData,
        pair,
        rule=pair.first.name,
        second_rule=pair.second.name,
        undecided=comparison.undecided or None,
        first=filled(RuleSide, pair.first, weight=number_in_words(pair.first.weight)),
        second=filled(RuleSide, pair.second, weight=number_in_words(pair.second.weight)),
        common_types=comparison.common,
        on_common_types=comparison.on_common,
        first_forbids=list(map(_trace, comparison.first_forbids)),
        second_forbids=list(map(_trace, comparison.second_forbids)),
    )


def _one_sided(one_sided: OneSided) -> OneSidedRule:
    rule, remark = one_sided.rule, one_sided.remark
    kind, because = (remark.kind, remark.because) if remark else (None, None)
    own = {"rule": rule.name, "remark": kind, "because": because, "alike": one_sided.alike}
    return filled(OneSidedRule, rule, weight=number_in_words(rule.weight), **own)


def _trace(trace: Trace) -> TraceData:
    return filled(TraceData, trace, ends=UNSET, told=UNSET)
