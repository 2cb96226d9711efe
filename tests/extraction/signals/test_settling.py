"""Values that last too short to be more than noise."""

from itertools import groupby, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.signals import settling
from rulec.extraction.signals.settling import agreeing
from rulec.extraction.signals.signal_columns import (
    Measured,
    SignalColumns,
    column_of,
    unknown_flags,
)
from rulec.extraction.traffic_thresholds import LEAST_S
from rulec.trace.end_to_end import EndToEnd
from rulec.trace.partly_known.partly_known_values import Truth

columns = st.lists(st.sampled_from("abc"), min_size=1, max_size=20)


def without_blips(column, least):
    return settling.without_blips(column, least, EndToEnd.of_one(column.shape[-1]))


def settled(signals, least_s, step_s):
    (values, *_) = (*signals.world.values(), *signals.about.values())
    spans = EndToEnd.of_one(column_of(values).shape[-1])
    return settling.settled(signals, least_s, step_s, spans)


def shown(truth):
    """T for sure, F for surely not, ? for unknown."""
    return "".join(
        "T" if sure else "?" if possible else "F"
        for sure, possible in zip(*np.atleast_1d(truth.sure, truth.possible), strict=True)
    )


def truth_of(text):
    letters = np.array(list(text))
    return Truth(letters == "T", letters != "F")


def after(text, least=3):
    return "".join(without_blips(np.array(list(text)), least).tolist())


def test_a_short_value_between_equal_ones_is_noise():
    assert after("aaabaaa") == "aaaaaaa"
    assert after("aaabbaaa") == "aaaaaaaa"
    assert after("aaabbbaaa") == "aaabbbaaa"
    # Between different ones it is a passage, and at an end nobody knows the other side
    assert after("aaabccc") == "aaabccc"
    assert after("baaaa") == "baaaa"
    assert after("aaaab") == "aaaab"


@pytest.mark.parametrize(
    ("values", "unknown"),
    [
        ([1, 0, 0, 0], "?..."),
        ([1, 1, 0, 0, 0], "??..."),
        ([1, 1, 1, 0, 0, 0], "......"),
        ([0, 0, 0, 1, 1], "...??"),
        ([1, 0, 0, 0, 1, 1], "?...??"),
        # Whatever it is, each lasts too short
        ([1, 1, 0, 0], "????"),
        ([1, 1], ".."),
    ],
)
def test_at_the_ends_of_a_recording_a_short_value_is_not_known(values, unknown):
    column = np.array([values], dtype=bool)
    signals = SignalColumns({"w": Truth.known(column[0])}, {"p": Truth.known(column)})
    found = settled(signals, {"p": 0.3, "w": 0.3}, 0.1)
    for truth in (found.world["w"], found.about["p"]):
        assert "".join("?" if flag else "." for flag in np.ravel(truth.unknown).tolist()) == unknown


@pytest.mark.parametrize(
    ("values", "there", "unknown"),
    [
        # Nothing is said of who is not there, and what stands for that is no neighbour
        ([1, 1, 0, 1, 1, 1], "..tttt", "..?..."),
        ([1, 1, 1, 0, 0, 1], "ttttt.", "...??."),
        ([1, 1, 1, 0, 0, 0], "ttttt.", "...??."),
        ([1, 0, 0, 0, 1, 1], ".ttt..", "......"),
        ([1, 1, 1, 0, 1, 1, 1], "ttttttt", "......."),
    ],
)
def test_where_somebody_comes_or_goes_a_short_value_is_not_known(values, there, unknown):
    column, is_there = np.array([values], dtype=bool), np.array([[x == "t" for x in there]])
    signals, spans = SignalColumns({}, {"p": Truth.known(column)}), EndToEnd.of_one(len(values))
    found = settling.settled(signals, {"p": 0.3}, 0.1, spans, is_there).about["p"]
    told = zip(found.unknown[0].tolist(), there, strict=True)
    assert "".join("?" if flag and x == "t" else "." for flag, x in told) == unknown


def test_flicker_is_settled_by_what_it_began_with():
    assert after("aaababaaa") == "aaaaaaaaa"
    assert after("aaabababbb") == "aaaaaaabbb"


def test_what_is_brief_within_what_is_brief_is_settled_alone():
    assert after("cbabc", least=4) == "cbbbc"


def test_what_is_said_of_one_line_is_settled_alike():
    assert len({LEAST_S[x] for x in ("on_solid_line", "broken_on_own_side", "single_line")}) == 1


@pytest.mark.parametrize(
    ("values", "unknown", "settled_unknown"),
    [
        # What it becomes is as little known as what is beside it on either side
        ([1, 1, 1, 0, 1, 1, 1], "..?....", "..??..."),
        ([1, 1, 1, 0, 1, 1, 1], "....?..", "...??.."),
        ([1, 1, 1, 0, 0, 1, 1, 1], "..?.....", "..???..."),
        ([1, 1, 1, 0, 1, 1, 1], ".?...?.", ".?...?."),
        ([1, 1, 1, 0, 0, 0, 1, 1, 1], "..?...?..", "..?...?.."),
    ],
)
@pytest.mark.parametrize("rows", [1, 2])
def test_what_is_settled_is_no_better_known(values, unknown, settled_unknown, rows):
    codes = np.array([values] * rows)
    flags = np.array([[sign == "?" for sign in unknown]] * rows)
    found = settled(SignalColumns(about={"p": Measured(codes, flags)}), {"p": 0.3}, 0.1)
    for row in unknown_flags(found.about["p"]):
        assert "".join("?" if known else "." for known in row.tolist()) == settled_unknown


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        # What may be otherwise for too short a time is not; what is sure so briefly may be noise
        ("TTT??TTT", "TTTTTTTT"),
        ("FFF??FFF", "FFFFFFFF"),
        ("TTT???TTT", "TTT???TTT"),
        ("FFF?TT?FFF", "FFF????FFF"),
        ("TTTF??FTTT", "TTT????TTT"),
        # At an end nobody knows how long it lasts
        ("TTTTT??", "TTTTT??"),
        ("?TTTFFF", "?TTTFFF"),
    ],
)
def test_truth_that_is_partly_known_is_settled_in_each_completion(given, expected):
    signals = SignalColumns({"w": truth_of(given)})
    assert shown(settled(signals, {"w": 0.3}, 0.1).world["w"]) == expected


@given(st.text("TF?", min_size=1, max_size=9), st.integers(2, 5), st.integers(0, 9))
def test_settled_truth_is_what_all_completions_have_in_common(text, least, border):
    spans = EndToEnd((0, border, len(text)) if 0 < border < len(text) else (0, len(text)))

    def settled_truth(truth):
        found = settling.settled(SignalColumns({"w": truth}), {"w": 0.1 * least}, 0.1, spans)
        return found.world["w"]

    completions = [
        settled_truth(Truth.known(np.array(values)))
        for values in product(*({"T": (True,), "F": (False,)}.get(x, (True, False)) for x in text))
    ]
    sure = np.all([truth.sure for truth in completions], axis=0)
    possible = np.any([truth.possible for truth in completions], axis=0)
    assert shown(settled_truth(truth_of(text))) == shown(Truth(sure, possible))


def test_rows_are_settled_by_themselves():
    rows = np.array([list("aabaa"), list("bbbbb"), list("abbba")])
    found = without_blips(rows, 2)
    assert ["".join(row) for row in found.tolist()] == ["aaaaa", "bbbbb", "abbba"]


@given(columns, st.integers(1, 4))
def test_what_lasts_stays_and_nothing_new_is_said(column, least):
    found = without_blips(np.array(column), least).tolist()
    assert len(found) == len(column)
    at = 0
    for value, run in groupby(column):
        length = len(list(run))
        if length >= least:
            assert found[at : at + length] == [value] * length
        at += length
    assert set(found) <= set(column)


@given(st.lists(st.sampled_from("ab"), min_size=1, max_size=20), st.integers(1, 4))
def test_settling_flags_again_changes_nothing(column, least):
    once = without_blips(np.array(column), least)
    assert without_blips(once, least).tolist() == once.tolist()


def test_durations_are_in_seconds_and_by_word():
    signals = SignalColumns({"brief": truth_of("FFTTFF"), "moment": truth_of("FFTTFF")})
    found = settled(signals, {"brief": 0.3}, 0.1)
    assert shown(found.world["brief"]) == "FFFFFF"
    assert shown(found.world["moment"]) == "FFTTFF"
    # Two steps of 0.2 s are long enough
    assert shown(settled(signals, {"brief": 0.3}, 0.2).world["brief"]) == "FFTTFF"


@pytest.mark.parametrize(
    ("codes", "doubtful", "there", "only"),
    [
        # From behind to beside: when is in doubt, not whether
        ("aabbb", ".??..", "-----", ".??.."),
        # By way of a third code, at once
        ("abbc", ".??.", "----", ".??."),
        # To and fro, and back again
        ("ababb", ".???.", "-----", "....."),
        ("aabaa", ".???.", "-----", "....."),
        # For longer than two states
        ("aabbb", ".???.", "-----", "....."),
        # Nobody knows what was before, or comes then
        ("aabb", "??..", "----", "...."),
        ("aabb", "..??", "----", "...."),
        # Away in between, or when it is sure
        ("aabbb", ".??..", "-- --", "....."),
        ("aabbb", ".??..", " ----", "....."),
    ],
)
def test_a_doubt_between_two_sure_codes_is_about_when(codes, doubtful, there, only):
    rows = [np.array([list(text)]) for text in (codes, doubtful, there)]
    one = EndToEnd.of_one(len(codes))
    (found,) = settling.only_when(rows[0], rows[1] == "?", rows[2] == "-", 2, one)
    assert "".join(".?"[flag] for flag in found.tolist()) == only


@pytest.mark.parametrize(
    ("codes", "doubtful", "there", "found"),
    [
        # Noise goes to and fro between the codes before and after
        ("ababb", ".???.", "-----", "abbbb"),
        ("aababb", ".????.", "------", "aabbbb"),
        ("aabab", ".???.", "-----", "aabbb"),
        # A third code is something else, as is who is back, or away
        ("abcab", ".???.", "-----", "abcab"),
        ("ababa", ".???.", "-----", "ababa"),
        ("ababb", ".???.", "-- --", "ababb"),
        # What is sure stays, and what nobody knows the end of
        ("ababb", ".....", "-----", "ababb"),
        ("ababb", "????.", "-----", "ababb"),
        # Each doubt by itself
        ("ababbcbcc", ".???.???.", "---------", "abbbbcccc"),
    ],
)
def test_who_gets_past_in_noise_does_so_once(codes, doubtful, there, found):
    rows = [np.array([list(text)]) for text in (codes, doubtful, there)]
    one = EndToEnd.of_one(len(codes))
    (row,) = settling.with_one_change(rows[0], rows[1] == "?", rows[2] == "-", one)
    assert "".join(row) == found


def test_what_surely_is_brings_with_it_what_it_implies():
    signals = SignalColumns(
        world={"enters_junction": truth_of("FTF"), "junction_zone": truth_of("FFT")},
        about={"boarding": truth_of("T?F"), "stopped": truth_of("???")},
    )
    found = agreeing(signals)
    assert shown(found.world["junction_zone"]) == "FTT"
    assert shown(found.about["stopped"]) == "T??"


drives = st.lists(st.tuples(st.text("ab", min_size=2, max_size=9)), min_size=1, max_size=4)


@given(drives, st.integers(1, 4), st.randoms())
def test_drives_end_to_end_are_settled_by_themselves(several, least, chance):
    texts = [text for (text,) in several]
    columns = [np.array([[letter == "a" for letter in text]]) for text in texts]
    unknown = [np.array([[chance.random() < 0.2 for _ in text]]) for text in texts]
    bounds = (0, *np.cumsum([len(text) for text in texts]).tolist())

    def words(column, flags):
        return SignalColumns(about={"p": Truth.known(column).unknown_at(flags)})

    whole = words(np.concatenate(columns, axis=1), np.concatenate(unknown, axis=1))
    found = settling.settled(whole, {"p": 0.1 * least}, 0.1, EndToEnd(bounds))
    parts = [
        settled(words(*own), {"p": 0.1 * least}, 0.1) for own in zip(columns, unknown, strict=True)
    ]
    for half in ("sure", "possible"):
        expected = np.concatenate([getattr(part.about["p"], half) for part in parts], axis=1)
        assert getattr(found.about["p"], half).tolist() == expected.tolist()
