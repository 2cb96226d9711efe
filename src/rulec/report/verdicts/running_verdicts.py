"""Verdicts after each state of a running trace, as text lines and JSON (see docs/online.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias

from rulec.diagnostics import RulecError
from rulec.monitoring.online.four_valued import (
    FourValued,
    RunningVerdict,
    VerdictRange,
    best_of,
    worst_of,
)
from rulec.monitoring.online.monitor_state import SoFar, VerdictChange
from rulec.report.json_document import JsonDocument, JsonPart, as_line, filled
from rulec.report.text.terminal_text import styled, visible
from rulec.report.verdicts.verdict_json import ErrorData, error_data
from rulec.report.verdicts.verdict_report import about

MOST_CHANGES = 20
"""Number of changes shown on a line; JSON has all of them."""

RunningData: TypeAlias = FourValued | Literal["open"]
"""A verdict after a state; open if it depends on unknown values."""

_STYLES: Mapping[str, str] = {"satisfied": "green", "violated": "red", "pending": "yellow"}


class ChangeData(JsonPart, frozen=True, kw_only=True):
    """A change of a rule's verdict on a binding by a state.

    ``ended``: one of the objects is no longer present.
    """

    rule: str
    binding: Mapping[str, str]
    before: RunningData
    verdict: RunningData
    best: FourValued
    worst: FourValued
    ended: bool


class RangeData(JsonPart, frozen=True, kw_only=True):
    """The best and the worst possible value of an open verdict."""

    best: FourValued
    worst: FourValued


class StateVerdict(JsonDocument, frozen=True, kw_only=True):
    """Verdicts after a state, counted from 0; ``verdict`` covers hard rules.

    ``open`` has the rules whose verdict is open.
    """

    state: int
    verdict: RunningData
    best: FourValued
    worst: FourValued
    rules: Mapping[str, RunningData]
    open: Mapping[str, RangeData]
    changes: Sequence[ChangeData]


class StateRefused(JsonDocument, frozen=True, kw_only=True):
    """A line that is no state, or a state that cannot follow the one before."""

    state: None
    error: ErrorData


def as_json(result: SoFar) -> str:
    """Write the verdicts after a state."""
    return as_line(
        filled(
            StateVerdict,
            result,
            verdict=_in_a_word(result.verdict),
            rules={rule: _in_a_word(verdict) for rule, verdict in result.rules.items()},
            open={name: x for name, x in result.rules.items() if isinstance(x, VerdictRange)},
            changes=[_change_data(change) for change in result.changes],
        )
    )


def _change_data(change: VerdictChange) -> ChangeData:
    return filled(
        ChangeData,
        change,
        before=_in_a_word(change.before),
        verdict=_in_a_word(change.verdict),
        best=best_of(change.verdict),
        worst=worst_of(change.verdict),
    )


def _in_a_word(verdict: RunningVerdict) -> RunningData:
    return "open" if isinstance(verdict, VerdictRange) else verdict


def refused_as_json(error: RulecError) -> str:
    """Write why a state was refused."""
    return as_line(StateRefused(state=None, error=error_data(error)))


def as_text(so_far: SoFar) -> str:
    """The state's number, the rulebook's verdict, and the changes of verdicts."""
    changes = [visible(_change(change)) for change in so_far.changes[:MOST_CHANGES]]
    if len(so_far.changes) > len(changes):
        changes.append(f"and {len(so_far.changes) - len(changes):,} more")
    verdict = styled(str(so_far.verdict), _STYLES.get(str(so_far.verdict), ""))
    return f"{so_far.state}: {'; '.join([verdict, *changes])}"


def _change(verdict_change: VerdictChange) -> str:
    left = "they parted" if len(verdict_change.binding) > 1 else "it left"
    perhaps = "perhaps " if isinstance(verdict_change.verdict, VerdictRange) else ""
    left = f", {perhaps}not fulfilled when {left}" if verdict_change.ended else ""
    what = f"{verdict_change.rule}{about(verdict_change.binding)}"
    return f"{what}: {verdict_change.verdict}{left}"
