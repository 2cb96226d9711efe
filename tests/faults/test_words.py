"""A word's computation raises: all rules that do not read it are judged as without the fault."""

import pytest

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.diagnostics.fault_messages import FAULT
from rulec.extraction.signals.settling import _IMPLIED
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.traces.to_trace import _WORDS
from rulec.logic.free_names import names_of
from rulec.monitoring.told_names import names_behind
from support.defined_words import LEFT_TO_DEFINITIONS

GERMAN = machines("de")
RECORDING = rulec.read_recording("docs/samples/following.xml")
PASSES = list(_WORDS._definitions)
QUICK = 12
"""Every so many passes are tried in the quick profile."""


def planted(monkeypatch, words, raises=lambda context: True):
    """Signals of which the function for some words raises."""
    computed = _WORDS._definitions[words]

    def broken(context):
        if raises(context):
            raise KeyError("planted")
        return computed(context)

    monkeypatch.setitem(_WORDS._definitions, words, broken)
    monkeypatch.setattr(_WORDS, "_read", {})


def judged(recording=RECORDING, wanted=None):
    return list(rulec.verify_recording(recording, GERMAN, wanted))


WITHOUT = judged()


def said(verdict, but=frozenset()):
    """What a verdict says, but for some rules."""
    found = (*verdict.violations, *verdict.open, *verdict.not_judged)
    return [own for own in found if own.rule not in but]


def lost_in(verdict):
    return {rule.rule for rule in verdict.not_judged if rule.by_fault}


def reading(words):
    """The rules that read some words, or others that these imply."""
    words = {*words, *(name for name, own in _IMPLIED.items() if not {*own}.isdisjoint(words))}
    defined = [word for word in GERMAN.vocabulary.meanings if word in LEFT_TO_DEFINITIONS]
    read = {
        rule.name: names_behind(names_of(rule.formula), GERMAN.vocabulary, defined)
        for rule in GERMAN.rules
    }
    return {rule for rule, names in read.items() if not words.isdisjoint(names)}


def check_only_its_rules_are_lost(monkeypatch, words):
    planted(monkeypatch, words)
    for before, after in zip(WITHOUT, judged(), strict=True):
        lost = lost_in(after.answer)
        assert lost <= reading(words)
        assert said(after.answer, lost) == said(before.answer, lost)
        assert bool(lost) <= bool(after.answer.faults)
        assert {x.rule for x in said(before.answer) if x.rule in reading(words)} <= {
            *lost,
            *(x.rule for x in said(after.answer)),
        }


@pytest.mark.parametrize("words", PASSES[::QUICK], ids=lambda words: words[0])
def test_rules_that_do_not_read_it_are_judged(monkeypatch, words):
    check_only_its_rules_are_lost(monkeypatch, words)


@pytest.mark.long
@pytest.mark.parametrize("words", PASSES, ids=lambda words: words[0])
def test_each_word_in_turn(monkeypatch, words):
    check_only_its_rules_are_lost(monkeypatch, words)


LANE_CHANGE = next(words for words in PASSES if "lane_change" in words)


def has_ego(name):
    return lambda context: name in [body.id for body in context.ego.participants]


def test_it_costs_the_drive_in_which_it_raises(monkeypatch):
    planted(monkeypatch, LANE_CHANGE, has_ego("1"))
    for before, after in zip(WITHOUT, judged(), strict=True):
        is_its = after.drive.ego == "1"
        assert lost_in(after.answer) == (reading(LANE_CHANGE) if is_its else set())
        assert bool(after.answer.faults) == is_its
        if not is_its:
            assert after.answer == before.answer
    (fault,) = after_faults(judged())
    assert fault.code == FAULT.code
    assert "`lane_change` in the drive of `1`" in fault.message
    assert "KeyError 'planted'" in fault.message
    assert "words.py" in fault.message


def after_faults(answers):
    return [
        diagnostic
        for answer in answers
        for fault in answer.answer.faults
        for diagnostic in fault.diagnostics
    ]


def test_what_raises_only_for_several_drives_costs_nothing_and_is_said(monkeypatch):
    planted(monkeypatch, LANE_CHANGE, lambda context: context.spans.n_drives > 1)
    after = judged()
    assert [own.answer for own in after] == [own.answer for own in WITHOUT]
    assert len({fault.message for fault in after_faults(after)}) == 1


def test_a_lost_word_does_not_take_its_default(monkeypatch):
    planted(monkeypatch, next(words for words in PASSES if "ego_on_call" in words))
    for wanted in (None, rulec.RequestedDrives(defaults=True)):
        for own in judged(wanted=wanted):
            assert lost_in(own.answer) == reading(["ego_on_call"])


def test_a_word_that_is_assumed_is_not_lost(monkeypatch):
    planted(monkeypatch, next(words for words in PASSES if "ego_on_call" in words))
    wanted = rulec.RequestedDrives(assumed={"ego_on_call": False})
    assert not any(lost_in(own.answer) for own in judged(wanted=wanted))


def test_a_drive_whose_way_cannot_be_found_costs_itself(monkeypatch):
    found = rulec.extraction.drives.Drives.stretches

    def broken(self, row):
        if self._tracks.participants[row].id == "1":
            raise IndexError("planted")
        return found(self, row)

    monkeypatch.setattr("rulec.extraction.drives.Drives.stretches", broken)
    after = judged()
    (lost,) = [own for own in after if isinstance(own, NoDrive)]
    assert lost.ego == "1"
    assert "IndexError planted" in lost.why
    others = [own for own in WITHOUT if own.drive.ego != "1"]
    kept = [own.answer for own in after if not isinstance(own, NoDrive)]
    assert kept == [own.answer for own in others]


def test_maneuvers_are_counted_without_the_rules_that_read_it(monkeypatch):
    scene = rulec.load_scenario("docs/samples/following.xml", rulec.Choice(ego="1"))
    before = rulec.find_maneuvers(scene, GERMAN)
    planted(monkeypatch, LANE_CHANGE)
    after = rulec.find_maneuvers(scene, GERMAN)
    lost = {rule.rule for rule in after.not_judged if rule.by_fault}
    assert lost == reading(LANE_CHANGE)
    kept = [rule for rule in before.not_judged if rule.rule not in lost]
    assert [rule for rule in after.not_judged if not rule.by_fault] == kept
