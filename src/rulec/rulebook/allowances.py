"""Comments that allow the warnings of their line: ``# rulec: allow R0208 because …``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from rulec.diagnostics import Diagnostic, Fix, Offer, Source, Span
from rulec.diagnostics.ways_out import offering
from rulec.rulebook.rulebook_messages import UNFIT_ALLOWANCE

_ALLOWANCE = re.compile(
    r"#\s*rulec:\s*allow\s+(?P<codes>R\d{4}(?:\s*,\s*R\d{4})*)\b[ \t]*(?:because[ \t]+(?P<why>\S))?"
)
_OF_OTHERS = ("R04", "R05", "R06", "R07", "R08")
"""The prefixes of codes that other verbs find; unused allowances of these are not reported."""


def judged_allowances(findings: Sequence[Diagnostic], source: Source) -> tuple[Diagnostic, ...]:
    """The findings of a source that no comment allows, and mistakes in such comments."""
    return (*without_allowed(findings), *_unfit(findings, source))


def without_allowed(findings: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Findings without the warnings that a comment on their line allows, with a reason."""
    return tuple([finding for finding in findings if not _is_allowed(finding)])


def _unfit(findings: Sequence[Diagnostic], source: Source) -> Iterator[Diagnostic]:
    # Where there are errors, not all warnings are known.
    if "rulec:" not in source.text or any(
        diagnostic.severity == "error" for diagnostic in findings
    ):
        return
    places = {
        (finding.place.line, finding.code)
        for finding in findings
        if finding.place is not None and finding.place.file == source.name
        if finding.severity == "warning"
    }
    for match in _ALLOWANCE.finditer(source.text):
        line, _ = source.position(match.start())
        span = Span(source, match.start(), match.end())
        if match["why"] is None:
            yield UNFIT_ALLOWANCE.at(
                span,
                "this comment says no reason",
                severity="warning",
                help="write `because` and the reason after it",
            )
        codes = re.findall(r"R\d{4}", match["codes"])
        idle = [
            code for code in codes if (line, code) not in places and not code.startswith(_OF_OTHERS)
        ]
        without = _without(source, match)
        offers = (Offer("Leave out the comment", (without,)),) if idle == codes else ()
        for code in idle:
            yield UNFIT_ALLOWANCE.at(
                span,
                f"there is no warning {code} on this line",
                severity="warning",
                help=offering(
                    "leave the comment out, or move it to the line that the warning is about",
                    *offers,
                ),
                fix=without if len(codes) == 1 else None,
            )


def _without(source: Source, comment: re.Match[str]) -> Fix:
    """The fix that removes the comment from its line."""
    before = source.text[: comment.start()]
    end = source.text.find("\n", comment.end())
    start = len(before.rstrip(" \t"))
    return Fix(Span(source, start, len(source.text) if end < 0 else end).place, "")


def _is_allowed(finding: Diagnostic) -> bool:
    if finding.severity != "warning" or finding.place is None:
        return False
    match = _ALLOWANCE.search(finding.place.excerpt)
    return match is not None and match["why"] is not None and finding.code in match["codes"]
