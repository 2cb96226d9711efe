"""A small rulebook with traces, and what has to be said of each, thought out by hand.

Expected is for each trace a list of ``"rule objects @ step"``, without ``@ step`` where only the
end decides; or the code with which it is refused.
"""

from dataclasses import dataclass
from functools import cached_property

from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from support.builders.rulebooks import compile_both_ways
from support.oracles.rulebook_oracle import Refused, Said


@dataclass(frozen=True)
class Case:
    text: str
    traces: tuple[Trace, ...]
    said: tuple[tuple[str, ...] | str, ...]

    @cached_property
    def rulebook(self):
        return parse_rulebook(self.text, "case.rules")

    @cached_property
    def compiled(self):
        return compile_both_ways(self.rulebook)

    @property
    def expected(self):
        strengths = {rule.name: rule.strength for rule in self.rulebook.rules}
        return [
            Refused(frozenset({one}))
            if isinstance(one, str)
            else tuple(sorted(violation(text, strengths) for text in one))
            for one in self.said
        ]


def violation(text, strengths):
    about, _, step = text.partition(" @ ")
    rule, *objects = about.split()
    return Said(rule, tuple(objects), int(step or -1), strengths[rule])


def case(text, *pairs, step_s=1.0):
    """Pairs of what a trace is and what is said of it.

    A trace is a list of states, or of the objects, the states, and who is there when.
    """
    traces = []
    for number, (given, _) in enumerate(pairs):
        objects, states, present = ({}, given, {}) if isinstance(given, list) else (*given, {})[:3]
        traces.append(Trace(f"t{number}", step_s, objects, tuple(states), present))
    return Case(text, tuple(traces), tuple(said for _, said in pairs))


P, Q, NEITHER, BOTH = {"p": True}, {"q": True}, {}, {"p": True, "q": True}
SIGNALS = "signal p, q default false\n"
