"""Engines that judge a word of letters, which the second reading of a trace has given."""

import numpy as np

from rulec.logic.formula import atoms_of
from rulec.logic.semantics import holds
from support.engines.engine import each
from support.oracles.bits import along
from support.oracles.installed_spot import spot
from support.oracles.past_in_spot import in_spot, spot_automaton
from support.oracles.rulebook_oracle import Said, in_steps
from support.oracles.state_oracle import Reading, as_facts_have_it, number


def word_by_word(keeps):
    """An engine that knows words, not traces: the letters are those of the second reading."""

    @each
    def judge_one(rulebook, compiled, trace):
        reading = Reading(rulebook, as_facts_have_it(rulebook, trace))
        found = []
        for rule in compiled.rules:
            formula = in_steps(rule.formula, number(trace.step_s))
            for objects, first, last in reading.choices(rule):
                word = [reading.letter(formula, objects, n) for n in range(first, last + 1)]
                if not keeps(rule, formula, word, rulebook.semantics):
                    found.append(Said(rule.name, tuple(objects.values()), None, rule.strength))
        return tuple(sorted(found))

    return judge_one


def on_bits(rule, formula, word, semantics):
    def column(one):
        return np.array([one in letter for letter in word], dtype=bool)

    return along(formula, len(word), column, semantics)


def direct(rule, formula, word, semantics):
    return holds(formula, word, semantics)


def by_spot(rule, formula, word, semantics):
    alive = "alive" if semantics == "finite" else None
    return meets(spot_automaton(formula, alive=alive), formula, word, alive)


def by_hoa(rule, formula, word, semantics):
    return meets(
        spot.automaton(rule.hoa), formula, word, "alive" if semantics == "finite" else None
    )


def meets(automaton, formula, word, alive):
    """Spot's word automaton meets the automaton. The word decides every proposition."""
    known = list(dict.fromkeys(atoms_of(formula)))
    letters = [
        " & ".join(("" if one in letter else "!") + in_spot(one) for one in known) or "1"
        for letter in word
    ]
    if alive is None:
        text = "; ".join([*letters[:-1], f"cycle{{{letters[-1]}}}"])
    else:
        text = "; ".join([*(f"{one} & {alive}" for one in letters), f"cycle{{!{alive}}}"])
    return spot.parse_word(text).as_automaton().intersects(automaton)
