"""Verdicts after each state of a running trace, as text lines and JSON (see docs/online.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rulec.diagnostics import RulecError
from rulec.monitoring.online.four_valued import FourValued
from rulec.monitoring.online.monitor_state import SoFar, VerdictChange
from rulec.report.json_document import JsonDocument, JsonPart, as_line, filled
from rulec.report.text.terminal_text import styled, visible
from rulec.report.verdicts.verdict_json import ErrorData, error_data

MOST_CHANGES = 20
"""So many fit on a line; JSON has them all."""

_STYLES: Mapping[FourValued, str] = {"satisfied": "green", "violated": "red", "pending": "yellow"}


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
        filled(
            StateVerdict,
            result,
            changes=[filled(ChangeData, change) for change in result.changes],
        )
    )


def refused_as_json(error: RulecError) -> str:
    """Write why a state could not be taken."""
    return as_line(StateRefused(state=None, error=error_data(error)))


def as_text(so_far: SoFar) -> str:
    """The state's number, the verdict of the rulebook, and what has changed."""
    changes = [visible(_change(change)) for change in so_far.changes[:MOST_CHANGES]]
    if len(so_far.changes) > len(changes):
        changes.append(f"and {len(so_far.changes) - len(changes):,} more")
    verdict = styled(so_far.verdict, _STYLES.get(so_far.verdict, ""))
    return f"{so_far.state}: {'; '.join([verdict, *changes])}"


def _change(verdict_change: VerdictChange) -> str:
    where = ", ".join(f"{name} = {item}" for name, item in verdict_change.binding.items())
    about = f" for {where}" if where else ""
    left = "they parted" if len(verdict_change.binding) > 1 else "it left"
    left = f", not fulfilled when {left}" if verdict_change.ended else ""
    return f"{verdict_change.rule}{about}: {verdict_change.verdict}{left}"
