"""Compiled random rulebooks, with what a table and a formula say of a word."""

from dataclasses import replace

import rulec
from rulec.automata.alphabet import letters_with, propositions_of
from rulec.automata.bundle.cut_machines import stored
from rulec.automata.second_compiler import with_automata
from rulec.diagnostics import RulecError
from rulec.logic.bounds import in_steps
from rulec.logic.semantics import holds
from support.generators.worded_rules import worded_rulebook


def compiled_at_random(chance, n_rules=8, most=5):
    """A compiled random rulebook, with machines for traces that are cut."""
    rulebook = rulec.parse_rulebook(worded_rulebook(chance, n_rules, most))
    try:
        compiled = rulec.compile_rulebook(rulebook, step_s=1)
    except RulecError:  # a formula whose automaton is too large
        return compiled_at_random(chance, n_rules, most)
    return with_automata(replace(compiled, prefixes=stored(compiled)))


def verdict(machine, word):
    """What the table of a file's entry says of a word of letters."""
    state = 0
    for letter in word:
        symbol = machine["letters"][letter]
        kept = machine["accepting"][state][symbol]
        state = machine["following"][state][symbol]
    return kept


def meaning(rule, semantics):
    """What a rule's formula says of a word of letters."""
    formula = rule.formula if rule.step_s is None else in_steps(rule.formula, rule.step_s)
    true_in = letters_with(rule.machine.reads, propositions_of(formula))

    def kept(word):
        truths = [{p for p, letters in true_in.items() if letters >> one & 1} for one in word]
        return holds(formula, truths, semantics)

    return kept


def some_words(chance, letters, n_words, longest=9):
    """Words of letters, the shortest ones first."""
    for letter in letters[:20]:
        yield [letter]
    for _ in range(n_words):
        few = [chance.choice(letters) for _ in range(3)]
        yield [chance.choice(few) for _ in range(chance.randint(2, longest))]
