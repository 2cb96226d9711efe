"""Drives of any length, in which vehicles change their places around ego."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

PLACES = {
    "esterle2019": [{"position": place} for place in "bbblllff"],
    "vienna": [
        {"station": station, "lateral": lateral, "gap": 30.5}
        for station, lateral in [
            ("behind", "same_lane"),
            ("behind", "left_of"),
            ("beside", "left_of"),
            ("in_front_of", "left_of"),
            ("in_front_of", "same_lane"),
        ]
    ],
}


def drive(places: list[dict[str, Any]], names: list[str]) -> Iterator[Any]:
    """States in which vehicles move on, from one place to the next, every other one at a time."""
    chance = random.Random(5)
    at = [chance.randrange(len(places)) for _ in names]
    while True:
        at = [(place + chance.randint(0, 1)) % len(places) for place in at]
        yield {
            relation: {name: places[place][relation] for name, place in zip(names, at, strict=True)}
            if isinstance(example, str)
            else {name: round(example + chance.uniform(-9, 9), 2) for name in names}
            for relation, example in places[0].items()
        }
