"""Messages about definitions of declared words."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.diagnostics.code import Code
from rulec.rulebook.elaborate.constant_messages import CIRCULAR_DEFINITION
from rulec.syntax import tree
from rulec.vocabulary import Signal

OTHERWISE_DECLARED = Code(
    "R0328",
    title="a definition does not fit the word that it defines",
    why="A declared signal may be defined; where a source does not tell it, the definition does. "
    "It is about the same objects as the signal, and looks at the present and the past.",
    bad="rulebook example\nsignal rain, wet\ndefine wet = ⟪eventually|once⟫ rain\n"
    "hard rule r { require never wet }\n",
)


def no_signal(item: tree.DefineItem, declared: Span | None) -> Diagnostic:
    return OTHERWISE_DECLARED.at(
        item.name.span,
        f"`{item.name.text}` is no signal",
        expected="only a signal can be defined",
        help="give the definition a name of its own",
        labels=() if declared is None else (Label(declared.place, "declared here"),),
    )


def other_objects(item: tree.DefineItem, declared: Signal, place: Span) -> Diagnostic:
    objects = ", ".join(declared.parameters)
    return OTHERWISE_DECLARED.at(
        item.name.span,
        f"`{item.name.text}` is about other objects than its definition",
        expected=f"expected `({objects})`" if objects else "expected no objects",
        help="define it for the objects that it is declared for",
        labels=(Label(place.place, "declared here"),),
    )


def looks_ahead(item: tree.DefineItem, operator: str) -> Diagnostic:
    return OTHERWISE_DECLARED.at(
        item.body.span,
        f"the definition of `{item.name.text}` looks ahead with `{operator}`",
        expected="expected the present or the past",
        help="use `once`, `historically`, `since` or `previously`",
    )


def circle(item: tree.DefineItem, names: tuple[str, ...]) -> Diagnostic:
    way = " → ".join(f"`{name}`" for name in names)
    return CIRCULAR_DEFINITION.at(
        item.name.span,
        f"the definition of `{names[0]}` goes round in a circle: {way}",
        expected="this word is among those that define it",
        help="say one of them without the others",
    )
