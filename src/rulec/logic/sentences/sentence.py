"""A formula as an unambiguous sentence of plain language.

A line contains only what is unambiguous: an adverb that applies to the rest of a line stands at its
head, and only simple clauses are joined by commas. Anything nested deeper becomes a list with
labels, as in contracts. Different formulas get different sentences.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum

from rulec.logic import formula as ltl
from rulec.logic.one_point import is_none, is_some, single_count
from rulec.logic.sentences import wording
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language

MOST_IN_A_LINE = 3
"""Longer chains of ``and``, ``or`` and ``then`` become lists."""


MOST_CLAUSES = 5
"""Longer chains that end in another chain become lists."""


class Shape(IntEnum):
    """The complexity of a phrase, from a clause to a list."""

    CLAUSE = 0
    """One atom or comparison, or its negation."""
    SCOPED = 1
    """Adverbs before one clause, which apply to the rest of the line."""
    JOINED = 2
    """Clauses joined by one ``and`` or ``or``."""
    REACHING = 3
    """Adverbs before joined clauses."""
    LINE = 4
    """Any other single line."""
    LIST = 5


@dataclass(frozen=True, slots=True)
class Phrase:
    """A line, and the list that it introduces, if any.

    In ``text`` the character ``label(n)`` is a placeholder for the label of the n-th of ``items``.
    ``joint`` is the word before the last item, or before the last joined clause.
    """

    text: str
    shape: Shape
    items: tuple[Phrase, ...] = ()
    joint: str = ""
    n_clauses: int = 1
    of: ltl.Formula | None = field(default=None, compare=False)
    """The formula that it says."""


def label(index: int) -> str:
    """The placeholder for the label of a phrase's item ``index`` (from 0)."""
    return chr(0xE000 + index)


def sentence(
    formula: ltl.Formula,
    variables: Sequence[tuple[str, str]],
    related: Related,
    language: Language = ENGLISH,
) -> Phrase:
    """A rule's formula as a sentence, without its full stop.

    Args:
        formula: the rule's requirement.
        variables: the rule's variables, each with its type.
        related: whether an object can be of both types; such variables stand for different objects.
        language: the language of the sentence.
    """
    body = phrase(formula, language, inside=False)
    if not variables:
        return body
    return replace(body, text=f"{_for_every(variables, related, language)}{body.text}")


def exemption(formula: ltl.Formula, scope: str, language: Language = ENGLISH) -> Phrase:
    """An exception of a rule as a sentence without full stop; ``scope`` as in a rulebook."""
    lead = language.exempt.format(language.stretches[scope])
    return _after(lead, phrase(formula, language, inside=True), language)


def condition(formula: ltl.Formula, language: Language = ENGLISH, *, guards: bool) -> Phrase:
    """The condition of a rule as a phrase. ``guards``: it applies throughout, else initially."""
    when = language.stretches["throughout" if guards else "initially"]
    lead = language.counts_only.format(when)
    return _after(lead, phrase(formula, language, inside=True), language)


def meaning(name: ltl.Atom, formula: ltl.Formula, language: Language = ENGLISH) -> Phrase:
    """What an atom stands for, as a sentence without full stop."""
    said = phrase(formula, language, inside=True)
    clause = wording.atom_clause(name, language, holds=True)
    return replace(said, text=language.means.format(clause, said.text))


Related = Callable[[str, str], bool]


def _for_every(variables: Sequence[tuple[str, str]], related: Related, language: Language) -> str:
    named = []
    for number, (name, of_type) in enumerate(variables):
        other = any(related(of_type, earlier) for _, earlier in variables[:number])
        words = language.type_of(of_type, wording.spoken(of_type))
        named.append(f"{words.other if other else words.every} {name}")
    return language.for_every.format(wording.listed(named, language))


def phrase(formula: ltl.Formula, language: Language = ENGLISH, *, inside: bool) -> Phrase:
    """A formula as a phrase. ``inside``: it refers to another time than the start of the trace."""
    return replace(_phrase(formula, language, inside=inside), of=formula)


def _phrase(formula: ltl.Formula, language: Language, *, inside: bool) -> Phrase:
    match formula:
        case ltl.Unary(ltl.UnaryOperator.NOT, ltl.Comparison() as operand) if _says_some(operand):
            return phrase(replace(operand, relation="<"), language, inside=inside)
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            denied = None if _counts(operand) else _clause(operand, language, holds=False)
            if denied is not None:
                return _simple(denied, language, inside=inside)
            scope = phrase(operand, language, inside=inside)
            if scope.text == language.one_of:
                return replace(scope, text=language.none_of)
            return _after(language.not_so, scope, language, denies=True)
        case ltl.Unary(operator, operand, bound):
            lead = wording.adverb(operator, bound, language, inside=inside)
            denies = operator is ltl.UnaryOperator.NEVER
            return _after(lead, phrase(operand, language, inside=True), language, denies=denies)
        case ltl.Binary(ltl.BinaryOperator.AND | ltl.BinaryOperator.OR):
            return _chain(formula, language, inside=inside)
        case ltl.Binary(ltl.BinaryOperator.THEN):
            return _phases(formula, language)
        case ltl.Binary(ltl.BinaryOperator.IMPLIES):
            return _condition(formula, language, inside=inside)
        case ltl.Binary(ltl.BinaryOperator.IFF):
            return _between(language.iff, formula, language, inside=inside)
        case ltl.Binary(ltl.BinaryOperator.XOR):
            return _between(language.xor, formula, language, inside=inside)
        case ltl.Binary(operator, bound=bound):
            pattern = wording.pattern_of(operator, bound, language, inside=inside)
            return _between(pattern, formula, language, inside=True)
        case ltl.Comparison() if (kind := _kind(formula, language)) is not None:
            return _simple(kind, language, inside=inside)
        case ltl.Comparison() if (count := single_count(formula)) is not None:
            body, there_are = count.body, wording.counted(formula, count, language)
            every = _denied(body) if is_none(formula) else None
            if every is not None:
                body = every
                words = language.type_of(count.type, wording.spoken(count.type))
                there_are = language.for_every.format(f"{words.every} {count.variable}").rstrip()
            lead = there_are if inside else language.there_at_start.format(there_are)
            return _after(lead, phrase(body, language, inside=True), language)
    clause = _clause(formula, language, holds=True)
    assert clause is not None, "everything else is a clause"
    return _simple(clause, language, inside=inside)


def _simple(clause: str, language: Language, *, inside: bool) -> Phrase:
    return Phrase(clause if inside else language.at_start.format(clause), Shape.CLAUSE)


def _denied(formula: ltl.Formula) -> ltl.Formula | None:
    """What a formula denies, if it is a negation."""
    match formula:
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return operand
    return None


def _says_some(formula: ltl.Comparison) -> bool:
    """Whether it says that there is at least one object."""
    return is_some(formula) and single_count(formula) is not None


def _kind(formula: ltl.Comparison, language: Language) -> str | None:
    """The clause that an object is of a type, or is not, if the formula says no more."""
    count = single_count(formula)
    if count is None or not (is_none(formula) or is_some(formula)):
        return None
    match count.body:
        case ltl.Same(left, right) if count.variable in (left, right) and left != right:
            words = language.type_of(count.type, wording.spoken(count.type))
            other = right if left == count.variable else left
            return language.kind[is_none(formula)].format(other, words.one)
    return None


def _counts(formula: ltl.Formula) -> bool:
    return isinstance(formula, ltl.Comparison) and single_count(formula) is not None


def _clause(formula: ltl.Formula, language: Language, *, holds: bool) -> str | None:
    match formula:
        case ltl.Atom():
            return wording.atom_clause(formula, language, holds=holds)
        case ltl.Comparison():
            bodies = dict(_bodies(formula, language))
            return wording.comparison_clause(formula, language, bodies, holds=holds)
        case ltl.Constant(value):
            return language.constants[value is not holds]
        case ltl.Same(left, right):
            return language.same[not holds].format(left, right)
    return None


def _bodies(formula: ltl.Comparison, language: Language) -> Iterator[tuple[ltl.Count, str]]:
    """What each count of a comparison is about, if that is short enough for a line."""
    for _, term in formula.terms:
        if isinstance(term, ltl.Count):
            body = phrase(term.body, language, inside=True)
            if body.shape <= Shape.JOINED:
                yield term, body.text


def _after(lead: str, scope: Phrase, language: Language, *, denies: bool = False) -> Phrase:
    """A phrase after words at the head of a line.

    The words apply to the rest of the line, or to the whole list that it introduces.
    """
    if scope.shape is Shape.JOINED and denies:
        return Phrase(f"{lead} {_together(scope, language)}", Shape.REACHING)
    # A comma is needed if more than a clause follows, unless one is there or the lead forbids it.
    runs_on = scope.shape is Shape.CLAUSE or scope.text.startswith(language.runs_on)
    pause = "" if runs_on or lead.endswith(language.no_pause_after) else ","
    shape = Shape.REACHING if scope.shape is Shape.JOINED else max(scope.shape, Shape.SCOPED)
    return replace(scope, text=f"{lead}{pause} {scope.text}", shape=shape)


def _together(joined: Phrase, language: Language) -> str:
    """Joined clauses after a negation, worded as one whole."""
    if joined.joint == language.or_:
        return language.either.format(joined.text)
    whole = language.both if joined.n_clauses == 2 else language.all_
    return whole.format(joined.text)


def _between(pattern: str, formula: ltl.Binary, language: Language, *, inside: bool) -> Phrase:
    """Clauses inserted in a pattern; longer ones become a list."""
    first = phrase(formula.left, language, inside=inside)
    last = phrase(formula.right, language, inside=inside)
    if last.shape is Shape.JOINED and pattern.endswith("{}"):
        last = Phrase(_together(last, language), Shape.CLAUSE)
    return _placed(pattern, (first, last), Shape.CLAUSE, language)


def _placed(pattern: str, sides: Sequence[Phrase], most: Shape, language: Language) -> Phrase:
    items: list[Phrase] = []
    places = []
    for side in sides:
        places.append(side.text if side.shape <= most else label(len(items)))
        items += [side] if side.shape > most else []
    text = pattern.format(*places)
    if not items:
        return Phrase(text, Shape.LINE)
    return Phrase(language.where.format(text), Shape.LIST, tuple(items))


def _condition(formula: ltl.Binary, language: Language, *, inside: bool) -> Phrase:
    left = phrase(formula.left, language, inside=inside)
    right = phrase(formula.right, language, inside=inside)
    if left.shape > Shape.REACHING:
        return _placed(language.implies, (left, right), Shape.REACHING, language)
    shape = Shape.LIST if right.shape is Shape.LIST else Shape.LINE
    return replace(right, text=language.implies.format(left.text, right.text), shape=shape)


def _chain(formula: ltl.Binary, language: Language, *, inside: bool) -> Phrase:
    """``and`` and ``or``, which are left-associative."""
    operands: list[ltl.Formula] = []
    rest: ltl.Formula = formula
    while isinstance(rest, ltl.Binary) and rest.operator is formula.operator:
        operands.append(rest.right)
        rest = rest.left
    parts = tuple(phrase(part, language, inside=inside) for part in (rest, *reversed(operands)))
    is_and = formula.operator is ltl.BinaryOperator.AND
    joint = language.and_ if is_and else language.or_
    fits_a_line = len(parts) <= MOST_IN_A_LINE and all(
        part.shape is Shape.CLAUSE for part in parts[:-1]
    )
    last = parts[-1]
    if fits_a_line and last.shape is Shape.JOINED and len(parts) + last.n_clauses <= MOST_CLAUSES:
        head = ", ".join(part.text for part in parts[:-1])
        return Phrase(f"{head}, {joint} {_together(last, language)}", Shape.LINE, (), joint)
    if fits_a_line and last.shape <= Shape.SCOPED:
        shape = Shape.JOINED if parts[-1].shape is Shape.CLAUSE else Shape.LINE
        texts = [part.text for part in parts]
        comma = "," if shape is Shape.LINE else ""
        head = ", ".join(texts[:-1])
        return Phrase(f"{head}{comma} {joint} {texts[-1]}", shape, (), joint, len(parts))
    all_of = language.both_of if len(parts) == 2 else language.all_of
    return Phrase(all_of if is_and else language.one_of, Shape.LIST, parts, joint)


def _phases(formula: ltl.Binary, language: Language) -> Phrase:
    """The phases of ``then``, with bounds as their durations.

    It is right-associative; a bound is the duration of the phase before it.
    """
    phases: list[tuple[Phrase, str]] = []
    rest: ltl.Formula = formula
    while isinstance(rest, ltl.Binary) and rest.operator is ltl.BinaryOperator.THEN:
        lasts = "" if rest.bound is None else wording.lasting(rest.bound, language)
        phases.append((phrase(rest.left, language, inside=True), lasts))
        rest = rest.right
    phases.append((phrase(rest, language, inside=True), ""))
    if len(phases) <= MOST_IN_A_LINE and all(phase.shape is Shape.CLAUSE for phase, _ in phases):
        steps = language.phase_joint.join(
            language.lasting_phase.format(lasts, phase.text)
            if lasts
            else language.phase.format(phase.text)
            for phase, lasts in phases
        )
        return Phrase(language.phase_line.format(steps), Shape.LINE)
    items = tuple(
        replace(phase, text=language.lasting_item.format(lasts, phase.text)) if lasts else phase
        for phase, lasts in phases
    )
    return Phrase(language.phases, Shape.LIST, items, language.then)
