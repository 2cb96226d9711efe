"""Letters without effect on a machine, recognised before all their reads are known."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rulec.automata.outcome_machine import KEPT, SetMonitor
from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram
from rulec.trace.remembered import Remembered


class IdleLetters:
    """The letters of a machine that are idle, given as the classes, as bits, that they may have.

    Impossible letters, excluded by axioms, are never idle, so that they get noticed.
    """

    def __init__(self, diagram: LetterDiagram, are_idle: Callable[[int], bool]) -> None:
        self._diagram = diagram
        self._known: Remembered[int, bool] = Remembered(
            lambda classes: bool(classes) and are_idle(classes)
        )

    def of_classes(self, classes: int) -> bool:
        """Whether letters of any of these classes, at least one, are idle."""
        return self._known[classes]

    def of_cube(self, cube: Sequence[int]) -> bool:
        """Whether letters are idle that have for each read any of its digits, as bits."""
        nodes = self._diagram.nodes(cube)
        return not nodes & 1 and self.of_classes(nodes >> 1)


def idle_letters(monitor: SetMonitor, diagram: LetterDiagram) -> IdleLetters:
    """The letters that keep a machine in a set of states in which every word of them is kept.

    So a word of such letters needs no run, nor does any part of it.
    """
    machine = monitor.machine

    def stays(home: int, classes: int) -> bool:
        steps = (monitor.step(here, classes) for here in (monitor.start, home))
        return all(step.states == home and step.worst == KEPT for step in steps)

    weights = diagram.n_letters()
    singles = range(machine.n_classes)
    homes = dict.fromkeys([monitor.start])
    homes |= dict.fromkeys(monitor.step(monitor.start, 1 << n).states for n in singles)
    worth = {home: sum(weights.get(n, 0) for n in singles if stays(home, 1 << n)) for home in homes}
    best = max(worth, key=worth.__getitem__)
    return IdleLetters(diagram, lambda classes: stays(best, classes))
