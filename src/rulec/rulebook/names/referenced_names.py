"""The names used in a tree."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.syntax import tree


def names_used(item: tree.Item) -> Iterator[str]:
    """Every name in an item's formulas, with repetitions, without its examples."""
    for formula in formulas_of(item):
        yield from names_in(formula)


def free_names(item: tree.Item) -> frozenset[str]:
    """The names in an item's formulas that its own variables and parameters do not stand for."""
    own = frozenset[str]()
    if isinstance(item, tree.RuleItem):
        own = frozenset(variable.name.text for variable in item.variables)
    elif isinstance(item, tree.DefineItem):
        own = frozenset(parameter.name.text for parameter in item.parameters)
    return frozenset(name for formula in formulas_of(item) for name in _free(formula, own))


def formulas_of(item: tree.Item) -> Iterator[tree.Formula]:
    """An item's formulas as written, without its examples."""
    match item:
        case tree.RuleItem(require=require, when=when, unless=unless):
            for formula in (require, when, *(exception.formula for exception in unless)):
                if formula is not None:
                    yield formula
        case tree.DefineItem(body=formula) | tree.FactItem(formula) | tree.ParamItem(value=formula):
            yield formula
        case tree.SetItem(value=value) if not isinstance(value, bool):
            yield value


def atoms_in(node: tree.SyntaxNode) -> Iterator[tree.AtomUse]:
    """Every use of a name in a part of a file, those in bounds included."""
    return (part for part in tree.nodes_in(node) if isinstance(part, tree.AtomUse))


def names_in(node: tree.SyntaxNode) -> Iterator[str]:
    """Every name in a part of a file, those in bounds included, with repetitions."""
    for use in atoms_in(node):
        yield from (use.name.text, *(argument.text for argument in use.arguments))


def _free(node: tree.SyntaxNode, own: frozenset[str]) -> Iterator[str]:
    if isinstance(node, tree.AtomUse):
        yield from (name for name in names_in(node) if name not in own)
    elif isinstance(node, tree.Aggregate):
        own |= {node.variable.name.text}
    for _, part in tree.parts_of(node):
        yield from _free(part, own)


def parts_of(formula: tree.Formula) -> tuple[tree.Formula, ...]:
    """The operands of a formula's outermost operator, from left to right."""
    return tuple([part for _, part in tree.parts_of(formula) if isinstance(part, tree.Formula)])


def chain_of(operator: str, formula: tree.Formula) -> Iterator[tree.Formula]:
    """The operands of a chain of one operator from left to right, however it is grouped."""
    if isinstance(formula, tree.Infix) and formula.operator == operator:
        yield from chain_of(operator, formula.left)
        yield from chain_of(operator, formula.right)
    else:
        yield formula
