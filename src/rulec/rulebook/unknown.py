"""Names that are no atom, or are used as if they took other arguments: what was meant?"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, nearest_name
from rulec.rulebook.declared import Declared
from rulec.syntax import tree
from rulec.vocabulary import Enumeration, Quantity, Signal

_GLUED = re.compile(r"([GFX]+)(\w+)")
_GLUED_BINARY = re.compile(r"(\w+?)([URWM])(\w+)")


def explain(use: tree.AtomUse, declared: Declared, variables: Sequence[str]) -> Diagnostic:
    """Why a name is no atom: it is something else, or it is not known."""
    name = use.name.text
    item = declared.items.get(name)
    if isinstance(item, Enumeration):
        values = ", ".join(f"`{_call(value, item)}`" for value in item.values)
        return _not_an_atom(use, declared, "has several values", f"write one of them: {values}")
    if isinstance(item, Quantity):
        why = f"is a number (in {item.unit})"
        return _not_an_atom(use, declared, why, "formulas are about signals and values only")
    if name in variables:
        return Diagnostic(
            "R0303",
            f"`{name}` is an object and cannot be true or false",
            use.name.span.place,
            expected="expected an atom",
            help=f"say something about it, such as `behind({name})`",
        )
    if name in declared.types:
        return Diagnostic(
            "R0303",
            f"`{name}` is a type of objects and cannot be true or false",
            use.name.span.place,
            expected="expected an atom",
            help=f"speak of an object: give the rule a variable, such as `(x: {name})`",
            labels=(Label(declared.type_spans[name].place, f"`{name}` is declared here"),),
        )
    return _unknown(use, declared, variables)


def _not_an_atom(use: tree.AtomUse, declared: Declared, why: str, help_: str) -> Diagnostic:
    name = use.name.text
    return Diagnostic(
        "R0303",
        f"`{name}` {why} and cannot be true or false",
        use.name.span.place,
        expected="expected an atom",
        help=help_,
        labels=(Label(declared.spans[name].place, f"`{name}` is declared here"),),
    )


def _unknown(use: tree.AtomUse, declared: Declared, variables: Sequence[str]) -> Diagnostic:
    name = use.name.text
    atoms = [
        *(one for one, item in declared.items.items() if isinstance(item, Signal)),
        *declared.value_of,
    ]
    glued = _glued(name, set(atoms))
    head, _, tail = name.rpartition("_")
    near = nearest_name(name, atoms)
    short = [
        f"{one}_{variable}" for one in atoms if _arity(declared, one) == 1 for variable in variables
    ]
    near_short = nearest_name(name, short)
    if glued:
        way_out = f"write `{glued}`"
    elif _arity(declared, head) == 1 and not use.arguments:
        known = ", ".join(f"`{one}`" for one in variables) or "none"
        way_out = f"`{head}_{tail}` means `{head}({tail})`; the rule's variables: {known}"
    elif _arity(declared, head) is not None and tail in variables and not use.arguments:
        number = _arity(declared, head)
        way_out = f"`{head}` is about {number or 'no'} objects, so `_{tail}` cannot stand behind it"
    elif near_short is not None and near is None and not use.arguments:
        way_out = f"did you mean `{near_short}`?"
    elif near is not None:
        way_out = f"did you mean `{near}`?"
    else:
        way_out = f"declare it, such as `signal {name}`, or `use` a vocabulary that has it"
    return Diagnostic(
        "R0202",
        f"nothing is called `{name}`",
        use.name.span.place,
        expected="expected a signal or a value",
        help=way_out,
    )


def _arity(declared: Declared, name: str) -> int | None:
    item = declared.items.get(name)
    found = item if isinstance(item, Signal) else declared.value_of.get(name)
    return None if found is None else len(found.parameters)


def _glued(name: str, atoms: set[str]) -> str:
    """``GFp`` as ``G F p``, ``pUq`` as ``p U q``, if p and q are atoms."""
    unary = _GLUED.fullmatch(name)
    if unary is not None:
        for cut in range(len(unary[1]), 0, -1):
            rest = unary[1][cut:] + unary[2]
            if rest in atoms:
                return " ".join([*unary[1][:cut], rest])
    binary = _GLUED_BINARY.fullmatch(name)
    if binary is not None and binary[1] in atoms and binary[3] in atoms:
        return " ".join(binary.groups())
    return ""


def wrong_number(
    use: tree.AtomUse,
    name: str,
    item: Signal | Enumeration,
    declared: Declared,
    variables: Sequence[str],
) -> Diagnostic:
    """A known atom with too few or too many objects."""
    needed, given = len(item.parameters), len(use.arguments)
    objects = {0: "no object", 1: "one object"}.get(needed, f"{needed} objects")
    has = {0: "none is", 1: "one is"}.get(given, f"{given} are")
    arguments = (list(variables) + ["…"] * needed)[:needed]
    written = f"{name}({', '.join(arguments)})" if needed else name
    return Diagnostic(
        "R0301",
        f"`{name}` is about {objects}, and {has} given",
        use.span.place,
        expected=f"expected {objects}",
        help=f"write `{written}`",
        labels=(Label(declared.spans[name].place, f"`{name}` is declared here"),),
    )


def two_readings(use: tree.AtomUse, readings: Sequence[tuple[str, str]]) -> Diagnostic:
    """``a_b_c`` where both ``a(b_c)`` and ``a_b(c)`` make sense."""
    ways = " or ".join(f"`{head}({variable})`" for head, variable in readings)
    return Diagnostic(
        "R0309",
        f"`{use.name.text}` can mean {ways}",
        use.span.place,
        expected="expected a name with one meaning",
        help="write the one you mean with parentheses",
    )


def _call(value: str, item: Enumeration) -> str:
    return f"{value}({', '.join('…' for _ in item.parameters)})" if item.parameters else value
