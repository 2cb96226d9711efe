"""Axioms: what a vocabulary states about every state, whatever the rules say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.diagnostic import at
from rulec.logic import formula as ltl
from rulec.logic.formula import parts_in
from rulec.logic.free_names import names_in, rename_variables, required_inputs
from rulec.logic.kleene import Unknown, holds
from rulec.logic.printing import formula_text
from rulec.rulebook.elaborate.elaboration import truth
from rulec.rulebook.elaborate.elaboration_messages import short
from rulec.rulebook.elaborate.scope import SIDES, BoundVariable, Scope
from rulec.rulebook.names.atom_messages import two_types
from rulec.rulebook.names.referenced_names import parts_of
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.rulebook_model import Axiom, ExampleState, Rule, Variable
from rulec.rulebook.rules.axiom_instances import bound_to
from rulec.rulebook.rules.example_messages import CONTRADICTORY_STATE
from rulec.rulebook.rules.implied_signals import with_what_follows
from rulec.syntax import tree
from rulec.vocabulary import Vocabulary


def axioms_of(
    files: Sequence[tree.File], symbols: SymbolTable, constants: ConstantsAndMacros
) -> tuple[tuple[Axiom, ...], list[Diagnostic]]:
    """The axioms of files, and the mistakes in their facts."""
    axioms: list[Axiom] = []
    mistakes: list[Diagnostic] = []
    for item in (item for file in files for item in file.items):
        if isinstance(item, tree.FactItem):
            wrong: list[Diagnostic] = []
            axiom = _axiom(item, symbols, constants, wrong)
            mistakes += wrong
            if axiom is not None and not wrong:
                axioms.append(axiom)
    return tuple(axioms), mistakes


def _axiom(
    item: tree.FactItem,
    symbols: SymbolTable,
    constants: ConstantsAndMacros,
    mistakes: list[Diagnostic],
) -> Axiom | None:
    """The axiom of a fact. Its variables have the types that its atoms require."""
    formula = item.formula
    if isinstance(formula, tree.Prefix) and formula.operator == "always" and not formula.bound:
        # Facts hold always; one may say so.
        formula = formula.operand
    variables: dict[str, BoundVariable] = {}
    for name, wanted in _required_types(formula, symbols, constants):
        known = variables.get(name.text)
        if known is None or known.type is None or symbols.fits(wanted, known.type):
            variables[name.text] = BoundVariable(wanted, name.span, name.text)
        elif not symbols.fits(known.type, wanted):
            mistakes.append(two_types(name, wanted, known.type, known.span))
    scope = Scope(
        symbols, constants, variables, mistakes, in_moment=True, taken=frozenset(variables)
    )
    holding = None
    with scope.within_limits("fact", tree.Name(short(formula), span=item.span)):
        holding = truth(formula, scope)
    typed = tuple(
        Variable(name, variable.type) for name, variable in variables.items() if variable.type
    )
    return None if holding is None else Axiom(typed, holding, item.span)


def _required_types(
    formula: tree.Formula,
    symbols: SymbolTable,
    constants: ConstantsAndMacros,
    counted: frozenset[str] = frozenset(),
) -> Iterator[tuple[tree.Name, str]]:
    """Every object in a formula, with the type required of it.

    ``counted`` are the variables of surrounding counts, which are not objects of the fact.
    """
    if isinstance(formula, tree.AtomUse):
        types = _parameter_types(formula.name.text, symbols, constants)
        if len(types) == len(formula.arguments):
            for name, type_ in zip(formula.arguments, types, strict=True):
                if type_ is not None and name.text not in counted:
                    yield name, type_
    elif isinstance(formula, tree.Aggregate):
        counted |= {formula.variable.name.text}
    for part in parts_of(formula):
        yield from _required_types(part, symbols, constants, counted)


def _parameter_types(
    name: str, symbols: SymbolTable, constants: ConstantsAndMacros
) -> Sequence[str | None]:
    """The parameter types of a name; None where any argument will do."""
    definition = constants.overlay.definitions.get(name)
    if definition is not None:
        written = (parameter.type for parameter in definition.parameters)
        return [type_.text if type_ and type_.text in symbols.types else None for type_ in written]
    item = symbols.items.get(name) or symbols.value_of.get(
        SIDES[name]["right"] if name in SIDES else name
    )
    return () if item is None else item.parameters


@dataclass(frozen=True, slots=True)
class ExampleValues:
    """The values of an example's state, with defaults for other values that are read.

    Values in neither are unknown. ``read`` are the declarations and objects that are read.
    """

    given: ExampleState
    read: frozenset[tuple[str, tuple[str, ...]]]
    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def value(self, name: str, items: tuple[str, ...]) -> bool | float | str | Unknown:
        """The value of a signal or an enumeration."""
        known = self.given.get((name, items))
        if known is None and (name, items) in self.read:
            known = self.vocabulary.declarations[name].default
        return Unknown(name, items) if known is None else known

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The value of a quantity."""
        value = self.value(name, items)
        # A number's decimals are what is written.
        return value if isinstance(value, Unknown) else Fraction(repr(value))


def contradicted(
    rule: Rule, axioms: Sequence[Axiom], vocabulary: Vocabulary
) -> Iterator[Diagnostic]:
    """Mistakes (R0306), one per state of examples that contradicts an axiom."""
    read_of: dict[tuple[tuple[str, str], ...], frozenset[tuple[str, tuple[str, ...]]]] = {}
    for example in rule.examples if axioms else ():
        objects = {item.name: item.type for item in (*rule.variables, *example.objects)}
        there = tuple(objects.items())
        if there not in read_of:
            read_of[there] = frozenset(
                (term.name, term.arguments)
                for term in required_inputs(rule.formula, objects, vocabulary.is_subtype)
            )
        read = read_of[there]
        for number, state in enumerate(example.states):
            full = with_what_follows(state, vocabulary)
            violated = _violated(ExampleValues(full, read, objects, vocabulary), axioms)
            if violated is not None:
                axiom, text = violated
                spans = example.state_spans
                yield CONTRADICTORY_STATE.at(
                    spans[number].place if spans else at(example.span),
                    f"this state cannot be: `{text}` holds in every state",
                    help="correct the state; or the fact, if there can be such states",
                    labels=(Label(axiom.span.place, "what holds in every state"),)
                    if axiom.span
                    else (),
                )


def _violated(state: ExampleValues, axioms: Sequence[Axiom]) -> tuple[Axiom, str] | None:
    known = {name for name, _ in (*state.given, *state.read)}
    for axiom in axioms:
        names_decide = _deciding_names(axiom.formula)
        if names_decide is not None and known.isdisjoint(names_decide):
            continue
        for binding in bound_to(axiom.variables, state.objects, state.vocabulary):
            if holds(axiom.formula, binding, state) is False:
                return axiom, formula_text(rename_variables(axiom.formula, binding))
    return None


# Each is asked about for every state of every example.
@lru_cache(maxsize=1024)
def _deciding_names(formula: ltl.Formula) -> frozenset[str] | None:
    """The names that must be known for an axiom to be violated; None if none must be.

    A count may be zero, and objects may coincide, whatever is known.
    """
    for part in parts_in(formula):
        match part:
            case ltl.Same() | ltl.Constant():
                return None
            case ltl.Comparison(terms) if any(isinstance(term, ltl.Count) for _, term in terms):
                return None
    return frozenset(names_in(formula))
