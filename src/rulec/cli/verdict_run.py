"""Files judged by one rulebook, with sums over their verdicts."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field

import click

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.cli.verdict_outputs import VerdictOutputs
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.verdicts.batch_table import BatchTally


@dataclass
class VerdictRun:
    """Judges files by ``rules``, and sums up the results.

    ``judged``: whether any trace or drive was judged, or there is no rule; ``complete``: whether
    each was judged; ``open_hard``: whether a hard rule is open.
    """

    rules: CompiledRulebook
    to: VerdictOutputs
    complaints: Complaints
    _: KW_ONLY
    total: BatchTally = field(default_factory=BatchTally)
    judged: bool = False
    complete: bool = True
    open_hard: bool = False

    def has_failed(self, *, strict: bool) -> bool:
        """Whether hard rules are violated or, if ``strict``, open, which is then said."""
        if self.total.outcomes["violated"]:
            return True
        if strict and self.open_hard:
            click.echo(
                "note: a hard rule is open, which counts as violated by `--strict`", err=True
            )
        return strict and self.open_hard
