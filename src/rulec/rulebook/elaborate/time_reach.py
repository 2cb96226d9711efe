"""Formulas in which temporal operators apply to less than it seems.

They are well-formed and read as written, but hardly anyone means them, so they deserve a warning.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rulec.diagnostics import Diagnostic
from rulec.rulebook.elaborate import time_reach_messages as say
from rulec.rulebook.names.referenced_names import atoms_in, chain_of, parts_of
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.rulebook_overlay import Overlay
from rulec.syntax import tree
from rulec.syntax.keywords import BINDS_NARROWLY, JOINS_ALIKE, LOOKS_BACK, OF_ONE_STATE, PRECEDENCE


def requirement_warnings(
    node: tree.Formula, symbols: SymbolTable, overlay: Overlay
) -> Iterator[Diagnostic]:
    """Warnings for the parts of a requirement that apply to the first state only."""
    parts = [*chain_of("and", node)]
    for part in parts:
        asked_once = _asked_once(part, overlay.definitions)
        if asked_once is not None and _changes(asked_once, symbols, overlay):
            yield say.first_state_only(part, asked_once, alone=len(parts) == 1)


def _asked_once(
    node: tree.Formula, definitions: Mapping[str, tree.DefineItem]
) -> tree.Formula | None:
    """The part of a requirement that is evaluated in the first state and in no other.

    It is all of a formula without an operator that looks ahead, the condition of a duty, or what a
    forbidden sequence begins with.
    """
    if not _looks_ahead(node, definitions):
        return node
    match node:
        case tree.Infix("implies", left, right) if not _looks_ahead(left, definitions):
            # `congested implies always p` is about whole traces, by how they begin.
            return None if all(map(_is_of_all_states, chain_of("and", right))) else left
        case tree.Prefix("not", tree.Infix("then", left, _)):
            return left
    return None


def _is_of_all_states(node: tree.Formula) -> bool:
    match node:
        case tree.Prefix("always" | "never", bound=None):
            return True
    return False


def operator_warnings(node: tree.Formula, overlay: Overlay) -> Iterator[Diagnostic]:
    """Warnings for temporal operators in a formula that apply to less than it may seem."""
    narrow = [*_narrow(node, (), overlay.definitions)]
    yield from narrow
    for warning in until_warnings(node):
        if not any(covers(diagnostic, warning) for diagnostic in narrow):
            yield warning


def covers(first: Diagnostic, warning: Diagnostic) -> bool:
    """Whether the place, or the fix, of one warning covers the place of another one.

    What stands behind an operator with two possible reaches is left until its author has chosen.
    """
    place = first.place if first.fix is None else first.fix.place
    if place is None or warning.place is None or place.file != warning.place.file:
        return False
    if say.leaves_reach_open(first):
        return place.start <= warning.place.start
    return place.start <= warning.place.start < (place.end_line or 0, place.end_column or 0)


def _narrow(
    node: tree.Formula,
    behind: Sequence[tree.Infix],
    definitions: Mapping[str, tree.DefineItem],
) -> Iterator[Diagnostic]:
    """Walk through a formula.

    ``behind`` are the operations that continue after it, nearest first.
    """
    if isinstance(node, tree.Grouping) and node.grouped:
        behind = ()
    match node:
        case tree.Infix(_, left, right):
            yield from _narrow(left, (node, *behind), definitions)
            yield from _narrow(right, behind, definitions)
        case tree.Prefix(operator, operand):
            grouped = isinstance(operand, tree.Grouping) and operand.grouped
            if operator in BINDS_NARROWLY and behind and not grouped:
                nearest = behind[0]
                joins = nearest.operator in JOINS_ALIKE
                alike = joins and _looks_ahead(nearest.right, definitions)
                # `then` has a warning of its own, and `eventually p implies q` reads as it is.
                if not alike and nearest.operator != "then" and (joins or operator != "eventually"):
                    until = _reach(node, behind, definitions)
                    yield say.narrow_operator(node, nearest.operator, until)
                    behind = ()
            yield from _narrow(operand, behind, definitions)
        case _:
            for part in parts_of(node):
                yield from _narrow(part, (), definitions)


def _reach(
    prefix: tree.Prefix,
    behind: Sequence[tree.Infix],
    definitions: Mapping[str, tree.DefineItem],
) -> int:
    """The end of what the operator was probably meant to apply to, as a character position."""
    end = prefix.span.end
    for operation in behind:
        alike = operation.operator in JOINS_ALIKE
        if alike and _looks_ahead(operation.right, definitions):
            break
        end = operation.span.end
    return end


def _looks_ahead(node: tree.Formula, definitions: Mapping[str, tree.DefineItem]) -> bool:
    """Whether a formula has an operator about later states, also in definitions that it uses."""
    pending, seen = [node], set[str]()
    while pending:
        part = pending.pop()
        if (
            isinstance(part, tree.Prefix | tree.Infix)
            and part.operator not in OF_ONE_STATE | LOOKS_BACK
        ):
            return True
        if isinstance(part, tree.AtomUse):
            names = {part.name.text, *(argument.text for argument in part.arguments)} - seen
            seen |= names
            pending += (definitions[name].body for name in names if name in definitions)
        pending += parts_of(part)
    return False


def _changes(node: tree.Formula, symbols: SymbolTable, overlay: Overlay) -> bool:
    """Whether a formula reads something that may change within a trace."""
    pending, seen = [node], set[str]()
    while pending:
        for use in atoms_in(pending.pop()):
            name = use.name.text
            if name in overlay.definitions and name not in seen:
                seen.add(name)
                pending.append(overlay.definitions[name].body)
            item = symbols.items.get(name) or symbols.value_of.get(name)
            if item is not None and not item.constant:
                return True
    return False


def until_warnings(
    node: tree.Formula, before: tree.Infix | None = None, behind: tree.Infix | None = None
) -> Iterator[Diagnostic]:
    """Warnings for operators like `until` in a formula that can be read in two ways.

    ``a until b and c`` means ``(a until b) and c``, but half of its readers take it for ``a until
    (b and c)``, so `and` and `or` beside such an operator deserve parentheses.

    ``before`` is the nearest operation whose right operand begins with the formula, ``behind`` the
    nearest one whose left operand ends with it.
    """
    if isinstance(node, tree.Grouping) and node.grouped:
        before = behind = None
    if not isinstance(node, tree.Infix):
        for part in parts_of(node):
            yield from until_warnings(part)
        return
    if _is_until(node):
        before = before if _misleads(before, node.left, right=False) else None
        behind = behind if _misleads(behind, _last(node), right=True) else None
        if before is not None or behind is not None:
            yield say.two_readings(node, before, behind)
        before = behind = None
    yield from until_warnings(node.left, before, node)
    yield from until_warnings(node.right, node, behind)


def _is_until(node: tree.Infix) -> bool:
    return PRECEDENCE[node.operator] > max(PRECEDENCE[join] for join in JOINS_ALIKE)


def _last(node: tree.Infix) -> tree.Formula:
    """The last operand of a chain: `c` of `a until b until c`."""
    last = node.right
    while isinstance(last, tree.Infix) and _is_until(last) and not last.grouped:
        last = last.right
    return last


def _misleads(join: tree.Infix | None, nearest: tree.Formula, *, right: bool) -> bool:
    """Whether a join may seem to join its neighbour only to the ``nearest`` operand."""
    if join is None or join.operator not in JOINS_ALIKE:
        return False
    grouped = isinstance(nearest, tree.Grouping) and nearest.grouped
    # `a until (b or c) and d` needs its parentheses in either reading; `(b and c)` shows where the
    # operand ends.
    if grouped and not (isinstance(nearest, tree.Infix) and nearest.operator != join.operator):
        return False
    # What both sides have is read alike: `a until b and c until d`.
    beside = join.right if right else join.left
    while isinstance(beside, tree.Infix) and beside.operator in JOINS_ALIKE and not beside.grouped:
        beside = beside.left if right else beside.right
    return not (isinstance(beside, tree.Infix) and _is_until(beside) and not beside.grouped)
