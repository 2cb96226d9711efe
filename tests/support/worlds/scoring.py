"""Verdicts of rulec on a world's recording, held against what is true there."""

import json
from collections import defaultdict
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from functools import cache
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import rulec
from rulec.cli.main import main
from support.worlds.truths import TRUTHS

SLACK_S = 1.6
"""Speeds are means over a second, and words may be told from the states around."""


SIMULATED_WORLD = [
    part for name in ("wet", "icy", "tunnel") for part in ("--assume", f"{name}=false")
]
"""What no file of the simulator says: its world is dry, and these nets have no tunnels."""


@dataclass(slots=True)
class Score:
    """How often a rule's verdicts were right: each pair of a vehicle and a rule is one.

    ``planted`` are true violations. Of these, and of lawful pairs, an open verdict, or a rule that
    was not judged, is neither right nor wrong; where one cannot tell the truth nothing is.
    """

    planted: int = 0
    found: int = 0
    missed: list = field(default_factory=list)
    false: list = field(default_factory=list)
    open: int = 0
    not_judged: int = 0
    kept: int = 0
    open_where_kept: int = 0
    unsure: int = 0

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
def scored_book(book):
    """The source of a rulebook's overlay with the scored rules alone: the rest takes its time."""
    names = (rule.name for rule in rulec.compile_rulebook(book).rules)
    left_out = (name for name in names if name not in TRUTHS)
    drops = "\n".join(f'drop rule {name} because "there is no truth for it"' for name in left_out)
    return f"rulebook scored\nextends {book}\n{drops}\n"


def answers(data, book, net=None):
    """Vehicle -> what `rulec verify --json` says of it; its drive may be in parts.

    Read from the command's output, which is what users rely on. Raises RuntimeError if it failed.
    """
    out, err = StringIO(), StringIO()
    roads = [] if net is None else ["--net", str(net), *SIMULATED_WORLD]
    with TemporaryDirectory() as folder, redirect_stdout(out), redirect_stderr(err):
        rules = Path(folder) / "scored.rules"
        rules.write_text(scored_book(book), encoding="utf-8")
        status = main(["verify", str(data), "-r", str(rules), *roads, "--json"])
    if status not in (0, 1):
        raise RuntimeError(err.getvalue()[-2000:])
    found = defaultdict(Answer)
    for line in out.getvalue().splitlines():
        verdict = json.loads(line)
        if "trace" not in verdict or "why_not" in verdict:
            continue
        answer = found[verdict["trace"].partition("#")[0]]
        for violation in verdict["violations"]:
            answer.violated[violation["rule"]].append(violation["time_s"])
        answer.open |= _rules(verdict.get("open", ()))
        answer.not_judged |= _rules(verdict.get("not_judged", ()))
    return dict(found)


def _rules(entries):
    return {entry if isinstance(entry, str) else entry["rule"] for entry in entries}


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
    if wrong:
        score.false.append(f"{where} {vehicle} {rule} at {min(wrong):.1f} s")
    if any(fact.sure for fact in facts):
        score.planted += 1
        first = min(fact.begin for fact in facts if fact.sure)
        if len(wrong) < len(times):
            score.found += 1
        elif rule in answer.open:
            score.open += 1
        elif rule in answer.not_judged:
            score.not_judged += 1
        else:
            score.missed.append(f"{where} {vehicle} {rule} at {first:.1f} s")
    elif facts:
        score.unsure += 1
    elif rule in answer.open:
        score.open_where_kept += 1
    elif rule in answer.not_judged:
        score.not_judged += 1
    elif not wrong:
        score.kept += 1


def _during(fact, at):
    return fact.begin - SLACK_S <= at <= fact.end + SLACK_S


def wrong(by_rule, exempt=()):
    """Each false accusation and each missed violation, apart from some rules."""
    for rule, score in by_rule.items():
        if rule not in exempt:
            yield from (f"falsely accused: {line}" for line in score.false)
            yield from (f"missed: {line}" for line in score.missed)


def undecided(by_rule):
    """The rules under which true violations are open, or not judged."""
    return {
        rule for rule, score in by_rule.items() if score.planted > score.found + len(score.missed)
    }


def table(by_kind):
    """Lines of a table: kind of world and rule, and how often verdicts were right."""
    head = "planted", "found", "missed", "false", "open", "unjudged", "kept", "open", "unsure"
    yield f"{'':40}{'violated':>24}{'':24}{'kept':>10}"
    yield f"{'world':18} {'rule':24}" + "".join(f"{name:>9}" for name in head)
    for kind, by_rule in by_kind.items():
        for rule, score in by_rule.items():
            numbers = [getattr(score, name) for name in Score.__slots__]
            numbers = [len(one) if isinstance(one, list) else one for one in numbers]
            planted, found, missed, false, opened, unjudged, kept, open_kept, unsure = numbers
            if planted or false or opened or open_kept:
                row = planted, found, missed, false, opened, unjudged, kept, open_kept, unsure
                yield f"{kind:18} {rule:24}" + "".join(f"{number:9}" for number in row)
