"""Resolution of syntax trees to the rulebook that they mean."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.rulebook.elaborate import rule_messages
from rulec.rulebook.elaborate.constant_checks import check_constants_and_macros
from rulec.rulebook.names.referenced_names import names_used
from rulec.rulebook.names.symbol_table import symbol_table
from rulec.rulebook.overlay.constants_and_macros import ConstantsAndMacros, in_force
from rulec.rulebook.overlay.priorities import pre_order
from rulec.rulebook.overlay.rulebook_overlay import Overlay, overlay
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook, SourceFile, Traffic
from rulec.rulebook.rules.axiom_checks import contradicted
from rulec.rulebook.rules.axioms import axiom_of
from rulec.rulebook.rules.rule_elaboration import translate_rule
from rulec.syntax import tree
from rulec.vocabulary import Vocabulary


def resolve(
    file: tree.File,
    vocabularies: Sequence[tree.File] = (),
    *,
    bases: Sequence[tree.File] = (),
    sources: tuple[SourceFile, ...] = (),
    opaque: bool = False,
    at: str,
    traffic: Traffic = "",
) -> tuple[Rulebook | None, tuple[Diagnostic, ...]]:
    """The rulebook as meant, and what is wrong with it.

    Args:
        file: a rulebook's tree; what could not be read in it is not complained about again.
        vocabularies: the trees of the vocabularies that it and its bases use, each once.
        bases: the trees of the rulebooks that it extends, the most general first.
        sources: the files read, for the record.
        opaque: a vocabulary or a base could not be read, so that any name may be missing for that
            reason.
        at: the day (ISO) whose law it is.
        traffic: the side on which traffic drives, whatever the trees say; if empty, what they say.

    Returns:
        The rulebook, None if there is an error in it or if its tree is not whole; errors and
        warnings.
    """
    books = [*bases, file]
    symbols = symbol_table([*vocabularies, *books], opaque=opaque)
    spans = {**symbols.type_spans, **symbols.spans}
    unsure = opaque or not all(book.complete for book in books)
    laid = overlay(books, spans, unsure=unsure)
    constants = ConstantsAndMacros(laid, at, traffic or _last_traffic(books))
    levels, priorities, mistakes = pre_order([line for book in books for line in book.priorities])
    known_levels = None if unsure else (*levels, *_levels_of_broken_lines(books))
    mistakes = [*symbols.mistakes, *laid.mistakes, *mistakes]
    mistakes += check_constants_and_macros(symbols, constants)
    axioms: list[Axiom] = []
    for fact in (item for vocabulary in (*vocabularies, *books) for item in vocabulary.items):
        if isinstance(fact, tree.FactItem):
            known, diagnostics = axiom_of(fact, symbols, constants)
            mistakes += diagnostics
            axioms += [known] if known is not None else []
    rules: list[Rule | None] = []
    for entry in laid.rules.values():
        rule, diagnostics = translate_rule(entry, symbols, constants, known_levels)
        mistakes += diagnostics
        if in_force(entry.item.in_force, at):
            rules.append(rule)
    good = [rule for rule in rules if rule is not None]
    if not symbols.mistakes:
        words = symbols.vocabulary(file.name.text if file.name else "")
        mistakes += [
            diagnostic for rule in good for diagnostic in contradicted(rule, axioms, words)
        ]
    mistakes = _once(mistakes)
    wrong = any(mistake.severity == "error" for mistake in mistakes)
    whole = all(_is_whole(vocabulary) for vocabulary in (*vocabularies, *books)) and not opaque
    # A rulebook without rules is there to be extended.
    if whole and not wrong and laid.rules:
        mistakes += _unused(file, books)
    if file.name is None or wrong or not whole or len(good) < len(rules):
        return None, tuple(mistakes)
    semantics = [book.semantics.kind for book in books if book.semantics]
    rulebook = Rulebook(
        name=file.name.text,
        vocabulary=symbols.vocabulary(file.name.text),
        rules=tuple(good),
        title=file.title.text.value if file.title else "",
        law=file.law.text.value if file.law else "",
        as_of=file.law.as_of if file.law else "",
        sources=sources,
        semantics=semantics[-1] if semantics else "stutter",
        traffic=constants.traffic,
        extends=tuple(base.name.text for base in reversed(bases) if base.name),
        levels=levels,
        priorities=priorities,
        remarks=tuple(laid.remarks),
        at=at,
        axioms=tuple(axioms),
    )
    return rulebook, tuple(mistakes)


def resolve_vocabulary(file: tree.File) -> tuple[Vocabulary | None, tuple[Diagnostic, ...]]:
    """A vocabulary by itself, and what is wrong with it."""
    symbols = symbol_table([file])
    mistakes = list(symbols.mistakes)
    constants = ConstantsAndMacros(Overlay(), "")
    for item in file.items:
        if isinstance(item, tree.FactItem):
            mistakes += axiom_of(item, symbols, constants)[1]
    if file.name is None or mistakes:
        return None, tuple(mistakes)
    return symbols.vocabulary(file.name.text), ()


def _levels_of_broken_lines(books: Sequence[tree.File]) -> list[str]:
    """Names in unreadable `priority` lines, which may be levels."""
    broken = (item for book in books for item in book.items if isinstance(item, tree.BrokenItem))
    return sorted({name for item in broken if item.word == "priority" for name in item.names})


def _once(mistakes: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Mistakes without repetitions, which come from uses of definitions."""
    first: dict[tuple[str, str, SourceLocation | None], Diagnostic] = {}
    for mistake in mistakes:
        first.setdefault((mistake.code, mistake.message, mistake.place), mistake)
    return list(first.values())


def _last_traffic(books: Sequence[tree.File]) -> Traffic:
    sides: list[Traffic] = [book.traffic.side for book in books if book.traffic]
    return sides[-1] if sides else ""


def _is_whole(file: tree.File) -> bool:
    broken = any(
        isinstance(item, tree.BrokenItem) or (isinstance(item, tree.RuleItem) and not item.complete)
        for item in file.items
    )
    return file.complete and not broken


def _unused(file: tree.File, books: Sequence[tree.File]) -> Iterator[Diagnostic]:
    """Options, parameters and definitions of the file itself that nothing speaks of."""
    used = {name for book in books for item in book.items for name in names_used(item)}
    for item in file.items:
        match item:
            case tree.OptionItem(name):
                kind = "option"
            case tree.ParamItem(name):
                kind = "parameter"
            case tree.DefineItem(name, again=False):
                kind = "definition"
            case _:
                continue
        if name.text not in used:
            yield rule_messages.unused_provision(kind, name)
