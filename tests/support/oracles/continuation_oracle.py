"""Whether a word can still be gone on with so that a formula holds, decided by Spot.

Spot's automaton is not the compiler's: it has no registers, and a past that is guessed.
"""

from bisect import bisect_left
from functools import cached_property

from rulec.logic.formula import atoms_of
from support.oracles.installed_spot import spot
from support.oracles.past_in_spot import in_spot, spot_automaton


class Hope:
    """For words of the letters that are possible; they end as ``semantics`` says.

    A letter is the set of the formula's propositions that are true in it.
    """

    def __init__(self, formula, semantics, letters):
        self._formula, self._letters = formula, list(letters)
        self._known = list(dict.fromkeys(atoms_of(formula)))
        self._alive = "alive" if semantics == "finite" else None

    def first_lost(self, word):
        """The index of the first letter after which nothing helps; None if there is hope still."""
        if self._can_be_saved(word):
            return None
        # What is lost stays so.
        return bisect_left(
            range(len(word)), True, key=lambda n: not self._can_be_saved(word[: n + 1])
        )

    def _can_be_saved(self, word):
        names = [in_spot(one) for one in self._known]
        said = "; ".join(self._said(letter, names, self._alive) for letter in word)
        return spot.parse_word(f"{said}; cycle{{1}}").as_automaton().intersects(self._keeping)

    @cached_property
    def _keeping(self):
        """The words that keep the formula, and that there can be."""
        kept = spot_automaton(self._formula, alive=self._alive)
        return spot.product(kept, spot.automaton(self._words()))

    def _words(self):
        """All words of possible letters, in HOA: they go on with one letter, or are over."""
        numbers = range(len(self._known))
        end = None if self._alive is None else len(self._known)
        named = [*self._known, *([] if self._alive is None else [self._alive])]
        names = [f'"{one}"' for one in named]
        letters = [self._said(letter, numbers, end) for letter in self._letters]
        lasts = [f"!{end}"] if self._alive else letters
        lines = ["HOA: v1", "Start: 0", f"AP: {len(names)} {' '.join(names)}"]
        lines += ["Acceptance: 1 Inf(0)", "--BODY--", "State: 0"]
        lines += [f"[{letter}] 0" for letter in letters]
        lines += [f"[{letter}] {n}" for n, letter in enumerate(lasts, 1)]
        for n, letter in enumerate(lasts, 1):
            lines += [f"State: {n} {{0}}", f"[{letter}] {n}"]
        return "\n".join([*lines, "--END--", ""])

    def _said(self, letter, names, alive):
        """A letter, in which a word goes on as long as it is ``alive``."""
        literals = [
            f"{'' if one in letter else '!'}{name}"
            for one, name in zip(self._known, names, strict=True)
        ]
        literals += [] if alive is None else [str(alive)]
        return " & ".join(literals) or ("1" if isinstance(names, list) else "t")
