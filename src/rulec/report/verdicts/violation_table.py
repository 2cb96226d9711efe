"""An explained violation as a table of states.

A table is folded to the parts that decide and the states that fit if it has too many parts or is
too wide; each independently.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from operator import itemgetter

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.thresholds import exact
from rulec.logic.bounds import BOOLEAN, operations_of
from rulec.logic.formula import Binary, BinaryOperator, Unary, UnaryOperator
from rulec.logic.printing import number_in_words
from rulec.logic.sentences.fact_clauses import facts_in_words
from rulec.monitoring.explain.explained_parts import Observation, Part
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.explain.margins import Margin, number_with_error
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import broken, clipped, styled, table_lines, visible
from rulec.report.verdicts.guard_text import GuardWording, runs
from rulec.report.verdicts.state_times import NUMBERS_ALONE, StateTimes
from rulec.rulebook.vocabulary_phrases import phrases_of
from rulec.trace import Value
from rulec.vocabulary.partial_values import Interval

WIDEST = 0.6
"""A part of the formula is cut at this share of the width; its own parts follow below it."""

NARROW = 0.48
"""The same share for a table that would be too wide."""

WIDEST_NUMBER = 20
"""A number with more characters is rounded."""

MOST_CHANGES = 6
"""Number of changes shown that would have kept the rule."""

MOST_SPANS = 12
"""Number of ranges of states listed that would need the same change."""

MOST_OF_NAMES = 16
"""Number of characters shown of counted objects' names; JSON has them all."""

INDENT = "    "


@dataclass(frozen=True, slots=True)
class TableOptions:
    """Layout and wording of a table.

    A table that is large or wider than ``width`` is folded, unless ``every_part`` is wanted.
    ``phrases`` describe the decisive state, ``times`` are shown beside its number.
    """

    width: int = PAGE_WIDTH
    every_part: bool = False
    phrases: Mapping[str, str] = field(default_factory=dict)
    times: StateTimes = NUMBERS_ALONE


DEFAULT_OPTIONS = TableOptions()


def tables(
    explained: Sequence[Explanation],
    rulebook: CompiledRulebook,
    *,
    width: int,
    every_part: bool,
    times: StateTimes,
) -> list[str]:
    """The text of each explanation in the words of a rulebook; see ``TableOptions``."""
    if not explained:
        return []
    options = TableOptions(width, every_part, phrases_of(rulebook), times)
    return [as_text(explanation, options) for explanation in explained]


def as_text(explanation: Explanation, options: TableOptions = DEFAULT_OPTIONS) -> str:
    """The rule's sentence and table, ``*`` marking changes at the decisive state."""
    width = options.width
    decisive = explanation.states.index(explanation.decisive)
    table = _table(explanation, decisive, width, every_part=options.every_part)
    titles = [f"{title} " for title in ("state", *table.titles)]
    # One column may be wider than what is left, if its numbers or names are long
    widest = width if options.every_part else width - len(INDENT) - max(map(len, titles)) - 2
    columns = [
        [
            styled(clipped(cell, widest), "bold" if decisive in places else "")
            for cell in (head(explanation.states, places), *table.values[places[0]])
        ]
        for places in table.columns
    ]
    lines = broken(visible(explanation.rule.says), width, INDENT, INDENT)
    words = decisive_state_in_words(explanation, options.phrases, options.times)
    lines += [*broken(words, width, INDENT, 2 * INDENT), *_repair(explanation, options)]
    rows = list(zip(titles, *columns, strict=True))
    lines += table_lines(rows, indent=INDENT, ruled=(0, table.n_facts))
    return "\n".join([*lines, *_left_out(explanation, table, width)])


def decisive_state_in_words(
    explanation: Explanation, phrases: Mapping[str, str], times: StateTimes = NUMBERS_ALONE
) -> str:
    """The decisive values in the decisive state, as a sentence; empty if there are none to name."""
    decisive = explanation.states.index(explanation.decisive)
    facts = []
    for fact in explanation.facts:
        value = fact.values[decisive]
        if fact.decides and fact.objects is None and value is not None:
            number = value.middle if isinstance(value, Interval) else value
            facts.append((fact.text, number, shown(value)))
    words = facts_in_words(facts, explanation.vocabulary, phrases)
    when = f"{explanation.decisive}{times.of(explanation.decisive)}"
    return f"at state {when}: {visible(words)}" if words else ""


def _repair(explanation: Explanation, options: TableOptions) -> Iterator[str]:
    if explanation.looked_at is not None:
        first, last = explanation.looked_at
        when = options.times.of(first, last)
        text = f"(states {first}-{last}{when} of this long trace were examined)"
        yield from broken(text, options.width, INDENT, 2 * INDENT)
        return
    changes = kept_if(explanation, options.times)
    for line in changes[:MOST_CHANGES]:
        yield from broken(line, options.width, INDENT, 2 * INDENT)
    if len(changes) > MOST_CHANGES:
        yield f"{INDENT}… and {len(changes) - MOST_CHANGES:,} more; --json has them all"


def kept_if(explanation: Explanation, times: StateTimes = NUMBERS_ALONE) -> list[str]:
    """The changes of states that would have kept the rule, a line for each range of states."""
    if explanation.repair is None:
        return ["no trace of as many states keeps it"]
    changes = itertools.groupby(repaired_states(explanation), key=itemgetter(1))
    return [
        f"{'and' if number else 'kept'} if {_states(list(run), times)}: {visible(says)}"
        for number, (says, run) in enumerate(changes)
    ]


def _states(run: Sequence[tuple[int, str]], times: StateTimes) -> str:
    numbers = [number for number, _ in run]
    if len(numbers) == 1:
        return f"state {numbers[0]}{times.of(numbers[0])} says"
    spans = [f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs(numbers)]
    if len(spans) == 1:
        return f"states {spans[0]}{times.of(numbers[0], numbers[-1])} say"
    if len(spans) > MOST_SPANS:
        spans[MOST_SPANS:] = [f"… ({len(spans) - MOST_SPANS:,} more)"]
    return f"states {', '.join(spans)} say"


def repaired_states(explanation: Explanation) -> Iterator[tuple[int, str]]:
    """The numbers of states, and what each should have contained."""
    wording = GuardWording(explanation.rule, explanation.vocabulary)
    for change in explanation.repair or ():
        yield change.place, wording.condition(change.cubes)


@dataclass(frozen=True)
class _Table:
    """The rows and columns of the table.

    The first ``n_facts`` rows are facts, the others parts. ``values`` are the cells of each state,
    ``columns`` the indices of the states that each column represents.
    """

    titles: list[str]
    n_facts: int
    values: list[tuple[str, ...]]
    columns: list[range]


def _table(explanation: Explanation, decisive: int, width: int, *, every_part: bool) -> _Table:
    """The table; titles are cut before states are left out."""
    for share in (WIDEST, NARROW):
        table = _rows(explanation, decisive, every_part, int(share * width))
        if every_part:
            return table
        columns_left = width - len(INDENT) - max(map(len, ("state", *table.titles))) - 1
        columns = fitting(table.values, explanation.states, decisive, columns_left)
        if columns == table.columns:
            break
    return replace(table, columns=columns)


def _rows(explanation: Explanation, decisive: int, every_part: bool, widest: int) -> _Table:
    whole = every_part or len(explanation.parts) <= MOST_PARTS
    facts = [fact for fact in explanation.facts if whole or fact.decides]
    parts = (titled if whole else folded)(explanation.parts, widest)
    cells = [_cells(fact, decisive) for fact in facts]
    cells += [_with_margins(map(shown, part.values), part.margins) for _, part in parts]
    return _Table(
        [*(_title(fact, widest) for fact in facts), *(visible(title) for title, _ in parts)],
        len(facts),
        list(zip(*cells, strict=True)),
        [range(n, n + 1) for n in range(len(explanation.states))],
    )


def _left_out(explanation: Explanation, table: _Table, width: int) -> Iterator[str]:
    n_rows, n_states = len(table.titles), sum(len(places) for places in table.columns)
    of_rows, of_states = len(explanation.facts) + len(explanation.parts), len(explanation.states)
    words = [
        f"{most - some} of {most} {kind}"
        for some, most, kind in ((n_rows, of_rows, "rows"), (n_states, of_states, "states"))
        if some < most
    ]
    if words:
        text = f"… without {' and '.join(words)}: --every-part shows them"
        yield from broken(text, width, INDENT, 2 * INDENT)


def _title(fact: Observation, widest: int) -> str:
    text = clipped(visible(fact.text), widest)
    return f"{text} in {visible(fact.unit)}" if fact.unit else text


def _cells(fact: Observation, decisive: int) -> list[str]:
    cells = _with_margins(map(shown, fact.values), fact.margins)
    for n, names in enumerate(fact.objects or ()):
        cells[n] += f": {clipped(visible(', '.join(names)), MOST_OF_NAMES)}" if names else ""
    cells[decisive] += "*" * fact.changed
    return cells


def _with_margins(cells: Iterable[str], margins: Sequence[Margin | None]) -> list[str]:
    """Truth values with the numbers compared beside them, such as ``F 12.3 < 15.5``.

    Where bounds leave the truth value open, it is unknown, such as ``? 1.3 to 1000 >= 3.0``.
    """
    beside = margins or itertools.repeat(None)
    return [
        f"{cell if margin.is_sure else shown(None)} {margin.sides}" if margin else cell
        for cell, margin in zip(cells, beside)  # noqa: B905
    ]


def shown(value: Value | Interval | None) -> str:
    """A value as a cell; None is unknown, ``12.3±0.4`` a value that may differ by 0.4."""
    if value is None:
        return "?"
    if isinstance(value, Interval):
        return number_with_error(value.middle, value.error)
    if isinstance(value, bool):
        return "T" if value else "F"
    if isinstance(value, str):
        return visible(value)
    text = number_in_words(exact(value)) if abs(value) < 10**WIDEST_NUMBER else ""
    fits = 0 < len(text) <= WIDEST_NUMBER
    return text if fits else f"{Decimal(value):.{WIDEST_NUMBER - 8}g}"


MOST_PARTS = 20
"""Of a formula with more parts, only those that decide are shown."""

LEAST = 24
"""Number of characters of a part that are shown at least, however deep it is nested."""

_CHAINED = (BinaryOperator.AND, BinaryOperator.OR)

Titled = tuple[str, Part]
"""A part's text, indented and cut, and the part."""


def titled(parts: Sequence[Part], widest: int) -> list[Titled]:
    """All parts, with their texts cut to a number of characters."""
    return [("  " * part.depth + clipped(part.text, widest), part) for part in parts]


def folded(parts: Sequence[Part], widest: int) -> list[Titled]:
    """The parts that decide, with their texts cut to a number of characters.

    The operands of a part about a single state are omitted, because the facts show them. The
    operands of nested `and`, or of nested `or`, are on one level.
    """
    return list(_folded(parts, 0, 0, widest))


def _folded(parts: Sequence[Part], at: int, depth: int, widest: int) -> Iterator[Titled]:
    part = parts[at]
    text = clipped(part.text, max(widest - 2 * depth, LEAST))
    yield "  " * depth + text, part
    now = all(operation.operator in BOOLEAN for operation in operations_of(part.formula))
    if now:
        return
    for operand in _operands(parts, at):
        yield from _folded(parts, operand, depth + 1, widest)


def _operands(parts: Sequence[Part], at: int) -> Iterator[int]:
    for operand in range(at + 1, len(parts)):
        if parts[operand].depth <= parts[at].depth:
            return
        if parts[operand].depth > parts[at].depth + 1 or not parts[operand].decides:
            continue
        if _is_link(parts[at], parts[operand]):
            yield from _operands(parts, operand)
        else:
            yield operand


def _is_link(part: Part, operand: Part) -> bool:
    match part.formula, operand.formula:
        case Binary(operator), Binary(inner):
            return operator is inner and operator in _CHAINED
        case Unary(UnaryOperator.NOT), Binary(inner):
            return inner in BOOLEAN
        case _:
            return False


def fitting(
    columns: Sequence[Sequence[str]], states: Sequence[int], decisive: int, columns_left: int
) -> list[range]:
    """Columns that fit into the available width, each as a range of states.

    If not all fit, adjacent equal columns are merged. If that is not enough, the decisive one is
    kept, and as many as fit of: the one before it, the first one, the one further back, the one
    after the decisive one, and those further back still.
    """
    places = [range(n, n + 1) for n in range(len(columns))]
    if sum(width(columns, states, place) for place in places) <= columns_left:
        return places
    places = _merged(columns, states, decisive)
    at = next(n for n, place in enumerate(places) if decisive in place)
    chosen: list[int] = []
    for state in dict.fromkeys([at, at - 1, 0, at - 2, at + 1, *range(at - 3, 0, -1)]):
        if 0 <= state < len(places):
            columns_left -= width(columns, states, places[state])
            if columns_left < 0 and chosen:
                break
            chosen.append(state)
    return [places[number] for number in sorted(chosen)]


def width(columns: Sequence[Sequence[str]], states: Sequence[int], places: range) -> int:
    """Width of a column in characters, with the space before it."""
    cells = (head(states, places), *columns[places[0]])
    return 2 + max(len(cell) for cell in cells)


def head(states: Sequence[int], places: range) -> str:
    """The numbers of the states that a column represents."""
    first, last = states[places[0]], states[places[-1]]
    return str(first) if first == last else f"{first}-{last}"


def _merged(columns: Sequence[Sequence[str]], states: Sequence[int], decisive: int) -> list[range]:
    starts = [
        place
        for place in range(len(columns))
        if not place
        or decisive in (place, place - 1)
        or states[place] != states[place - 1] + 1
        or columns[place] != columns[place - 1]
    ]
    return list(itertools.starmap(range, itertools.pairwise([*starts, len(columns)])))
