"""Places of diagnostics about a query, mapped from the surrounding program to the query."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.diagnostics import Diagnostic, Source, SourceLocation, Span


@dataclass(frozen=True, slots=True)
class QueryPlaces:
    """The text of a ``query``, and the ``program`` that contains parts of it.

    ``parts`` are the start of each part in the program, its start in the query, and its length, in
    characters. Messages use the same name for both texts.
    """

    query: Source
    program: Source
    parts: tuple[tuple[int, int, int], ...]

    def relocated(self, problem: Diagnostic) -> Diagnostic:
        """The diagnostic with its places in the query.

        Places in the rest of the program are dropped.
        """
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
