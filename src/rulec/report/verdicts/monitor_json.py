"""Verdicts after each state of a running trace, as JSON (see docs/online.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rulec.diagnostics import RulecError
from rulec.monitoring.online.four_valued import FourValued
from rulec.monitoring.online.monitor_state import SoFar
from rulec.report.json_document import JsonDocument, JsonPart, as_line
from rulec.report.verdicts.verdict_json import ErrorData, error_data


class ChangeData(JsonPart, frozen=True, kw_only=True):
    """A change of a rule's verdict on a binding by a state.

    ``ended``: one of the objects is no longer there.
    """

    rule: str
    binding: Mapping[str, str]
    before: FourValued
    verdict: FourValued
    ended: bool


class StateVerdict(JsonDocument, frozen=True, kw_only=True):
    """Verdicts after a state, counted from 0; ``verdict`` covers hard rules."""

    state: int
    verdict: FourValued
    rules: Mapping[str, FourValued]
    changes: Sequence[ChangeData]


class StateRefused(JsonDocument, frozen=True, kw_only=True):
    """A line that is no state, or not one that can follow."""

    state: None
    error: ErrorData


def as_json(result: SoFar) -> str:
    """Write the verdicts behind a state."""
    return as_line(
        StateVerdict(
            state=result.state,
            verdict=result.verdict,
            rules=result.rules,
            changes=[ChangeData(**change._asdict()) for change in result.changes],
        )
    )


def refused_as_json(error: RulecError) -> str:
    """Write why a state could not be taken."""
    return as_line(StateRefused(state=None, error=error_data(error)))
