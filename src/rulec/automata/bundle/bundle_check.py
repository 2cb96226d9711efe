"""A compiled rulebook's file into data, with everything checked that running relies on."""

from __future__ import annotations

from collections.abc import Container, Sequence
from fractions import Fraction
from itertools import chain

from rulec.automata.alphabet import reads_of
from rulec.automata.bundle import bundle_schema as schema
from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.bundle.formula_check import problem_in
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read, Threshold, trap
from rulec.diagnostics import SourceLocation
from rulec.logic.bounds import BOOLEAN, in_steps, operations_of, speaks_of_seconds
from rulec.logic.codec import from_data, number_from_data, terms_from_data
from rulec.logic.formula import Formula
from rulec.logic.printing import in_words
from rulec.rulebook.model import Certainty, Semantics, SourceFile, Strength, Variable
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary


def checked(read: schema.File) -> CompiledRulebook:
    """The file's content, if it is sound. ValueError with what is wrong otherwise."""
    vocabulary = Vocabulary(
        read.vocabulary.name,
        {name: ObjectType(name, parent) for name, parent in read.vocabulary.types.items()},
        {item.name: _declaration(item) for item in read.vocabulary.declarations},
    )
    _check_vocabulary(vocabulary)
    names = [rule.name for rule in read.rules]
    for name in (read.name, *names):
        # They become names of files.
        plain = name and not name.startswith(".") and not set(name) & set("/\\\0")
        _require(bool(plain), f"`{name}` is not a name")
    _require(len(set(names)) == len(names), "two rules have the same name")
    semantics: Semantics = read.semantics
    return CompiledRulebook(
        read.name,
        vocabulary,
        tuple(_rule(rule, vocabulary, read.levels) for rule in read.rules),
        read.title,
        read.law,
        read.as_of,
        tuple(SourceFile(source.name, source.sha256) for source in read.sources),
        read.rulec,
        read.spot,
        semantics,
        tuple(read.levels),
        _priorities(read),
        tuple(read.extends),
        read.at,
        tuple(_fact(fact, vocabulary) for fact in read.facts),
        read.traffic,
    )


def _priorities(read: schema.File) -> frozenset[tuple[str, str]]:
    """They are a pre-order of the levels."""
    _require(len(set(read.levels)) == len(read.levels), "two levels have the same name")
    pairs = frozenset(read.priorities)
    _require(len(pairs) == len(read.priorities), "a priority is said twice")
    named = {level for pair in pairs for level in pair}
    _require(named <= set(read.levels), "a priority is about an unknown level")
    below: dict[str, set[str]] = {level: {level} for level in read.levels}
    for higher, lower in pairs:
        below[higher].add(lower)
    closed = all(below[lower] <= below[higher] for higher, lower in pairs)
    _require(closed, "the priorities leave out what follows from them")
    return pairs


def _declaration(
    item: schema.Enumeration | schema.Signal | schema.Quantity,
) -> Enumeration | Signal | Quantity:
    parameters = tuple(item.parameters)
    match item:
        case schema.Enumeration():
            return Enumeration(item.name, parameters, tuple(item.values), item.default)
        case schema.Signal():
            return Signal(item.name, parameters, item.default)
        case schema.Quantity():
            return Quantity(item.name, parameters, item.unit, item.default)


def _check_vocabulary(vocabulary: Vocabulary) -> None:
    types = vocabulary.types
    for item in types.values():
        seen, parent = {item.name}, item.parent
        while parent is not None:
            _require(parent in types and parent not in seen, f"type `{item.name}` has no root")
            seen.add(parent)
            parent = types[parent].parent
    for declaration in vocabulary.declarations.values():
        for parameter in declaration.parameters:
            _require(parameter in types, f"`{declaration.name}` is about an unknown type")
        if isinstance(declaration, Enumeration) and declaration.default is not None:
            known = declaration.default in declaration.values
            _require(known, f"the default of `{declaration.name}` is not one of its values")


def _fact(fact: schema.Fact, vocabulary: Vocabulary) -> CompiledAxiom:
    variables = _variables(fact.variables, vocabulary, "a fact")
    formula = from_data(fact.tree)
    problem = problem_in(formula, vocabulary, {one.name for one in variables})
    _require(problem is None, f"a fact {problem}")
    timeless = all(one.operator in BOOLEAN for one in operations_of(formula))
    _require(timeless, "a fact speaks of more than one state")
    _require(in_words(formula) == fact.formula, "a fact has two different formulas")
    return CompiledAxiom(
        variables, formula, SourceLocation(fact.file, fact.line) if fact.file else None
    )


def _variables(
    read: Sequence[tuple[str, str]], vocabulary: Vocabulary, of: str
) -> tuple[Variable, ...]:
    variables = tuple(Variable(name, type_name) for name, type_name in read)
    names = {variable.name for variable in variables}
    _require(len(names) == len(variables), f"{of} names a variable twice")
    for variable in variables:
        _require(variable.type in vocabulary.types, f"{of} is about an unknown type")
    return variables


def _rule(rule: schema.Rule, vocabulary: Vocabulary, levels: Container[str]) -> CompiledRule:
    variables = _variables(rule.variables, vocabulary, f"rule `{rule.name}`")
    formula = from_data(rule.tree)
    problem = problem_in(formula, vocabulary, {one.name for one in variables})
    _require(problem is None, f"rule `{rule.name}` {problem}")
    _require(in_words(formula) == rule.formula, f"rule `{rule.name}` has two different formulas")
    machine = _machine(rule.machine, rule.name)
    same = machine.reads == reads_of(formula, vocabulary)
    _require(same, f"the table of rule `{rule.name}` does not read what its formula does")
    level = rule.level
    _require(not level or level in levels, f"rule `{rule.name}` has an unknown level")
    weight = number_from_data(rule.weight)
    _require(weight > 0, f"rule `{rule.name}` has no weight")
    strength: Strength = rule.strength
    certainty: Certainty = rule.certainty
    return CompiledRule(
        rule.name,
        strength,
        variables,
        rule.cite,
        rule.says,
        formula,
        machine,
        rule.hoa,
        _step(rule, formula),
        level,
        weight,
        rule.source,
        certainty,
        rule.book,
    )


def _step(rule: schema.Rule, formula: Formula) -> Fraction | None:
    """The step of traces that it is for, without which bounds in seconds are no numbers."""
    needed = speaks_of_seconds(formula)
    _require(needed is (rule.step_s is not None), f"rule `{rule.name}` is for a wrong step")
    if rule.step_s is None:
        return None
    step = number_from_data(rule.step_s)
    in_steps(formula, step)
    return step


def _machine(read: schema.Machine, rule: str) -> MealyMonitor:
    reads = tuple(_read(one) for one in read.reads)
    n_letters = 1
    for item in reads:
        n_letters *= item.size
    n_states = len(read.successors)
    n_classes = len(read.successors[0]) if read.successors else 0
    fits: list[bool] = [
        n_states > 0,
        len(read.letters) == n_letters,
        all(IMPOSSIBLE <= letter < n_classes for letter in read.letters),
        all(len(row) == n_classes for row in read.successors),
        all(len(row) == n_classes for row in read.outputs),
        len(read.outputs) == n_states,
        all(0 <= state < n_states for state in chain.from_iterable(read.successors)),
    ]
    _require(all(fits), f"the table of rule `{rule}` has a row or number that does not fit")
    traps = [trap(read.successors, read.outputs, verdict=verdict) for verdict in (False, True)]
    _require(
        traps == [read.rejecting_sink, read.accepting_sink],
        f"rule `{rule}` names a wrong dead or safe state",
    )
    return MealyMonitor(
        reads,
        tuple(read.letters),
        tuple(tuple(row) for row in read.successors),
        tuple(tuple(row) for row in read.outputs),
        read.rejecting_sink,
        read.accepting_sink,
    )


def _read(read: schema.Read | schema.NumberRead) -> Read | NumberRead:
    match read:
        case schema.Read():
            return Read(read.name, tuple(read.variables), tuple(read.values), read.others)
        case schema.NumberRead():
            thresholds = (
                Threshold(number_from_data(one.limit), one.inclusive) for one in read.thresholds
            )
            return NumberRead(terms_from_data(read.terms), tuple(thresholds))


def _require(condition: bool, problem: str) -> None:
    if not condition:
        raise ValueError(problem)
