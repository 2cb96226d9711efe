"""Judges words by HOA files, with hoa-utils alone. Runs in an environment of its own.

Standard input: JSON lines {"hoa": text, "words": [[[true atoms], …], …]}; standard output: for each
a JSON list of verdicts, the last letter of a word going on for ever.
"""

import json
import sys

from hoa.ast.acceptance import AcceptanceAtom, AtomType
from hoa.ast.boolean_expression import BinaryOp, FalseFormula, TrueFormula, UnaryOp
from hoa.ast.label import LabelAtom
from hoa.parsers import HOAParser


def holds(label, letter, propositions):
    if isinstance(label, LabelAtom):
        return propositions[label.proposition] in letter
    if isinstance(label, TrueFormula):
        return True
    if isinstance(label, FalseFormula):
        return False
    if isinstance(label, UnaryOp):
        return not holds(label.argument, letter, propositions)
    assert isinstance(label, BinaryOp)
    both = [holds(operand, letter, propositions) for operand in label.operands]
    return all(both) if label.SYMBOL == "&" else any(both)


def accepting(condition, seen):
    if isinstance(condition, AcceptanceAtom):
        met = condition.acceptance_set in seen
        return met if condition.atom_type == AtomType.INFINITE else not met
    if isinstance(condition, TrueFormula):
        return True
    if isinstance(condition, FalseFormula):
        return False
    both = [accepting(operand, seen) for operand in condition.operands]
    return all(both) if condition.SYMBOL == "&" else any(both)


def accepts(automaton, word):
    header = automaton.header
    (start,) = header.start_states
    (state,) = start
    edges = {state.index: (state, out) for state, out in automaton.body.state2edges.items()}

    def step(state, letter):
        source, out = edges[state]
        (edge,) = [e for e in out if e.label is None or holds(e.label, letter, header.propositions)]
        (target,) = edge.state_conj
        return target, set(edge.acc_sig or ()) | set(source.acc_sig or ())

    for letter in word:
        state, _ = step(state, letter)
    visited = {}
    while state not in visited:
        visited[state] = step(state, word[-1])
        state, _ = visited[state]
    seen, here = set(), state
    while True:
        here, marks = visited[here]
        seen |= marks
        if here == state:
            return accepting(header.acceptance.condition, seen)


for line in sys.stdin:
    job = json.loads(line)
    automaton = HOAParser()(job["hoa"])
    print(json.dumps([accepts(automaton, [set(letter) for letter in w]) for w in job["words"]]))
