"""Resolves a rule's examples to the values of each state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rulec.diagnostics import Span
from rulec.logic import formula as ltl
from rulec.logic.free_names import required_inputs
from rulec.rulebook.arithmetic.linear_arithmetic import share_of
from rulec.rulebook.elaborate.amounts import literal
from rulec.rulebook.elaborate.scope import BoundVariable, Scope
from rulec.rulebook.names.declaration_messages import twice
from rulec.rulebook.rulebook_model import Example, ExampleState, Variable
from rulec.rulebook.rules import example_messages as say
from rulec.syntax import tree
from rulec.vocabulary.written_numbers import number_of

Key = tuple[str, tuple[str, ...]]
"""A declaration, with the objects that it is about."""


def example_of(example: tree.ExampleItem, formula: ltl.Formula | None, scope: Scope) -> Example:
    """The example; mistakes in it are reported."""
    variables = dict(scope.variables)
    for parameter in example.objects:
        name = parameter.name
        assert parameter.type is not None, "the grammar asks for a type"
        known_type = scope.symbols.known_type(parameter.type, scope.report)
        if name.text in variables:
            scope.report(twice("object", name, variables[name.text].span))
        variables[name.text] = BoundVariable(known_type, parameter.span, name.text)
    inside = replace(scope, variables=variables, used=set(), owner="example")
    types = {name: variable.type for name, variable in variables.items() if variable.type}
    needed: dict[Key, ltl.Atom | ltl.QuantityTerm] = {}
    if formula is not None:
        for term in required_inputs(formula, types, scope.symbols.fits):
            is_meant = term.name in scope.constants.overlay.meanings
            if scope.symbols.items[term.name].default is None and not is_meant:
                needed.setdefault((term.name, term.arguments), term)
    return Example(
        accepts=example.accepts,
        states=tuple(_state(state, needed, inside) for state in example.states),
        label=example.label,
        objects=tuple(
            Variable(parameter.name.text, parameter.type.text)
            for parameter in example.objects
            if parameter.type
        ),
        span=example.span,
        state_spans=tuple(state.span for state in example.states),
    )


def _state(
    state: tree.ExampleState, needed: Mapping[Key, ltl.Atom | ltl.QuantityTerm], scope: Scope
) -> ExampleState:
    values: dict[Key, bool | str | float] = {}
    places: dict[Key, Span] = {}
    unclear = False
    for fact in state.literals:
        term = _subject(fact.atom, scope)
        value = None if term is None else _value(fact, term, scope)
        if term is None or value is None:
            unclear = True
            continue
        key = (term.name, term.arguments)
        if values.setdefault(key, value) != value:
            scope.report(say.contradiction(fact, term, places[key]))
        places.setdefault(key, fact.span)
    missing = [term for key, term in needed.items() if key not in values]
    if missing and not unclear:
        scope.report(say.left_open(state, missing[0], scope.symbols))
    return values


def _subject(use: tree.AtomUse, scope: Scope) -> ltl.Atom | ltl.QuantityTerm | None:
    """Subject of a state literal; None after a reported mistake."""
    kind = scope.constants.overlay.kind_of(use.name.text)
    if not kind or scope.behind(use.name.text) is not None:
        return scope.reference(use)
    scope.report(say.no_fact(use, kind, scope.constants.overlay.declared_at[use.name.text]))
    return None


def _value(
    fact: tree.StateLiteral, term: ltl.Atom | ltl.QuantityTerm, scope: Scope
) -> bool | str | float | None:
    """Value of a state literal; None after a reported mistake."""
    if isinstance(term, ltl.QuantityTerm):
        return _number(fact, term, scope)
    if fact.value is not None:
        scope.report(say.not_a_number(fact, term, scope.symbols))
    elif term.value is None:
        return not fact.negated
    elif fact.negated:
        scope.report(say.denied(fact, term, scope.symbols))
    else:
        return term.value
    return None


def _number(fact: tree.StateLiteral, quantity: ltl.QuantityTerm, scope: Scope) -> float | None:
    if fact.value is None:
        scope.report(say.without_number(fact, quantity, scope.symbols))
        return None
    minus = isinstance(fact.value, tree.Minus)
    node = fact.value.operand if isinstance(fact.value, tree.Minus) else fact.value
    assert isinstance(node, tree.NumberLiteral), "the grammar has no other"
    given, unit = literal(node, scope), scope.symbols.unit_of(quantity.name)
    if given is None or unit is None:
        return None
    if given.dimension not in (None, unit.dimension):
        scope.report(say.other_dimension(fact, quantity, given, unit))
        return None
    if given.is_bare and share_of(unit):
        scope.report(say.without_unit(fact, quantity, unit))
        return None
    try:
        value = number_of(given.cases[0][1].constant / unit.factor)
    except OverflowError:
        scope.report(say.too_large(fact, quantity, unit))
        return None
    return -value if minus else value
