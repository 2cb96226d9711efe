"""Verdicts of rulec on a world's recording, held against what is true there."""

from collections import defaultdict
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import rulec
from rulec import DriveVerdict, RequestedDrives, Verdict
from support.worlds.truths import TRUTHS

SLACK_S = 1.6
"""Speeds are means over a second, and words may be told from the states around."""


MOST_OPEN = 0.1
"""The largest share of open verdicts where the source tells what a rule reads."""

SIMULATED_WORLD = {"wet": False, "icy": False, "tunnel": False}
"""What no file of the simulator says: its world is dry, and these nets have no tunnels."""


@dataclass(slots=True)
class Score:
    """How often a rule's verdicts were right: each pair of a vehicle and a rule is one.

    ``planted`` are true violations; one that is found counts, whether or not it is the only one,
    one that is ``open``, or not judged, is neither found nor missed. ``kept`` are lawful pairs with
    that verdict. ``told`` are pairs whose words the source tells, ``undecided`` those of them that
    are open, whatever is true, which may be ``unsure``.
    """

    planted: int = 0
    found: int = 0
    missed: list = field(default_factory=list)
    false: list = field(default_factory=list)
    open: list = field(default_factory=list)
    kept: int = 0
    unsure: int = 0
    told: int = 0
    undecided: list = field(default_factory=list)

    def add(self, other):
        for name in self.__slots__:
            setattr(self, name, getattr(self, name) + getattr(other, name))


@dataclass(slots=True)
class Answer:
    """What was said of one vehicle: rule -> when it was violated (s), and what is not decided."""

    violated: dict = field(default_factory=lambda: defaultdict(list))
    open: set = field(default_factory=set)
    not_judged: set = field(default_factory=set)


def true_facts(world):
    """Facts in a world under all rules of its rulebook that there is a truth for."""
    return [fact for rule in scored_rules(world.book) for fact in TRUTHS[rule](world)]


@cache
def scored_rules(book):
    """The rules of a rulebook that there is a truth for."""
    known = {rule.name for rule in rulec.compile_rulebook(book).rules}
    return tuple(sorted(TRUTHS.keys() & known))


@cache
def _scored_machines(book):
    """A rulebook's overlay with the scored rules alone: the rest takes its time."""
    names = (rule.name for rule in rulec.compile_rulebook(book).rules)
    left_out = (name for name in names if name not in TRUTHS)
    drops = "\n".join(f'drop rule {name} because "there is no truth for it"' for name in left_out)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "scored.rules"
        file.write_text(f"rulebook scored\nextends {book}\n{drops}\n", encoding="utf-8")
        return rulec.compile_rulebook(file)


def answers(data, book, net=None):
    """Vehicle -> what is said of it; its drive may be in parts. Raises RulecError."""
    wanted = RequestedDrives(assumed={} if net is None else SIMULATED_WORLD)
    verdicts = rulec.verify_recording(data, _scored_machines(book), wanted, net)
    found = defaultdict(Answer)
    for one in verdicts.answers():
        if isinstance(one, DriveVerdict) and isinstance(one.answer, Verdict):
            answer = found[one.drive.trace.id.partition("#")[0]]
            for violation in one.answer.violations:
                at = one.drive.time_s(violation.step)
                answer.violated[violation.rule].append(at)
            answer.open |= {result.rule for result in one.answer.open}
            answer.not_judged |= {result.rule for result in one.answer.not_judged}
    return dict(found)


def scores(facts, found, book, where=""):
    """Rule -> its score; ``where`` is said of each verdict that is wrong."""
    by_pair = defaultdict(list)
    for fact in facts:
        by_pair[fact.vehicle, fact.rule].append(fact)
    result = {}
    for rule in scored_rules(book):
        score = result[rule] = Score()
        for vehicle, answer in found.items():
            _add(score, by_pair[vehicle, rule], answer, (where, vehicle, rule))
    return result


def _add(score, facts, answer, name):
    where, vehicle, rule = name
    times = answer.violated.get(rule, [])
    wrong = [at for at in times if not any(_during(fact, at) for fact in facts)]
    is_open, told = rule in answer.open, rule not in answer.not_judged
    score.told += told
    if is_open:
        score.undecided.append(f"{where} {vehicle} {rule}")
    if wrong:
        score.false.append(f"{where} {vehicle} {rule} at {min(wrong):.1f} s")
    if any(fact.sure for fact in facts):
        first = min(fact.begin for fact in facts if fact.sure)
        line = f"{where} {vehicle} {rule} at {first:.1f} s"
        score.planted += 1
        if len(wrong) < len(times):
            score.found += 1
        elif is_open or not told:
            score.open.append(line)
        else:
            score.missed.append(line)
    elif facts:
        score.unsure += 1
    elif told and not is_open and not wrong:
        score.kept += 1


def _during(fact, at):
    return fact.begin - SLACK_S <= at <= fact.end + SLACK_S


def wrong(by_rule, exempt=()):
    """Each false accusation and each missed violation, apart from some rules."""
    for rule, score in by_rule.items():
        if rule not in exempt:
            yield from (f"falsely accused: {line}" for line in score.false)
            yield from (f"missed: {line}" for line in score.missed)


def with_open(by_rule):
    """The rules under which true violations are open, or not judged."""
    return {rule for rule, score in by_rule.items() if score.open}


def open_share(by_rule):
    """Of the pairs whose words the source tells, the share that is open."""
    told = sum(score.told for score in by_rule.values())
    return sum(len(score.undecided) for score in by_rule.values()) / max(told, 1)


_HEAD = "planted", "found", "missed", "false", "open", "kept", "unsure", "told", "undecided"


def table(by_kind):
    """Lines of a table: kind of world and rule, and how often verdicts were right."""
    yield f"{'world':18} {'rule':24}" + "".join(f"{name:>10}" for name in _HEAD)
    whole = {}
    for kind, by_rule in by_kind.items():
        for rule, score in by_rule.items():
            whole.setdefault(rule, Score()).add(score)
            if score.planted or score.false or score.undecided:
                yield _row(kind, rule, score)
    if len(by_kind) > 1:
        yield from (_row("all", rule, score) for rule, score in whole.items())
    yield f"open: {open_share(whole):.1%} of what the source tells"


def _row(kind, rule, score):
    numbers = (getattr(score, name) for name in _HEAD)
    cells = (len(one) if isinstance(one, list) else one for one in numbers)
    return f"{kind:18} {rule:24}" + "".join(f"{cell:10}" for cell in cells)
