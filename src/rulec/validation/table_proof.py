"""Proof of a table against its formula: an exhaustive search of the product of both."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from rulec.validation.demands import Demands
from rulec.validation.formula_progression import DemandState, FormulaProgression
from rulec.validation.letter_sets import NumberedLetters
from rulec.validation.unprovable import UnprovableError, require

MOST_STATES = 1 << 13
"""Formulas with more states, as this checker counts them, are not proved."""

QUICK_WORK = 1 << 18
"""The limit of work where a table has to be proved at once or not at all."""

MOST_CLASS_BITS = 1 << 28
"""The greatest product of the numbers of letter classes and of letters."""

Rows: TypeAlias = list[list[int]]


@dataclass(frozen=True, slots=True)
class ClaimedTable:
    """A deterministic table: each letter's class, a class's letters as bits, and rows by state."""

    numbers: Sequence[int]
    classes: tuple[int, ...]
    following: Rows
    outputs: Rows

    @classmethod
    def read(
        cls, entry: Mapping[str, Any], outputs: str, letters: NumberedLetters, possible: int
    ) -> ClaimedTable:
        """The table of an entry; ``outputs`` is the name of its output rows.

        Raises UnprovableError if a possible letter has no class, or an excluded one has.
        """
        following, verdicts, numbers = entry["following"], entry[outputs], entry["letters"]
        width = len(following[0]) if following else 0
        require(len(numbers) == letters.count, "its table does not fit the letters of its reads")
        require(width * letters.count <= MOST_CLASS_BITS, "it has too many classes of letters")
        bits = [bytearray(letters.count // 8 + 1) for _ in range(width)]
        excluded = bytearray(letters.count // 8 + 1)
        for letter, number in enumerate(numbers):
            require(type(number) is int and -1 <= number < width, "a letter has no class")
            (excluded if number == -1 else bits[number])[letter // 8] |= 1 << letter % 8
        states = range(len(following))
        fits = len(verdicts) == len(following) > 0 and all(
            len(row) == width and all(type(each) is kind for each in row)
            for rows, kind in (
                (following, int),
                (verdicts, bool if outputs == "accepting" else int),
            )
            for row in rows
        )
        require(fits, "its table has a row that does not fit")
        require(all(each in states for row in following for each in row), "its table lacks a state")
        same = int.from_bytes(excluded, "little") == letters.everything & ~possible
        require(same, "the letters that it leaves out are not those that the facts exclude")
        classes = tuple([int.from_bytes(each, "little") for each in bits])
        return cls(numbers, classes, following, verdicts)

    def split(self, letters: int) -> Iterator[tuple[int, int]]:
        """The classes of some possible letters, each with those that it contains, as bits."""
        while letters:
            number = self.numbers[_lowest(letters)]
            yield number, letters & self.classes[number]
            letters &= ~self.classes[number]


@dataclass(frozen=True, slots=True)
class Move:
    """The letters (as bits) leading to a state, and whether a word ending with one is kept."""

    letters: int
    target: DemandState
    kept: bool


class FormulaMachine:
    """A formula's machine with its verdicts; ``ends`` if nothing follows a word."""

    def __init__(self, progression: FormulaProgression, possible: int, *, ends: bool) -> None:
        self.progression, self.possible, self._ends = progression, possible, ends
        self._moves: dict[DemandState, list[Move]] = {}

    def moves(self, state: DemandState) -> list[Move]:
        """The moves from a state."""
        if state not in self._moves:
            few = len(self._moves) < MOST_STATES
            require(few, f"its formula has more than {MOST_STATES} states for this checker")
            self._moves[state] = list(self._all_moves(state))
        return self._moves[state]

    def _all_moves(self, state: DemandState) -> Iterator[Move]:
        kept = 0 if self._ends else self.progression.kept_for_ever(state)
        for target, letters in self.progression.moves(state).items():
            if self._ends:
                kept = self.possible if self.progression.holds_at_the_end(target) else 0
            for verdict, side in ((True, letters & kept), (False, letters & ~kept)):
                if side:
                    yield Move(side, target, verdict)


def prove_words(
    tree: Any, letters_of: Callable[[Any], int], entry: Mapping[str, Any], *, ends: bool
) -> None:
    """Raise UnprovableError unless a table judges every word as a tree does; bounds are in steps.

    ``letters_of`` gives the letters of an atom or a comparison; letters with a class count as
    possible. Neither this nor the meaning of letters is checked. For callers with many tables: each
    takes at most a fraction of a second.
    """
    letters = NumberedLetters(len(entry["letters"]))
    classes = "".join(["0" if number < 0 else "1" for number in reversed(entry["letters"])])
    possible = int(classes, 2)
    demands = Demands(possible, QUICK_WORK)
    root = demands.read(tree, None, lambda atom: letters_of(atom) & possible)
    prove_table(
        FormulaMachine(FormulaProgression(demands, root), possible, ends=ends), entry, letters
    )


def prove_table(
    machine: FormulaMachine, entry: Mapping[str, Any], letters: NumberedLetters
) -> None:
    """Raise UnprovableError unless a rule's table judges every word as its formula does.

    All pairs of states that some word leads to are examined, the shortest words first.
    """
    table = ClaimedTable.read(entry, "accepting", letters, machine.possible)
    by_class: dict[DemandState, list[tuple[int, Move, int]]] = {}
    first = machine.progression.start, 0
    came: dict[tuple[DemandState, int], tuple[tuple[DemandState, int], int] | None] = {first: None}
    waiting = [first]
    for pair in waiting:
        state, row = pair
        if state not in by_class:
            by_class[state] = [
                (symbol, move, common)
                for move in machine.moves(state)
                for symbol, common in sorted(table.split(move.letters))
            ]
        for symbol, move, common in by_class[state]:
            target = move.target, table.following[row][symbol]
            if table.outputs[row][symbol] is not move.kept:
                wrong, right = ("kept", "violated")[move.kept], ("violated", "kept")[move.kept]
                word = [*_word(came, pair), _lowest(common)]
                raise UnprovableError(
                    f"a trace of {_states(len(word))} is {wrong} by its table, {right} by its tree",
                    [letters.described(letter) for letter in word],
                )
            if target not in came:
                came[target] = pair, _lowest(common)
                waiting.append(target)
    _check_sinks(table, entry, {row for _, row in came})


def _states(number: int) -> str:
    return "one state" if number == 1 else f"{number} states"


def _lowest(letters: int) -> int:
    return (letters & -letters).bit_length() - 1


def _word(
    came: Mapping[tuple[DemandState, int], tuple[tuple[DemandState, int], int] | None],
    pair: tuple[DemandState, int],
) -> list[int]:
    word: list[int] = []
    while (before := came[pair]) is not None:
        pair = before[0]
        word.append(before[1])
    return word[::-1]


def _check_sinks(table: ClaimedTable, entry: Mapping[str, Any], reached: set[int]) -> None:
    """Check that from the dead state nothing is accepted, and from the safe state everything."""
    used = [symbol for symbol, members in enumerate(table.classes) if members]
    for name, verdict in (("dead", True), ("safe", False)):
        hopeful = {
            state
            for state, row in enumerate(table.outputs)
            if any(row[symbol] is verdict for symbol in used)
        }
        hopeful = led_to(
            hopeful,
            {s: {row[symbol] for symbol in used} for s, row in enumerate(table.following)},
        )
        lost = set(range(len(table.following))) - hopeful
        claimed = set() if entry[name] is None else {entry[name]}
        right = claimed <= lost and lost & reached <= claimed
        require(right, f"the state that it calls {name} is not the right one")


def led_to(good: set[Any], following: Mapping[Any, set[Any]]) -> set[Any]:
    """The nodes of a graph from which a node in ``good`` can be reached, these included."""
    before: dict[Any, list[Any]] = {}
    for node, targets in following.items():
        for target in targets:
            before.setdefault(target, []).append(node)
    reaching, waiting = set(good), list(good)
    for node in waiting:
        for row in before.get(node, ()):
            if row not in reaching:
                reaching.add(row)
                waiting.append(row)
    return reaching
