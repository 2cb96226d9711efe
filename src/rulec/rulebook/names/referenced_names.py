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


def names_in_examples(rule: tree.RuleItem) -> Iterator[str]:
    """Every name in the states of a rule's examples, with repetitions."""
    for state in (state for example in rule.examples for state in example.states):
        for literal in state.literals:
            yield from names_in(literal.atom)


def atoms_in(formula: tree.Formula) -> Iterator[tree.AtomUse]:
    """Every use of a name in a formula, those in bounds included."""
    if isinstance(formula, tree.AtomUse):
        yield formula
    for part in (*parts_of(formula), *_ends_of_bound(formula)):
        yield from atoms_in(part)


def names_in(formula: tree.Formula) -> Iterator[str]:
    """Every name in a formula, those in bounds included, with repetitions."""
    for use in atoms_in(formula):
        yield from (use.name.text, *(argument.text for argument in use.arguments))


def _free(formula: tree.Formula, own: frozenset[str]) -> Iterator[str]:
    if isinstance(formula, tree.AtomUse):
        yield from (name for name in names_in(formula) if name not in own)
    elif isinstance(formula, tree.Aggregate):
        own |= {formula.variable.name.text}
    for part in (*parts_of(formula), *_ends_of_bound(formula)):
        yield from _free(part, own)


def _ends_of_bound(formula: tree.Formula) -> Iterator[tree.Amount]:
    if isinstance(formula, tree.Prefix | tree.Infix) and formula.bound is not None:
        yield from filter(None, (formula.bound.low, formula.bound.high))


def parts_of(formula: tree.Formula) -> tuple[tree.Formula, ...]:
    """The operands of a formula's outermost operator, from left to right."""
    match formula:
        case tree.Prefix(operand=operand) | tree.Minus(operand) | tree.Aggregate(body=operand):
            return (operand,)
        case (
            tree.Infix(left=left, right=right)
            | tree.Compare(left=left, right=right)
            | tree.Arithmetic(left=left, right=right)
        ):
            return left, right
        case tree.Conditional(value, condition, otherwise):
            return value, condition, otherwise
        case tree.AtomUse() | tree.TruthLiteral() | tree.NumberLiteral():
            return ()
