"""The values of words in recorded drives, by their definitions in the vocabulary `road`."""

from rulec import RequestedDrives, parse_rulebook
from rulec.extraction.selection import selected_drives
from rulec.monitoring.moments.name_tables import tables_of
from rulec.monitoring.told_names import names_behind, words_meant

LEFT_TO_DEFINITIONS = {"accelerating", "braking_hard", "can_stop_at_once", "impedes_traffic"}
"""The words that recordings can provide, although they do not tell them."""


def defined(word, found, ego="7", lines="", vocabulary="road"):
    """In each state T, F, or ? where the word is unknown, by a rulebook with these ``lines``."""
    rule = "hard rule any { require always (speed >= 0) }"
    book = parse_rulebook(f"rulebook own\ntraffic right\nuse {vocabulary}\n{lines}\n{rule}")
    (drive,) = selected_drives(
        found,
        RequestedDrives(ego),
        "some.xml",
        traffic="right",
        vocabulary=book.vocabulary,
        names=names_behind({word}, book.vocabulary),
    ).of(ego)
    assert word in words_meant(book.vocabulary, drive.arrays.told)
    truth = tables_of(drive.arrays, book.vocabulary).world(word)
    halves = zip(truth.sure.ravel(), truth.possible.ravel(), strict=True)
    return "".join("T" if sure else "?" if possible else "F" for sure, possible in halves)
