"""Inlay hints: meanings that are implicit in the text."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types as lsp

from rulec.language_server.names.hover_texts import value_text
from rulec.language_server.names.name_occurrences import DocumentNames
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.rulebook.names.referenced_names import formulas_of, parts_of
from rulec.syntax import tree
from rulec.syntax.keywords import BINDS_NARROWLY, JOINS_ALIKE


def inlay_hints(
    names: DocumentNames, positions: TextPositions, where: lsp.Range
) -> list[lsp.InlayHint]:
    """The hints in a range of a document."""
    first, last = positions.offset(where.start), positions.offset(where.end)
    hints: list[lsp.InlayHint] = []
    for item in names.file.items:
        if item.span.start <= last and first <= item.span.end:
            for offset, label, tip in _in_item(item, names):
                if first <= offset <= last:
                    position = positions.position(offset)
                    hints.append(lsp.InlayHint(position, label, tooltip=tip))
    return hints


Hint = tuple[int, str, str]
"""A character offset, the text shown there, and its explanation."""


def _in_item(item: tree.Item, names: DocumentNames) -> Iterator[Hint]:
    if isinstance(item, tree.RuleItem):
        yield from _inherited(item, names)
    for formula in formulas_of(item):
        yield from _in_formula(formula, names)


def _inherited(rule: tree.RuleItem, names: DocumentNames) -> Iterator[Hint]:
    """The strength and the level that a rule inherits from another book."""
    entry = names.chain.names.constants.overlay.rules.get(rule.name.text)
    if not rule.override or entry is None:
        return
    if rule.strength is None and entry.item.strength is not None:
        deed = "confirm" if rule.confirm else "override"
        yield (
            rule.span.start + len(deed),
            f" {entry.item.strength}",
            "inherited, since this rule does not set it",
        )
    if rule.level is None and entry.item.level is not None and not rule.variables:
        yield rule.name.span.end, f" in {entry.item.level.text}", "inherited level"


def _in_formula(formula: tree.Formula, names: DocumentNames) -> Iterator[Hint]:
    if isinstance(formula, tree.Infix) and formula.operator not in JOINS_ALIKE | {"then"}:
        yield from _narrow(formula.left, formula.operator)
    elif isinstance(formula, tree.Infix):
        yield from _narrow(formula.left, formula.operator, unless=formula.right)
    if isinstance(formula, tree.Compare | tree.Arithmetic):
        yield from _units(formula, names)
    if isinstance(formula, tree.AtomUse):
        yield from _value(formula, names)
    for part in parts_of(formula):
        yield from _in_formula(part, names)


def _narrow(left: tree.Formula, follows: str, unless: tree.Formula | None = None) -> Iterator[Hint]:
    """Parentheses that show how little a temporal operator applies to: ``(never a) and b``."""
    while isinstance(left, tree.Infix) and not left.grouped:
        left = left.right
    alike = isinstance(unless, tree.Prefix) and unless.operator in BINDS_NARROWLY
    if isinstance(left, tree.Prefix) and left.operator in BINDS_NARROWLY and not left.grouped:
        if alike:
            return
        why = f"`{left.operator}` binds tighter than `{follows}`: it applies to this part only"
        yield left.span.start, "(", why
        yield left.span.end, ")", why


def _units(formula: tree.Compare | tree.Arithmetic, names: DocumentNames) -> Iterator[Hint]:
    """The unit of a bare 0, and a number converted to the unit of the quantity beside it."""
    sides = (formula.left, formula.right)
    for number, other in (sides, sides[::-1]):
        if not isinstance(number, tree.NumberLiteral) or not isinstance(other, tree.AtomUse):
            continue
        unit = names.chain.names.symbols.unit_meant(other.name.text)
        if not unit or unit == number.unit:
            continue
        end = number.span.end
        if not number.unit:
            if number.text.strip("0.") == "":
                yield end, f" {unit}", f"the unit of `{other.name.text}`"
            continue
        symbols = names.chain.names.symbols
        theirs, own = symbols.unit(unit), symbols.unit(number.unit)
        if theirs is not None and own is not None and theirs.dimension == own.dimension:
            amount = float(number.text) * float(own.factor / theirs.factor)
            yield end, f" = {amount:.6g} {unit}", f"in the unit of `{other.name.text}`"


def _value(use: tree.AtomUse, names: DocumentNames) -> Iterator[Hint]:
    """The value of a parameter on the day whose law applies."""
    constants = names.chain.names.constants
    number = constants.numbers.get(use.name.text)
    if number is None or use.name.text not in constants.overlay.parameters:
        return
    text = value_text(number)
    if len(text) <= 40:
        yield use.name.span.end, f" = {text}", f"on {constants.at}"
