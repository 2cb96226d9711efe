"""Joint letters of several monitors: their letters in one common state.

The product of their decision diagrams is searched level by level, starting with sums of numbers,
because these depend on each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from heapq import heappop, heappush
from itertools import count

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.resource_limits import SEARCH
from rulec.witnesses import letter_functions, state_synthesis
from rulec.witnesses.counted_objects import CountedObjectKinds, fewest_counted_objects
from rulec.witnesses.counted_types import facts_beside
from rulec.witnesses.diagrams.decision_diagrams import DecisionDiagrams
from rulec.witnesses.diagrams.plainest_ways import (
    Choices,
    Nodes,
    WaySearch,
    chosen_digit,
    digits_chosen,
)
from rulec.witnesses.joint_reads import joint_reads
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.relevant_axioms import ground_axioms, relevant_axioms, subjects_read
from rulec.witnesses.undecided import UndecidedError

JointLetter = tuple[int, ...]
"""The letter class that each monitor reads."""

Way = tuple[int, int, int, JointLetter]
"""The number of non-default digits, a serial number, the digits, and the classes of counts, and of
what allows the objects that they count."""

MOST_LETTERS = 20_000

_SUMS_TRIED = 20
_COUNTS_TRIED = 100
"""Search steps charged for solving inequalities, and for looking for objects to count."""


class JointAlphabet:
    """Joint letters of monitors, each with the plainest state that gives it.

    States satisfy the universe's axioms, their numbers are consistent, and they may have as many
    further objects as the counts need. Raises UndecidedError if that is too much to decide.

    ``candidates`` are, in order, the letters that the diagrams allow. Whether some state gives a
    letter takes a search of its own, so that is done on demand.
    """

    def __init__(
        self, universe: ObjectUniverse, monitors: Sequence[letter_functions.LetterFunction]
    ) -> None:
        self._universe = universe
        vocabulary = universe.vocabulary
        axioms = list(ground_axioms(universe))
        facts = [axiom.function for axiom in axioms]
        reads = (read for function in (*monitors, *facts) for read in function.reads)
        self._counts = [
            letter_functions.count_function(count, universe)
            for count in letter_functions.counts_read(reads)
        ]
        beside = facts_beside([function.count for function in self._counts], universe)
        read = [*monitors, *(count.function for count in self._counts), *beside]
        relevant = relevant_axioms(axioms, [function.reads for function in read])
        functions = [*read, *(axiom.function for axiom in relevant)]
        self._joint = joint_reads(functions, vocabulary)
        self._n_monitors = len(monitors)
        self._n_keys = len(read)
        self._n_numbers = sum(isinstance(read, NumberRead) for read in self._joint.reads)
        self._diagrams = DecisionDiagrams()
        roots = tuple(map(self._diagrams.of, functions, self._joint.views))
        axiom_roots = self._diagrams.open_axioms(roots[self._n_keys :])
        self._root = None if axiom_roots is None else roots[: self._n_keys] + axiom_roots
        self._defaults = [
            state_synthesis.default_digit(read, vocabulary) for read in self._joint.reads
        ]
        self._sizes = [read.size for read in self._joint.reads]
        self._subjects = subjects_read(self._joint.reads)
        self._object_kinds = CountedObjectKinds(universe, self._subjects)
        self._numbers: dict[
            object, dict[state_synthesis.Subject, state_synthesis.Value] | None
        ] = {}
        self._fitting: dict[tuple[tuple[int, int], ...], bool] = {}
        self._search()

    def _search(self) -> None:
        """Find the candidates, and the ways to them."""
        self._steps_left = self._most_steps = SEARCH.value()
        self._states: dict[JointLetter, state_synthesis.JointState | None] = {}
        self._may_miss_some = False
        ways_to = self._ways_to = dict[JointLetter, list[Way]]()
        choices = Choices(self._sizes, self._defaults)
        search = WaySearch(self._diagrams, choices, self._take)
        numbers = count()
        for number_digits, nodes in self._numbered(self._root, ()) if self._root else ():
            cost = sum(self._cost(level, digit) for level, digit in number_digits)
            chosen = sum(chosen_digit(level, digit) for level, digit in number_digits)
            ways = search.ways(nodes[: self._n_keys], nodes[self._n_keys :])
            for key, (more, digits) in ways.items():
                letter, classes = key[: self._n_monitors], key[self._n_monitors :]
                way = (cost + more, next(numbers), chosen + digits, classes)
                heappush(ways_to.setdefault(letter, []), way)
            self._take(len(ways))
            if len(ways_to) > MOST_LETTERS:
                raise UndecidedError(
                    "too many different states of the world have to be distinguished"
                )
        self.candidates: Sequence[JointLetter] = tuple(ways_to)

    def read_of(self, subject: state_synthesis.Subject) -> Read | None:
        """The joint read of an enumeration or signal, None if there is none."""
        reads = (read for read in self._joint.reads if isinstance(read, Read))
        return next((read for read in reads if (read.name, read.variables) == subject), None)

    @property
    def is_counting(self) -> bool:
        """Whether deciding if some state gives a letter may take long, because of counts."""
        return bool(self._counts)

    def state(self, letter: JointLetter) -> state_synthesis.JointState | None:
        """The plainest state that gives a letter, None if there is none. Raises UndecidedError."""
        if letter not in self._states:
            self._states[letter] = self._best(self._ways_to.get(letter, []))
        return self._states[letter]

    def can_be_read(self, letter: JointLetter) -> bool:
        """Whether some state gives the letter. Raises UndecidedError."""
        return self.state(letter) is not None

    def require_complete(self) -> None:
        """Raise UndecidedError if some letter for which no state was found may have one.

        Asked before it is concluded that there is no word.
        """
        if self._may_miss_some:
            raise UndecidedError("which objects count depends on more than one number at once")

    def states_of(self, word: Iterable[JointLetter]) -> list[state_synthesis.JointState]:
        """A state for each letter of a word of possible letters."""
        return [state for letter in word if (state := self.state(letter)) is not None]

    @property
    def letters(self) -> list[JointLetter]:
        """All letters that some state gives."""
        return list(filter(self.can_be_read, self.candidates))

    def _take(self, steps: int) -> None:
        """Count steps of the search, and raise UndecidedError beyond the limit."""
        self._steps_left -= steps
        if self._steps_left < 0:
            raise UndecidedError(
                f"it takes more than {self._most_steps:,} steps of search for states of the world, "
                f"and `rulec --limit {SEARCH.name}=NUMBER` lifts the limit"
            )

    def _cost(self, level: int, digit: int) -> int:
        default = self._defaults[level]
        return int(default is not None and digit != default)

    def _level(self, nodes: Sequence[int]) -> int:
        """The first joint read that a node tests; the number of joint reads if there is none."""
        return int(min(self._diagrams.level(nodes), len(self._joint.reads)))

    def _after(self, nodes: Nodes, level: int) -> Iterator[tuple[int, Nodes]]:
        """The digits of a joint read that violate no axiom, and the nodes after each."""
        rows = self._diagrams.restricted(nodes, level, self._sizes[level])
        for digit in range(self._sizes[level]):
            axioms = self._diagrams.open_axioms(rows[digit][self._n_keys :])
            if axioms is not None:
                yield digit, rows[digit][: self._n_keys] + axioms

    def _numbered(
        self, nodes: Nodes, number_digits: tuple[tuple[int, int], ...]
    ) -> Iterator[tuple[tuple[tuple[int, int], ...], Nodes]]:
        """Possible digits of the sums, and the nodes after each combination."""
        level = self._level(nodes)
        if level >= self._n_numbers:
            yield number_digits, nodes
            return
        for digit, following in self._after(nodes, level):
            chosen = (*number_digits, (level, digit))
            if self._fits(chosen):
                yield from self._numbered(following, chosen)

    def _fits(self, number_digits: tuple[tuple[int, int], ...]) -> bool:
        """Whether sums can have these digits; all but the last are known to be possible."""
        self._take(_SUMS_TRIED)
        if number_digits not in self._fitting:
            reads = [(self._joint.reads[level], digit) for level, digit in number_digits]
            numbers = [(read, digit) for read, digit in reads if isinstance(read, NumberRead)]
            *earlier, (last, _) = numbers
            known = {term for read, _ in earlier for _, term in read.terms}
            self._fitting[number_digits] = (
                known.isdisjoint(term for _, term in last.terms)
                or state_synthesis.solve_numbers(numbers, self._universe.vocabulary, {}) is not None
            )
        return self._fitting[number_digits]

    def _best(self, candidates: list[Way]) -> state_synthesis.JointState | None:
        while candidates:
            _, _, chosen, classes = heappop(candidates)
            self._take(_COUNTS_TRIED if self._counts else 1)
            state = self._state(digits_chosen(chosen), classes)
            if state is None:
                continue
            if fewest_counted_objects(state, self._object_kinds) is not None:
                return state
            self._may_miss_some |= self._object_kinds.may_miss_some(state)
        return None

    def _state(
        self, chosen: Sequence[tuple[int, int]], classes: Sequence[int]
    ) -> state_synthesis.JointState | None:
        """A state with these digits at these levels; the first ``classes`` are of the counts."""
        vocabulary = self._universe.vocabulary
        counted = tuple(
            (function.count, function.counted[letter_class])
            for function, letter_class in zip(self._counts, classes, strict=False)
        )
        digits = [(self._joint.reads[level], digit) for level, digit in chosen]
        sums = [(read, digit) for read, digit in digits if isinstance(read, NumberRead)]
        # Many states have the same numbers.
        key = tuple(chosen[: len(sums)]), tuple([number for _, number in counted])
        if key not in self._numbers:
            numbers = state_synthesis.solve_numbers(sums, vocabulary, dict(counted))
            self._numbers[key] = None if numbers is None else state_synthesis.float_values(numbers)
        values = self._numbers[key]
        if values is None:
            return None
        values = state_synthesis.values_of(digits, vocabulary) | values
        return state_synthesis.JointState(values, sums, counted)
