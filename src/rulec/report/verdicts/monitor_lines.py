"""Verdicts after each state of a running trace, as text lines."""

from __future__ import annotations

from collections.abc import Mapping

from rulec.monitoring.online.four_valued import FourValued
from rulec.monitoring.online.monitor_state import SoFar, VerdictChange
from rulec.report.text.terminal_text import styled, visible

MOST_CHANGES = 20
"""So many fit on a line; JSON has them all."""

_STYLES: Mapping[FourValued, str] = {"satisfied": "green", "violated": "red", "pending": "yellow"}


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
    left = (
        ", not fulfilled when they parted"
        if verdict_change.ended and len(verdict_change.binding) > 1
        else ""
    )
    left = left or (", not fulfilled when it left" if verdict_change.ended else "")
    return f"{verdict_change.rule}{about}: {verdict_change.verdict}{left}"
