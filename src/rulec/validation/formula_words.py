"""A formula's tree in words, as shown in reports and reviews."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from rulec.validation.unprovable import exact

_LOOSEST_FIRST = ("iff", "implies", "then", "xor", "or", "and")


def parted(tree: Sequence[Any]) -> tuple[Any, list[Any], Any]:
    """The operator of a tree that is not an atom, its operands, and its bound or None."""
    operator, *operands = tree
    is_bounded = operands and isinstance(operands[-1], dict) and "unit" in operands[-1]
    return operator, operands, operands.pop() if is_bounded else None


def atoms_in(tree: Any) -> Iterator[dict[str, Any]]:
    """The atoms and comparisons of a tree, except those within counts."""
    if isinstance(tree, dict):
        yield tree
    elif isinstance(tree, list):
        for operand in parted(tree)[1]:
            yield from atoms_in(operand)


def comparisons_in(tree: Any) -> Iterator[dict[str, Any]]:
    """The comparisons of a tree, except those within counts."""
    return (atom for atom in atoms_in(tree) if "terms" in atom)


def formula_words(tree: Any) -> str:
    """The words of a formula, with as few parentheses as rulec writes."""
    if isinstance(tree, bool):
        return "true" if tree else "false"
    if isinstance(tree, dict):
        return _atom_words(tree)
    operator, rest, bound = parted(tree)
    word = operator if bound is None else f"{operator}[{_bound_words(operator, bound)}]"
    if len(rest) == 1:
        inner = formula_words(rest[0])
        return f"{word} ({inner})" if _is_binary(rest[0]) else f"{word} {inner}"
    left = _side(operator, rest[0], chain=operator in ("and", "or"))
    return f"{left} {word} {_side(operator, rest[1], chain=operator == 'then')}"


def _is_binary(tree: Any) -> bool:
    """Whether the outermost operator has two operands."""
    if not isinstance(tree, list):
        return False
    return len(parted(tree)[1]) == 2


def _binds(operator: str) -> int:
    known = operator in _LOOSEST_FIRST
    return _LOOSEST_FIRST.index(operator) if known else len(_LOOSEST_FIRST)


def _side(operator: str, tree: Any, *, chain: bool) -> str:
    words = formula_words(tree)
    if not _is_binary(tree) or _binds(tree[0]) > _binds(operator):
        return words
    return words if chain and tree[0] == operator else f"({words})"


_ARGUMENT = re.compile(r"([(,]\s*)(\w+)(?=\s*[,)])")


def _atom_words(atom: Mapping[str, Any]) -> str:
    if "terms" in atom:
        return str(atom["text"])
    if "same" in atom:
        return " = ".join(atom["same"])
    name = str(atom["value"] or atom["name"])
    if "number" in atom:
        # A comparison that is calculated names its objects by their places
        places = {f"x{place}": own for place, own in enumerate(atom["variables"], 1)}
        return _ARGUMENT.sub(lambda found: f"{found[1]}{places.get(found[2], found[2])}", name)
    return f"{name}({', '.join(atom['variables'])})" if atom["variables"] else str(name)


def _bound_words(operator: str, bound: Mapping[str, Any]) -> str:
    low, high = exact(bound["from"]), bound["to"]
    if operator in ("next", "weak next", "previously", "weak previously"):
        return _time(low, bound["unit"])
    if high is None:
        return f">= {_time(low, bound['unit'])}"
    to = _time(exact(high), bound["unit"])
    return f"{_time(low, bound['unit'])} .. {to}" if low else f"<= {to}"


def _time(amount: Fraction, unit: str) -> str:
    return f"{_decimal(amount)} {'step' if unit == 'steps' and amount == 1 else unit}"


def _decimal(number: Fraction) -> str:
    rest, places = number.denominator, 0
    while rest % 2 == 0 or rest % 5 == 0:
        rest //= 10 if rest % 10 == 0 else 2 if rest % 2 == 0 else 5
        places += 1
    if rest != 1:
        return str(number)
    digits = str(int(number * 10**places)).zfill(places + 1)
    return f"{digits[:-places]}.{digits[-places:]}" if places else digits


def term_words(term: Mapping[str, Any]) -> str:
    """The words of a quantity or a count, by which terms are sorted."""
    if "count" in term:
        return f"count {term['count']}: {term['type']} ({formula_words(term['body'])})"
    arguments = ", ".join(term["variables"])
    return f"{term['quantity']}({arguments})" if arguments else str(term["quantity"])
