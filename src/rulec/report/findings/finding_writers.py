"""The formats of findings, by name and file ending."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rulec.report.findings.verdict_finding import RecordingFindings

ENDINGS: Mapping[str, tuple[str, ...]] = {
    "jsonl": (".jsonl", ".ndjson"),
    "csv": (".csv",),
    "parquet": (".parquet", ".pq"),
    "junit": (".xml",),
    "sarif": (".sarif", ".sarif.json"),
    "mcap": (".mcap",),
}
"""Name of a format -> the endings of its files."""


class FindingWriter(Protocol):
    """Writes findings to a stream: recording by recording, then the end."""

    def add(self, recording: RecordingFindings) -> None:
        """Add the findings of a recording. Raises RulecError."""

    def close(self) -> None:
        """Write the end. Raises RulecError."""
