"""Marks declarations as constant or presumed, according to lines of their own."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, declared, meant, offering
from rulec.rulebook.names.declaration_messages import DECLARED_TWICE
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import name_left_out
from rulec.vocabulary import Enumeration

NOTHING_TO_MARK = Code(
    "R0216",
    title="a constant or presumed name is not declared",
    why="A `constant` or `presumed` line lists signals, quantities and enumerations, which must "
    "be declared in the rulebook or in a vocabulary that it uses. It lists an enumeration, not "
    "one of its values, and the bare name of a declaration about objects.",
    bad="rulebook example\nkind is one of a_car, a_truck\nconstant kinds\n"
    "hard rule r { require always a_car }\n",
    good="rulebook example\nkind is one of a_car, a_truck\nconstant kind\n"
    "hard rule r { require always a_car }\n",
)

NOT_TO_BE_PRESUMED = Code(
    "R0325",
    title="a name cannot be presumed",
    why="A presumed name has its default where no source provides it, so it needs a default. "
    "Every verdict that rests on it says so. A rulebook and its vocabularies may presume a dozen "
    "names, since a verdict that rests on more says little about what was observed. Names that "
    "are not presumed are unknown where nothing provides them.",
    bad="rulebook example\nsignal waved_through\npresumed waved_through\n"
    "hard rule r { require never waved_through }\n",
    good="rulebook example\nsignal waved_through default false\npresumed waved_through\n"
    "hard rule r { require never waved_through }\n",
)


MOST_PRESUMED = 12
"""The most presumed names: each is listed with every verdict that rests on it."""


def mark_constant_and_presumed(symbols: SymbolTable, files: Sequence[tree.File]) -> None:
    """Mark the declarations of the names in `constant` and `presumed` lines.

    A file marks a name once; files that build upon each other may repeat the mark.
    """
    for file in files:
        seen: dict[tuple[type, str], tree.Name] = {}
        for item, name in _marked(file):
            first = seen.setdefault((type(item), name.text), name)
            if first is not name:
                symbols.mistakes.append(_marked_twice(item, name, first.span))
            elif name.text in symbols.items:
                _mark(symbols, item, name)
            elif not symbols.may_know(name.text):
                value_of = symbols.value_of.get(name.text)
                of = "" if value_of is None else value_of.name
                symbols.mistakes.append(_nothing_to_mark(item, name, symbols.items.keys(), of))
    for text, enumeration in symbols.value_of.items():
        now = symbols.items.get(enumeration.name)
        if isinstance(now, Enumeration):
            symbols.value_of[text] = now


def _marked(file: tree.File) -> Iterator[tuple[tree.ConstantItem | tree.PresumedItem, tree.Name]]:
    for item in file.items:
        if isinstance(item, tree.ConstantItem | tree.PresumedItem):
            yield from ((item, name) for name in item.names)


def _mark(
    symbols: SymbolTable, item: tree.ConstantItem | tree.PresumedItem, name: tree.Name
) -> None:
    declared = symbols.items[name.text]
    if isinstance(item, tree.ConstantItem):
        symbols.items[name.text] = replace(declared, constant=True)
        return
    if declared.default is None:
        if name.text not in symbols.uncertain:
            symbols.mistakes.append(_no_default(name, symbols.spans[name.text]))
        return
    symbols.items[name.text] = replace(declared, presumed=True)
    presumed = sum(known.presumed for known in symbols.items.values())
    if presumed > MOST_PRESUMED and not declared.presumed:
        symbols.mistakes.append(_too_many_presumed(name, presumed, MOST_PRESUMED))


def _marked_twice(
    item: tree.ConstantItem | tree.PresumedItem, again: tree.Name, first: Span
) -> Diagnostic:
    return DECLARED_TWICE.at(
        again.span,
        f"`{again.text}` is called {_marked_as(item)} twice",
        expected="said again here",
        help=offering("leave it out", *name_left_out(again.span)),
        labels=(Label(first.place, "first said here"),),
    )


def _nothing_to_mark(
    item: tree.ConstantItem | tree.PresumedItem,
    name: tree.Name,
    known: Collection[str],
    enumeration: str = "",
) -> Diagnostic:
    """Mistake: a name is not declared; it may be a value of an enumeration."""
    signal = f"signal {name.text} default false"
    if enumeration:
        message = f"`{name.text}` is a value, and only what has values can be {_marked_as(item)}"
        way_out: Help = offering(f"write `{enumeration}`, whose value it is", enumeration)
    else:
        message = f"nothing is called `{name.text}` that could be {_marked_as(item)}"
        way_out = meant(name.text, list(known))
    return NOTHING_TO_MARK.at(
        name.span,
        message,
        expected="expected a signal, a quantity or an enumeration",
        help=way_out or offering(f"declare it, such as `{signal}`", declared(signal, name.span)),
    )


def _no_default(name: tree.Name, known: Span) -> Diagnostic:
    return NOT_TO_BE_PRESUMED.at(
        name.span,
        f"`{name.text}` has no default that could be presumed",
        expected="expected a name that has a default",
        help=offering(
            "give it a default where it is declared, or leave it out here",
            *name_left_out(name.span),
        ),
        labels=(Label(known.place, "declared here"),),
    )


def _too_many_presumed(name: tree.Name, number: int, most: int) -> Diagnostic:
    return NOT_TO_BE_PRESUMED.at(
        name.span,
        f"`{name.text}` is the {number}th name that is presumed; there may be {most}",
        expected="one more than can be presumed",
        help="presume only what is rare and no source could tell; leave the others unknown",
    )


def _marked_as(item: tree.ConstantItem | tree.PresumedItem) -> str:
    return "constant" if isinstance(item, tree.ConstantItem) else "presumed"
