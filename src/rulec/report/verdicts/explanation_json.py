"""An explained violation as JSON, with nothing left out."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import UNSET, UnsetType

from rulec.monitoring.explain.explanation import Explanation, Observation
from rulec.report.json_document import JsonPart
from rulec.report.verdicts.violation_table import repaired_states

Value = bool | int | float | str


class FactData(JsonPart, frozen=True, kw_only=True):
    """Something that the rule reads, and its value in each state.

    ``unit`` is a quantity's; ``objects`` are, for a count, those that counted in each state.
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
    """A state to be changed for the rule to be kept."""

    state: int
    says: str


class ExplanationData(JsonPart, frozen=True, kw_only=True):
    """Explanation of a violation; null ``repair``: no equally long trace complies."""

    book: str
    cite: str
    says: str
    states: Sequence[int]
    decisive: int
    facts: Sequence[FactData]
    parts: Sequence[FormulaPart]
    repair: Sequence[RepairData] | None


def explanation_data(explanation: Explanation) -> ExplanationData:
    """The explanation with all its facts, parts and states."""
    rule = explanation.rule
    return ExplanationData(
        book=rule.book,
        cite=rule.cite,
        says=rule.says,
        states=explanation.states,
        decisive=explanation.decisive,
        facts=[_fact(observation) for observation in explanation.facts],
        parts=[
            FormulaPart(
                formula=part.text,
                depth=part.depth,
                values=part.values,
                changed=part.changed,
                decides=part.decides,
            )
            for part in explanation.parts
        ],
        repair=None
        if explanation.repair is None
        else [RepairData(state=number, says=says) for number, says in repaired_states(explanation)],
    )


def _fact(observation: Observation) -> FactData:
    return FactData(
        reads=observation.text,
        values=observation.values,
        changed=observation.changed,
        decides=observation.decides,
        unit=observation.unit or UNSET,
        objects=UNSET if observation.objects is None else observation.objects,
    )
