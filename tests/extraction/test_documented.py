"""docs/recordings.md has every threshold with its value, docs/recorded_words.md every word."""

import re
from dataclasses import fields
from pathlib import Path

from rulec.extraction.drives import Drives
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.signals import ego_signals
from rulec.extraction.signals.map import lanes_ahead, line_signals, map_signals
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.extraction.traffic_thresholds import LEAST_S, USUAL
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.trace.vocabulary_projection import RECORDED_UNITS, UNTOLD_VALUES
from rulec.vocabulary import Quantity
from support.builders.drive_contexts import context_of
from support.builders.recordings import recording, straight, vehicle
from support.defined_words import LEFT_TO_DEFINITIONS
from support.signal_arrays import bounded
from support.words import words_of

DOCS = Path(__file__).parents[2] / "docs"
EXTRACTION = Path(__file__).parents[2] / "src" / "rulec" / "extraction"
PAGE = (DOCS / "recordings.md").read_text()
DEFINITIONS, WRONG = (
    (DOCS / "recorded_words.md").read_text().split("## What each word may get wrong")
)

SIGNALS = (
    words_of(ego_signals),
    words_of(participant_signals, participant_conduct, lanes_ahead, following_signals),
    words_of(following_signals),
    words_of(map_signals),
    words_of(line_signals),
)
"""The passes that measure numbers."""

NOT_IN_THAT = {
    *("light", "crosses_light_line", "indicator", "warning_lights", "hazard_lights"),
    *("marked_lanes", "on_solid_line", "broken_on_own_side", "single_line"),
    *("one_way", "divided", "lane_kind", "tunnel", "tracks_at_kerb"),
    *("on_priority_road", "turn_on_red_sign", "no_turn_on_red_sign"),
    *("level_crossing_zone", "enters_level_crossing", "guarded", "past_level_crossing_sign"),
    *("wet", "icy", "visibility", "raining", "night", "told_to_stop", "told_to_go"),
    *("headlamps", "front_fog_lamps", "rear_fog_lamps"),
}
"""Words of marks, signs, lamps, rails and weather, which the recording below has not."""


def test_every_threshold_with_its_value():
    rows = re.findall(r"^\| `(\w+)` \| ([0-9.]+) \|", PAGE, re.MULTILINE)
    assert rows == [(x.name, f"{getattr(USUAL, x.name):g}") for x in fields(USUAL)]


def test_every_word():
    cells = [line.split("|")[1] for line in DEFINITIONS.splitlines() if line.startswith("| `")]
    documented = {word for cell in cells for word in re.findall(r"`(\w+)`", cell)}
    lane = straight(1, 0, 99, signs=frozenset({"STOP", "YIELD", "NO_OVERTAKING_START"}))
    limits = {"limit_mps": 9.0, "minimum_mps": 5.0}
    lane = straight(1, 0, 99, signs=lane.signs, types=frozenset({"highway"}), **limits)
    found = recording([lane], [vehicle(1, {0: (9, 0), 1: (19, 0)})])
    (drive,) = Drives(found, "right").of("1")
    assert drive.words | NOT_IN_THAT | LEFT_TO_DEFINITIONS == documented
    assert LEFT_TO_DEFINITIONS.isdisjoint(drive.words)


def test_every_value_that_no_format_has():
    (line,) = re.findall(r"^No source tells .*?judged\.", DEFINITIONS, re.MULTILINE | re.DOTALL)
    documented = re.findall(r"`(\w+)`", line.partition("; nor of ")[2])
    names = UNTOLD_VALUES.keys()
    values = [word for word in documented if word not in names]
    assert sorted(values) == sorted(x for own in UNTOLD_VALUES.values() for x in own)
    declarations = load_rulebook("de").vocabulary.declarations
    assert all(own < {*declarations[name].values} for name, own in UNTOLD_VALUES.items())
    code = "".join(file.read_text() for file in EXTRACTION.rglob("*.py"))
    assert [value for value in values if f'"{value}"' in code] == []


def test_every_word_is_told_by_the_formats_that_the_page_says():
    told = {"commonroad": set(), "sumo": set()}
    needs = ""
    for line in DEFINITIONS.splitlines():
        if line.startswith("| `"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            needs = needs if cells[2:] == ["the same"] else "".join(cells[2:])
            words = set(re.findall(r"`(\w+)`", cells[0]))
            # Lamps that neither of the two has
            words -= words if "(OSI)" in needs else set()
            if "(SUMO)" not in needs and not re.match("SUMO(?!, or)", needs):
                told["commonroad"] |= words
            if "(CommonRoad)" not in needs:
                told["sumo"] |= words
    assert told == {name: TELLABLE_WORDS[name] for name in told}


def rows_of_what_may_be_wrong():
    """The words of each row, and its other cells."""
    for line in WRONG.splitlines():
        if line.startswith("| `"):
            words, *cells = (cell.strip() for cell in line.strip("|").split("|"))
            yield re.findall(r"`(\w+)`", words), cells


def test_every_word_has_its_tolerance_its_duration_and_what_may_be_wrong():
    rows = list(rows_of_what_may_be_wrong())
    words = [word for own, _ in rows for word in own]
    assert sorted(words) == sorted(set().union(*TELLABLE_WORDS.values()))
    for own, (tolerance, duration, wrong) in rows:
        assert tolerance in ("none", "unknown", "interval"), own
        assert wrong, own
        least = {LEAST_S.get(word) for word in own}
        assert least == {None if duration == "none" else float(duration.removesuffix(" s"))}


def test_numbers_that_are_intervals_are_those_that_the_page_says():
    cars = [vehicle(k, {s: (9.0 + 11 * k + 5 * s, 0) for s in range(4)}) for k in (7, 8)]
    context = context_of(recording([straight(1, 0, 99, signs=frozenset({"STOP"}))], cars))
    told = {name for signals_of in SIGNALS for name in bounded(signals_of(context))}
    rows = rows_of_what_may_be_wrong()
    said = {word for own, cells in rows for word in own if cells[0] == "interval"}
    assert told == said


def test_a_recording_tells_what_files_of_its_format_can_tell():
    found = recording([straight(1, 0, 99)], [vehicle(1, {0: (9, 0), 1: (19, 0)})])
    drives = selected_drives(found, RequestedDrives(), "some.xml")
    # Where there is neither a bus nor what runs on rails nobody has to see their doors and tracks.
    of_nobody = {"conflict_with_rail", "boarding", "leaving_stop"}
    assert drives.told_words() - of_nobody <= TELLABLE_WORDS["commonroad"]
    assert {"speed", "limit", "ego_mass"} & drives.told_words() == {"speed"}


def test_every_word_is_one_of_a_vocabulary_and_numbers_have_its_unit():
    declared = {
        **load_rulebook("esterle2019").vocabulary.declarations,
        **load_rulebook("de").vocabulary.declarations,
        **load_rulebook("us-ca").vocabulary.declarations,
        **load_rulebook("nl").vocabulary.declarations,
        **load_rulebook("pl").vocabulary.declarations,
    }
    (drive,) = Drives(
        recording([straight(1, 0, 99)], [vehicle(1, {0: (9, 0), 1: (19, 0)})]), "right"
    ).of("1")
    assert drive.words <= set(declared)
    units = {x.name: x.unit for x in declared.values() if isinstance(x, Quantity)}
    assert {name: units[name] for name in RECORDED_UNITS} == RECORDED_UNITS
