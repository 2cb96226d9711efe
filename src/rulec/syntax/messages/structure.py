"""What is said about braces and about clauses that stand in the wrong place."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.diagnostics import Diagnostic, Label, Source, Span
from rulec.diagnostics.source_text import SourceLocation
from rulec.syntax.scanner import Token


@dataclass(frozen=True, slots=True)
class StructureMessages:
    """Diagnostics about tokens of one file, by index."""

    source: Source
    tokens: list[Token]

    def place(self, index: int) -> SourceLocation:
        """The token, or the empty place behind the last one."""
        if index < len(self.tokens):
            token = self.tokens[index]
            return Span(self.source, token.start, token.end).place
        return self._behind(len(self.tokens) - 1)

    def _behind(self, index: int) -> SourceLocation:
        end = self.tokens[index].end
        return Span(self.source, end, end).place

    def no_close(self, what: str, opened: int, index: int) -> Diagnostic:
        """The brace of ``what``, at ``opened``, should have been closed before ``index``."""
        at_end = index >= len(self.tokens)
        return Diagnostic(
            "R0108",
            f"the file ends before {what} does" if at_end else f"{what} does not end before this",
            self.place(index),
            expected="expected `}`" if at_end else "expected `}` before this",
            help=f"end {what} with `}}`",
            labels=(Label(self.place(opened), f"{what} begins here"),),
        )

    def no_open(self, before: int, what: str) -> Diagnostic:
        """A ``{`` is missing behind token ``before``."""
        return Diagnostic(
            "R0108",
            f"{what} stand between `{{` and `}}`, and the `{{` is missing",
            self._behind(before),
            expected="expected `{`",
            help="write `{` before them",
        )

    def outside(self, index: int, closed: int | None) -> Diagnostic:
        """A clause or a ``}`` that belongs to no rule; ``closed`` is the last rule's end."""
        labels: tuple[Label, ...] = ()
        if closed is not None:
            labels = (Label(self.place(closed), "what came before ended here"),)
        if self.tokens[index].text == "}":
            return Diagnostic(
                "R0108",
                "this `}` closes nothing",
                self.place(index),
                help="delete it, or look for a `{` that is missing before it",
                labels=labels,
            )
        word = self.tokens[index].text
        return Diagnostic(
            "R0109",
            f"`{'in force' if word == 'in' else word}` stands outside of any rule",
            self.place(index),
            expected="expected a declaration or a rule",
            help="clauses stand between the `{` and the `}` of their rule",
            labels=labels,
        )

    def behind_vocabulary(self, index: int, closed: int) -> Diagnostic:
        """Something stands behind the vocabulary's closing brace."""
        return Diagnostic(
            "R0109",
            "nothing can stand behind a vocabulary's `}`",
            self.place(index),
            expected="expected the end of the file",
            help="move it before the `}`, or into a file of its own",
            labels=(Label(self.place(closed), "the vocabulary ended here"),),
        )
