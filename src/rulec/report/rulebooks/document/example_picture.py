"""A rule's example as a small picture: a frame for each state, the road seen from above.

Ego drives upwards. Only some words of the vocabulary ``road`` are drawn: others' positions and
directions, lights, crossings, speeds and gaps; the table below the picture is complete.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html import escape

from rulec.rulebook.rulebook_model import Example, Rule
from rulec.vocabulary import Vocabulary

WIDTH, HEIGHT = 96, 132
"""Size of a frame in px."""

MOST_FRAMES = 10
"""Of a longer example only the first states are drawn."""

_LANES = {"left_of": 1, "same_lane": 0, "right_of": -1}
"""Ego's lateral position relative to an object -> lanes that the object is right of ego."""

_ROWS = {"behind": -1, "beside": 0, "in_front_of": 1}
"""Ego's position relative to an object along the road -> rows the object is below ego."""

_LIGHTS = ("red_light", "amber_light", "green_light", "red_cross", "flashing_red", "flashing_amber")

_CROSSINGS = ("crossing", "zebra", "crossing_zone")

_ON_CROSSING = ("on_crossing", "entering_crossing")
_AT_CROSSING = ("waiting_to_cross", "about_to_cross")

_DISTANCES = ("gap", "time_headway", "lateral_gap")

_PLACED = {"station", "lateral", "crossing_use", "light"}
"""An example that mentions none of these is not drawn, because there would be little to see."""


@dataclass
class ExampleFigures:
    """Pictures of examples, by the addresses used for them in a document."""

    vocabulary: Vocabulary
    by_address: dict[str, str] = field(default_factory=dict)

    def add(self, example: Example, rule: Rule) -> str:
        """Draw an example and return its address; empty if nothing in it can be drawn."""
        mentioned = {name for state in example.states for name, _ in state}
        if mentioned.isdisjoint(_PLACED):
            return ""
        address = f"example:{rule.name}/{len(self.by_address) + 1}"
        self.by_address[address] = picture(example, rule, self.vocabulary)
        return address


def picture(example: Example, rule: Rule, vocabulary: Vocabulary) -> str:
    """The picture as an SVG element, with the colours of the page that contains it."""
    objects = {item.name: item.type for item in (*rule.variables, *example.objects)}
    states = example.states[:MOST_FRAMES]
    width = len(states) * (WIDTH + 8) - 8
    frames = []
    for number, given in enumerate(states):
        state = _State(given, vocabulary)
        marks = "".join(_frame(state, objects, vocabulary))
        frames.append(f'<g transform="translate({number * (WIDTH + 8)} 0)">{marks}</g>')
    height = HEIGHT + 14
    numbers = "".join(
        f'<text x="{number * (WIDTH + 8) + WIDTH / 2:g}" y="{height - 2}">{number}</text>'
        for number in range(len(states))
    )
    return (
        f'<svg class="example" role="img" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" xmlns="http://www.w3.org/2000/svg">'
        f"{''.join(frames)}{numbers}</svg>"
    )


@dataclass(frozen=True, slots=True)
class _State:
    """A state of an example, completed by the defaults of its vocabulary."""

    given: Mapping[tuple[str, tuple[str, ...]], bool | str | float]
    vocabulary: Vocabulary

    def value(self, name: str, *objects: str) -> bool | str | float | None:
        declared = self.vocabulary.declarations.get(name)
        if declared is None:
            return None
        return self.given.get((name, objects), declared.default)

    def says(self, name: str, *objects: str) -> bool:
        return (name, objects) in self.given

    def has(self, *values: str) -> bool:
        """Whether ego has any of these values of enumerations, or signals."""
        return any(
            value is True if name in values else isinstance(value, str) and value in values
            for (name, objects), value in self.given.items()
            if not objects
        )


def _frame(state: _State, objects: Mapping[str, str], vocabulary: Vocabulary) -> Iterator[str]:
    middle = WIDTH / 2
    yield f'<rect class="road" x="6" y="0" width="{WIDTH - 12}" height="{HEIGHT}"/>'
    for x in (6 + (WIDTH - 12) / 3, 6 + 2 * (WIDTH - 12) / 3):
        yield f'<path class="mark" d="M{x:g} 2V{HEIGHT - 2}"/>'
    light = next((name for name in _LIGHTS if state.has(name)), None)
    if state.has(*_CROSSINGS) or any(
        state.value("crossing_use", name) in (*_ON_CROSSING, *_AT_CROSSING)
        for name, kind in objects.items()
        if vocabulary.is_subtype(kind, "pedestrian")
    ):
        y = _crossing_at(state) - 8
        yield from (
            f'<rect class="stripe" x="{9 + 12 * n}" y="{y:g}" width="6" height="16"/>'
            for n in range(7)
        )
    if light is not None:
        style = light.removeprefix("flashing_").removesuffix("_light").removesuffix("_cross")
        yield f'<circle class="light {style}" cx="{WIDTH - 12}" cy="28" r="5"/>'
    for name, kind in objects.items():
        yield from _other_object(state, name, kind, vocabulary)
    yield from _vehicle(middle, HEIGHT / 2, "ego", down=state.has("reversing"))
    if state.has("lane_change", "straddling"):
        yield f'<path class="arrow" d="M{middle + 9:g} 60l10 -12m0 6v-6h-6"/>'
    if state.says("speed"):
        text = f"{state.value('speed'):g} km/h"
        yield f'<text x="{middle:g}" y="{HEIGHT / 2 + 24:g}">{escape(text)}</text>'


def _other_object(state: _State, name: str, kind: str, vocabulary: Vocabulary) -> Iterator[str]:
    """An object at its position; nothing if the position is not given."""
    if not vocabulary.is_subtype(kind, "road_user") or "station" not in vocabulary.declarations:
        return
    station, lateral = state.value("station", name), state.value("lateral", name)
    use = state.value("crossing_use", name)
    if station is None and lateral is None and use not in (*_ON_CROSSING, *_AT_CROSSING):
        return
    row = _ROWS.get(str(station), 0)
    lane = _LANES.get(str(lateral), 0 if row else 1)
    x, y = WIDTH / 2 + lane * 28, HEIGHT / 2 + row * 44
    if vocabulary.is_subtype(kind, "pedestrian"):
        if use in _ON_CROSSING:
            x, y = WIDTH / 2 + 22, _crossing_at(state)
        elif use in _AT_CROSSING:
            x, y = WIDTH - 7, _crossing_at(state)
        yield f'<circle class="person" cx="{x:g}" cy="{y:g}" r="5"/>'
    elif vocabulary.is_subtype(kind, "vulnerable_user"):
        yield f'<rect class="person" x="{x - 3:g}" y="{y - 9:g}" width="6" height="18" rx="3"/>'
    else:
        long = any(vocabulary.is_subtype(kind, x) for x in ("bus", "truck", "rail_vehicle"))
        yield from _vehicle(x, y, "other", down=state.value("oncoming", name) is True, long=long)
    yield f'<text class="name" x="{x:g}" y="{y + 4:g}">{escape(name[:4])}</text>'
    for word in _DISTANCES:
        if state.says(word, name):
            item = vocabulary.declarations[word]
            text = f"{state.value(word, name):g} {getattr(item, 'unit', '')}"
            far = (WIDTH / 2 + x) / 2, (HEIGHT / 2 + y) / 2
            yield f'<path class="gap" d="M{WIDTH / 2:g} {HEIGHT / 2:g}L{x:g} {y:g}"/>'
            yield f'<text x="{far[0]:g}" y="{far[1] + 3:g}">{escape(text)}</text>'


def _crossing_at(state: _State) -> float:
    """The y coordinate of the crossing's middle: at ego, or ahead of it."""
    return HEIGHT / 2 if state.has("crossing") else HEIGHT / 2 - 28


def _vehicle(x: float, y: float, style: str, *, down: bool, long: bool = False) -> Iterator[str]:
    """A body with a windscreen at its front."""
    half = 19 if long else 13
    yield (
        f'<rect class="{style}" x="{x - 8:g}" y="{y - half:g}" width="16" height="{2 * half}" '
        'rx="3"/>'
    )
    screen = y + half - 8 if down else y - half + 4
    yield f'<rect class="screen" x="{x - 6:g}" y="{screen:g}" width="12" height="4"/>'
