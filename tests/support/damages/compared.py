"""Verdicts on a damaged recording, held one by one against those on the whole one."""

from collections import defaultdict
from dataclasses import dataclass, field

import rulec
from rulec import DriveVerdict, RequestedDrives, Verdict

SAME_S = 2.0
"""A violation is the same one as another that is decided at most so long before or after it."""

TAKES_S = 5.0
"""So long before it is decided a violation may begin: who came in sight since then keeps the rule.

The books' longest time is that to go back to the kerb, ``time_to_keep_in``.
"""


@dataclass
class Said:
    """What is said of a vehicle by rule: when it is violated (s), and what is not decided.

    ``spans`` are the times of its drives.
    """

    violated: dict = field(default_factory=lambda: defaultdict(list))
    open: set = field(default_factory=set)
    not_judged: set = field(default_factory=set)
    spans: list = field(default_factory=list)

    def outcome(self, rule):
        if rule in self.violated:
            return "violated"
        return "open" if rule in self.open or rule in self.not_judged else "kept"


def said(recording, rules, egos=(), was=None, assumed=None, **thresholds):
    """Vehicle -> what is said of it, by its id in the whole recording."""
    limits = rulec.Thresholds(**thresholds)
    wanted = RequestedDrives(egos=tuple(egos), assumed=assumed or {}, thresholds=limits)
    found = defaultdict(Said)
    for one in rulec.verify_recording(recording, rules, wanted).answers():
        if not isinstance(one, DriveVerdict) or not isinstance(one.answer, Verdict):
            continue
        drive, answer = one.drive, one.answer
        mine = found[(was or {}).get(drive.ego, drive.ego)]
        mine.spans.append((drive.time_s(0), drive.time_s(drive.arrays.n_states - 1)))
        for violation in answer.violations:
            if violation.strength == "hard":
                at = drive.time_s(violation.step)
                mine.violated[violation.rule].append(
                    (at, tuple(_first_id(x, was) for x in violation.binding.values()))
                )
        mine.open |= {x.rule for x in answer.open if x.strength == "hard"}
        mine.not_judged |= {x.rule for x in answer.not_judged if x.strength == "hard"}
    return dict(found)


@dataclass
class Comparison:
    """Rule -> vehicles, by what became of their verdicts.

    Of those who are accused on the damaged recording: ``agreed``, by the whole one, too;
    ``elsewhere``, which accuses them at another time and about others; ``surer``, where it leaves
    that open; ``false``, where it keeps the rule. Of those whom the whole one accuses while they
    drive on the damaged one, too: ``found``, ``open``, and ``acquitted``.
    """

    agreed: dict = field(default_factory=lambda: defaultdict(list))
    elsewhere: dict = field(default_factory=lambda: defaultdict(list))
    surer: dict = field(default_factory=lambda: defaultdict(list))
    false: dict = field(default_factory=lambda: defaultdict(list))
    found: dict = field(default_factory=lambda: defaultdict(list))
    open: dict = field(default_factory=lambda: defaultdict(list))
    acquitted: dict = field(default_factory=lambda: defaultdict(list))

    def add(self, whole, damaged, where=""):
        """Compare what is said of everybody who has drives in both."""
        for ego, now in damaged.items():
            if ego in whole:
                self._add_one(ego, whole[ego], now, where)

    def _add_one(self, ego, then, now, where):
        for rule, times in now.violated.items():
            line = f"{where} {ego} {rule} {times[:2]}"
            before = then.violated.get(rule, ())
            if any(_is_same(one, other) for one in times for other in before):
                self.agreed[rule].append(line)
            elif before:
                self.elsewhere[rule].append(f"{line}, whole {before[:2]}")
            elif then.outcome(rule) == "open":
                self.surer[rule].append(line)
            else:
                self.false[rule].append(line)
        for rule, times in then.violated.items():
            there = [
                one
                for one in times
                if any(a + TAKES_S <= one[0] <= b - SAME_S for a, b in now.spans)
            ]
            if there:
                home = {"violated": self.found, "open": self.open, "kept": self.acquitted}
                home[now.outcome(rule)][rule].append(f"{where} {ego} {rule} {there[:2]}")

    def table(self):
        names = ("agreed", "elsewhere", "surer", "false", "found", "open", "acquitted")
        homes = [getattr(self, name) for name in names]
        yield f"{'rule':28}" + "".join(f"{name:>10}" for name in names)
        sums = [sum(map(len, home.values())) for home in homes]
        for rule in sorted(set().union(*homes)):
            yield f"{rule:28}" + "".join(f"{len(home.get(rule, ())):10}" for home in homes)
        yield f"{'all':28}" + "".join(f"{x:10}" for x in sums)


def _first_id(name, was):
    """An object's id in the whole recording; who comes again has a number behind it."""
    return (was or {}).get(name, name)


def _is_same(one, other):
    """Decided at about the same time, or about the same others, or what goes on for long."""
    (at, about), (then, of) = one, other
    return abs(at - then) <= SAME_S or (about == of and at >= then)
