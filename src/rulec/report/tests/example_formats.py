"""Outcomes of examples in the requested format."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.book_tests.example_coverage import RuleCoverage
from rulec.book_tests.example_runs import ExampleRun
from rulec.report.tests.example_text import Besides, as_text
from rulec.report.tests.junit import as_junit


def render(
    runs: Sequence[ExampleRun],
    covered: Sequence[Sequence[RuleCoverage]] | None,
    output_format: str,
    besides: Besides,
    *,
    width: int,
    in_full: bool,
) -> str:
    """Write runs as ``full``, ``json`` or ``junit``, with coverage unless it is None.

    Text has a width in characters, and names every example only ``in_full``. ``besides`` are
    written only as ``junit``, whose reader may see nothing but the file.
    """
    match output_format:
        case "json":
            # msgspec and its types take 9 ms.
            from rulec.report.tests.example_json import as_json

            return as_json(runs, covered)
        case "junit":
            return as_junit(runs, covered, besides)
        case _:
            return as_text(runs, covered, besides, width, in_full=in_full)
