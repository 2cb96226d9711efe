"""States of the world in which rules are satisfied, whatever happened before.

If one such state exists for several rules, they never conflict: wherever each of them can still be
kept, that state as the last one keeps them all. Most rules are satisfied if everything has its
default, so most pairs need no search.
"""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.witnesses.joint_alphabet import JointAlphabet
from rulec.witnesses.letter_functions import LetterFunction, counts_read
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.relevant_axioms import ground_axioms, hold_by_default


def have_harmless_state(
    monitors: Sequence[MealyMonitor], functions: Sequence[LetterFunction], universe: ObjectUniverse
) -> bool:
    """Whether some state is harmless to all monitors, whose letters the functions compute.

    False is inconclusive: states that depend on earlier ones may keep them together. Raises
    UndecidedError.
    """
    harmless = [harmless_classes(monitor) for monitor in monitors]
    if not all(harmless):
        return False
    contents = [
        LetterFunction(function.reads, tuple([int(symbol in own) for symbol in function.letters]))
        for function, own in zip(functions, harmless, strict=True)
    ]
    reads = [read for content in contents for read in content.reads]
    # Counts have no default: the universe's own objects may be among those counted.
    if (
        not counts_read(reads)
        and hold_by_default(contents, universe.vocabulary)
        and all(axiom.holds_by_default for axiom in ground_axioms(universe))
    ):
        return True
    return JointAlphabet(universe, contents).can_be_read((1,) * len(contents))


def harmless_classes(machine: MealyMonitor) -> frozenset[int]:
    """The letter classes that are accepted in every state from which the rule can be kept.

    Such states include those reached by an accepted letter, where the trace may end.
    """
    kept = {
        target
        for row, verdicts in zip(machine.successors, machine.outputs, strict=True)
        for target, verdict in zip(row, verdicts, strict=True)
        if verdict
    }
    kept |= {state for state, verdicts in enumerate(machine.outputs) if any(verdicts)}
    n_before = 0
    while len(kept) > n_before:
        n_before = len(kept)
        kept |= {state for state, row in enumerate(machine.successors) if not kept.isdisjoint(row)}
    classes = range(len(machine.outputs[0]))
    return frozenset(
        symbol for symbol in classes if all(machine.outputs[state][symbol] for state in kept)
    )
