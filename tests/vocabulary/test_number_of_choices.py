"""The number of choices of objects, against going through them, and its limit."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.resource_limits import in_force
from rulec.vocabulary import ObjectType, Vocabulary
from rulec.vocabulary.vocabulary_model import choices, number_of_choices

PARENTS = {"user": None, "car": "user", "taxi": "car", "tram": "user", "sign": None}
TYPES = {name: ObjectType(name, parent) for name, parent in PARENTS.items()}
WORDS = Vocabulary("words", TYPES, {})
KINDS = st.sampled_from(sorted(PARENTS))


@given(st.lists(KINDS, max_size=4), st.lists(KINDS, max_size=6))
def test_the_number_is_that_of_going_through_them(types, kinds):
    objects = {f"o{number}": kind for number, kind in enumerate(kinds)}
    assert number_of_choices(types, objects, WORDS) == len(list(choices(types, objects, WORDS)))


def test_more_choices_than_the_limit_are_refused_before_the_first_is_made():
    objects = {f"o{number}": "car" for number in range(30)}
    with pytest.raises(RulecError, match=r"427,518,000 choices .* the limit is 1,000,000"):
        next(choices(["car"] * 6, objects, WORDS))
    with in_force(["choices=427518000"]):
        assert next(choices(["car"] * 6, objects, WORDS)) == tuple(objects)[:6]


def test_a_limit_goes_back_to_what_it_was_behind_its_block():
    objects = {"a": "car", "b": "car"}
    with in_force(["choices=1"]), pytest.raises(RulecError, match="R0718"):
        next(choices(["car", "car"], objects, WORDS))
    assert len(list(choices(["car", "car"], objects, WORDS))) == 2


def test_nothing_is_of_a_type_that_is_not_declared():
    objects = {"a": "car", "b": "car"}
    assert number_of_choices(["boat", "boat"], objects, WORDS) == 0
    assert list(choices(["boat", "boat"], objects, WORDS)) == []
    assert list(choices(["boat", "car"], objects, WORDS)) == []
    assert list(choices(["car", "car"], {"a": "boat", "b": "boat"}, WORDS)) == []
