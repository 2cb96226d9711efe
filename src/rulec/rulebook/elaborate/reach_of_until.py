"""Places where `and` or `or` is beside `until` or a similar operator, without parentheses.

``a until b and c`` means ``(a until b) and c``, but half of its readers take it for ``a until (b
and c)``, so it deserves parentheses.
"""

from __future__ import annotations

from collections.abc import Iterator

from rulec.diagnostics import Diagnostic
from rulec.rulebook.elaborate.time_reach_messages import two_readings
from rulec.rulebook.names.referenced_names import parts_of
from rulec.syntax import tree
from rulec.syntax.keywords import JOINS_ALIKE, PRECEDENCE


def until_warnings(
    node: tree.Formula, before: tree.Infix | None = None, behind: tree.Infix | None = None
) -> Iterator[Diagnostic]:
    """Warnings for operators like `until` in a formula that can be read in two ways.

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
            yield two_readings(node, before, behind)
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
