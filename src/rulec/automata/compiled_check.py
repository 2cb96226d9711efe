"""A compiled rulebook's file into data, with everything checked that running relies on."""

from __future__ import annotations

from collections.abc import Container
from itertools import chain

from rulec.automata import compiled_schema as schema
from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.automata.letters import reads_of
from rulec.automata.machine import Machine, Read, trap
from rulec.logic.data import from_data
from rulec.logic.formula import Atom, atoms_of
from rulec.logic.printing import in_words
from rulec.rulebook.model import SourceFile, Strength, Variable
from rulec.vocabulary import Declaration, Enumeration, ObjectType, Quantity, Signal, Vocabulary


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
    return CompiledRulebook(
        read.name,
        vocabulary,
        tuple(_rule(rule, vocabulary) for rule in read.rules),
        read.title,
        read.law,
        read.as_of,
        tuple(SourceFile(source.name, source.sha256) for source in read.sources),
        read.rulec,
        read.spot,
    )


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


def _rule(rule: schema.Rule, vocabulary: Vocabulary) -> CompiledRule:
    variables = tuple(Variable(name, type_name) for name, type_name in rule.variables)
    types = {variable.name: variable.type for variable in variables}
    _require(len(types) == len(variables), f"rule `{rule.name}` names a variable twice")
    for type_name in types.values():
        _require(type_name in vocabulary.types, f"rule `{rule.name}` is about an unknown type")
    formula = from_data(rule.tree)
    for atom in atoms_of(formula):
        fits = _fits(atom, vocabulary.declarations.get(atom.name), types)
        _require(fits, f"rule `{rule.name}` speaks of `{atom}`, which its vocabulary lacks")
    _require(in_words(formula) == rule.formula, f"rule `{rule.name}` has two different formulas")
    machine = _machine(rule.machine, rule.name)
    same = machine.reads == reads_of(formula, vocabulary)
    _require(same, f"the table of rule `{rule.name}` does not read what its formula does")
    strength: Strength = rule.strength
    return CompiledRule(
        rule.name,
        strength,
        variables,
        rule.cite,
        rule.says,
        formula,
        machine,
        rule.hoa,
    )


def _fits(atom: Atom, declaration: Declaration | None, variables: Container[str]) -> bool:
    match declaration:
        case Enumeration(values=values):
            known = atom.value in values
        case Signal():
            known = atom.value is None
        case _:
            return False
    about = len(declaration.parameters) == len(atom.arguments)
    return known and about and all(argument in variables for argument in atom.arguments)


def _machine(read: schema.Machine, rule: str) -> Machine:
    reads = tuple(Read(r.name, tuple(r.variables), tuple(r.values), r.others) for r in read.reads)
    n_letters = 1
    for item in reads:
        n_letters *= item.size
    n_states = len(read.following)
    n_classes = len(read.following[0]) if read.following else 0
    fits: list[bool] = [
        n_states > 0,
        len(read.letters) == n_letters,
        all(0 <= letter < n_classes for letter in read.letters),
        all(len(row) == n_classes for row in read.following),
        all(len(row) == n_classes for row in read.accepting),
        len(read.accepting) == n_states,
        all(0 <= state < n_states for state in chain.from_iterable(read.following)),
    ]
    _require(all(fits), f"the table of rule `{rule}` has a row or number that does not fit")
    traps = [trap(read.following, read.accepting, verdict=verdict) for verdict in (False, True)]
    _require(traps == [read.dead, read.safe], f"rule `{rule}` names a wrong dead or safe state")
    return Machine(
        reads,
        tuple(read.letters),
        tuple(tuple(row) for row in read.following),
        tuple(tuple(row) for row in read.accepting),
        read.dead,
        read.safe,
    )


def _require(condition: bool, problem: str) -> None:
    if not condition:
        raise ValueError(problem)
