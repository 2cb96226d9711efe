"""Messages about braces, and clauses in the wrong place."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.diagnostics import Diagnostic, Label, Source, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.source_text import SourceLocation
from rulec.syntax.scanner import Token

UNBALANCED_BRACE = Code(
    "R0108",
    title="a brace is missing or closes nothing",
    why="The clauses of a rule, the states of an example and the items of a vocabulary stand "
    "between `{` and `}`. The message names what was not begun or not ended.",
    bad="rulebook example\nsignal p\nhard rule a { require p\nhard rule b { require not p }\n",
    good="rulebook example\nsignal p\nhard rule a { require p }\nhard rule b { require not p }\n",
)

OUTSIDE_BRACES = Code(
    "R0109",
    title="something stands outside the braces that it belongs in",
    why="A clause such as `cite` or `accept` belongs to a rule and stands between its braces; "
    "behind the `}` of a vocabulary nothing can stand.",
    bad="rulebook example\nsignal p\nhard rule r { require p }\naccept { p }\n",
    good="rulebook example\nsignal p\nhard rule r { require p accept { p } }\n",
)


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
        return UNBALANCED_BRACE.at(
            self.place(index),
            f"the file ends before {what} does" if at_end else f"{what} does not end before this",
            expected="expected `}`" if at_end else "expected `}` before this",
            help=f"end {what} with `}}`",
            labels=(Label(self.place(opened), f"{what} begins here"),),
        )

    def no_open(self, before: int, what: str) -> Diagnostic:
        """A ``{`` is missing behind token ``before``."""
        return UNBALANCED_BRACE.at(
            self._behind(before),
            f"{what} stand between `{{` and `}}`, and the `{{` is missing",
            expected="expected `{`",
            help="write `{` before them",
        )

    def outside(self, index: int, closed: int | None) -> Diagnostic:
        labels: tuple[Label, ...] = ()
        if closed is not None:
            labels = (Label(self.place(closed), "what came before ended here"),)
        if self.tokens[index].text == "}":
            return UNBALANCED_BRACE.at(
                self.place(index),
                "this `}` closes nothing",
                help="delete it, or look for a `{` that is missing before it",
                labels=labels,
            )
        word = self.tokens[index].text
        return OUTSIDE_BRACES.at(
            self.place(index),
            f"`{'in force' if word == 'in' else word}` stands outside of any rule",
            expected="expected a declaration or a rule",
            help="clauses stand between the `{` and the `}` of their rule",
            labels=labels,
        )

    def behind_vocabulary(self, index: int, closed: int) -> Diagnostic:
        return OUTSIDE_BRACES.at(
            self.place(index),
            "nothing can stand behind a vocabulary's `}`",
            expected="expected the end of the file",
            help="move it before the `}`, or into a file of its own",
            labels=(Label(self.place(closed), "the vocabulary ended here"),),
        )
