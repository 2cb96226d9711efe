"""Messages about states of examples."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from rulec.diagnostics import Diagnostic, Fix, Label, Offer, Span, any_of
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import left_out, offering, put, text_before
from rulec.logic.formula import Atom, QuantityTerm
from rulec.logic.printing import term_text
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate.elaboration_messages import hour_meant
from rulec.rulebook.names.atom_messages import MIXED_DIMENSIONS, NOT_BOOLEAN, NUMBER_OR_FORMULA
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.syntax import tree
from rulec.syntax.messages.literal_values import NUMBER_TOO_LARGE
from rulec.syntax.tree_printer import print_formula
from rulec.vocabulary import Enumeration
from rulec.vocabulary.dimensions import Unit

CONTRADICTORY_STATE = Code("R0306")

INCOMPLETE_STATE = Code("R0307")

DENIED_VALUE = Code("R0310")


def denied(fact: tree.StateLiteral, atom: Atom, symbols: SymbolTable) -> Diagnostic:
    """``not`` before an enumeration's value."""
    item = symbols.items[atom.name]
    assert isinstance(item, Enumeration), "only enumerations have values"
    atoms = (replace(atom, value=value) for value in item.values if value != atom.value)
    others = [str(other) for other in atoms]
    shown = [f"`{other}`" for other in others]
    return DENIED_VALUE.at(
        fact.span,
        f"a state says which value `{_subject(atom)}` has, not which it lacks",
        expected="expected a value",
        help=offering(f"write {any_of(shown)}", *(others if len(others) == 1 else ()))
        if others
        else f"`{atom}` always holds",
        labels=(Label(symbols.spans[atom.name].place, f"`{atom.name}` is declared here"),),
    )


def contradiction(fact: tree.StateLiteral, term: Atom | QuantityTerm, first: Span) -> Diagnostic:
    if isinstance(term, Atom) and term.value is None:
        message = f"`{term}` cannot be both true and false in one state"
    else:
        message = f"`{_subject(term)}` cannot have two values in one state"
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


def left_open(
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
        f"this state leaves open `{_subject(term)}`, which the formula needs",
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


def no_fact(use: tree.AtomUse, kind: str, declared: tree.Name) -> Diagnostic:
    return NOT_BOOLEAN.at(
        use.span,
        f"`{use.name.text}` is {'an' if kind == 'option' else 'a'} {kind} of the rulebook, no fact "
        "about a state",
        expected="expected a signal, a value or a quantity",
        help="name the facts themselves",
        labels=(Label(declared.span.place, f"`{use.name.text}` is declared here"),),
    )


def without_number(fact: tree.StateLiteral, term: QuantityTerm, symbols: SymbolTable) -> Diagnostic:
    unit = symbols.unit_text(term.name)
    return NUMBER_OR_FORMULA.at(
        fact.span,
        f"`{term_text(term)}` is a number (in {unit}) and cannot be true or false",
        expected="expected its value",
        help=f"write `{term_text(term)} = 5 {unit}`",
        labels=(Label(symbols.spans[term.name].place, f"`{term.name}` is declared here"),),
    )


def not_a_number(fact: tree.StateLiteral, atom: Atom, symbols: SymbolTable) -> Diagnostic:
    return NUMBER_OR_FORMULA.at(
        fact.span,
        f"`{atom}` is true or false and has no number",
        expected=f"expected `{atom}`",
        help=f"write `{atom}` or, for a signal, `not {atom}`",
        labels=(Label(symbols.spans[atom.name].place, f"`{atom.name}` is declared here"),),
    )


def other_dimension(
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


def without_unit(fact: tree.StateLiteral, term: QuantityTerm, unit: Unit) -> Diagnostic:
    """The error for a number without a unit, for a quantity in a unit such as `%`."""
    assert fact.value is not None, "only a value may lack its unit"
    written = f"{print_formula(fact.value)} {unit.text}"
    return MIXED_DIMENSIONS.at(
        fact.value.span,
        f"`{term_text(term)}` is in {unit.text} and `{print_formula(fact.value)}` has no unit",
        expected=f"expected a number in {unit.text}",
        help=offering(f"write the unit, such as `{written}`", written),
    )


def too_large(fact: tree.StateLiteral, term: QuantityTerm, unit: Unit) -> Diagnostic:
    assert fact.value is not None, "only a value can be too large"
    return NUMBER_TOO_LARGE.at(
        fact.value.span,
        f"this number is too large for `{term_text(term)}`, which counts in {unit.text}",
        help=f"write a number below 1e308 {unit.text}",
    )


def _subject(term: Atom | QuantityTerm) -> str:
    return (
        term_text(term) if isinstance(term, QuantityTerm) else str(Atom(term.name, term.arguments))
    )
