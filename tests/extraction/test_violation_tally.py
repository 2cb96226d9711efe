"""The tally of violations over the drives of a recording."""

from collections import Counter

from rulec.diagnostics import Diagnostic, RulecError
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.monitoring.verdict import (
    NotJudged,
    OpenReasons,
    OpenVerdict,
    RuleNotJudged,
    Verdict,
    Violation,
)
from rulec.report.verdicts.violation_tally import ViolationTally
from rulec.trace.trace_arrays import TraceArrays


def drive(name, start_s=0.0, kinds=("speed",)):
    return Drive(name, start_s, TraceArrays(name, 0.5, 4), dict.fromkeys(kinds, float))


def verdict(own, *violations):
    found = [Violation(rule, strength, {}, step) for rule, strength, step in violations]
    return DriveVerdict(own, Verdict(own.arrays.id, tuple(found)))


def tally(*verdicts):
    counted = ViolationTally()
    for each in verdicts:
        counted.add(each, ("fast", "gentle", "late"))
    return counted


def test_drives_are_counted_by_their_verdict():
    counted = tally(
        verdict(drive("1")),
        verdict(drive("2"), ("fast", "hard", 1)),
        # Soft rules do not decide
        verdict(drive("3"), ("gentle", "soft", 1)),
    )
    assert counted.drives == {"satisfied": ["1", "3"], "violated": ["2"]}
    assert counted.judged == 3


def test_the_first_time_of_each_rule_and_drive_counts():
    own = drive("2", start_s=10.0)
    counted = tally(
        verdict(own, ("fast", "hard", 3), ("fast", "hard", 1), ("late", "hard", None)),
        verdict(drive("3"), ("fast", "hard", 0)),
    )
    # Only the end decides `late`: in state 3
    assert counted.first_s == {"fast": {"2": 10.5, "3": 0.0}, "late": {"2": 11.5}}


def test_names_are_those_that_all_drives_supply():
    counted = tally(verdict(drive("1", kinds=("a", "b"))), verdict(drive("2", kinds=("b", "c"))))
    assert counted.words == {"b"}
    assert tally().words is None


def test_drives_without_a_verdict_are_kept_with_the_reason():
    error = RulecError(Diagnostic("R0502", "something is missing"))
    nobody = NoDrive("4", "it is never on a lane in its direction")
    counted = tally(nobody, DriveVerdict(drive("5"), NotJudged("5", error)))
    assert counted.not_judged == [nobody, NoDrive("5", "something is missing")]
    assert counted.judged == 0
    assert counted.words is None


def test_many_violations_about_one_object_are_one_finding():
    parked = Violation("near", "hard", {"v": "7"}, 0)
    other = Violation("near", "hard", {"v": "8"}, 0)
    drives = [DriveVerdict(drive(name), Verdict(name, (parked, other))) for name in ("1", "2")]
    drives.append(DriveVerdict(drive("3"), Verdict("3", (parked, parked))))
    assert tally(*drives).causes == {"near": {("7",): ["1", "2", "3"], ("8",): ["1", "2"]}}


def test_a_rule_that_is_open_or_not_judged_does_not_count_as_judged():
    doubtful = OpenVerdict("late", "hard", {}, ("not told",), ("built_up", "indicator"))
    missing = RuleNotJudged("fast", "hard", ("light",))
    own = drive("1")
    counted = tally(
        DriveVerdict(own, Verdict("1", (), (doubtful,), (missing,))), verdict(drive("2"))
    )
    assert counted.judged_in == {"gentle": 2, "fast": 1, "late": 1}
    assert list(counted.open_rules) == ["late"]
    assert counted.open_on == {"built_up", "indicator"}
    assert list(counted.untold["fast"]) == ["light"]
    assert counted.drives == {"satisfied": ["2"], "open": ["1"]}
    assert counted.open_hard == 1


def test_names_are_counted_without_finding_reasons():
    asked, told = [], []

    def open_on(rule, *names):
        def reasons():
            asked.append(rule)
            return OpenReasons(("not told",), names)

        def beyond(known):
            told.append((rule, set(known)))
            return frozenset(names) - known

        return OpenVerdict.explained_later(rule, "hard", {}, reasons, beyond=beyond)

    open_verdicts = (
        open_on("late", "light"),
        open_on("fast", "light"),
        open_on("gentle", "speed", "light"),
    )
    counted = tally(DriveVerdict(drive("1"), Verdict("1", (), open_verdicts)))
    assert asked == []
    # Of each but for those that are known to be among them
    assert told == [("late", set()), ("fast", {"light"}), ("gentle", {"light"})]
    assert counted.open_on == {"light", "speed"}
    assert list(counted.open_rules) == ["late", "fast", "gentle"]
    # They can be asked for later on
    assert [one.depends_on for one in open_verdicts] == [("light",), ("light",), ("speed", "light")]


def test_tallies_of_parts_have_the_names_of_all():
    counted, later = ViolationTally(), ViolationTally()
    counted.open_on, later.open_on = {"light"}, {"speed"}
    counted.include(later)
    assert counted.open_on == {"light", "speed"}


def test_each_rule_has_one_outcome():
    doubtful = OpenVerdict("torn", "hard", {}, ("not told",), ("light",))
    missing = RuleNotJudged("blind", "hard", ("light",))
    counted, rules = ViolationTally(), ("fast", "gentle", "late", "torn", "blind")
    broken = Violation("fast", "hard", {}, 0)
    one = DriveVerdict(drive("1"), Verdict("1", (broken,), (doubtful,), (missing,)))
    counted.add(one, rules, Counter({"fast": 2, "gentle": 1}))
    assert counted.outcomes(rules) == {
        "fast": "found",
        "gentle": "nothing found",
        "late": "idle",
        "torn": "open",
        "blind": "not judged",
    }
    # In a second drive there was an occasion to break it
    later = ViolationTally()
    later.add(verdict(drive("2")), rules, Counter({"fast": 1, "late": 3, "blind": 1}))
    counted.include(later)
    assert counted.opportunities == Counter({"fast": 3, "gentle": 1, "late": 3, "blind": 1})
    assert counted.outcomes(("gentle", "late")) == {
        "gentle": "nothing found",
        "late": "nothing found",
    }
    # Open in one drive is open, whatever was found in others
    assert counted.outcomes(("torn",)) == {"torn": "open"}


def test_a_rule_is_not_judged_where_only_some_drives_keep_it_whatever_is_not_told():
    rules, missing = ("foggy",), RuleNotJudged("foggy", "hard", ("visibility",))
    kept = DriveVerdict(drive("1"), Verdict("1", (), kept_regardless=("foggy",)))
    asked = DriveVerdict(drive("2"), Verdict("2", (), (), (missing,)))
    counted = ViolationTally()
    counted.add(kept, rules)
    assert counted.outcomes(rules) == {"foggy": "kept regardless"}
    assert counted.with_answer == {"foggy"}
    counted.add(asked, rules)
    assert counted.outcomes(rules) == {"foggy": "not judged"}
    assert counted.with_answer == set()
    # Where a third one tells of fog, it can be found to be violated
    counted.add(verdict(drive("3")), rules)
    assert counted.outcomes(rules) == {"foggy": "nothing found"}
