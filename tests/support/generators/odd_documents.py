"""JSON documents in which one value is odd: what usual readers of JSON let through."""

import copy
import math

ODD_VALUES = {
    "nan": math.nan,
    "infinity": math.inf,
    "huge": 10**4000,
    "negative": -(10**30),
    "surrogate": "\ud800",
    "power": "1e9999999",
    "digits": "9" * 5000,
    "nothing": None,
    "list": [[[]]],
}


def places_in(data, above=()):
    """The keys that lead to everything in a document."""
    if isinstance(data, dict | list):
        for key, value in data.items() if isinstance(data, dict) else enumerate(data):
            yield (*above, key)
            yield from places_in(value, (*above, key))


def with_value(data, place, value):
    """A document with another value at a place."""
    data = copy.deepcopy(data)
    part = data
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    return data
