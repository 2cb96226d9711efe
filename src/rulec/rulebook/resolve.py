"""Resolves syntax trees to a rulebook."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass, replace

from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.rulebook.elaborate import rule_messages
from rulec.rulebook.elaborate.constant_checks import check_constants_and_macros
from rulec.rulebook.names.constant_and_presumed import mark_constant_and_presumed
from rulec.rulebook.names.referenced_names import names_used
from rulec.rulebook.names.symbol_table import SymbolTable, symbol_table
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros
from rulec.rulebook.overlay.priorities import pre_order
from rulec.rulebook.overlay.rulebook_overlay import (
    Overlay,
    RuleEntry,
    in_force,
    law_line,
    overlay,
    own_law,
)
from rulec.rulebook.rulebook_model import (
    Axiom,
    Provision,
    Rule,
    Rulebook,
    SourceFile,
    Topic,
    Traffic,
)
from rulec.rulebook.rules.axiom_contradictions import (
    all_contradictions,
    contradictions,
    impossible_triggers,
)
from rulec.rulebook.rules.axioms import axioms_of, contradicted
from rulec.rulebook.rules.implied_signals import with_implied
from rulec.rulebook.rules.meanings import meanings_of, parameters_of, with_calculated
from rulec.rulebook.rules.rule_elaboration import translate_rule
from rulec.syntax import tree
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class BookNames:
    """The names that the formulas of a rulebook can use on a day, and mistakes in them.

    ``known_levels`` are the levels that a rule may name; None if they are not known for certain.
    """

    symbols: SymbolTable
    constants: ConstantsAndMacros
    levels: tuple[str, ...]
    priorities: frozenset[tuple[str, str]]
    known_levels: tuple[str, ...] | None
    axioms: tuple[Axiom, ...]
    vocabulary: Vocabulary
    mistakes: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class TranslatedRule:
    """A resolved rule, None if it has mistakes, which are then among its ``mistakes``.

    ``contradictions`` are the states of its examples that axioms exclude.
    """

    rule: Rule | None
    mistakes: tuple[Diagnostic, ...]
    contradictions: tuple[Diagnostic, ...] = ()


@dataclass(frozen=True, slots=True)
class Resolution:
    """The names of a rulebook, the rulebook itself if it is sound and whole, and all mistakes."""

    names: BookNames
    rulebook: Rulebook | None
    mistakes: tuple[Diagnostic, ...]


Translate = Callable[[RuleEntry, BookNames, bool], TranslatedRule]
"""Resolves a rule's entry, given the names it can use, and whether it is the rulebook's own law."""


def translated(entry: RuleEntry, names: BookNames, confirmed: bool) -> TranslatedRule:
    """A resolved rule, with all mistakes in it."""
    rule, mistakes = translate_rule(
        entry, names.symbols, names.constants, names.known_levels, confirmed=confirmed
    )
    if rule is None or names.symbols.mistakes:
        return TranslatedRule(rule, tuple(mistakes))
    known = names.axioms, names.vocabulary
    mistakes += contradictions(rule.variables, *known)
    if rule.book == names.vocabulary.name:
        # Whoever says that there are no trams need not drop each rule on trams that is inherited.
        mistakes += impossible_triggers(rule, *known, entry.item.name.span)
    return TranslatedRule(rule, tuple(mistakes), tuple(contradicted(rule, *known)))


def names_of(
    books: Sequence[tree.File],
    vocabularies: Sequence[tree.File] = (),
    *,
    opaque: bool = False,
    at: str,
    traffic: Traffic = "",
) -> BookNames:
    """What the formulas of a rulebook can speak of; the arguments are those of ``resolve``."""
    file, files = books[-1], (*vocabularies, *books)
    symbols = symbol_table(files, opaque=opaque)
    mark_constant_and_presumed(symbols, files)
    unsure = opaque or not all(book.complete for book in books)
    laid = overlay(files, {**symbols.type_spans, **symbols.spans}, unsure=unsure)
    sides: list[Traffic] = ["", *(book.traffic.side for book in books if book.traffic)]
    constants = ConstantsAndMacros(laid, at, traffic or sides[-1])
    levels, priorities, mistakes = pre_order([line for book in books for line in book.priorities])
    known_levels = None if unsure else (*levels, *_levels_of_broken_lines(books))
    mistakes = [*symbols.mistakes, *laid.mistakes, *mistakes]
    mistakes += check_constants_and_macros(symbols, constants)
    axioms, wrong_facts = axioms_of(files, symbols, constants)
    mistakes += wrong_facts
    meanings, wrong_meanings = meanings_of(symbols, constants)
    mistakes += wrong_meanings
    vocabulary = symbols.vocabulary(file.name.text if file.name else "")
    if not symbols.mistakes and (wrong_facts := all_contradictions(axioms, vocabulary)):
        mistakes += wrong_facts
        axioms = ()  # no more is said of what they rule out
    return BookNames(
        symbols,
        constants,
        levels=levels,
        priorities=priorities,
        known_levels=known_levels,
        axioms=axioms,
        vocabulary=replace(
            with_implied(vocabulary, [axiom.formula for axiom in axioms]),
            meanings=meanings,
            parameters=parameters_of(vocabularies, symbols, constants),
        ),
        mistakes=tuple(mistakes),
    )


def resolve(
    books: Sequence[tree.File],
    vocabularies: Sequence[tree.File] = (),
    sources: tuple[SourceFile, ...] = (),
    translate: Translate = translated,
    *,
    opaque: bool = False,
    at: str,
    traffic: Traffic = "",
) -> Resolution:
    """The rulebook as meant, if there is no error and the trees are whole, and what is wrong.

    Args:
        books: the trees of the rulebooks that it extends, the most general first, and its own. What
            could not be read in them is not complained about again.
        vocabularies: the trees of the vocabularies that they use, each once.
        sources: the files read, for the record.
        translate: resolves each rule.
        opaque: a vocabulary or a base could not be read, so that any name may be missing for that
            reason.
        at: the day (ISO) whose law it is.
        traffic: the side on which traffic drives, whatever the trees say; if empty, what they say.
    """
    names = names_of(books, vocabularies, opaque=opaque, at=at, traffic=traffic)
    whole = not opaque and all(map(is_whole, (*vocabularies, *books)))
    return Resolution(names, *_with_rules(books, names, sources, translate, whole=whole))


def _with_rules(
    books: Sequence[tree.File],
    names: BookNames,
    sources: tuple[SourceFile, ...],
    translate: Translate,
    *,
    whole: bool,
) -> tuple[Rulebook | None, tuple[Diagnostic, ...]]:
    """The rulebook of trees whose names are resolved, and all mistakes.

    ``whole``: all files could be read completely.
    """
    file, laid, at = books[-1], names.constants.overlay, names.constants.at
    mistakes = list(names.mistakes)
    own, law = own_law(books), law_line(books)
    rules: list[Rule | None] = []
    contradictions: list[Diagnostic] = []
    not_in_force: list[str] = []
    for entry in laid.rules.values():
        rule = translate(entry, names, any(entry.law is book for book in own))
        mistakes += rule.mistakes
        if in_force(entry.item.in_force, at):
            rules.append(rule.rule)
            contradictions += rule.contradictions
        else:
            not_in_force.append(entry.item.name.text)
    good = [rule for rule in rules if rule is not None]
    mistakes = _distinct_mistakes([*mistakes, *contradictions])
    wrong = any(mistake.severity == "error" for mistake in mistakes)
    # A rulebook without rules is there to be extended.
    if whole and not wrong and laid.rules:
        mistakes += _unused(books, laid.meanings)
    if file.name is None or wrong or not whole or len(good) < len(rules):
        return None, tuple(mistakes)
    semantics = [book.semantics.kind for book in books if book.semantics]
    rulebook = Rulebook(
        name=file.name.text,
        vocabulary=with_calculated(
            names.vocabulary,
            [*(rule.formula for rule in good), *(axiom.formula for axiom in names.axioms)],
        ),
        rules=tuple(good),
        title=file.title.text.value if file.title else "",
        law=law.text.value if law else "",
        as_of=law.as_of if law else "",
        sources=sources,
        semantics=semantics[-1] if semantics else "stutter",
        traffic=names.constants.traffic,
        extends=tuple(base.name.text for base in reversed(books[:-1]) if base.name),
        levels=names.levels,
        priorities=names.priorities,
        remarks=tuple(laid.remarks),
        at=at,
        axioms=names.axioms,
        not_in_force=tuple(not_in_force),
        topics=tuple(Topic(name, entry.title.value) for name, entry in laid.topics.items()),
        provisions=tuple(
            Provision(
                entry.number.value,
                entry.heading.value,
                item.link.value,
                item.as_of,
                treatment=entry.treatment,
                because=entry.because.value if entry.because else "",
                certainty=item.certainty,
            )
            for file, item in laid.provisions
            if any(file is own_file for own_file in own)
            for entry in item.entries
        ),
    )
    return rulebook, tuple(mistakes)


def resolve_vocabulary(file: tree.File) -> tuple[Vocabulary | None, tuple[Diagnostic, ...]]:
    """A vocabulary by itself, and mistakes in it."""
    symbols = symbol_table([file])
    mark_constant_and_presumed(symbols, [file])
    axioms, wrong_facts = axioms_of([file], symbols, ConstantsAndMacros(Overlay(), ""))
    vocabulary = symbols.vocabulary(file.name.text if file.name else "")
    if not symbols.mistakes:
        wrong_facts += all_contradictions(axioms, vocabulary)
    mistakes = [*symbols.mistakes, *wrong_facts]
    return None if file.name is None or mistakes else vocabulary, tuple(mistakes)


def _levels_of_broken_lines(books: Sequence[tree.File]) -> list[str]:
    """Names in unreadable `priority` lines, which may be levels."""
    broken = (item for book in books for item in book.items if isinstance(item, tree.BrokenItem))
    return sorted({name for item in broken if item.word == "priority" for name in item.names})


def _distinct_mistakes(mistakes: Sequence[Diagnostic]) -> list[Diagnostic]:
    first: dict[tuple[str, str, SourceLocation | None], Diagnostic] = {}
    for mistake in mistakes:
        first.setdefault((mistake.code, mistake.message, mistake.place), mistake)
    return list(first.values())


def is_whole(file: tree.File) -> bool:
    """Whether a file could be read completely."""
    broken = any(
        isinstance(item, tree.BrokenItem) or (isinstance(item, tree.RuleItem) and not item.complete)
        for item in file.items
    )
    return file.complete and not broken


def _unused(books: Sequence[tree.File], declared: Container[str]) -> Iterator[Diagnostic]:
    used = {name for book in books for item in book.items for name in names_used(item)}
    for item in books[-1].items:
        match item:
            case tree.OptionItem(name):
                kind = "option"
            case tree.ParamItem(name):
                kind = "parameter"
            case tree.DefineItem(name, again=False):
                kind = "definition"
            case _:
                continue
        if name.text not in used and name.text not in declared:
            yield rule_messages.unused_provision(kind, name)
