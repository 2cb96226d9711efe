"""The compiled rulebook as a file: JSON, version 1, described in docs/compiled.md."""

from __future__ import annotations

import json
from collections.abc import Collection
from itertools import chain
from pathlib import Path
from typing import Literal

import msgspec

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.automata.machine import Machine, Read, trap
from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.files import make_folder, opened, written_whole
from rulec.rulebook.model import SourceFile, Strength, Variable
from rulec.vocabulary import Declaration, Enumeration, ObjectType, Quantity, Signal, Vocabulary

FORMAT = "rulec compiled rulebook"
VERSION = 1


class _Source(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    sha256: str


class _Enumeration(msgspec.Struct, tag="enumeration", tag_field="kind", forbid_unknown_fields=True):
    name: str
    parameters: list[str]
    values: list[str]
    default: str | None


class _Signal(msgspec.Struct, tag="signal", tag_field="kind", forbid_unknown_fields=True):
    name: str
    parameters: list[str]
    default: bool | None


class _Quantity(msgspec.Struct, tag="quantity", tag_field="kind", forbid_unknown_fields=True):
    name: str
    parameters: list[str]
    unit: str
    default: float | None


class _Vocabulary(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    types: dict[str, str | None]
    declarations: list[_Enumeration | _Signal | _Quantity]


class _Read(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    variables: list[str]
    values: list[str]
    others: bool


class _Machine(msgspec.Struct, forbid_unknown_fields=True):
    reads: list[_Read]
    letters: list[int]
    following: list[list[int]]
    accepting: list[list[bool]]
    dead: int | None
    safe: int | None


class _Rule(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    strength: Literal["hard", "soft"]
    variables: list[tuple[str, str]]
    cite: str
    says: str
    formula: str
    machine: _Machine
    hoa: str


class _Header(msgspec.Struct):
    format: Literal["rulec compiled rulebook"]
    version: int


class _File(msgspec.Struct, forbid_unknown_fields=True):
    format: str
    version: int
    rulec: str
    spot: str
    name: str
    title: str
    law: str
    as_of: str
    sources: list[_Source]
    semantics: Literal["stutter"]
    vocabulary: _Vocabulary
    rules: list[_Rule]


def to_json(rulebook: CompiledRulebook) -> str:
    """The file's text."""
    vocabulary = rulebook.vocabulary
    data = {
        "format": FORMAT,
        "version": VERSION,
        "rulec": rulebook.rulec,
        "spot": rulebook.spot,
        "name": rulebook.name,
        "title": rulebook.title,
        "law": rulebook.law,
        "as_of": rulebook.as_of,
        "sources": rulebook.sources,
        "semantics": "stutter",
        "vocabulary": {
            "name": vocabulary.name,
            "types": {item.name: item.parent for item in vocabulary.types.values()},
            "declarations": [
                {"kind": type(item).__name__.lower(), **msgspec.to_builtins(item)}
                for item in vocabulary.declarations.values()
            ],
        },
        "rules": [
            {**msgspec.to_builtins(rule), "variables": [(v.name, v.type) for v in rule.variables]}
            for rule in rulebook.rules
        ],
    }
    return json.dumps(msgspec.to_builtins(data), indent=1, ensure_ascii=False) + "\n"


def from_json(data: bytes, file: str) -> CompiledRulebook:
    """Read a compiled rulebook, checking everything that running relies on.

    Raises:
        RulecError: R0404 if it is not a compiled rulebook, of a version that this rulec does not
            read, or damaged.
    """
    try:
        header = msgspec.json.decode(data, type=_Header)
    except msgspec.MsgspecError as problem:
        raise _damaged(file, f"this is not a compiled rulebook: {problem}") from None
    except (RecursionError, UnicodeDecodeError):
        raise _damaged(file, "this is not a compiled rulebook") from None
    if header.version != VERSION:
        raise _damaged(
            file,
            f"this compiled rulebook is of version {header.version}; "
            f"this rulec reads version {VERSION}",
        )
    try:
        read = msgspec.json.decode(data, type=_File)
        return _checked(read)
    except (msgspec.MsgspecError, ValueError) as problem:
        raise _damaged(file, f"this compiled rulebook is damaged: {problem}") from None


def _checked(read: _File) -> CompiledRulebook:
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
        _require(bool(plain), f"{name!r} is not a name")
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


def _declaration(item: _Enumeration | _Signal | _Quantity) -> Enumeration | Signal | Quantity:
    parameters = tuple(item.parameters)
    match item:
        case _Enumeration():
            return Enumeration(item.name, parameters, tuple(item.values), item.default)
        case _Signal():
            return Signal(item.name, parameters, item.default)
        case _Quantity():
            return Quantity(item.name, parameters, item.unit, item.default)


def _check_vocabulary(vocabulary: Vocabulary) -> None:
    types = vocabulary.types
    for item in types.values():
        seen, parent = {item.name}, item.parent
        while parent is not None:
            _require(parent in types and parent not in seen, f"type {item.name} has no root")
            seen.add(parent)
            parent = types[parent].parent
    for declaration in vocabulary.declarations.values():
        for parameter in declaration.parameters:
            _require(parameter in types, f"{declaration.name} is about an unknown type")
        if isinstance(declaration, Enumeration) and declaration.default is not None:
            known = declaration.default in declaration.values
            _require(known, f"the default of {declaration.name} is not one of its values")


def _rule(rule: _Rule, vocabulary: Vocabulary) -> CompiledRule:
    variables = tuple(Variable(name, type_name) for name, type_name in rule.variables)
    types = {variable.name: variable.type for variable in variables}
    _require(len(types) == len(variables), f"rule {rule.name} names a variable twice")
    for type_name in types.values():
        _require(type_name in vocabulary.types, f"rule {rule.name} is about an unknown type")
    for read in rule.machine.reads:
        fits = _fits(read, vocabulary.declarations.get(read.name), types.keys())
        _require(fits, f"rule {rule.name} reads {read.name}, which its vocabulary lacks")
    strength: Strength = rule.strength
    return CompiledRule(
        rule.name,
        strength,
        variables,
        rule.cite,
        rule.says,
        rule.formula,
        _machine(rule.machine, rule.name),
        rule.hoa,
    )


def _fits(read: _Read, declaration: Declaration | None, variables: Collection[str]) -> bool:
    if declaration is None or isinstance(declaration, Quantity):
        return False
    about = len(declaration.parameters) == len(read.variables)
    values = declaration.values if isinstance(declaration, Enumeration) else ()
    told_apart = set(read.values)
    return (
        about
        and set(read.variables) <= set(variables)
        and bool(values) == bool(told_apart)
        and told_apart <= set(values)
        and len(told_apart) == len(read.values)
        and read.others == (len(told_apart) < len(values))
    )


def _machine(read: _Machine, rule: str) -> Machine:
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
    _require(all(fits), f"the table of rule {rule} has a row or number that does not fit")
    traps = [trap(read.following, read.accepting, verdict=verdict) for verdict in (False, True)]
    _require(traps == [read.dead, read.safe], f"rule {rule} names a wrong dead or safe state")
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


def _damaged(file: str, message: str) -> RulecError:
    return RulecError(
        Diagnostic(
            "R0404",
            message,
            Place(file),
            help="compile it again from its source with `rulec compile`",
        )
    )


def read_compiled(path: Path) -> CompiledRulebook:
    """Read a compiled rulebook's file. Raises RulecError: R0701, R0404."""
    with opened(path) as stream:
        return from_json(stream.read(), str(path))


def write_compiled(rulebook: CompiledRulebook, folder: Path) -> list[Path]:
    """Write ``RULE.hoa`` for every rule and ``RULEBOOK.json`` into a folder, made if need be.

    Each file appears whole or not at all; the compiled rulebook comes last.

    Returns:
        The files, in the order in which they were written.

    Raises:
        RulecError: R0702.
    """
    make_folder(folder)
    texts = {folder / f"{rule.name}.hoa": rule.hoa for rule in rulebook.rules}
    texts[folder / f"{rulebook.name}.json"] = to_json(rulebook)
    for path, text in texts.items():
        with written_whole(path) as stream:
            stream.write(text.encode())
    return list(texts)
