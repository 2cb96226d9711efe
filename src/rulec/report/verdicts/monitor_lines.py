"""What a monitor says behind a state, on one line: as text for people, as JSON for machines."""

from __future__ import annotations

import json
from collections.abc import Mapping

import click

from rulec.diagnostics import RulecError
from rulec.monitoring.online.four_valued import FourValued
from rulec.monitoring.online.monitor_state import SoFar, VerdictChange
from rulec.report.findings.source_excerpt import visible
from rulec.report.verdicts.verdict_report import error_as_data

MOST_CHANGES = 20
"""So many fit on a line; JSON has them all."""

_COLORS: Mapping[FourValued, str] = {"satisfied": "green", "violated": "red", "pending": "yellow"}


def as_json(found: SoFar) -> str:
    """The verdicts behind a state, as docs/online.md describes them."""
    data = {
        "state": found.state,
        "verdict": found.verdict,
        "rules": dict(found.rules),
        "changes": [{**one._asdict(), "binding": dict(one.binding)} for one in found.changes],
    }
    return json.dumps(data, ensure_ascii=False)


def refused_as_json(error: RulecError) -> str:
    """In place of the verdicts behind a state that could not be taken."""
    return json.dumps({"state": None, "error": error_as_data(error)}, ensure_ascii=False)


def as_text(found: SoFar) -> str:
    """The state's number, the verdict of the rulebook, and what has changed."""
    changes = [visible(_change(one)) for one in found.changes[:MOST_CHANGES]]
    if len(found.changes) > len(changes):
        changes.append(f"and {len(found.changes) - len(changes):,} more")
    verdict = click.style(found.verdict, fg=_COLORS.get(found.verdict))
    return f"{found.state}: {'; '.join([verdict, *changes])}"


def _change(one: VerdictChange) -> str:
    where = ", ".join(f"{name} = {item}" for name, item in one.binding.items())
    about = f" for {where}" if where else ""
    left = ", not fulfilled when they parted" if one.ended and len(one.binding) > 1 else ""
    left = left or (", not fulfilled when it left" if one.ended else "")
    return f"{one.rule}{about}: {one.verdict}{left}"
