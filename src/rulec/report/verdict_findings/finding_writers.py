"""The formats that findings are written in, by their names and the endings of their files."""

from __future__ import annotations

# Imports within functions: each format has libraries of its own, up to 0.1 s, and one is written.
from collections.abc import Mapping
from typing import IO, TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rulec.report.verdict_findings.verdict_finding import FindingContext, RecordingFindings

ENDINGS: Mapping[str, tuple[str, ...]] = {
    "jsonl": (".jsonl", ".ndjson"),
    "csv": (".csv",),
    "parquet": (".parquet", ".pq"),
    "junit": (".xml",),
    "sarif": (".sarif", ".sarif.json"),
    "xqar": (".xqar",),
    "mcap": (".mcap",),
}
"""Name of a format -> how its files end."""


class FindingWriter(Protocol):
    """Writes findings to a stream: recording by recording, and what comes at the end."""

    def add(self, recording: RecordingFindings) -> None:
        """Take the findings of a recording. Raises RulecError."""

    def close(self) -> None:
        """Write what comes at the end. Raises RulecError."""


def finding_writer(form: str, stream: IO[bytes], about: FindingContext, name: str) -> FindingWriter:
    """A writer of a format, for a stream that is called ``name`` in messages.

    Raises RulecError R0706 if Parquet cannot be written here.
    """
    match form:
        case "csv":
            from rulec.report.verdict_findings.finding_tables import CsvWriter

            return CsvWriter(stream, about.columns)
        case "parquet":
            from rulec.report.verdict_findings.finding_tables import ParquetWriter

            return ParquetWriter(stream, name, about.columns)
        case "junit":
            from rulec.report.verdict_findings.finding_junit import JUnitWriter

            return JUnitWriter(stream, about)
        case "sarif":
            from rulec.report.verdict_findings.finding_sarif import SarifWriter

            return SarifWriter(stream, about)
        case "xqar":
            from rulec.report.verdict_findings.quality_checker import QualityCheckerWriter

            return QualityCheckerWriter(stream, about)
        case "mcap":
            from rulec.report.verdict_findings.finding_mcap import McapWriter

            return McapWriter(stream, about, name)
        case _:
            from rulec.report.verdict_findings.finding_tables import JsonLinesWriter

            return JsonLinesWriter(stream, about.columns)
