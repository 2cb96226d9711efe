"""A document is made of results: by the names of its fields, part by part."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import pytest
from msgspec import UNSET, UnsetType

from rulec.report.json_document import JsonDocument, JsonPart, as_builtins, filled


class Wheel(JsonPart, frozen=True, kw_only=True):
    size: float
    maker: str | None


class Cart(JsonDocument, frozen=True, kw_only=True):
    name: str
    wheels: Sequence[Wheel]
    spare: Wheel | None
    by_side: Mapping[str, Wheel]
    remarks: Sequence[str] | UnsetType = UNSET
    speed: float | UnsetType = UNSET
    until: float | UnsetType | None = UNSET


@dataclass
class MadeWheel:
    size: float | Fraction
    maker: str = ""
    price: int = 3


@dataclass
class MadeCart:
    wheels: tuple[MadeWheel, ...]
    spare: MadeWheel | None
    by_side: dict[str, MadeWheel]
    remarks: tuple[str, ...] = ()
    speed: float = 0.0


def test_parts_are_made_of_what_stands_in_their_place():
    made = MadeCart(
        (MadeWheel(2.0, "A"), MadeWheel(Fraction(1, 2))), None, {"left": MadeWheel(1.0)}, ("old",)
    )
    assert as_builtins(filled(Cart, made, name="c")) == {
        "version": 1,
        "name": "c",
        "wheels": [{"size": 2.0, "maker": "A"}, {"size": 0.5, "maker": None}],
        "spare": None,
        "by_side": {"left": {"size": 1.0, "maker": None}},
        "remarks": ("old",),
        "speed": 0.0,
    }


def test_what_is_empty_or_given_by_nothing_is_left_out():
    written = as_builtins(filled(Cart, MadeCart((), None, {}), name="c"))
    assert {"remarks", "until"}.isdisjoint(written)


def test_the_first_source_that_has_a_field_gives_it_and_an_own_value_comes_before():
    wheel = filled(Wheel, MadeWheel(1.0), MadeWheel(2.0, "B"), maker="C")
    assert (wheel.size, wheel.maker) == (1.0, "C")


@pytest.mark.parametrize(("until", "is_there"), [(None, True), (2.0, True), (UNSET, False)])
def test_a_null_of_ones_own_is_written_where_it_may_be(until, is_there):
    written = as_builtins(filled(Cart, MadeCart((), None, {}), name="c", until=until, speed=None))
    assert ("until" in written) == is_there
    assert "speed" not in written


def test_a_field_that_must_be_there_needs_a_source():
    with pytest.raises(AttributeError):
        filled(Cart, MadeCart((), None, {}))
