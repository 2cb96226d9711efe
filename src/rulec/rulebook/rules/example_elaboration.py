"""Resolves a rule's examples to the values of each state."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from rulec.diagnostics import Diagnostic, Fix, Label, Offer, Span, any_of
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import left_out, offering, put, text_before
from rulec.logic import formula as ltl
from rulec.logic.formula import Atom, QuantityTerm
from rulec.logic.free_names import required_inputs
from rulec.logic.printing import term_text
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases, share_of
from rulec.rulebook.elaborate.amounts import literal
from rulec.rulebook.elaborate.elaboration_messages import hour_meant
from rulec.rulebook.elaborate.scope import BoundVariable, Scope
from rulec.rulebook.names.atom_messages import MIXED_DIMENSIONS, NOT_BOOLEAN, NUMBER_OR_FORMULA
from rulec.rulebook.names.declaration_messages import twice
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.rulebook_model import Example, ExampleState, Variable
from rulec.syntax import tree
from rulec.syntax.messages.literals import NUMBER_TOO_LARGE
from rulec.syntax.tree_printer import print_formula
from rulec.vocabulary import Enumeration
from rulec.vocabulary.dimensions import Unit
from rulec.vocabulary.written_numbers import number_of

CONTRADICTORY_STATE = Code(
    "R0306",
    title="a state of an example contradicts itself or a fact",
    why="In one state a signal is true or false, an enumeration has exactly one value, and every "
    "`fact` of the vocabulary holds. Values that a state does not mention have their default, if "
    "the rule reads them. Successive states are separated by `;`.",
    bad="rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
    "  require always not r(v)\n  accept { b(v) and l(v) }\n}\n",
    good="rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
    "  require always not r(v)\n  accept { b(v); l(v) }\n}\n",
)

INCOMPLETE_STATE = Code(
    "R0307",
    title="a state lacks a value that has no default",
    why="Values that an example does not mention have the default of their declaration. Without a "
    "default, every state must give the value if the formula needs it: a missing value is never "
    "taken to be false.",
    bad="rulebook example\nsignal wet, fog\nhard rule r {\n  require always not (wet and fog)\n"
    "  accept { wet }\n}\n",
    good="rulebook example\nsignal wet, fog\nhard rule r {\n  require always not (wet and fog)\n"
    "  accept { wet and not fog }\n}\n",
)

DENIED_VALUE = Code(
    "R0310",
    title="a state denies a value instead of naming one",
    why="In a state of an example an enumeration has exactly one value, which the state must "
    "name. Excluding one value would leave open which of the others it has.",
    bad="rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
    "  require always not r(v)\n  accept { not r(v) }\n}\n",
    good="rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
    "  require always not r(v)\n  accept { l(v) }\n}\n",
)


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
            scope.report(_contradiction(fact, term, places[key]))
        places.setdefault(key, fact.span)
    missing = [term for key, term in needed.items() if key not in values]
    if missing and not unclear:
        scope.report(_left_open(state, missing[0], scope.symbols))
    return values


def _subject(use: tree.AtomUse, scope: Scope) -> ltl.Atom | ltl.QuantityTerm | None:
    """Subject of a state literal; None after a reported mistake."""
    kind = scope.constants.overlay.kind_of(use.name.text)
    if not kind or scope.behind(use.name.text) is not None:
        return scope.reference(use)
    scope.report(_no_fact(use, kind, scope.constants.overlay.declared_at[use.name.text]))
    return None


def _value(
    fact: tree.StateLiteral, term: ltl.Atom | ltl.QuantityTerm, scope: Scope
) -> bool | str | float | None:
    """Value of a state literal; None after a reported mistake."""
    if isinstance(term, ltl.QuantityTerm):
        return _number(fact, term, scope)
    if fact.value is not None:
        scope.report(_not_a_number(fact, term, scope.symbols))
    elif term.value is None:
        return not fact.negated
    elif fact.negated:
        scope.report(_denied(fact, term, scope.symbols))
    else:
        return term.value
    return None


def _number(fact: tree.StateLiteral, quantity: ltl.QuantityTerm, scope: Scope) -> float | None:
    if fact.value is None:
        scope.report(_without_number(fact, quantity, scope.symbols))
        return None
    minus = isinstance(fact.value, tree.Minus)
    node = fact.value.operand if isinstance(fact.value, tree.Minus) else fact.value
    assert isinstance(node, tree.NumberLiteral), "the grammar has no other"
    given, unit = literal(node, scope), scope.symbols.unit_of(quantity.name)
    if given is None or unit is None:
        return None
    if given.dimension not in (None, unit.dimension):
        scope.report(_other_dimension(fact, quantity, given, unit))
        return None
    if given.is_bare and share_of(unit):
        scope.report(_without_unit(fact, quantity, unit))
        return None
    try:
        value = number_of(given.cases[0][1].constant / unit.factor)
    except OverflowError:
        scope.report(_too_large(fact, quantity, unit))
        return None
    return -value if minus else value


def _denied(fact: tree.StateLiteral, atom: Atom, symbols: SymbolTable) -> Diagnostic:
    """``not`` before an enumeration's value."""
    item = symbols.items[atom.name]
    assert isinstance(item, Enumeration), "only enumerations have values"
    atoms = (replace(atom, value=value) for value in item.values if value != atom.value)
    others = [str(other) for other in atoms]
    shown = [f"`{other}`" for other in others]
    return DENIED_VALUE.at(
        fact.span,
        f"a state says which value `{_subject_text(atom)}` has, not which it lacks",
        expected="expected a value",
        help=offering(f"write {any_of(shown)}", *(others if len(others) == 1 else ()))
        if others
        else f"`{atom}` always holds",
        labels=(Label(symbols.spans[atom.name].place, f"`{atom.name}` is declared here"),),
    )


def _contradiction(fact: tree.StateLiteral, term: Atom | QuantityTerm, first: Span) -> Diagnostic:
    if isinstance(term, Atom) and term.value is None:
        message = f"`{term}` cannot be both true and false in one state"
    else:
        message = f"`{_subject_text(term)}` cannot have two values in one state"
    return CONTRADICTORY_STATE.at(
        fact.span,
        message,
        expected="this contradicts what was said before",
        help=offering("keep one of them, or put a `;` between two states", *_kept_apart(fact.span)),
        labels=(Label(first.place, "said before"),),
    )


def _kept_apart(fact: Span) -> Iterator[Offer]:
    """A fact left out of its state, or begun a new state with."""
    joint = re.search(r"\s*\band\s+\Z", text_before(fact))
    if joint is not None:
        begin = fact.start - len(joint[0])
        yield left_out(Span(fact.source, begin, fact.end), f"Leave out `and {fact.text}`")
        apart = Span(fact.source, begin, fact.start)
        yield Offer(f"Put `;` before `{fact.text}`", (Fix(apart.place, "; "),))


def _left_open(
    state: tree.ExampleState, term: Atom | QuantityTerm, symbols: SymbolTable
) -> Diagnostic:
    item = symbols.items[term.name]
    said: list[str] = []
    if isinstance(term, QuantityTerm):
        ways = [f"{term_text(term)} = … {symbols.unit_text(term.name)}"]
    elif isinstance(item, Enumeration):
        ways = said = [str(Atom(term.name, term.arguments, value)) for value in item.values]
    else:
        ways = [f"{term}", f"not {term}"]
        said = ways[::-1]
    declared = symbols.spans[term.name]
    # A vocabulary is not for the author of an example to change.
    is_own = declared.source == state.span.source
    return INCOMPLETE_STATE.at(
        state.span,
        f"this state leaves open `{_subject_text(term)}`, which the formula needs",
        expected=f"expected {any_of([f'`{way}`' for way in ways])}",
        help=offering(
            f"say it in this state{', or give its declaration a default' if is_own else ''}",
            *(
                put(f"Say `{fact}` in this state", f" and {fact}", state.span, state.span.end)
                for fact in said
            ),
        ),
        labels=(Label(declared.place, f"`{term.name}` has no default"),),
    )


def _no_fact(use: tree.AtomUse, kind: str, declared: tree.Name) -> Diagnostic:
    return NOT_BOOLEAN.at(
        use.span,
        f"`{use.name.text}` is {'an' if kind == 'option' else 'a'} {kind} of the rulebook, no fact "
        "about a state",
        expected="expected a signal, a value or a quantity",
        help="name the facts themselves",
        labels=(Label(declared.span.place, f"`{use.name.text}` is declared here"),),
    )


def _without_number(
    fact: tree.StateLiteral, term: QuantityTerm, symbols: SymbolTable
) -> Diagnostic:
    unit = symbols.unit_text(term.name)
    return NUMBER_OR_FORMULA.at(
        fact.span,
        f"`{term_text(term)}` is a number (in {unit}) and cannot be true or false",
        expected="expected its value",
        help=f"write `{term_text(term)} = 5 {unit}`",
        labels=(Label(symbols.spans[term.name].place, f"`{term.name}` is declared here"),),
    )


def _not_a_number(fact: tree.StateLiteral, atom: Atom, symbols: SymbolTable) -> Diagnostic:
    return NUMBER_OR_FORMULA.at(
        fact.span,
        f"`{atom}` is true or false and has no number",
        expected=f"expected `{atom}`",
        help=f"write `{atom}` or, for a signal, `not {atom}`",
        labels=(Label(symbols.spans[atom.name].place, f"`{atom.name}` is declared here"),),
    )


def _other_dimension(
    fact: tree.StateLiteral, term: QuantityTerm, given: NumberByCases, unit: Unit
) -> Diagnostic:
    assert fact.value is not None, "only a value has a unit"
    given_kind = given.dimension.name if given.dimension else "number"
    slip = hour_meant(fact.value) if isinstance(fact.value, tree.NumberLiteral) else ""
    return MIXED_DIMENSIONS.at(
        fact.value.span,
        f"`{term_text(term)}` is a {unit.dimension.name} and `{print_formula(fact.value)}` "
        f"a {given_kind}",
        expected=f"expected a {unit.dimension.name}",
        help=slip or f"write it in {unit.text}",
    )


def _without_unit(fact: tree.StateLiteral, term: QuantityTerm, unit: Unit) -> Diagnostic:
    """The error for a number without a unit, for a quantity in a unit such as `%`."""
    assert fact.value is not None, "only a value may lack its unit"
    written = f"{print_formula(fact.value)} {unit.text}"
    return MIXED_DIMENSIONS.at(
        fact.value.span,
        f"`{term_text(term)}` is in {unit.text} and `{print_formula(fact.value)}` has no unit",
        expected=f"expected a number in {unit.text}",
        help=offering(f"write the unit, such as `{written}`", written),
    )


def _too_large(fact: tree.StateLiteral, term: QuantityTerm, unit: Unit) -> Diagnostic:
    assert fact.value is not None, "only a value can be too large"
    return NUMBER_TOO_LARGE.at(
        fact.value.span,
        f"this number is too large for `{term_text(term)}`, which counts in {unit.text}",
        help=f"write a number below 1e308 {unit.text}",
    )


def _subject_text(term: Atom | QuantityTerm) -> str:
    return (
        term_text(term) if isinstance(term, QuantityTerm) else str(Atom(term.name, term.arguments))
    )
