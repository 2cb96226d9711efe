"""Formats lines of Rust as rustfmt does, as far as generated code needs it.

A generated line holds one item, field, arm, statement or expression, however long it is. The
numbers are rustfmt's: an argument list, an array or a structure stays on one line only up to a
width of its own, and short values fill lines.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

_LINE = 100
_STEP = "    "
_WIDEST = {"(": 60, "[": 60, "{": 18}
_WIDEST_CHOICE = 50
_SHORT = 10

_SIMPLE = re.compile(r'[-&]*("[^"]*"|[\w.#+]+)')
_HEAD = re.compile(r"(.*? (?:=|\+=|=>) )(.*)")
_FIELD = re.compile(r"([\w#]+: )(.*)")
_CHOICE = re.compile(r"if (.*) \{ (.*) \} else \{ (.*) \}")
_OPENING = re.compile(r"[\[({]")
_CLOSERS = {"(": ")", "[": "]", "{": "}"}


class _List(NamedTuple):
    """A bracketed list: the text before the bracket, and the parts."""

    name: str
    bracket: str
    parts: Sequence[str]

    @property
    def pad(self) -> str:
        """The space between brackets and parts on one line."""
        return " " * (self.bracket == "{")

    def on_a_line(self, parts: Sequence[str]) -> str:
        """The whole list on one line."""
        inner = f"{self.pad}{', '.join(parts)}{self.pad}" if parts else ""
        return f"{self.name}{self.bracket}{inner}{_CLOSERS[self.bracket]}"


def formed(lines: Iterable[str]) -> Iterator[str]:
    """Lines in rustfmt's form; comments and lines that only open or close a block are unchanged."""
    for line in lines:
        text = line.lstrip(" ")
        indent = line[: len(line) - len(text)]
        if text.startswith(("//", "#")) or text.endswith(("{", "[")) or not _OPENING.search(text):
            yield from _signature(indent, text)
            continue
        tail = text[-1] if text[-1] in ";," else ""
        text = text.removesuffix(tail)
        match = _HEAD.fullmatch(text)
        head, expression = match.groups() if match else ("", text)
        yield from _whole(indent, head, expression, tail)


def _signature(indent: str, text: str) -> Iterator[str]:
    """The head of a function, with its parameters on separate lines if it is too long."""
    match = re.fullmatch(r"((?:pub )?fn \w+)\((.*)\)( -> .*| \{)", text)
    if match is None or len(indent) + len(text) <= _LINE:
        yield f"{indent}{text}"
        return
    yield f"{indent}{match[1]}("
    yield from (f"{indent}{_STEP}{part}," for part in _parts(match[2]))
    yield f"{indent}){match[3]}"


def _whole(indent: str, head: str, expression: str, tail: str) -> Iterator[str]:
    room = _LINE - len(indent) - len(tail)
    is_choice = head.endswith("=> ") and expression.startswith("if ")
    here = _laid(expression, indent, room - len(head), states=not head)
    below = _laid(expression, indent + _STEP, room - len(_STEP), states=is_choice)
    if len(here) > 1 and head.endswith("= ") and _is_better_below(here, below):
        yield f"{indent}{head}".rstrip()
        head, here = _STEP, below
    elif head.endswith("=> ") and (is_choice or (len(here) > 1 and _is_better_below(here, below))):
        yield f"{indent}{head}{{"
        yield from [f"{indent}{_STEP}{below[0]}", *below[1:]]
        yield f"{indent}}}"
        return
    here[-1] += tail
    yield f"{indent}{head}{here[0]}"
    yield from here[1:]


def _is_better_below(here: Sequence[str], below: Sequence[str]) -> bool:
    return (
        len(below) == 1
        or len(here) > len(below) + 1
        or any(here[0].endswith(bracket) and not below[0].endswith(bracket) for bracket in "([{")
    )


def _laid(expression: str, indent: str, room: int, *, states: bool = False) -> list[str]:
    """The lines of an expression, the first without its indentation.

    ``room`` is what is left of the first line. As a statement (``states``) an ``if`` always has
    several lines.
    """
    if (choice := _CHOICE.fullmatch(expression)) is not None:
        if not states and len(expression) <= min(_WIDEST_CHOICE, room):
            return [expression]
        condition, chosen, other = choice.groups()
        return [
            f"if {condition} {{",
            *_indented(_laid(chosen, indent + _STEP, _LINE - len(indent) - 4), indent),
            f"{indent}}} else {{",
            *_indented(_laid(other, indent + _STEP, _LINE - len(indent) - 4), indent),
            f"{indent}}}",
        ]
    if (field := _FIELD.fullmatch(expression)) is not None:
        first, *others = _laid(field[2], indent, room - len(field[1]))
        return [f"{field[1]}{first}", *others]
    if (listed := _listed(expression)) is not None:
        return _laid_list(listed, indent, room)
    owner, _, own = expression.rpartition(".")
    if len(expression) > room and owner:
        return [owner, f"{indent}{_STEP}.{own}"]
    return [expression]


def _laid_list(listed: _List, indent: str, room: int) -> list[str]:
    name, bracket, parts = listed
    inner_room = room - len(listed.on_a_line([])) - 2 * len(listed.pad)
    content = ", ".join(parts)
    widest = min(_WIDEST[bracket], inner_room)
    if len(parts) == 1 and bracket == "(" and _is_call(parts[0]):
        # A call that is the only argument shares its lines with the outer brackets.
        first, *others = _laid(parts[0], indent, widest)
        if others or len(first) <= widest:
            *others, last = [f"{name}({first}", *others]
            return [*others, f"{last})"]
    elif len(parts) == 1 and bracket != "{":
        widest = inner_room
    is_flat = all(len(_laid(part, indent, _LINE)) == 1 for part in parts)
    if is_flat and len(content) <= widest:
        return [listed.on_a_line(parts)]
    inner = indent + _STEP
    if all(_SIMPLE.fullmatch(part) and len(part) <= _SHORT for part in parts):
        middle = _filled(parts, inner)
    else:
        middle = []
        for part in parts:
            lines = _laid(part, inner, _LINE - len(inner) - 1)
            lines[-1] += ","
            middle += [f"{inner}{lines[0]}", *lines[1:]]
    return [f"{name}{bracket}", *middle, f"{indent}{_CLOSERS[bracket]}"]


def _is_call(expression: str) -> bool:
    listed = _listed(expression)
    return listed is not None and listed.bracket == "(" and bool(listed.name)


def _indented(lines: Sequence[str], indent: str) -> list[str]:
    return [f"{indent}{_STEP}{lines[0]}", *lines[1:]]


def _filled(parts: Sequence[str], indent: str) -> list[str]:
    lines = [indent]
    for number, part in enumerate(parts, 1):
        gap = " " * (lines[-1] != indent)
        # One column is kept free for a comma, unless everything is on one line.
        widest = _LINE - (number < len(parts) or len(lines) > 1)
        if len(f"{lines[-1]}{gap}{part},") > widest:
            lines.append(indent)
            gap = ""
        lines[-1] += f"{gap}{part},"
    return lines


def _listed(expression: str) -> _List | None:
    """A call, an array, a tuple or a structure's literal; None for anything else."""
    match = re.match(r"[&\w:#.]*( (?=\{))?", expression)
    start = match.end() if match else 0
    if start == len(expression) or expression[start] not in _CLOSERS:
        return None
    bracket = expression[start]
    inner = expression[start + 1 : -1]
    if expression[-1] != _CLOSERS[bracket] or _closes_early(inner):
        return None
    return _List(expression[:start], bracket, _parts(inner.strip(" ")))


def _closes_early(inner: str) -> bool:
    return min(_depths(inner), default=0) < 0


def _depths(text: str) -> list[int]:
    """The number of open brackets after each character; brackets within strings do not count."""
    depth, depths, quoted = 0, [], False
    for character in text:
        quoted ^= character == '"'
        if not quoted:
            depth += (character in "([{") - (character in ")]}")
        depths.append(depth + quoted * 1000)
    return depths


def _parts(text: str) -> list[str]:
    """The parts between commas that are outside of inner brackets."""
    cuts = [at for at, depth in enumerate(_depths(text)) if text[at] == "," and not depth]
    starts = [0, *(at + 1 for at in cuts)]
    parts = [text[a:b].strip(" ") for a, b in zip(starts, [*cuts, len(text)], strict=True)]
    return [part for part in parts if part]
