"""Checks sources, by the cache where nothing has changed."""

from __future__ import annotations

from pathlib import Path

from rulec.diagnostics import Diagnostic
from rulec.rulebook.reading.reading_cache import BookQuestion, recalled, remember_findings


def findings_of(question: BookQuestion) -> tuple[Diagnostic, ...]:
    """All errors and warnings about a rulebook or a vocabulary."""
    reading, _ = recalled(question)
    if reading is not None:
        return reading.findings
    from rulec.rulebook import loader  # the parser takes 60 ms, and what is known needs none

    name, folders = question.name, list(map(Path, question.search_path))
    diagnosis = loader.diagnose(name, question.data, Path(name), folders, question.at)
    if diagnosis.dependencies is not None:
        remember_findings(question, diagnosis.findings, diagnosis.dependencies)
    return diagnosis.findings
