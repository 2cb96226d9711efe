"""Names that are no atom, or are used as if they took other arguments: what was meant?"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rulec.diagnostics import Diagnostic, Label, any_of, did_you_mean, named, nearest_name
from rulec.rulebook.declared import Declared
from rulec.syntax import tree
from rulec.syntax.keywords import INFIX_LETTERS, PREFIX_LETTERS
from rulec.vocabulary import Enumeration, Quantity, Signal

_ATOM = "expected a signal or a value"
_GLUED = re.compile(rf"([{PREFIX_LETTERS}]+)(\w+)")
_GLUED_BINARY = re.compile(rf"(\w+?)([{INFIX_LETTERS}])(\w+)")


def explain(use: tree.AtomUse, declared: Declared, variables: Sequence[str]) -> Diagnostic:
    """Why a name is no atom: it is something else, or it is not known."""
    name = use.name.text
    item = declared.items.get(name)
    if isinstance(item, Enumeration):
        values = any_of([f"`{_call(value, item)}`" for value in item.values])
        return _not_an_atom(use, declared, "has several values", f"write {values}")
    if isinstance(item, Quantity):
        why = f"is a number (in {item.unit})"
        return _not_an_atom(use, declared, why, "formulas are about signals and values only")
    if name in variables:
        example = next(iter(_about_one(declared)), "p")
        return Diagnostic(
            "R0303",
            f"`{name}` is an object and cannot be true or false",
            use.name.span.place,
            expected=_ATOM,
            help=f"say something about it, such as `{example}({name})`",
        )
    if name in declared.types:
        return Diagnostic(
            "R0303",
            f"`{name}` is a type of objects and cannot be true or false",
            use.name.span.place,
            expected=_ATOM,
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
        expected=_ATOM,
        help=help_,
        labels=(Label(declared.spans[name].place, f"`{name}` is declared here"),),
    )


def _unknown(use: tree.AtomUse, declared: Declared, variables: Sequence[str]) -> Diagnostic:
    name = use.name.text
    atoms = _atoms(declared)
    glued = _glued(name, set(atoms))
    if name == "if":
        way_out = "write `p implies q` for `if p then q`"
    elif glued:
        way_out = f"write `{glued}`"
    else:
        way_out = (
            ("" if use.arguments else _short_form(name, declared, variables))
            or did_you_mean(name, atoms)
            or f"declare it, such as `signal {name}`, or `use` a vocabulary that has it"
        )
    return Diagnostic(
        "R0202",
        f"nothing is called `{name}`",
        use.name.span.place,
        expected=_ATOM,
        help=way_out,
    )


def _short_form(name: str, declared: Declared, variables: Sequence[str]) -> str:
    """What may be wrong with ``b_v`` where it stands for ``b(v)``."""
    head, _, tail = name.rpartition("_")
    item = declared.behind_atom(head)
    if item is not None and len(item.parameters) == 1:
        known = f"its variables are {named(variables)}" if variables else "it has none"
        return f"`{name}` means `{head}({tail})`, but the rule has no variable `{tail}`; {known}"
    if item is not None and tail in variables:
        number = len(item.parameters) or "no"
        return f"`{head}` is about {number} objects, so `_{tail}` cannot stand behind it"
    near = nearest_name(head, _about_one(declared)) if tail in variables else None
    return f"did you mean `{near}_{tail}`?" if near else ""


def _atoms(declared: Declared) -> list[str]:
    signals = (one for one, item in declared.items.items() if isinstance(item, Signal))
    return [*signals, *declared.value_of]


def _about_one(declared: Declared) -> list[str]:
    """The atoms about one object."""
    found = ((name, declared.behind_atom(name)) for name in _atoms(declared))
    return [name for name, item in found if item is not None and len(item.parameters) == 1]


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
    ways = any_of([f"`{head}({variable})`" for head, variable in readings])
    return Diagnostic(
        "R0309",
        f"`{use.name.text}` can mean {ways}",
        use.span.place,
        expected="expected a name with one meaning",
        help="write the one you mean with parentheses",
    )


def _call(value: str, item: Enumeration) -> str:
    return f"{value}({', '.join('…' for _ in item.parameters)})" if item.parameters else value
