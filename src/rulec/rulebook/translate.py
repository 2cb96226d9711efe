"""From a rule as written to a rule as meant."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.diagnostics import Diagnostic, Label, Span, any_of
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.rulebook.declaration_messages import twice, unknown_type
from rulec.rulebook.declared import Declared
from rulec.rulebook.model import Example, ExampleState, Rule, Variable
from rulec.rulebook.scope import BoundVariable, Scope
from rulec.syntax import tree
from rulec.vocabulary import Enumeration, Quantity


def translate_rule(item: tree.RuleItem, declared: Declared) -> tuple[Rule | None, list[Diagnostic]]:
    """The rule as meant (None if it has a mistake), its mistakes and warnings."""
    mistakes: list[Diagnostic] = []
    scope = Scope(declared, _variables(item, declared, mistakes), mistakes)
    formula = None if item.require is None else _formula(item.require, scope)
    if item.complete and formula is not None:
        mistakes += _unused(item, scope)
    examples = [_example(example, formula, scope) for example in item.examples]
    if formula is None or any(one.severity == "error" for one in mistakes):
        return None, mistakes
    rule = Rule(
        item.name.text,
        item.strength,
        tuple(Variable(one.name.text, one.type.text) for one in item.variables if one.type),
        formula,
        item.cite.value if item.cite else "",
        item.says.value if item.says else "",
        tuple(examples),
        item.span,
    )
    return rule, mistakes


def _variables(
    item: tree.RuleItem, declared: Declared, mistakes: list[Diagnostic]
) -> dict[str, BoundVariable]:
    found: dict[str, BoundVariable] = {}
    for one in item.variables:
        name, type_ = one.name, one.type
        assert type_ is not None, "the grammar asks for a variable's type"
        known = type_.text in declared.types
        if not known and not declared.may_know_type(type_.text):
            mistakes.append(unknown_type(type_, list(declared.types)))
        if name.text in found:
            mistakes.append(twice("variable", name, found[name.text].span))
        else:
            found[name.text] = BoundVariable(type_.text if known else None, one.span)
    return found


def _formula(node: tree.Formula, scope: Scope) -> Formula | None:
    match node:
        case tree.AtomUse():
            return scope.atom(node)
        case tree.Truth(value):
            return Constant(value)
        case tree.Prefix(operator, inside):
            operand = _formula(inside, scope)
            return None if operand is None else Unary(UnaryOperator(operator), operand)
        case tree.Infix(operator, first, second):
            left, right = _formula(first, scope), _formula(second, scope)
            if operator == "then" and isinstance(first, tree.Prefix):
                scope.mistakes += _endless_phase(first)
            if left is None or right is None:
                return None
            return Binary(BinaryOperator(operator), left, right)


def _endless_phase(phase: tree.Prefix) -> Iterator[Diagnostic]:
    """Who writes ``never p then q`` means ``never (p then q)``: ``never p`` has no end."""
    if phase.operator in ("always", "never", "eventually"):
        yield Diagnostic(
            "R0311",
            f"`{phase.operator}` speaks of this phase alone, not of the whole sequence",
            phase.span.place,
            expected=f"`{phase.operator}` binds tighter than `then`",
            help=f"write `{phase.operator} (… then …)` to speak of the sequence",
            severity="warning",
        )


def _unused(item: tree.RuleItem, scope: Scope) -> Iterator[Diagnostic]:
    for one in item.variables:
        if one.name.text not in scope.used:
            yield Diagnostic(
                "R0207",
                f"the formula of `{item.name.text}` says nothing about `{one.name.text}`",
                one.span.place,
                expected="not used in `require`",
                help="leave the variable out, or speak of it",
                severity="warning",
            )


def _example(example: tree.Example, formula: Formula | None, scope: Scope) -> Example:
    needed = {} if formula is None else _without_default(formula, scope.declared)
    states = tuple(_state(state, needed, scope) for state in example.states)
    spans = tuple(state.span for state in example.states)
    return Example(example.accepts, states, example.label, example.span, spans)


def _without_default(
    formula: Formula, declared: Declared
) -> dict[tuple[str, tuple[str, ...]], Atom]:
    """What a state has to say for the formula to be judged, with an atom of each for the help."""
    return {
        (atom.name, atom.arguments): atom
        for atom in atoms_of(formula)
        if declared.items[atom.name].default is None
    }


def _state(
    state: tree.ExampleState,
    needed: dict[tuple[str, tuple[str, ...]], Atom],
    scope: Scope,
) -> ExampleState:
    said: dict[tuple[str, tuple[str, ...]], bool | str] = {}
    places: dict[tuple[str, tuple[str, ...]], Span] = {}
    unclear = False
    for literal in state.literals:
        atom = scope.atom(literal.atom)
        if atom is None:
            unclear = True
            continue
        if atom.value is not None and literal.negated:
            scope.mistakes.append(_denied(literal, atom, scope.declared))
            unclear = True
            continue
        key = (atom.name, atom.arguments)
        value = not literal.negated if atom.value is None else atom.value
        if said.setdefault(key, value) != value:
            scope.mistakes.append(_contradiction(literal, atom, places[key]))
        places.setdefault(key, literal.span)
    missing = [atom for key, atom in needed.items() if key not in said]
    if missing and not unclear:
        scope.mistakes.append(_left_open(state, missing[0], scope.declared))
    return said


def _denied(literal: tree.StateLiteral, atom: Atom, declared: Declared) -> Diagnostic:
    item = declared.items[atom.name]
    assert isinstance(item, Enumeration), "only enumerations have values"
    others = [
        f"`{Atom(atom.name, atom.arguments, value)}`"
        for value in item.values
        if value != atom.value
    ]
    return Diagnostic(
        "R0310",
        f"a state says which value `{_subject(atom)}` has, not which it lacks",
        literal.span.place,
        expected="expected a value",
        help=f"write {any_of(others)}" if others else f"`{atom}` always holds",
        labels=(Label(declared.spans[atom.name].place, f"`{atom.name}` is declared here"),),
    )


def _contradiction(literal: tree.StateLiteral, atom: Atom, first: Span) -> Diagnostic:
    if atom.value is None:
        message = f"`{atom}` cannot be both true and false in one state"
    else:
        message = f"`{_subject(atom)}` cannot have two values in one state"
    return Diagnostic(
        "R0306",
        message,
        literal.span.place,
        expected="this contradicts what was said before",
        help="keep one of them, or put a `;` between two states",
        labels=(Label(first.place, "said before"),),
    )


def _left_open(state: tree.ExampleState, atom: Atom, declared: Declared) -> Diagnostic:
    item = declared.items[atom.name]
    assert not isinstance(item, Quantity), "quantities are no atoms"
    if isinstance(item, Enumeration):
        ways = [f"`{Atom(atom.name, atom.arguments, value)}`" for value in item.values]
    else:
        ways = [f"`{atom}`", f"`not {atom}`"]
    return Diagnostic(
        "R0307",
        f"this state leaves open `{_subject(atom)}`, which the formula needs",
        state.span.place,
        expected=f"expected {any_of(ways)}",
        help="say it in this state, or give its declaration a default",
        labels=(Label(declared.spans[atom.name].place, f"`{atom.name}` has no default"),),
    )


def _subject(atom: Atom) -> str:
    return str(Atom(atom.name, atom.arguments))
