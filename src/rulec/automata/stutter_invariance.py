"""Stutter invariance: whether a rule depends on how long something lasts."""

from __future__ import annotations

from rulec.automata.mealy_monitor import MealyMonitor


def stutter_invariant(machine: MealyMonitor) -> bool:
    """Tell whether repeated letters never change a verdict (Lamport's stuttering).

    A letter read once more must change neither the verdict, if the word ends with it, nor what
    becomes of any word that goes on. In a minimal machine no two states have the same future, so
    that is seen in the table.
    """
    return all(
        successors[after][symbol] == after and outputs[after][symbol] == verdicts[symbol]
        for successors, outputs in [(machine.successors, machine.outputs)]
        for row, verdicts in zip(successors, outputs, strict=True)
        for symbol, after in enumerate(row)
    )
