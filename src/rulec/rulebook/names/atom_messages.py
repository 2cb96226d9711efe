"""Names that are no atom, or are used as if they took other arguments: what was meant?"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rulec.diagnostics import Diagnostic, Label, any_of, did_you_mean, named, nearest_name
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.syntax import tree
from rulec.syntax.keywords import INFIX_LETTERS, PREFIX_LETTERS
from rulec.vocabulary import Enumeration, Quantity, Signal

if TYPE_CHECKING:
    from rulec.rulebook.names.scope import Scope

_ATOM = "expected a signal or a value"
_GLUED = re.compile(rf"([{PREFIX_LETTERS}]+)(\w+)")
_GLUED_BINARY = re.compile(rf"(\w+?)([{INFIX_LETTERS}])(\w+)")


def explain(use: tree.AtomUse, scope: Scope) -> Diagnostic:
    """Why a name is no atom: it is something else, or it is not known."""
    name, declared = use.name.text, scope.declared
    item = declared.items.get(name)
    if isinstance(item, Enumeration):
        values = any_of([f"`{_call(value, item)}`" for value in item.values])
        return _not_an_atom(use, declared, "has several values", f"write {values}")
    if name in declared.types:
        return Diagnostic(
            "R0303",
            f"`{name}` is a type of objects and cannot be true or false",
            use.name.span.place,
            expected=_ATOM,
            help=f"speak of an object: give the rule a variable, such as `(x: {name})`",
            labels=(Label(declared.type_spans[name].place, f"`{name}` is declared here"),),
        )
    return _unknown(use, scope)


def _not_an_atom(use: tree.AtomUse, declared: SymbolTable, why: str, help_: str) -> Diagnostic:
    name = use.name.text
    return Diagnostic(
        "R0303",
        f"`{name}` {why} and cannot be true or false",
        use.name.span.place,
        expected=_ATOM,
        help=help_,
        labels=(Label(declared.spans[name].place, f"`{name}` is declared here"),),
    )


def _unknown(use: tree.AtomUse, scope: Scope) -> Diagnostic:
    name, declared = use.name.text, scope.declared
    atoms = declared.atoms()
    quantities = [one for one, item in declared.items.items() if isinstance(item, Quantity)]
    known = [*atoms, *quantities, *scope.provisions.names(), *scope.relations]
    glued = _glued(name, set(atoms))
    if name == "if":
        way_out = "write `p implies q` for `if p then q`"
    elif glued:
        way_out = f"write `{glued}`"
    else:
        variables = list(scope.variables)
        way_out = (
            ("" if use.arguments else _short_form(name, declared, variables))
            or did_you_mean(name, known)
            or f"declare it, such as `signal {_as_used(use, scope)}`, "
            "or `use` a vocabulary that has it"
        )
    return Diagnostic(
        "R0202",
        f"nothing is called `{name}`",
        use.name.span.place,
        expected=_ATOM,
        help=way_out,
    )


def _as_used(use: tree.AtomUse, scope: Scope) -> str:
    """How a signal would be declared that fits its use: `braking(v: vehicle)` for `braking(v)`."""
    variables = [scope.variables.get(one.text) for one in use.arguments]
    if not variables or not all(one is not None and one.type for one in variables):
        return use.name.text
    parameters = (
        f"{argument.text}: {variable.type}"
        for argument, variable in zip(use.arguments, variables, strict=True)
        if variable is not None
    )
    return f"{use.name.text}({', '.join(parameters)})"


def no_traffic(use: tree.AtomUse, name: str) -> Diagnostic:
    """``near_side_of`` in a rulebook that does not say on which side traffic drives."""
    return Diagnostic(
        "R0211",
        f"`{name}` depends on the side on which traffic drives, and the rulebook does not say it",
        use.name.span.place,
        expected="left or right?",
        help="write `traffic right` or `traffic left` in the rulebook's header",
    )


def no_sides(use: tree.AtomUse, name: str, side: str) -> Diagnostic:
    """``near_side_of`` with a vocabulary that has no sides."""
    return Diagnostic(
        "R0211",
        f"`{name}` means `{side}` here, which the vocabulary does not have",
        use.name.span.place,
        expected=_ATOM,
        help="`use` a vocabulary that has `left_of` and `right_of`, such as `road`",
    )


def _short_form(name: str, declared: SymbolTable, variables: Sequence[str]) -> str:
    """What may be wrong with ``b_v`` where it stands for ``b(v)``."""
    head, _, tail = name.rpartition("_")
    item = declared.behind_atom(head)
    if item is not None and len(item.parameters) == 1:
        known = f"its variables are {named(variables)}" if variables else "it has none"
        return f"`{name}` means `{head}({tail})`, but the rule has no variable `{tail}`; {known}"
    if item is not None and tail in variables:
        number = len(item.parameters) or "no"
        return f"`{head}` is about {number} objects, so `_{tail}` cannot stand behind it"
    near = nearest_name(head, declared.about_one()) if tail in variables else None
    return f"did you mean `{near}_{tail}`?" if near else ""


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
    use: tree.AtomUse, name: str, item: Signal | Enumeration | Quantity, scope: Scope
) -> Diagnostic:
    """A known atom with too few or too many objects."""
    needed, given = len(item.parameters), len(use.arguments)
    objects = {0: "no object", 1: "one object"}.get(needed, f"{needed} objects")
    has = {0: "none is", 1: "one is"}.get(given, f"{given} are")
    arguments = (list(scope.variables) + ["…"] * needed)[:needed]
    written = f"{name}({', '.join(arguments)})" if needed else name
    return Diagnostic(
        "R0301",
        f"`{name}` is about {objects}, and {has} given",
        use.span.place,
        expected=f"expected {objects}",
        help=f"write `{written}`",
        labels=(Label(scope.declared.spans[name].place, f"`{name}` is declared here"),),
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
