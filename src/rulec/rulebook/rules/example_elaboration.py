"""A rule's examples as meant: the values that each state gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rulec.diagnostics import Span
from rulec.logic import formula as ltl
from rulec.logic.required_inputs import required_inputs
from rulec.rulebook.elaborate.number_literals import literal
from rulec.rulebook.elaborate.scope import BoundVariable, Scope
from rulec.rulebook.names.declaration_messages import twice, unknown_type
from rulec.rulebook.rulebook_model import Example, ExampleState, Variable
from rulec.rulebook.rules import example_messages as say
from rulec.syntax import tree

Key = tuple[str, tuple[str, ...]]
"""A declaration, and the objects that it is asked about."""


def example_of(example: tree.ExampleItem, formula: ltl.Formula | None, scope: Scope) -> Example:
    """The example; what is wrong with it is reported."""
    variables = dict(scope.variables)
    for object_ in example.objects:
        name, kind = object_.name, object_.type
        assert kind is not None, "the grammar asks for a type"
        known = kind.text in scope.symbols.types
        if not known and not scope.symbols.may_know_type(kind.text):
            scope.report(unknown_type(kind, list(scope.symbols.types)))
        if name.text in variables:
            scope.report(twice("object", name, variables[name.text].span))
        variables[name.text] = BoundVariable(kind.text if known else None, object_.span, name.text)
    inside = replace(scope, variables=variables, used=set())
    kinds = {
        name: variable.type for name, variable in variables.items() if variable.type is not None
    }
    needed: dict[Key, ltl.Atom | ltl.QuantityTerm] = {}
    if formula is not None:
        for what in required_inputs(formula, kinds, scope.symbols.fits):
            if scope.symbols.items[what.name].default is None:
                needed.setdefault((what.name, what.arguments), what)
    return Example(
        accepts=example.accepts,
        states=tuple(_state(state, needed, inside) for state in example.states),
        label=example.label,
        objects=tuple(
            Variable(object_.name.text, object_.type.text)
            for object_ in example.objects
            if object_.type
        ),
        span=example.span,
        state_spans=tuple(state.span for state in example.states),
    )


def _state(
    state: tree.ExampleState, needed: Mapping[Key, ltl.Atom | ltl.QuantityTerm], scope: Scope
) -> ExampleState:
    said: dict[Key, bool | str | float] = {}
    places: dict[Key, Span] = {}
    unclear = False
    for fact in state.literals:
        result = _named(fact.atom, scope)
        value = None if result is None else _value(fact, result, scope)
        if result is None or value is None:
            unclear = True
            continue
        key = (result.name, result.arguments)
        if said.setdefault(key, value) != value:
            scope.report(say.contradiction(fact, result, places[key]))
        places.setdefault(key, fact.span)
    missing = [what for key, what in needed.items() if key not in said]
    if missing and not unclear:
        scope.report(say.left_open(state, missing[0], scope.symbols))
    return said


def _named(use: tree.AtomUse, scope: Scope) -> ltl.Atom | ltl.QuantityTerm | None:
    """Subject of a state literal; None after a reported mistake."""
    kind = scope.constants.overlay.kind_of(use.name.text)
    if kind and scope.behind(use.name.text) is None:
        scope.report(say.no_fact(use, kind, scope.constants.overlay.declared_at[use.name.text]))
        return None
    return scope.reference(use)


def _value(
    fact: tree.StateLiteral, atom: ltl.Atom | ltl.QuantityTerm, scope: Scope
) -> bool | str | float | None:
    """Value of a state literal; None after a reported mistake."""
    if isinstance(atom, ltl.QuantityTerm):
        return _number(fact, atom, scope)
    if fact.value is not None:
        scope.report(say.not_a_number(fact, atom, scope.symbols))
        return None
    if atom.value is not None and fact.negated:
        scope.report(say.denied(fact, atom, scope.symbols))
        return None
    return not fact.negated if atom.value is None else atom.value


def _number(fact: tree.StateLiteral, quantity: ltl.QuantityTerm, scope: Scope) -> float | None:
    """A quantity's value, in the unit of its declaration."""
    unit = scope.symbols.unit_of(quantity.name)
    if fact.value is None:
        scope.report(say.without_number(fact, quantity, scope.symbols))
        return None
    minus = isinstance(fact.value, tree.Minus)
    node = fact.value.operand if isinstance(fact.value, tree.Minus) else fact.value
    assert isinstance(node, tree.NumberLiteral), "the grammar has no other"
    given = literal(node, scope)
    if given is None or unit is None:
        return None
    if given.dimension not in (None, unit.dimension):
        scope.report(say.other_dimension(fact, quantity, given, unit))
        return None
    try:
        value = float(given.cases[0][1].constant / unit.factor)
    except OverflowError:
        scope.report(say.too_large(fact, quantity, unit))
        return None
    return -value if minus else value
