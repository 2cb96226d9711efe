"""Trams that come from a side, where ego has a sign to give way or to stop.

Each is driven by formulas, so that it is known who cut off whom: the tram has to brake for ego, or
is so far away that it does not.
"""

from functools import cache

import pytest

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.crossroads import STEP_S, crossroads, driven
from support.builders.national_books import read

GIVES_WAY = ("give_way_sign", "stop_sign_give_way", "stop_sign_giving_way", "stop_sign")
OF_TRAMS = (*GIVES_WAY, "rail_priority_at_signs")

SURE = ("de", "at", "ch", "fr", "gb", "jp", "nl", "be", "it", "es", "pl", "au", "au-nsw")
"""Where who has a sign to give way or to stop has to give way to trams, too."""

OPEN = ("us", "us-ca", "us-tx", "us-fl", "us-az", "us-nv", "kr", "cn", "se", "ie", "in")
"""Where trams are no vehicles in the words of the law, or it is not known whether they are."""

USUAL = ("de", "fr", "gb", "jp", "nl", "us", "us-ca", "kr", "ie")
"""The books that are asked without `--long`: laws of all families, on both sides of the road."""


def asked_of(books):
    """The books as parameters."""
    return [x if x in USUAL else pytest.param(x, marks=pytest.mark.long) for x in books]


LEFT = ("gb", "jp", "au", "au-nsw", "ie", "in")


@cache
def scene(sign, who, from_left, offends, side):
    """Ego goes straight on at 9 m/s, or from its line; the other brakes for it, or is far away."""
    stops = [(0, 9.0), (2, 9.0), (5, 0.0), (7, 0.0), (10, 6.0), (14, 9.0)]
    speeds = stops if sign == "STOP" else [(0, 9.0)]
    begins_s = 7.0 if sign == "STOP" else 6.0
    ego = driven("ego", speeds, (begins_s, -11.0), [(0, -1.75)])
    length, kind = (30.0, "train") if who == "tram" else (4.5, "car")
    # Were it not for ego its front would be at ego's lane so soon, half a second after ego
    comes_s, brakes_s = (4.4, 2.5) if sign == "STOP" else (2.2, 0.6)
    at = (begins_s, -8.0 * comes_s - (0.0 if from_left else 3.5) - length / 2)
    brakes = [(0, 8.0), (begins_s + brakes_s, 8.0), (begins_s + brakes_s + 1.2, 3.0)]
    brakes += [(begins_s + brakes_s + 3.7, 8.0)]
    if not offends:
        at, brakes = (begins_s, at[1] - 100.0), [(0, 8.0)]
    turned = -1 if from_left else 1
    other = driven("other", brakes, at, [(0, -1.75)], kind, turned=turned, length=length)
    found = rulec.build_recording(
        crossroads(sign),
        [ego, other],
        step_s=STEP_S,
        side="right",
        complete=("YIELD", "PRIORITY", "STOP", "light", "arrivals", "rail"),
    )
    return mirrored_recording(found) if side == "left" else found


def judged(book, *scene_of):
    """The rules on giving way at signs that ego violated, and those that are open."""
    found = scene(*scene_of, "left" if book in LEFT else "right")
    wanted = RequestedDrives(egos=("ego",))
    (one,) = RecordingVerdicts(found, machines(book), wanted, "by hand").answers()
    rules = {x.rule for x in one.answer.violations}, {x.rule for x in one.answer.open}
    return tuple(found & {*OF_TRAMS} for found in rules)


def asked(book, sign):
    """The rule of a book on giving way at a sign, which may be the one on stopping there."""
    rules = {rule.name for rule in read(book).rulebook.rules}
    if sign == "YIELD":
        return {"give_way_sign"}
    return (rules & {*GIVES_WAY[1:3]}) or {"stop_sign"}


SCENES = pytest.mark.parametrize(("sign", "from_left"), [("YIELD", False), ("STOP", True)])


@SCENES
@pytest.mark.parametrize("book", asked_of(SURE))
def test_who_cuts_off_a_tram_at_a_sign_violates(book, sign, from_left):
    violated, _ = judged(book, sign, "tram", from_left, True)
    by_trams = {"rail_priority_at_signs"} & {x.name for x in read(book).rulebook.rules}
    assert violated == (by_trams or asked(book, sign))


@SCENES
@pytest.mark.parametrize("book", asked_of(OPEN))
def test_where_trams_may_be_no_vehicles_it_is_open(book, sign, from_left):
    assert judged(book, sign, "tram", from_left, True) == (set(), asked(book, sign))


@SCENES
@pytest.mark.parametrize("book", ["de", "us", "jp"])
def test_a_tram_that_is_far_away_is_not_cut_off(book, sign, from_left):
    assert judged(book, sign, "tram", from_left, False) == (set(), set())


@SCENES
@pytest.mark.parametrize("book", ["de", "us", "jp"])
def test_of_cars_the_books_say_what_they_said(book, sign, from_left):
    assert judged(book, sign, "car", from_left, True) == (asked(book, sign), set())
    assert judged(book, sign, "car", from_left, False) == (set(), set())
