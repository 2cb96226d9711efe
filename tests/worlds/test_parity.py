"""One world in many formats: no verdict contradicts another; what a format cannot tell is open."""

import os
from collections import Counter
from functools import cache
from itertools import combinations

import pytest

import rulec
from rulec.extraction.traces.recorded_drive import NoDrive
from support.parity.street import cars
from support.parity.writers import WRITERS

LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
SEEDS = range(60) if LONG else range(2)
BOOKS = ("de", "us-ca") if LONG else ("de",)
WHOLE = "CommonRoad", "CSV", "Parquet", "OSI"
"""Formats that tell of the street all that there is."""


@cache
def compiled(book):
    return rulec.compile_rulebook(book, step_s=0.1)


def outcomes(file, names, rules):
    """(car, rule) -> violated, open or kept, of all that are judged."""
    found = {}
    for one in rulec.verify_recording(file, rules).answers():
        if isinstance(one, NoDrive):
            continue
        car, answer = names[one.drive.ego.partition("#")[0]], one.answer
        doubtful = {x.rule for x in (*answer.open, *answer.not_judged)}
        violated = {x.rule for x in answer.violations}
        for rule in rules.rules:
            name = rule.name
            said = "violated" if name in violated else "open" if name in doubtful else "kept"
            # Of several drives of a car one may violate what the others keep
            order = ("violated", "open", "kept")
            found[car, name] = min(said, found.get((car, name), "kept"), key=order.index)
    return found


@pytest.fixture(scope="module", params=[(book, seed) for book in BOOKS for seed in SEEDS])
def by_format(request, tmp_path_factory):
    """Format -> the outcomes of a world, by car and rule."""
    book, seed = request.param
    world, found = cars(seed), {}
    for name, write in WRITERS.items():
        folder = tmp_path_factory.mktemp(f"{seed}")
        found[name] = outcomes(*write(folder, world), compiled(book))
    return found


def test_no_format_contradicts_another(by_format):
    found = [
        (one, other, key)
        for one, other in combinations(by_format, 2)
        for key in by_format[one].keys() & by_format[other].keys()
        if {by_format[one][key], by_format[other][key]} == {"kept", "violated"}
    ]
    assert found == []


def test_formats_that_tell_all_have_the_same_verdicts(by_format):
    """Lamps for one no file tells; what is open is open in all."""
    first, *others = (by_format[name] for name in WHOLE)
    for other in others:
        assert {key for key in first if first[key] != other.get(key)} == set()


def test_something_is_found(by_format):
    """A world in which all is open, or nothing happens, would show nothing."""
    counts = {name: Counter(found.values()) for name, found in by_format.items()}
    assert all(counts[name]["violated"] >= 1 for name in WHOLE)
    for name, found in by_format.items():
        assert counts[name]["kept"] >= 20
        assert len({car for car, _ in found}) == 8
