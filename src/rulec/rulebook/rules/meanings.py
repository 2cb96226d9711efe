"""What declared words mean: their definitions, and comparisons that are calculated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from rulec.diagnostics import Diagnostic
from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN, PAST, operations_of
from rulec.logic.free_names import names_of, terms_of
from rulec.rulebook.elaborate import constant_messages as say
from rulec.rulebook.elaborate.elaboration import number, truth
from rulec.rulebook.elaborate.macro_expansion import parameter_value
from rulec.rulebook.elaborate.scope import Scope, bound_variables
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.syntax import tree
from rulec.vocabulary import Signal, Vocabulary
from rulec.vocabulary.vocabulary_model import Meaning


def meanings_of(
    symbols: SymbolTable, constants: ConstantsAndMacros
) -> tuple[Mapping[str, Meaning], list[Diagnostic]]:
    """The meanings of declared words, each after those that it reads, and mistakes in them."""
    mistakes: list[Diagnostic] = []
    found: dict[str, Meaning] = {}
    for item in constants.overlay.meanings.values():
        wrong: list[Diagnostic] = []
        meaning = _meaning(item, symbols, constants, wrong)
        mistakes += wrong
        if meaning is not None and not any(each.severity == "error" for each in wrong):
            found[item.name.text] = meaning
    ordered: dict[str, Meaning] = {}
    for name in found:
        circle = _place(name, found, ordered, ())
        if circle:
            item = constants.overlay.meanings[name]
            mistakes.append(say.meanings_circle(item, circle))
            return MappingProxyType({}), mistakes
    return MappingProxyType(ordered), mistakes


def _place(
    name: str, found: Mapping[str, Meaning], ordered: dict[str, Meaning], above: tuple[str, ...]
) -> tuple[str, ...]:
    """Put a word behind those that its meaning reads; the words of a circle, if there is one."""
    if name in above:
        return (*above[above.index(name) :], name)
    for read in sorted(found[name].reads) if name not in ordered else ():
        circle = _place(read, found, ordered, (*above, name)) if read in found else ()
        if circle:
            return circle
    ordered.setdefault(name, found[name])
    return ()


def _meaning(
    item: tree.DefineItem,
    symbols: SymbolTable,
    constants: ConstantsAndMacros,
    mistakes: list[Diagnostic],
) -> Meaning | None:
    declared = symbols.items.get(item.name.text)
    if not isinstance(declared, Signal):
        mistakes.append(say.no_signal(item, symbols.spans.get(item.name.text)))
        return None
    typed = tuple(
        parameter
        if parameter.type is not None
        else replace(parameter, type=tree.Name(kind, span=parameter.span))
        for parameter, kind in zip(item.parameters, declared.parameters, strict=False)
    )
    variables = bound_variables(typed, symbols, mistakes.append)
    kinds = tuple([variable.type for variable in variables.values()])
    if len(item.parameters) != len(declared.parameters) or (
        None not in kinds and kinds != declared.parameters
    ):
        mistakes.append(say.other_objects(item, declared, symbols.spans[declared.name]))
        return None
    scope = Scope(
        symbols, constants, variables, mistakes, taken=frozenset(variables), owner="definition"
    )
    formula = None
    with scope.within_limits("definition", item.name):
        formula = truth(item.body, scope)
    if formula is None or None in kinds:
        return None
    mistakes += scope.unused(item.parameters, item)
    later = (x.operator for x in operations_of(formula) if x.operator not in BOOLEAN | PAST)
    ahead = next(later, None)
    if ahead is not None:
        mistakes.append(say.looks_ahead(item, ahead.value))
    return Meaning(tuple(variables), formula, names_of(formula))


def parameters_of(
    vocabularies: Sequence[tree.File], symbols: SymbolTable, constants: ConstantsAndMacros
) -> Mapping[str, Fraction]:
    """The values (in base units) of the parameters that vocabularies declare."""
    found: dict[str, Fraction] = {}
    for item in (item for file in vocabularies for item in file.items):
        if isinstance(item, tree.ParamItem):
            use = tree.AtomUse(item.name, span=item.name.span)
            value = parameter_value(use, Scope(symbols, constants, {}, []), number)
            if value is not None and value.is_constant:
                found[item.name.text] = value.cases[0][1].constant
    return MappingProxyType(found)


def with_calculated(vocabulary: Vocabulary, formulas: Iterable[ltl.Formula]) -> Vocabulary:
    """The vocabulary with a signal for each comparison in formulas that is calculated."""
    found = {own.name: own for formula in formulas for own in _calculated(formula)}
    if not found:
        return vocabulary
    signals = {name: Signal(name, _types(own, vocabulary)) for name, own in found.items()}
    own_meanings = {name: _as_meaning(own) for name, own in found.items()}
    return replace(
        vocabulary,
        declarations=MappingProxyType({**vocabulary.declarations, **signals}),
        meanings=MappingProxyType({**vocabulary.meanings, **own_meanings}),
    )


def _calculated(formula: ltl.Formula) -> Iterator[ltl.Calculated]:
    for proposition in ltl.atoms_of(formula):
        terms: Iterable[ltl.Term] = ()
        if isinstance(proposition, ltl.Comparison):
            terms = (term for _, term in proposition.terms)
        elif isinstance(proposition, ltl.Calculated):
            yield proposition
            terms = terms_of(proposition.number)
        for term in terms:
            if isinstance(term, ltl.Count):
                yield from _calculated(term.body)


def _as_meaning(own: ltl.Calculated) -> Meaning:
    variables = tuple([f"x{place}" for place in range(1, len(own.arguments) + 1)])
    return Meaning(variables, replace(own, arguments=variables), names_of(own))


def _types(own: ltl.Calculated, vocabulary: Vocabulary) -> tuple[str, ...]:
    """The narrowest type that the quantities ask for each object."""
    found: dict[str, str] = {}
    for name, type_ in _typed(terms_of(own.number), vocabulary, frozenset()):
        if name not in found or vocabulary.is_subtype(type_, found[name]):
            found[name] = type_
    return tuple([found[f"x{place}"] for place in range(1, len(own.arguments) + 1)])


def _typed(
    terms: Iterable[ltl.Atom | ltl.Term], vocabulary: Vocabulary, counted: frozenset[str]
) -> Iterator[tuple[str, str]]:
    for term in terms:
        if isinstance(term, ltl.Count):
            inside = ltl.atoms_of(term.body)
            own = counted | {term.variable}
            for part in inside:
                if isinstance(part, ltl.Comparison):
                    yield from _typed((x for _, x in part.terms), vocabulary, own)
                elif not isinstance(part, ltl.Calculated):
                    yield from _typed((part,), vocabulary, own)
        else:
            kinds = vocabulary.declarations[term.name].parameters
            pairs = zip(term.arguments, kinds, strict=True)
            yield from (pair for pair in pairs if pair[0] not in counted)
