"""Putting the parsed parts together: what may come once, what must come, what comes first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from rulec.diagnostics import Diagnostic, Label, Source, Span, nearest_name
from rulec.syntax import tree
from rulec.syntax.build import RuleHead
from rulec.syntax.keywords import CLAUSE_WORDS, ITEM_WORDS

Clause = tuple[str, tree.Text | tree.Formula | None, Span]
"""A clause's word, what it says (None if that could not be read), and the word's place."""

HOW_TO_BEGIN: Final = (
    "expected `rulebook NAME`",
    "a rulebook begins with `rulebook NAME`, a vocabulary with `vocabulary NAME { … }`",
)
"""What a diagnostic about a file's beginning expects, and its help."""

Item = (
    tree.FileLine
    | tree.TitleLine
    | tree.LawLine
    | tree.UseLine
    | tree.Declaration
    | tree.RuleItem
    | tree.BrokenItem
)


def assemble_rule(
    head: RuleHead,
    parts: Sequence[Clause | tree.Example | None],
    span: Span,
    head_span: Span,
    *,
    complete: bool,
) -> tuple[tree.RuleItem, list[Diagnostic]]:
    """The rule of a head and its clauses in any order; None stands for an unreadable example."""
    mistakes: list[Diagnostic] = []
    said: dict[str, Clause] = {}
    for part in parts:
        if isinstance(part, tuple):
            first = said.setdefault(part[0], part)
            if first is not part:
                mistakes.append(_twice(f"`{part[0]}`", part[2], first[2]))
    unread = any(part is None or (isinstance(part, tuple) and part[1] is None) for part in parts)
    complete = complete and not unread
    if "require" not in said and complete:
        mistakes.append(_no_require(head, head_span))
        complete = False

    def value(word: str) -> tree.Text | tree.Formula | None:
        return said[word][1] if word in said else None

    cite, says, require = value("cite"), value("says"), value("require")
    rule = tree.RuleItem(
        "hard" if head.strength == "hard" else "soft",
        head.name,
        head.variables,
        None if isinstance(require, tree.Text) else require,
        cite if isinstance(cite, tree.Text) else None,
        says if isinstance(says, tree.Text) else None,
        tuple(part for part in parts if isinstance(part, tree.Example)),
        complete,
        span,
    )
    return rule, mistakes


def assemble_file(source: Source, parts: Sequence[Item]) -> tuple[tree.File, list[Diagnostic]]:
    """The file of its header lines and items."""
    mistakes: list[Diagnostic] = []
    first = parts[0]
    file_line = first if isinstance(first, tree.FileLine) else None
    kind = file_line.kind if file_line is not None else "rulebook"
    if file_line is None and not isinstance(first, tree.BrokenItem):
        mistakes.append(_no_file_line(first))
    titles = [part for part in parts if isinstance(part, tree.TitleLine)]
    laws = [part for part in parts if isinstance(part, tree.LawLine)]
    if kind == "vocabulary":
        mistakes += _not_for_a_vocabulary(parts)
    else:
        for lines, word in ((titles, "`title`"), (laws, "`law`")):
            mistakes += [_twice(word, line.span, lines[0].span) for line in lines[1:]]
        mistakes += _used_twice(parts)
        said = {one.place for one in mistakes}
        mistakes += [one for one in _misplaced(parts) if one.place not in said]
        mistakes += _no_rule(parts)
    file = tree.File(
        kind,
        None if file_line is None else file_line.name,
        titles[0] if titles else None,
        laws[0] if laws else None,
        tuple(part for part in parts if isinstance(part, tree.UseLine)),
        tuple(part for part in parts if not isinstance(part, _Header)),
        not any(isinstance(part, tree.BrokenItem) and _may_use(part) for part in parts),
        Span(source, 0, len(source.text)),
    )
    return file, mistakes


_Header = tree.FileLine | tree.TitleLine | tree.LawLine | tree.UseLine


def _may_use(item: tree.BrokenItem) -> bool:
    """Was it meant as a ``use`` line? Then any name may be missing because of it."""
    if item.word in ITEM_WORDS:
        return item.word == "use"
    near = nearest_name(item.word, ITEM_WORDS | CLAUSE_WORDS)
    return near == "use" or (near is None and len(item.names) == 2)


def _used_twice(parts: Sequence[Item]) -> Iterable[Diagnostic]:
    first: dict[str, Span] = {}
    for part in parts:
        if isinstance(part, tree.UseLine):
            name = part.name.text
            if name in first:
                yield _twice(f"`use {name}`", part.span, first[name])
            first.setdefault(name, part.span)


def _misplaced(parts: Sequence[Item]) -> Iterable[Diagnostic]:
    """Header lines behind the first item, and a second ``rulebook`` line."""
    item: Item | None = None
    for part in parts[1:]:
        if isinstance(part, tree.FileLine):
            yield Diagnostic(
                "R0115",
                f"`{part.kind} {part.name.text}` begins a second file in this one",
                part.span.place,
                help="move it to a file of its own",
                labels=(Label(parts[0].span.place, "the file begins here"),),
            )
        elif not isinstance(part, _Header):
            item = item or (None if isinstance(part, tree.BrokenItem) else part)
        elif item is not None:
            yield Diagnostic(
                "R0115",
                "header lines stand before declarations and rules",
                part.span.place,
                expected="expected a declaration or a rule",
                help="move it to the top of the file, below `rulebook NAME`",
                labels=(Label(_start(item.span).place, "the header ended before this"),),
            )


def _no_rule(parts: Sequence[Item]) -> Iterable[Diagnostic]:
    if not any(isinstance(part, tree.RuleItem | tree.BrokenItem) for part in parts):
        yield Diagnostic(
            "R0114",
            "the rulebook has no rule",
            _start(parts[0].span).place,
            help="a rule is written `hard rule NAME { require … }`",
        )


def _not_for_a_vocabulary(parts: Sequence[Item]) -> Iterable[Diagnostic]:
    for part in parts[1:]:
        if isinstance(part, tree.RuleItem | _Header):
            yield Diagnostic(
                "R0115",
                "a vocabulary holds declarations only",
                _start(part.span).place,
                expected="expected a declaration",
                help="rules and header lines belong in a rulebook",
            )


def _twice(what: str, again: Span, first: Span) -> Diagnostic:
    return Diagnostic(
        "R0116",
        f"{what} is given twice",
        again.place,
        expected="given again here",
        help="keep one of them",
        labels=(Label(first.place, "first given here"),),
    )


def _no_require(head: RuleHead, span: Span) -> Diagnostic:
    return Diagnostic(
        "R0114",
        f"rule `{head.name.text}` requires nothing",
        span.place,
        expected="expected a `require` clause in this rule",
        help="say what must hold, such as `require always not p`",
    )


def _no_file_line(first: Item) -> Diagnostic:
    return Diagnostic(
        "R0114",
        "the file does not say what it is",
        _start(first.span).place,
        *HOW_TO_BEGIN,
    )


def _start(span: Span) -> Span:
    """The first line of a span, without what follows: enough to show where something stands."""
    end = span.source.text.find("\n", span.start, span.end)
    return span if end < 0 else Span(span.source, span.start, end)
