"""Subtypes and values of a vocabulary."""

import pytest

from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary

WORDS = Vocabulary(
    "words",
    {
        name: ObjectType(name, parent)
        for name, parent in [
            ("user", None),
            ("vehicle", "user"),
            ("bus", "vehicle"),
            ("tree", None),
        ]
    },
    {
        "lamp": Enumeration("lamp", (), ("red", "green"), "red"),
        "at": Enumeration("at", ("user",), ("here", "there")),
        "wet": Signal("wet"),
        "speed": Quantity("speed", (), "km/h"),
    },
)


def test_ancestors_go_upward():
    assert list(WORDS.ancestors("bus")) == ["bus", "vehicle", "user"]


@pytest.mark.parametrize(
    ("name", "of", "expected"),
    [("bus", "user", True), ("bus", "bus", True), ("user", "bus", False), ("tree", "user", False)],
)
def test_subtypes(name, of, expected):
    assert WORDS.is_subtype(name, of) is expected


def test_values_know_their_enumeration():
    found = {value: item.name for value, item in WORDS.enumeration_of.items()}
    assert found == {"red": "lamp", "green": "lamp", "here": "at", "there": "at"}
