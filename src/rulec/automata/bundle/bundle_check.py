"""Semantic checks of a compiled rulebook's file: everything that running it relies on."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import prod

from msgspec import UNSET, UnsetType
from msgspec.structs import astuple

from rulec.automata import mealy_monitor as monitors
from rulec.automata.alphabet import reads_of
from rulec.automata.bundle import bundle_schema as schema
from rulec.automata.bundle.bundle_messages import AUTOMATON_TOO_LARGE
from rulec.automata.bundle.clocked_entries import (
    check_sinks,
    check_table,
    require,
    timed_machine,
)
from rulec.automata.bundle.compiled_rulebook import (
    CompiledAxiom,
    CompiledRule,
    CompiledRulebook,
    alike,
    too_large_rule,
)
from rulec.automata.bundle.cut_machines import (
    BEGUN,
    StoredPrefixes,
    TimedCut,
    looks_back,
)
from rulec.automata.bundle.formula_check import check_formula
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.automata.tables import SizeError
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN, PAST, has_seconds, in_steps, operations_of
from rulec.logic.codec import from_data, number_from_data, terms_from_data
from rulec.logic.free_names import names_of
from rulec.logic.opportunities import trigger_of
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import (
    Exemption,
    Rule,
    Rulebook,
    RuleParts,
    SourceFile,
    Variable,
)
from rulec.rulebook.rules.implied_signals import with_implied
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary.vocabulary_model import Meaning

MOST_STEPS = 100
"""Results are kept for so many steps before all are discarded."""


def rulebook_of(read: schema.BundleFile) -> CompiledRulebook:
    """The compiled rulebook of a sound file; raises ValueError for any other."""
    _check_visible(read)
    kind_of = {entry: kind for kind, entry in schema.ENTRY_OF.items()}
    vocabulary = Vocabulary(
        read.vocabulary.name,
        {name: ObjectType(name, parent) for name, parent in read.vocabulary.types.items()},
        {item.name: kind_of[type(item)](*astuple(item)) for item in read.vocabulary.declarations},
    )
    _check_vocabulary(vocabulary)
    for name in (read.name, *[rule.name for rule in read.rules]):
        # Names become file names.
        plain = name and not name.startswith(".") and not set(name) & set("/\\\0")
        require(bool(plain), f"{name!a} is not a name")
    rulebook = CompiledRulebook(
        **alike(Rulebook, read),
        rulec=read.rulec,
        spot=read.spot,
        vocabulary=vocabulary,
        rules=tuple(_rule(rule, vocabulary, read) for rule in read.rules),
        sources=tuple(SourceFile(source.name, source.sha256) for source in read.sources),
        priorities=_priorities(read),
        axioms=tuple(_axiom(fact, vocabulary) for fact in read.facts),
    )
    own = read.vocabulary.parameters.items()
    vocabulary = replace(
        vocabulary,
        meanings=_meanings(read.vocabulary, vocabulary),
        parameters={name: number_from_data(value) for name, value in own},
    )
    known = with_implied(vocabulary, [axiom.formula for axiom in rulebook.axioms])
    rulebook = replace(rulebook, vocabulary=known)
    _check_names(rulebook)
    rulebook = replace(rulebook, prefixes=_prefixes(rulebook, read))
    return replace(rulebook, recompile=AnyStep(rulebook))


def _check_visible(read: schema.BundleFile) -> None:
    """Names are printed as they are, so none may contain terminal control characters."""
    vocabulary = read.vocabulary
    declared = vocabulary.declarations
    enumerations = [item for item in declared if isinstance(item, schema.EnumerationEntry)]
    bound = [rule.variables for rule in read.rules] + [fact.variables for fact in read.facts]
    names = [
        *(read.name, vocabulary.name, read.rulec, read.spot, read.at, *read.extends, *read.levels),
        *[name for rule in read.rules for name in (rule.name, rule.book)],
        *vocabulary.types,
        *[item.name for item in declared],
        *[value for item in enumerations for value in item.values],
        *[name for variables in bound for pair in variables for name in pair],
    ]
    for name in names:
        require(name.isprintable(), f"the name {name!a} has a character that is not visible")


def _check_names(rulebook: CompiledRulebook) -> None:
    names = {rule.name for rule in rulebook.rules}
    require(len(names) == len(rulebook.rules), "two rules have the same name")


def _prefixes(rulebook: CompiledRulebook, read: schema.BundleFile) -> StoredPrefixes | None:
    """The machines for cut traces, checked; None if the file has none."""
    lacking = [rule.cut is UNSET for rule in read.rules]
    if any(lacking):
        require(all(lacking), "only some of its rules have machines for cut traces")
        return None
    for rule in read.rules:
        if rule.cut:
            check_table(rule.cut, len(rule.machine.letters), rule.name)
            known = len(rule.cut.starts) > 0 and set(rule.cut.starts) <= set(
                range(len(rule.cut.successors))
            )
            require(known, f"the table of rule `{rule.name}` for cut traces has no valid start")
    return StoredPrefixes(
        {
            rule.name: _outcome_machine(rule, entry.cut)
            for rule, entry in zip(rulebook.rules, read.rules, strict=True)
        },
        timed={
            rule.name: _timed_cut(rule, entry.cut_clocked, ends=read.semantics == "finite")
            for rule, entry in zip(rulebook.rules, read.rules, strict=True)
            if entry.cut_clocked is not None
        },
    )


def _timed_cut(rule: CompiledRule, read: schema.CutClockedEntry, *, ends: bool) -> TimedCut:
    fits = (read.continuing is not None) is looks_back(rule) and (read.alone is None) is ends
    require(fits, f"the machines of rule `{rule.name}` for cut traces are not those it needs")
    reads = rule.machine.reads
    if looks_back(rule):
        reads = (*reads, monitors.Read(BEGUN.name, ()))
    return TimedCut(
        None
        if read.continuing is None
        else timed_machine(read.continuing, reads, rule.name, ends=ends),
        None if read.alone is None else timed_machine(read.alone, reads, rule.name, ends=True),
    )


def _outcome_machine(
    rule: CompiledRule, read: schema.CutMachineEntry | UnsetType | None
) -> OutcomeMachine | None:
    if not read:
        return None
    letters, successors, outputs, starts = astuple(read)
    return OutcomeMachine(rule.machine.reads, letters, successors, outputs, frozenset(starts))


def _priorities(read: schema.BundleFile) -> frozenset[tuple[str, str]]:
    """The priorities, checked to be a pre-order of the levels."""
    require(len(set(read.levels)) == len(read.levels), "two levels have the same name")
    pairs = frozenset(read.priorities)
    require(len(pairs) == len(read.priorities), "a priority is listed twice")
    named = {level for pair in pairs for level in pair}
    require(named <= set(read.levels), "a priority is about an unknown level")
    below: dict[str, set[str]] = {level: {level} for level in read.levels}
    for higher, lower in pairs:
        below[higher].add(lower)
    closed = all(below[lower] <= below[higher] for higher, lower in pairs)
    require(closed, "the priorities are not transitively closed")
    return pairs


def _check_vocabulary(vocabulary: Vocabulary) -> None:
    types = vocabulary.types
    for item in types.values():
        seen, parent = {item.name}, item.parent
        while parent is not None:
            require(parent in types and parent not in seen, f"type `{item.name}` has no root")
            seen.add(parent)
            parent = types[parent].parent
    for declaration in vocabulary.declarations.values():
        for parameter in declaration.parameters:
            require(parameter in types, f"`{declaration.name}` is about an unknown type")
        require(
            not declaration.presumed or declaration.default is not None,
            f"`{declaration.name}` is presumed, but has no default",
        )
        if isinstance(declaration, Enumeration) and declaration.default is not None:
            known = declaration.default in declaration.values
            require(known, f"the default of `{declaration.name}` is not one of its values")


def _meanings(read: schema.VocabularyEntry, vocabulary: Vocabulary) -> dict[str, Meaning]:
    """The meanings of words, each of which reads no word that has its meaning later."""
    found: dict[str, Meaning] = {}
    for name, entry in read.meanings.items():
        declared, formula, of = (
            vocabulary.declarations.get(name),
            from_data(entry.tree),
            f"`{name}`",
        )
        fits = isinstance(declared, Signal) and len(declared.parameters) == len(entry.variables)
        require(fits and len({*entry.variables}) == len(entry.variables), f"{of} cannot be defined")
        own = {*entry.variables}
        check_formula(formula, vocabulary, own, of, counted=False, is_meaning=True)
        require(formula_text(formula) == entry.formula, f"{of} has two different meanings")
        is_past = all(part.operator in BOOLEAN | PAST for part in operations_of(formula))
        require(is_past, f"the meaning of {of} looks ahead")
        found[name] = Meaning(entry.variables, formula, names_of(formula))
    places = {name: place for place, name in enumerate(found)}
    for name, meaning in found.items():
        ordered = all(places.get(read, -1) < places[name] for read in meaning.reads)
        require(ordered, f"`{name}` is defined by a word that is defined after it")
    return found


def _axiom(fact: schema.AxiomEntry, vocabulary: Vocabulary) -> CompiledAxiom:
    axiom = CompiledAxiom(
        tuple([Variable(name, type_name) for name, type_name in fact.variables]),
        from_data(fact.tree),
        SourceLocation(fact.file, fact.line) if fact.file else None,
    )
    _check_parts(axiom, fact, vocabulary, "a fact")
    timeless = all(part.operator in BOOLEAN for part in operations_of(axiom.formula))
    require(timeless, "a fact is about more than one state")
    return axiom


def _check_parts(
    compiled: CompiledAxiom | CompiledRule,
    read: schema.AxiomEntry | schema.BundleRule,
    vocabulary: Vocabulary,
    of: str,
) -> None:
    """Check the variables and the formula of a rule or axiom; ``of`` is its name in errors."""
    names = {variable.name for variable in compiled.variables}
    require(len(names) == len(compiled.variables), f"{of} names a variable twice")
    for variable in compiled.variables:
        require(variable.type in vocabulary.types, f"{of} is about an unknown type")
    check_formula(compiled.formula, vocabulary, names, of, counted=False)
    same = formula_text(compiled.formula) == read.formula
    require(same, f"{of} has two different formulas")


def _rule(rule: schema.BundleRule, vocabulary: Vocabulary, read: schema.BundleFile) -> CompiledRule:
    reads = tuple([_read(item) for item in rule.machine.reads])
    formula = from_data(rule.tree)
    parts = None if rule.parts is None else _rule_parts(rule.parts)
    compiled = CompiledRule(
        **alike(Rule, rule),
        hoa=rule.hoa,
        variables=tuple([Variable(name, type_name) for name, type_name in rule.variables]),
        formula=formula,
        machine=monitors.MealyMonitor(reads, *astuple(rule.machine)[1:]),
        step_s=None if rule.step_s is None else number_from_data(rule.step_s),
        weight=number_from_data(rule.weight),
        trigger=trigger_of(formula) if parts is None else _trigger_of(parts),
        parts=parts,
        certificate=rule.certificate,
    )
    _check_rule(compiled, rule, vocabulary, read.levels)
    if rule.clocked is None:
        return compiled
    ends = read.semantics == "finite"
    return replace(compiled, timed=timed_machine(rule.clocked, reads, rule.name, ends=ends))


def _check_rule(
    rule: CompiledRule, read: schema.BundleRule, vocabulary: Vocabulary, levels: Container[str]
) -> None:
    name, formula = rule.name, rule.formula
    _check_parts(rule, read, vocabulary, f"rule `{name}`")
    _check_machine(read.machine, name)
    same = rule.machine.reads == reads_of(formula, vocabulary)
    require(same, f"the table of rule `{name}` does not read the same as its formula")
    known = not rule.level or rule.level in levels
    require(known, f"rule `{name}` has an unknown level")
    require(rule.weight > 0, f"rule `{name}` has no weight")
    fits = has_seconds(formula) is (rule.step_s is not None)
    require(fits, f"rule `{name}` is for a wrong step")
    if rule.step_s is not None:
        in_steps(formula, rule.step_s)
    if rule.parts is not None:
        variables = {variable.name for variable in rule.variables}
        formulas = [rule.parts.required, *(part.formula for part in rule.parts.exemptions)]
        for part in (*formulas, rule.parts.condition):
            if part is not None:
                of = f"a part of rule `{name}`"
                check_formula(part, vocabulary, variables, of, counted=False)


def _rule_parts(read: schema.PartsEntry) -> RuleParts:
    condition = None if read.condition is None else from_data(read.condition)
    exemptions = tuple([Exemption(from_data(tree), scope) for scope, tree in read.exemptions])
    return RuleParts(from_data(read.required), exemptions, condition)


def _trigger_of(parts: RuleParts) -> ltl.Formula | None:
    exceptions = [(part.formula, part.scope == "initially") for part in parts.exemptions]
    return trigger_of(parts.required, exceptions, parts.condition)


def _check_machine(read: schema.MachineEntry, rule: str) -> None:
    check_table(read, prod(_read(item).size for item in read.reads), rule)
    check_sinks(read, rule)


def _read(read: schema.ReadEntry | schema.NumberReadEntry) -> monitors.Read | monitors.NumberRead:
    if isinstance(read, schema.ReadEntry):
        return monitors.Read(*astuple(read))
    return monitors.NumberRead(
        terms_from_data(read.terms),
        tuple(
            monitors.Threshold(number_from_data(item.limit), item.inclusive)
            for item in read.thresholds
        ),
    )


@dataclass(frozen=True, slots=True, eq=False)
class AnyStep:
    """A ``Recompiler`` of a rulebook that was compiled for one step."""

    book: CompiledRulebook
    _known: dict[Fraction, CompiledRulebook] = field(default_factory=dict, repr=False)

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step.

        Raises RulecError R0401 for rules that are too large for it, R0507 for those without clocks.
        """
        book = self.judgeable_at(step_s)
        if book.too_large:
            raise RulecError(
                [
                    AUTOMATON_TOO_LARGE.at(
                        None,
                        f"rule `{left_out.name}` cannot be judged: {left_out.why}",
                        help="longer steps mean fewer states; for a recording, every fifth state "
                        "may be enough",
                    )
                    for left_out in book.too_large
                ]
            )
        return book

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step, without rules too large for it. Raises R0507."""
        if step_s not in self._known:
            if len(self._known) >= MOST_STEPS:
                self._known.clear()
            self._known[step_s] = self._at(step_s)
        return self._known[step_s]

    def _at(self, step_s: Fraction) -> CompiledRulebook:
        found = [(rule, _if_small(rule, step_s)) for rule in self.book.rules]
        rules = [small for _, small in found if small is not None]
        left_out = [too_large_rule(rule, step_s) for rule, small in found if small is None]
        own = {id(rule) for rule in self.book.rules}
        prefixes = self.book.prefixes
        if isinstance(prefixes, StoredPrefixes):
            prefixes = prefixes.at_other_steps([rule for rule in rules if id(rule) not in own])
        return replace(
            self.book,
            rules=tuple(rules),
            recompile=self,
            prefixes=prefixes,
            too_large=tuple(left_out),
        )


def _if_small(rule: CompiledRule, step_s: Fraction) -> CompiledRule | None:
    try:
        return rule.at(step_s)
    except SizeError:
        return None
