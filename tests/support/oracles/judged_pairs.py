"""How many of the rules that recorded drives are judged by, maneuvers are judged by, too.

A pair is a recording and a rule that `verify` keeps or violates for sure in some drive in which the
rule's trigger is met. It is judged in maneuvers if half of them or more keep or violate the rule
for sure, and one may meet its trigger. From the folder of the tests:

    RULEC_RECORDINGS=FOLDER python -m support.oracles.judged_pairs de [fr …]
"""

import random
import sys
from collections import Counter
from dataclasses import dataclass
from itertools import islice

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.monitoring.moments.drive_facts import facts_of
from rulec.monitoring.verdict import Verdict
from rulec.planning.ranking.cheapest import cheapest
from rulec.trace.plain_unknowns import with_plain_unknowns
from rulec.trace.trace_model import trace_of
from support.builders.recorded_data import RECORDINGS

_RANDOM, _CHEAPEST = 40, 10


@dataclass(frozen=True)
class JudgedPairs:
    """The rules that are judged in a recording's drives, and which of them in its maneuvers."""

    file: str
    in_drives: frozenset[str]
    judged: frozenset[str]
    may_be_met: frozenset[str]
    met: frozenset[str]

    @property
    def in_maneuvers(self):
        return self.in_drives & self.judged & self.may_be_met


def judged_pairs(file, rules):
    """The pairs of a recording; none are judged in maneuvers where there is no scene."""
    drives = _in_drives(file, rules)
    try:
        found = rulec.find_maneuvers(file, rules)
    except rulec.RulecError:
        return JudgedPairs(file.stem, drives, *[frozenset()] * 3)
    judged = {one.rule.name for one in found.rule_outcomes() if one.judged}
    met, may_be_met = _met(found)
    return JudgedPairs(file.stem, drives, frozenset(judged), may_be_met, met)


def _in_drives(file, rules):
    names = set()
    verdicts = rulec.verify_recording(file, rules)
    for answer in verdicts.answers():
        if isinstance(answer, DriveVerdict) and isinstance(answer.answer, Verdict):
            verdict = answer.answer
            left_out = {one.rule for one in (*verdict.not_judged, *verdict.open)}
            exposed = facts_of(answer.drive.arrays, verdicts.rules, verdict).exposure
            names |= {name for name, own in exposed.items() if own.opportunities} - left_out
    return frozenset(names)


def _met(found):
    """The rules whose trigger some maneuver meets for sure, and those of which one may."""
    surely, perhaps = set(), set()
    paths = list(random_paths(found.paths, _RANDOM, random.Random(1))) if found.traces else []
    paths += [one.nodes for one in islice(cheapest(found.possible), _CHEAPEST)]
    for nodes in paths:
        trace = with_plain_unknowns(trace_of(found.paths, nodes, ""))
        exposed = facts_of(trace, found.rules, Verdict("", ())).exposure
        for name, own in exposed.items():
            surely |= {name} if own.opportunities else set()
            perhaps |= {name} if own.perhaps_opportunities else set()
    return frozenset(surely), frozenset(perhaps)


def random_paths(graph, number, chance):
    """Paths from the start to a goal, each step chosen among those that lead there."""
    alive = [set(graph.goals)]
    for rows in reversed(graph.successors):
        alive.append({i for i, row in enumerate(rows) if not alive[-1].isdisjoint(row)})
    alive.reverse()
    for _ in range(number):
        path = [graph.start]
        for rows, there in zip(graph.successors, alive[1:], strict=True):
            path.append(chance.choice([j for j in rows[path[-1]] if j in there]))
        yield tuple(path)


def main(books):
    for book in books:
        rules, total, missing = machines(book), Counter(), Counter()
        for file in sorted(RECORDINGS.glob("*.xml")):
            pairs = judged_pairs(file, rules)
            row = {
                "in drives": len(pairs.in_drives),
                "half judged": len(pairs.in_drives & pairs.judged),
                "and may be met": len(pairs.in_maneuvers),
                "and met for sure": len(pairs.in_maneuvers & pairs.met),
            }
            total.update(row)
            missing.update(pairs.in_drives - pairs.in_maneuvers)
            _say(f"{book:8} {pairs.file:36}", *row.values())
        _say(book, dict(total), f"{total['and may be met'] / total['in drives']:.1%}")
        _say(book, "not judged:", dict(missing.most_common()))


def _say(*parts):
    sys.stdout.write(" ".join(map(str, parts)) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:] or ["de"])
