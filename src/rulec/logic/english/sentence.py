"""A formula as a plain English sentence that has one reading only.

What can be said in a line without doubt is: what scopes over the rest of a line stands at its head,
and only simple clauses stand between commas. Whatever is nested deeper becomes a list with labels,
as in contracts. Different formulas get different sentences.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

from rulec.logic import formula as ltl
from rulec.logic.english import wording

MOST_IN_A_LINE = 3
"""Longer chains of ``and``, ``or`` and ``then`` become lists."""


class Shape(IntEnum):
    """The complexity of a phrase, from a word to a list."""

    CLAUSE = 0
    """One atom or comparison, or its denial."""
    SCOPED = 1
    """Adverbs before one clause: they reach to the end."""
    JOINED = 2
    """Clauses joined by one ``and`` or ``or``."""
    REACHING = 3
    """Adverbs before joined clauses."""
    LINE = 4
    """Anything else that is one line."""
    LIST = 5


@dataclass(frozen=True, slots=True)
class Phrase:
    """A line, and the list that it introduces, if any.

    In ``text`` the character ``label(n)`` stands for the label of the n-th of ``items``. ``joint``
    is the word before the last item, or before the last of the clauses that are joined.
    """

    text: str
    shape: Shape
    items: tuple[Phrase, ...] = ()
    joint: str = ""
    n_clauses: int = 1


def label(index: int) -> str:
    """The placeholder of the label of a phrase's item ``index``, from 0."""
    return chr(0xE000 + index)


def sentence(
    formula: ltl.Formula, variables: Sequence[tuple[str, str]], related: Related
) -> Phrase:
    """A rule's formula as a sentence, without its full stop.

    Args:
        formula: what the rule requires.
        variables: the rule's variables, each with its type.
        related: can an object be of both types? If so the variables stand for different ones.
    """
    body = phrase(formula, inside=False)
    return replace(body, text=f"{_for_every(variables, related)}{body.text}") if variables else body


_WHEN = {
    "initially": "at the start of the trace",
    "at start": "at the start of the stretch that the rule guards",
    "throughout": "throughout the stretch that the rule guards",
    "at some point": "at some point of the stretch that the rule guards",
    "at end": "at the end of the stretch that the rule guards",
}


def exemption(formula: ltl.Formula, scope: str) -> Phrase:
    """An exception of a rule as a sentence, without its full stop.

    ``scope`` is as in a rulebook.
    """
    return _after(f"it does not count if, {_WHEN[scope]},", phrase(formula, inside=True))


def condition(formula: ltl.Formula, *, guards: bool) -> Phrase:
    """The condition of a rule as a phrase. ``guards``: it guards a stretch of the trace."""
    when = _WHEN["throughout" if guards else "initially"]
    return _after(f"it counts only if, {when},", phrase(formula, inside=True))


Related = Callable[[str, str], bool]


def _for_every(variables: Sequence[tuple[str, str]], related: Related) -> str:
    named = []
    for number, (name, of_type) in enumerate(variables):
        other = any(related(of_type, earlier) for _, earlier in variables[:number])
        named.append(f"every {'other ' if other else ''}{wording.spoken(of_type)} {name}")
    return f"for {wording.listed(named)}: "


def phrase(formula: ltl.Formula, *, inside: bool) -> Phrase:
    """A formula as a phrase. ``inside``: it speaks of another time than the start of the trace."""
    at_start = "" if inside else " at the start"
    match formula:
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            denied = None if _counts(operand) else _clause(operand, holds=False)
            if denied is not None:
                return Phrase(f"{denied}{at_start}", Shape.CLAUSE)
            return _after("it is not the case that", phrase(operand, inside=inside))
        case ltl.Unary(operator, operand, bound):
            return _after(
                wording.adverb(operator, bound, inside=inside), phrase(operand, inside=True)
            )
        case ltl.Binary(ltl.BinaryOperator.AND | ltl.BinaryOperator.OR):
            return _chain(formula, inside=inside)
        case ltl.Binary(ltl.BinaryOperator.THEN):
            return _phases(formula)
        case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right):
            return _condition(phrase(left, inside=inside), phrase(right, inside=inside))
        case ltl.Binary(ltl.BinaryOperator.IFF, left, right):
            return _between("{} if and only if {}", left, right, inside=inside)
        case ltl.Binary(ltl.BinaryOperator.XOR, left, right):
            return _between("either {} or {}, but not both", left, right, inside=inside)
        case ltl.Binary(operator, left, right, bound):
            return _between(
                wording.pattern_of(operator, bound, inside=inside), left, right, inside=True
            )
        case ltl.Comparison() if (count := wording.single_count(formula)) is not None:
            there_are = wording.counted(formula, count)
            lead = there_are if inside else f"at the start {there_are}"
            return _after(lead, phrase(count.body, inside=True))
    clause = _clause(formula, holds=True)
    assert clause is not None, "everything else is a clause"
    return Phrase(f"{clause}{at_start}", Shape.CLAUSE)


def _counts(formula: ltl.Formula) -> bool:
    return isinstance(formula, ltl.Comparison) and wording.single_count(formula) is not None


def _clause(formula: ltl.Formula, *, holds: bool) -> str | None:
    match formula:
        case ltl.Atom():
            return wording.atom_in_english(formula, holds=holds)
        case ltl.Comparison():
            return wording.comparison_in_english(formula, holds=holds)
        case ltl.Constant(value):
            verb = "holds" if holds else "does not hold"
            return f"“{'true' if value else 'false'}” {verb}"
        case ltl.Same(left, right):
            return f"{left} {'is' if holds else 'is not'} the same as {right}"
    return None


def _after(lead: str, scope: Phrase) -> Phrase:
    """A phrase after words at the head of a line.

    The words reach to the line's end, or over the list that they introduce.
    """
    if scope.shape is Shape.JOINED and lead.endswith("that"):
        return Phrase(f"{lead} {_together(scope)}", Shape.REACHING)
    # A pause is made where more than a clause follows, unless there is one or `that` forbids it.
    runs_on = scope.shape is Shape.CLAUSE or scope.text.startswith(("it ", "there "))
    pause = "" if runs_on or lead.endswith(("that", "which", ",")) else ","
    shape = Shape.REACHING if scope.shape is Shape.JOINED else max(scope.shape, Shape.SCOPED)
    return replace(scope, text=f"{lead}{pause} {scope.text}", shape=shape)


def _together(joined: Phrase) -> str:
    """Joined clauses behind a denial, worded as one whole."""
    if joined.joint == "or":
        return f"either {joined.text}"
    pair = joined.n_clauses == 2
    return f"both {joined.text}" if pair else f"all of this is so: {joined.text}"


def _between(pattern: str, left: ltl.Formula, right: ltl.Formula, *, inside: bool) -> Phrase:
    """Clauses in the places of a pattern, longer ones in a list."""
    first, last = phrase(left, inside=inside), phrase(right, inside=inside)
    if last.shape is Shape.JOINED and pattern.endswith("{}"):
        last = Phrase(_together(last), Shape.CLAUSE)
    return _placed(pattern, (first, last), Shape.CLAUSE)


def _placed(pattern: str, sides: Sequence[Phrase], most: Shape) -> Phrase:
    items: list[Phrase] = []
    places = []
    for side in sides:
        places.append(side.text if side.shape <= most else label(len(items)))
        items += [side] if side.shape > most else []
    text = pattern.format(*places)
    if not items:
        return Phrase(text, Shape.LINE)
    return Phrase(f"{text}, where:", Shape.LIST, tuple(items))


def _condition(left: Phrase, right: Phrase) -> Phrase:
    if left.shape > Shape.REACHING:
        return _placed("if {}, then {}", (left, right), Shape.REACHING)
    shape = Shape.LIST if right.shape is Shape.LIST else Shape.LINE
    return replace(right, text=f"if {left.text}, then {right.text}", shape=shape)


def _chain(formula: ltl.Binary, *, inside: bool) -> Phrase:
    """``and`` and ``or``, which are read from the left."""
    operands: list[ltl.Formula] = []
    rest: ltl.Formula = formula
    while isinstance(rest, ltl.Binary) and rest.operator is formula.operator:
        operands.append(rest.right)
        rest = rest.left
    parts = tuple(phrase(part, inside=inside) for part in (rest, *reversed(operands)))
    joint = formula.operator.value
    if (
        len(parts) <= MOST_IN_A_LINE
        and all(part.shape is Shape.CLAUSE for part in parts[:-1])
        and parts[-1].shape <= Shape.SCOPED
    ):
        shape = Shape.JOINED if parts[-1].shape is Shape.CLAUSE else Shape.LINE
        texts = [part.text for part in parts]
        comma = "," if shape is Shape.LINE else ""
        head = ", ".join(texts[:-1])
        return Phrase(f"{head}{comma} {joint} {texts[-1]}", shape, (), joint, len(parts))
    both = "both" if len(parts) == 2 else "all"
    head = f"{both} of these hold:" if joint == "and" else "at least one of these holds:"
    return Phrase(head, Shape.LIST, parts, joint)


def _phases(formula: ltl.Binary) -> Phrase:
    """The phases of ``then``, with bounds as their durations.

    It is read from the right; a bound says how long the phase before it lasts.
    """
    phases: list[tuple[Phrase, str]] = []
    rest: ltl.Formula = formula
    while isinstance(rest, ltl.Binary) and rest.operator is ltl.BinaryOperator.THEN:
        lasts = "" if rest.bound is None else f" {wording.lasting(rest.bound)}"
        phases.append((phrase(rest.left, inside=True), lasts))
        rest = rest.right
    phases.append((phrase(rest, inside=True), ""))
    if len(phases) <= MOST_IN_A_LINE and all(one.shape is Shape.CLAUSE for one, _ in phases):
        steps = ", then".join(f"{lasts} {one.text}" for one, lasts in phases)
        return Phrase(f"without a break first{steps}", Shape.LINE)
    items = tuple(
        replace(one, text=f"{lasts.strip()}: {one.text}") if lasts else one for one, lasts in phases
    )
    head = "these phases follow one another without a break, each for at least one moment:"
    return Phrase(head, Shape.LIST, items, "then")
