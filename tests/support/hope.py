"""Whether a word can still be gone on with so that a formula holds, decided by Spot.

Spot's automaton is not the compiler's: it has no registers, and a past that is guessed.
"""

import spot
from past_in_spot import in_spot, spot_automaton

from rulec.logic.formula import atoms_of


class Hope:
    """For words of the letters that are possible; they end as ``semantics`` says.

    A letter is the set of the formula's propositions that are true in it.
    """

    def __init__(self, formula, semantics, letters):
        self._formula, self._semantics, self._letters = formula, semantics, letters
        self._known = list(dict.fromkeys(atoms_of(formula)))
        self._automaton = None

    def first_lost(self, word):
        """The index of the first letter after which nothing helps; None if there is hope still."""
        if self._can_be_saved(word):
            return None
        return next(n for n in range(len(word)) if not self._can_be_saved(word[: n + 1]))

    def _can_be_saved(self, word):
        if self._automaton is None:
            self._automaton = self._of_all_that_keep_it()
        alive = " & alive" if self._semantics == "finite" else ""
        said = "; ".join(f"{self._said(letter)}{alive}" for letter in word)
        return spot.parse_word(f"{said}; cycle{{1}}").as_automaton().intersects(self._automaton)

    def _of_all_that_keep_it(self):
        possible = " | ".join(self._said(letter) for letter in self._letters)
        if self._semantics == "finite":
            return spot_automaton(self._formula, f"G({possible})", "alive")
        settled = "".join(f" & (FG {in_spot(one)} | FG !{in_spot(one)})" for one in self._known)
        return spot_automaton(self._formula, f"G({possible}){settled}")

    def _said(self, letter):
        return " & ".join(
            ["1", *(f"{'' if one in letter else '!'}{in_spot(one)}" for one in self._known)]
        )
