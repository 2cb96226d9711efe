"""Values that last too short to be more than noise."""

from itertools import groupby

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.signals import settling
from rulec.extraction.signals.settling import agreeing
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.traffic_thresholds import LEAST_S
from rulec.trace.end_to_end import EndToEnd

columns = st.lists(st.sampled_from("abc"), min_size=1, max_size=20)


def without_blips(column, least):
    return settling.without_blips(column, least, EndToEnd.of_one(column.shape[-1]))


def settled(signals, least_s, step_s):
    (column, *_) = (*signals.world.values(), *signals.about.values())
    return settling.settled(signals, least_s, step_s, EndToEnd.of_one(column.shape[-1]))


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
    found = settled(SignalColumns({"w": column[0]}, {"p": column}), {"p": 0.3, "w": 0.3}, 0.1)
    for name in ("p", "w"):
        flags = found.unknown.get(name, np.zeros(len(values), dtype=bool))
        assert "".join("?" if flag else "." for flag in np.ravel(flags).tolist()) == unknown


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
    signals, spans = SignalColumns({}, {"p": column}), EndToEnd.of_one(len(values))
    found = settling.settled(signals, {"p": 0.3}, 0.1, spans, is_there)
    flags = found.unknown.get("p", np.zeros((1, len(values)), dtype=bool))
    shown = zip(flags[0].tolist(), there, strict=True)
    assert "".join("?" if flag and x == "t" else "." for flag, x in shown) == unknown
    kept = [k for k, x in enumerate(there) if x == "t" and unknown[k] == "?"]
    assert found.about["p"][0, kept].tolist() == column[0, kept].tolist()


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
    column = np.array([values] * rows, dtype=bool)
    flags = np.array([[sign == "?" for sign in unknown]] * rows)
    found = settled(SignalColumns(about={"p": column}, unknown={"p": flags}), {"p": 0.3}, 0.1)
    for row in found.unknown["p"]:
        assert "".join("?" if known else "." for known in row.tolist()) == settled_unknown


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
    flags = np.array([False, False, True, True, False, False])
    signals = SignalColumns({"brief": flags, "moment": flags})
    found = settled(signals, {"brief": 0.3}, 0.1)
    assert not found.world["brief"].any()
    assert found.world["moment"].tolist() == flags.tolist()
    # Two steps of 0.2 s are long enough
    assert settled(signals, {"brief": 0.3}, 0.2).world["brief"].tolist() == flags.tolist()


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
    rows = np.array([[True, True, False], [False, False, False]])
    signals = SignalColumns(
        world={
            "enters_junction": np.array([False, True, False]),
            "junction_zone": np.array([False, False, True]),
        },
        about={"boarding": rows, "stopped": np.zeros((2, 3), dtype=bool)},
        unknown={
            "boarding": np.array([[False, True, False], [False, False, False]]),
            "stopped": np.ones((2, 3), dtype=bool),
        },
    )
    found = agreeing(signals)
    assert found.world["junction_zone"].tolist() == [False, True, True]
    assert found.about["stopped"].tolist() == [[True, False, False], [False, False, False]]
    assert found.unknown["stopped"].tolist() == [[False, True, True], [True, True, True]]


drives = st.lists(st.tuples(st.text("ab", min_size=2, max_size=9)), min_size=1, max_size=4)


@given(drives, st.integers(1, 4), st.randoms())
def test_drives_end_to_end_are_settled_by_themselves(several, least, chance):
    texts = [text for (text,) in several]
    columns = [np.array([[letter == "a" for letter in text]]) for text in texts]
    unknown = [np.array([[chance.random() < 0.2 for _ in text]]) for text in texts]
    bounds = (0, *np.cumsum([len(text) for text in texts]).tolist())

    def words(column, flags):
        return SignalColumns(about={"p": column}, unknown={"p": flags})

    whole = words(np.concatenate(columns, axis=1), np.concatenate(unknown, axis=1))
    found = settling.settled(whole, {"p": 0.1 * least}, 0.1, EndToEnd(bounds))
    parts = [
        settled(words(*own), {"p": 0.1 * least}, 0.1) for own in zip(columns, unknown, strict=True)
    ]
    for kind in ("about", "unknown"):
        expected = np.concatenate([getattr(part, kind)["p"] for part in parts], axis=1)
        assert getattr(found, kind)["p"].tolist() == expected.tolist()
