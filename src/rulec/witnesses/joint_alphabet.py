"""The joint letters of several machines: what they can read in one and the same state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from heapq import heappop, heappush

from rulec.automata.mealy_monitor import NumberRead
from rulec.witnesses.counted_objects import fewest_counted_objects
from rulec.witnesses.decision_diagrams import DecisionDiagrams
from rulec.witnesses.joint_reads import joint_reads
from rulec.witnesses.letter_functions import (
    LetterFunction,
    axiom_function,
    count_function,
    counts_read,
)
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.state_synthesis import (
    JointState,
    default_digit,
    solve_numbers,
    synthesize_state,
)
from rulec.witnesses.undecided import UndecidedError

JointLetter = tuple[int, ...]
"""For each machine the class of the letter that it reads."""

MOST_SYMBOLS = 20_000
MOST_NODES = 200_000

Steps = tuple["tuple[int, int]", "Steps"] | None
"""The digits chosen on a way through the diagrams, the first one first."""


class JointAlphabet:
    """The symbols that machines can read together, each with a plain state in which they do.

    States are those that the scene's facts allow; numbers fit together, and there can be as many
    further objects as counts ask for. Raises UndecidedError where that is too much to tell.
    """

    def __init__(self, scene: ObjectUniverse, machines: Sequence[LetterFunction]) -> None:
        self._scene = scene
        axioms = [
            axiom_function(fact_formula, scene.vocabulary) for fact_formula in scene.fact_formulas()
        ]
        self._counts = [
            count_function(count, scene)
            for count in counts_read(
                read for function in (*machines, *axioms) for read in function.reads
            )
        ]
        columns = [*machines, *(count.column for count in self._counts), *axioms]
        self._joint = joint_reads(columns, scene.vocabulary)
        self._n_machines = len(machines)
        self._n_keys = len(machines) + len(self._counts)
        self._n_numbers = sum(isinstance(read, NumberRead) for read in self._joint.reads)
        self._diagrams = DecisionDiagrams()
        roots = [
            self._diagrams.of(column, views)
            for column, views in zip(columns, self._joint.views, strict=True)
        ]
        self._usual = [default_digit(read, scene.vocabulary) for read in self._joint.reads]
        self._plain: dict[tuple[int, ...], dict[JointLetter, tuple[int, Steps]]] = {}
        result: dict[JointLetter, list[tuple[int, int, Steps, JointLetter]]] = {}
        number = 0
        for sides, ways in self._numbered(self._cleared(roots), ()):
            cost = sum(self._cost(level, digit) for level, digit in sides)
            for key, (more, steps) in ways.items():
                for side in reversed(sides):
                    steps = (side, steps)
                number += 1
                heappush(
                    result.setdefault(key[: self._n_machines], []),
                    (cost + more, number, steps, key[self._n_machines :]),
                )
            if len(result) > MOST_SYMBOLS:
                raise UndecidedError("too many different states of the world have to be told apart")
        self.situations: Mapping[JointLetter, JointState] = {
            symbol: best
            for symbol, candidates in result.items()
            if (best := self._best(candidates)) is not None
        }

    @property
    def symbols(self) -> list[JointLetter]:
        """All that can be read."""
        return list(self.situations)

    def _cost(self, level: int, digit: int) -> int:
        usual = self._usual[level]
        return int(usual is not None and digit != usual)

    def _cleared(self, nodes: Sequence[int]) -> tuple[int, ...]:
        """The nodes without the facts that hold; empty if one does not."""
        keys, axioms = nodes[: self._n_keys], nodes[self._n_keys :]
        open_facts = []
        for fact in axioms:
            if self._diagrams.level(fact) < len(self._joint.reads):
                open_facts.append(fact)
            elif not self._diagrams.value(fact):
                return ()
        return (*keys, *dict.fromkeys(open_facts))

    def _level(self, nodes: Sequence[int]) -> int | None:
        level = min(map(self._diagrams.level, nodes), default=len(self._joint.reads))
        return int(level) if level < len(self._joint.reads) else None

    def _after(self, nodes: Sequence[int], level: int, digit: int) -> tuple[int, ...]:
        return self._cleared([self._diagrams.child(node, level, digit) for node in nodes])

    def _numbered(
        self, nodes: tuple[int, ...], sides: tuple[tuple[int, int], ...]
    ) -> Iterator[tuple[tuple[tuple[int, int], ...], Mapping[JointLetter, tuple[int, Steps]]]]:
        """All ways for sums to come out, and what is then left to be read."""
        if not nodes:
            return
        level = self._level(nodes)
        if level is None or level >= self._n_numbers:
            yield sides, self._ways(nodes)
            return
        for digit in range(self._joint.reads[level].size):
            chosen = (*sides, (level, digit))
            if self._fits(chosen):
                yield from self._numbered(self._after(nodes, level, digit), chosen)

    def _fits(self, sides: Sequence[tuple[int, int]]) -> bool:
        """Can the sums come out so? The last one is new, the others can."""
        reads = [(self._joint.reads[level], digit) for level, digit in sides]
        numbers = [(read, digit) for read, digit in reads if isinstance(read, NumberRead)]
        *others, (last, _) = numbers
        known = {term for read, _ in others for _, term in read.terms}
        if known.isdisjoint(term for _, term in last.terms):
            return True
        return solve_numbers(numbers, self._scene.vocabulary, {}) is not None

    def _ways(self, nodes: tuple[int, ...]) -> Mapping[JointLetter, tuple[int, Steps]]:
        """For all that can be read the plainest way to get there."""
        if nodes in self._plain:
            return self._plain[nodes]
        if len(self._plain) > MOST_NODES:
            raise UndecidedError("too many different states of the world have to be told apart")
        level = self._level(nodes)
        result: dict[JointLetter, tuple[int, Steps]] = {}
        if level is None:
            result[tuple(map(self._diagrams.value, nodes))] = 0, None
        else:
            for digit in range(self._joint.reads[level].size):
                following = self._after(nodes, level, digit)
                if not following:
                    continue
                own = self._cost(level, digit)
                for key, (cost, steps) in self._ways(following).items():
                    if key not in result or own + cost < result[key][0]:
                        result[key] = own + cost, ((level, digit), steps)
        self._plain[nodes] = result
        return result

    def _best(self, candidates: list[tuple[int, int, Steps, JointLetter]]) -> JointState | None:
        while candidates:
            _, _, steps, classes = heappop(candidates)
            digits = []
            while steps is not None:
                (level, digit), steps = steps
                digits.append((self._joint.reads[level], digit))
            counted = tuple(
                (count.count, count.counted[which])
                for count, which in zip(self._counts, classes, strict=True)
            )
            joint_state = synthesize_state(self._scene, digits, counted)
            if (
                joint_state is not None
                and fewest_counted_objects(joint_state, self._scene) is not None
            ):
                return joint_state
        return None
