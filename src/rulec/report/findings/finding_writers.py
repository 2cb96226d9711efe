"""The formats of findings, by name and file ending."""

from __future__ import annotations

# Imports within functions: each format needs its own libraries, up to 0.1 s, but one is written.
from collections.abc import Mapping
from typing import IO, TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rulec.report.findings.verdict_finding import FindingContext, RecordingFindings

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


def finding_writer(form: str, stream: IO[bytes], about: FindingContext, name: str) -> FindingWriter:
    """The writer of a format, for a stream called ``name`` in messages.

    Raises RulecError R0706 if Parquet is not available.
    """
    match form:
        case "junit":
            from rulec.report.findings.junit import JUnitWriter

            return JUnitWriter(stream, about)
        case "sarif":
            from rulec.report.findings.sarif import SarifWriter

            return SarifWriter(stream, about)
        case "mcap":
            from rulec.report.findings.finding_mcap import McapWriter

            return McapWriter(stream, about, name)
        case _:
            from rulec.report.findings.finding_tables import FindingTable

            return FindingTable(form, stream, name, about.columns)
