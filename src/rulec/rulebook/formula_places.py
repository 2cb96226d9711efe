"""Places in the program around a formula, as places in what somebody has asked."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.diagnostics import Diagnostic, Source, SourceLocation, Span


@dataclass(frozen=True, slots=True)
class AskedParts:
    """What has been ``asked``, and the ``program`` in which parts of it stand.

    ``parts`` are where each begins in the program, where in what was asked, and how long it is.
    Both texts are called alike in messages.
    """

    asked: Source
    program: Source
    parts: tuple[tuple[int, int, int], ...]

    def relocated(self, problem: Diagnostic) -> Diagnostic:
        """The diagnostic, with no place where it is about what nobody has written."""
        place = problem.place and self._place(problem.place)
        moved = ((label, self._place(label.place)) for label in problem.labels)
        labels = tuple(
            replace(label, place=location) for label, location in moved if location is not None
        )
        expected = problem.expected if place is not None else ""
        return replace(problem, place=place, labels=labels, expected=expected)

    def _place(self, place: SourceLocation) -> SourceLocation | None:
        if place.file != self.program.name or place.line is None or place.column is None:
            return place
        lines = self.program.text.split("\n")
        start = sum(len(line) + 1 for line in lines[: place.line - 1]) + place.column - 1
        for begin, at_text, length in self.parts:
            if begin <= start <= begin + length:
                shift = at_text - begin
                end = start + max((place.end_column or 0) - place.column, 0)
                if place.end_line != place.line:
                    end = begin + length
                return Span(self.asked, start + shift, min(end, begin + length) + shift).place
        return None
