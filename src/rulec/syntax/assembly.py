"""Assembles parsed parts, checking their number and order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, Final

from rulec.diagnostics import Diagnostic, Label, Source, Span, nearest_name
from rulec.syntax import tree
from rulec.syntax.building.items import Clause
from rulec.syntax.keywords import CLAUSE_WORDS, ITEM_WORDS
from rulec.syntax.messages import structure

ClausePart = tuple[str, Clause | None, Span]
"""A clause's keyword, its content (None if it could not be read), and the keyword's place."""

_PLAIN = ("require", "cite", "says", "when", "source")
"""Clauses that become the rule's field of that name."""

_CONFIRMING = ("cite", "says", "source", "certainty", "topic")
"""Clauses that a confirmation may have."""

Part = tree.HeaderLine | tree.Item
"""The parts at the top level of a file."""


def assemble_rule(
    head: tree.RuleItem,
    parts: Sequence[ClausePart | tree.ExampleItem | None],
    span: Span,
    head_span: Span,
    *,
    complete: bool,
) -> tuple[tree.RuleItem, list[Diagnostic]]:
    """Assemble a rule; None stands for an unreadable example."""
    mistakes: list[Diagnostic] = []
    first_given: dict[str, ClausePart] = {}
    for part in parts:
        if isinstance(part, tuple):
            first = first_given.setdefault(part[0], part)
            if first is not part and part[0] not in ("unless", "also"):
                clause = "in force" if part[0] == "in" else part[0]
                mistakes.append(structure.given_twice(f"`{clause}`", part[2], first[2]))
    unread = any(part is None or (isinstance(part, tuple) and part[1] is None) for part in parts)
    complete = complete and not unread
    if "require" not in first_given and complete and not head.override:
        mistakes.append(_no_require(head, head_span))
        complete = False
    if head.confirm:
        more = [part for word, part in first_given.items() if word not in _CONFIRMING]
        mistakes += [structure.changed_by_confirming(head.name.text, *part[::2]) for part in more]
        if "cite" not in first_given and complete and not more:
            mistakes.append(structure.no_cite(head.name.text, head_span))
        complete = complete and not more and "cite" in first_given
    given: dict[str, Any] = {word: content for word, content, _ in first_given.values()}
    plain: dict[str, Any] = {word: given.get(word) for word in _PLAIN}
    rule = replace(
        head,
        examples=tuple(part for part in parts if isinstance(part, tree.ExampleItem)),
        complete=complete,
        span=span,
        unless=tuple(
            part[1]
            for part in parts
            if isinstance(part, tuple) and isinstance(part[1], tree.Unless)
        ),
        certainty=given.get("certainty") or "",
        in_force=given.get("in"),
        topics=given.get("topic") or (),
        **plain,
    )
    return rule, mistakes


def assemble_file(source: Source, parts: Sequence[Part]) -> tuple[tree.File, list[Diagnostic]]:
    """Assemble the file from its header lines and items."""
    mistakes: list[Diagnostic] = []
    first = parts[0]
    file_line = first if isinstance(first, tree.FileLine) else None
    kind = file_line.kind if file_line is not None else "rulebook"
    if file_line is None and not isinstance(first, tree.BrokenItem):
        mistakes.append(_no_file_line(first))
    once: dict[str, list[Any]] = {
        word: [part for part in parts if isinstance(part, line)] for word, line in _ONCE.items()
    }
    if kind == "vocabulary":
        mistakes += _not_for_a_vocabulary(parts)
    else:
        for word, lines in once.items():
            mistakes += [
                structure.given_twice(f"`{word}`", line.span, lines[0].span) for line in lines[1:]
            ]
        mistakes += _used_twice(parts)
        reported = {mistake.place for mistake in mistakes}
        mistakes += [mistake for mistake in _misplaced(parts) if mistake.place not in reported]
        mistakes += _no_rule(parts)
    file = tree.File(
        kind=kind,
        name=None if file_line is None else file_line.name,
        uses=tuple(part for part in parts if isinstance(part, tree.UseLine)),
        items=tuple(part for part in parts if not isinstance(part, tree.HeaderLine)),
        complete=not any(isinstance(part, tree.BrokenItem) and _may_use(part) for part in parts),
        span=Span(source, 0, len(source.text)),
        priorities=tuple(part for part in parts if isinstance(part, tree.PriorityLine)),
        **{word: next(iter(lines), None) for word, lines in once.items()},
    )
    return file, mistakes


_ONCE: Final = {
    "title": tree.TitleLine,
    "law": tree.LawLine,
    "extends": tree.ExtendsLine,
    "traffic": tree.TrafficLine,
    "semantics": tree.SemanticsLine,
    "step": tree.StepLine,
}


def _may_use(item: tree.BrokenItem) -> bool:
    """Whether unreadable text may have been ``use`` or ``extends``."""
    if item.word in ITEM_WORDS:
        return item.word in ("use", "extends")
    near = nearest_name(item.word, ITEM_WORDS | CLAUSE_WORDS)
    return near in ("use", "extends") or (near is None and len(item.names) == 2)


def _used_twice(parts: Sequence[Part]) -> Iterable[Diagnostic]:
    first: dict[str, Span] = {}
    for part in parts:
        if isinstance(part, tree.UseLine):
            name = part.name.text
            if name in first:
                yield structure.given_twice(f"`use {name}`", part.span, first[name])
            first.setdefault(name, part.span)


def _misplaced(parts: Sequence[Part]) -> Iterable[Diagnostic]:
    item: Part | None = None
    for part in parts[1:]:
        if isinstance(part, tree.FileLine):
            yield structure.MISPLACED_LINE.at(
                part.span,
                f"`{part.kind} {part.name.text}` begins a second file in this one",
                help="move it to a file of its own",
                labels=(Label(parts[0].span.place, "the file begins here"),),
            )
        elif not isinstance(part, tree.HeaderLine):
            item = item or (None if isinstance(part, tree.BrokenItem) else part)
        elif item is not None:
            yield structure.MISPLACED_LINE.at(
                part.span,
                "header lines come before declarations and rules",
                expected="expected a declaration or a rule",
                help="move it to the top of the file, below `rulebook NAME`",
                labels=(Label(_start(item.span).place, "the header ended before this"),),
            )


def _no_rule(parts: Sequence[Part]) -> Iterable[Diagnostic]:
    # One that has none of its own offers something to those that extend it.
    enough = tree.RuleItem | tree.BrokenItem | tree.ExtendsLine | tree.Definition | tree.Listing
    if not any(isinstance(part, enough) for part in parts):
        yield structure.MISSING_PART.at(
            _start(parts[0].span),
            "the rulebook has no rule",
            help="a rule is written `hard rule NAME { require … }`",
        )


def _not_for_a_vocabulary(parts: Sequence[Part]) -> Iterable[Diagnostic]:
    for part in parts[1:]:
        misplaced = isinstance(part, tree.RuleItem | tree.Listing | tree.HeaderLine)
        if misplaced or (isinstance(part, tree.Definition) and not is_of_words(part)):
            yield structure.MISPLACED_LINE.at(
                _start(part.span),
                "a vocabulary holds declarations and what its words mean",
                expected="expected a declaration, `param` or `define`",
                help="rules and header lines belong in a rulebook",
            )


def is_of_words(item: tree.Definition) -> bool:
    """Whether a vocabulary may have the item: a definition, or a parameter of definitions."""
    return isinstance(item, tree.ParamItem) or (
        isinstance(item, tree.DefineItem) and not item.again
    )


def _no_require(head: tree.RuleItem, span: Span) -> Diagnostic:
    return structure.MISSING_PART.at(
        span,
        f"rule `{head.name.text}` requires nothing",
        expected="expected a `require` clause in this rule",
        help="say what must hold, such as `require always not p`",
    )


def _no_file_line(first: Part) -> Diagnostic:
    return structure.MISSING_PART.at(
        _start(first.span),
        "the file does not say what it is",
        expected=structure.EXPECTED_BEGINNING,
        help=structure.how_to_begin(first.span),
    )


def _start(span: Span) -> Span:
    end = span.source.text.find("\n", span.start, span.end)
    return span if end < 0 else Span(span.source, span.start, end)
