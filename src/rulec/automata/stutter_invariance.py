"""Does a rule depend on how long something lasts?"""

from __future__ import annotations

from rulec.automata.mealy_monitor import Machine


def stutter_invariant(machine: Machine) -> bool:
    """Is a word judged the same however often each of its letters stands there in a row?

    A letter read once more must change neither the verdict, if the word ends with it, nor what
    becomes of any word that goes on. In a minimal machine no two states have the same future, so
    that is seen in the table.
    """
    return all(
        following[after][symbol] == after and accepting[after][symbol] == verdicts[symbol]
        for following, accepting in [(machine.following, machine.accepting)]
        for row, verdicts in zip(following, accepting, strict=True)
        for symbol, after in enumerate(row)
    )
