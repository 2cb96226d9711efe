"""Messages about the parts of a file that are missing, misplaced, or lack a brace."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath

from rulec.diagnostics import Diagnostic, Fix, Label, Offer, Source, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.diagnostic import SourceLocation
from rulec.diagnostics.ways_out import Help, WayOut, left_out, line_above, offering, put_before
from rulec.files.source_detection import first_word_at
from rulec.syntax.keywords import CHANGE_WORDS, CLAUSE_WORDS, ITEM_WORDS, RULE_WORDS
from rulec.syntax.messages.larger_edits import (
    MOST_MOVED,
    brace_closed,
    clause_left_out,
    end_of_clause,
    requirements_joined,
)
from rulec.syntax.scanner import Token

EXPECTED_BEGINNING = "expected `rulebook NAME`"
HOW_TO_BEGIN = "a rulebook begins with `rulebook NAME`, a vocabulary with `vocabulary NAME { … }`"

EMPTY_FILE = Code("R0103")

MISSING_PART = Code("R0114")

MISPLACED_LINE = Code("R0115")

GIVEN_TWICE = Code("R0116")

NOT_A_RULEBOOK = Code("R0117")

CONFIRMED_AND_CHANGED = Code("R0120")


def changed_by_confirming(rule: str, word: str, place: Span) -> Diagnostic:
    head = place.source.text.rfind("confirm rule", 0, place.start)
    confirmed = Span(place.source, max(0, head), head + len("confirm rule"))
    override = Offer("Override the rule", (Fix(confirmed.place, "override rule"),))
    return CONFIRMED_AND_CHANGED.at(
        place,
        f"`{'in force' if word == 'in' else word}` changes rule `{rule}`, which is confirmed here",
        expected="expected `cite`, `source`, `certainty`, `says`, `topic` or an example",
        help=offering(
            f"write `override rule {rule}` to change it, or leave this out",
            *((override,) if head >= 0 else ()),
            clause_left_out(place),
        ),
    )


def no_cite(rule: str, head: Span) -> Diagnostic:
    """A confirmation without the provision that confirms the rule."""
    return MISSING_PART.at(
        head,
        f"this does not say which provision confirms rule `{rule}`",
        expected="expected a `cite` clause in it",
        help='name the article of this rulebook\'s own law, such as `cite "Art. 5(1)"`',
    )


def given_twice(clause: str, again: Span, first: Span) -> Diagnostic:
    if clause == "`require`":
        way_out: Help = offering(
            "join them by `and`, or write a rule for each", *requirements_joined(again)
        )
    else:
        # What of it is law, only the author knows.
        is_law = again.text in ("when", "unless")
        way_out = offering("keep one of them", *(() if is_law else (clause_left_out(again),)))
    return GIVEN_TWICE.at(
        again,
        f"{clause} is given twice",
        expected="given again here",
        help=way_out,
        labels=(Label(first.place, "first given here"),),
    )


def no_beginning(source: Source) -> Diagnostic:
    """The message about a file that does not begin like a source; it quotes nothing of it."""
    start, end = first_word_at(source.text)
    word = source.text[start:end]
    line, column = source.position(start)
    place = SourceLocation(source.name, line, column, line, column + max(1, len(word)))
    if word in ITEM_WORDS:
        code, message = MISSING_PART, "the file does not say what it is"
    else:
        code, message = NOT_A_RULEBOOK, "the file is no rulebook"
    if _COMPILED in source.text[:_HEAD]:
        way_out = "give its name the ending `.json`; packed with gzip it may stay"
        if source.name.endswith(".json"):
            way_out = "give the source that it was compiled from"
        return code.at(place, "the file is a compiled rulebook, and no source", help=way_out)
    return code.at(
        place,
        message,
        help=how_to_begin(Span(source, start, end)) if code is MISSING_PART else HOW_TO_BEGIN,
    )


def how_to_begin(first: Span) -> WayOut:
    """Help for a file that does not say what it is: a rulebook of the file's name, perhaps."""
    stem = PurePath(first.source.name).stem
    begins = line_above(f"Begin with `rulebook {stem}`", f"rulebook {stem}", first)
    return offering(HOW_TO_BEGIN, *((begins,) if stem.isidentifier() else ()))


_COMPILED, _HEAD = '"rulec compiled rulebook"', 1000
"""The text at the beginning of a compiled rulebook, and how many characters are searched."""


UNBALANCED_BRACE = Code("R0108")

OUTSIDE_BRACES = Code("R0109")


@dataclass(frozen=True, slots=True)
class StructureMessages:
    """Diagnostics about tokens of one file, by index."""

    source: Source
    tokens: list[Token]

    def place(self, index: int) -> SourceLocation:
        """The token's place, or the empty place after the last token."""
        return Span(self.source, *self._bounds(index)).place

    def _bounds(self, index: int) -> tuple[int, int]:
        if index < len(self.tokens):
            return self.tokens[index].start, self.tokens[index].end
        return self.tokens[-1].end, self.tokens[-1].end

    def _behind(self, index: int) -> SourceLocation:
        end = self.tokens[index].end
        return Span(self.source, end, end).place

    def _into_the_braces(self, closed: int | None, end: int) -> Iterator[Offer]:
        """What follows a closing brace, up to a character, moved into it."""
        if closed is None or self.tokens[closed].text != "}":
            return
        start, behind = self._bounds(closed)
        if end - behind > MOST_MOVED:
            return
        brace, both = Span(self.source, start, behind), Span(self.source, start, end)
        inside = f"{self.source.text[behind:end].rstrip()}\n}}"
        yield Offer("Put it inside the braces", (Fix(both.place, inside),))
        yield left_out(brace, "Leave out the `}` before it")

    def no_close(self, block: str, opened: int, index: int) -> Diagnostic:
        """The brace of a ``block``, at ``opened``, should have been closed before ``index``."""
        at_end = index >= len(self.tokens)
        sign = Span(self.source, *self._bounds(index))
        return UNBALANCED_BRACE.at(
            self.place(index),
            f"the file ends before {block} does" if at_end else f"{block} does not end before this",
            expected="expected `}`" if at_end else "expected `}` before this",
            help=offering(f"end {block} with `}}`{self._or_moved_out(index)}", brace_closed(sign)),
            labels=(Label(self.place(opened), f"{block} begins here"),),
        )

    def _or_moved_out(self, index: int) -> str:
        """Another way out for a declaration, if a clause or a `}` comes after its line."""
        declaring = ITEM_WORDS - {*RULE_WORDS, *CHANGE_WORDS, "rule"}
        if index >= len(self.tokens) or self.tokens[index].text not in declaring:
            return ""
        lines = (token for token in self.tokens[index + 1 :] if token.first)
        after = next(lines, None)
        if after is None or after.text not in (*CLAUSE_WORDS, "}"):
            return ""
        return f", or put `{self.tokens[index].text}` above it, if it goes on below"

    def no_open(self, before: int, content: str, *, confirms: bool = False) -> Diagnostic:
        """A ``{`` is missing after token ``before``, perhaps in a confirmation."""
        end = self.tokens[before].end
        opened = put_before(" {", Span(self.source, end, end))
        way_out: Help = offering("write `{` before them", opened)
        if confirms:
            way_out = 'write which provision confirms it, such as `{ cite "s. 12" }`'
        return UNBALANCED_BRACE.at(
            self._behind(before),
            f"{content} go between `{{` and `}}`, and the `{{` is missing",
            expected="expected `{`",
            help=way_out,
        )

    def before_brace(self, index: int) -> Diagnostic:
        """A clause between a rule's head and its ``{``."""
        word = self.tokens[index].text
        clause = "in force" if word == "in" else word
        return OUTSIDE_BRACES.at(
            self.place(index),
            f"`{clause}` comes before the `{{` of its rule",
            expected="expected `{`",
            help=f"move it after the `{{`: `{clause}` is a clause, and no part of the head",
        )

    def outside(self, index: int, closed: int | None) -> Diagnostic:
        labels: tuple[Label, ...] = ()
        if closed is not None:
            labels = (Label(self.place(closed), "what came before ended here"),)
        if self.tokens[index].text == "}":
            return UNBALANCED_BRACE.at(
                self.place(index),
                "this `}` closes nothing",
                help=offering(
                    "delete it, or look for a `{` that is missing before it",
                    left_out(Span(self.source, *self._bounds(index))),
                ),
                labels=labels,
            )
        word, start = self.tokens[index].text, self.tokens[index].start
        return OUTSIDE_BRACES.at(
            self.place(index),
            f"`{'in force' if word == 'in' else word}` is outside any rule",
            expected="expected a declaration or a rule",
            help=offering(
                "clauses go between the `{` and the `}` of their rule, as in "
                "`hard rule NAME { require … }`",
                *self._into_the_braces(closed, end_of_clause(self.source.text, start)),
            ),
            labels=labels,
        )

    def behind_vocabulary(self, index: int, closed: int) -> Diagnostic:
        return OUTSIDE_BRACES.at(
            self.place(index),
            "nothing can follow a vocabulary's `}`",
            expected="expected the end of the file",
            help=offering(
                "move it before the `}`, or into a file of its own",
                *self._into_the_braces(closed, len(self.source.text.rstrip())),
            ),
            labels=(Label(self.place(closed), "the vocabulary ended here"),),
        )
