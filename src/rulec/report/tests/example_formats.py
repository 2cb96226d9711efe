"""Outcomes of examples, in the format that somebody asked for."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.book_tests.example_coverage import RuleCoverage
from rulec.book_tests.example_runs import ExampleRun
from rulec.report.tests.example_text import Besides, as_text


def render(
    runs: Sequence[ExampleRun],
    covered: Sequence[Sequence[RuleCoverage]] | None,
    output_format: str,
    besides: Besides,
) -> str:
    """Write runs as ``full``, ``json`` or ``junit``, with coverage unless None.

    ``besides`` is in ``junit`` alone, of which nothing but the file may be looked at.
    """
    match output_format:
        case "json":
            # msgspec and its types take 9 ms.
            from rulec.report.tests.example_json import as_json

            return as_json(runs, covered)
        case "junit":
            # ElementTree takes 4 ms.
            from rulec.report.tests.junit import as_junit

            return as_junit(runs, covered, besides)
        case _:
            return as_text(runs, covered)
