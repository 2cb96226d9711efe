"""Places of diagnostics about a query: from the program around its formula to its own text."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.diagnostics import Diagnostic, Source, SourceLocation, Span


@dataclass(frozen=True, slots=True)
class QueryPlaces:
    """The text of a ``query``, and the ``program`` in which parts of it stand.

    ``parts`` are where each begins in the program, where in the query, and its length, in
    characters. Both texts are called alike in messages.
    """

    query: Source
    program: Source
    parts: tuple[tuple[int, int, int], ...]

    def relocated(self, problem: Diagnostic) -> Diagnostic:
        """The diagnostic with its places in the query, without those in the rest of the program."""
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
        for begin, in_query, length in self.parts:
            if begin <= start <= begin + length:
                shift = in_query - begin
                end = start + max((place.end_column or 0) - place.column, 0)
                if place.end_line != place.line:
                    end = begin + length
                return Span(self.query, start + shift, min(end, begin + length) + shift).place
        return None
