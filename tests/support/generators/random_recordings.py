"""Random recordings of a straight road of some lanes, for properties of drives."""

from hypothesis import strategies as st

from support.builders.recordings import lanelet, recording, straight, vehicle

STEP_S = 0.5
WIDTH_M = 4.0

# A grid on which no body ends within a threshold's breadth of a mark or of another body: then
# nothing depends on the last digit of a number.
_PLACES = st.integers(0, 40).map(lambda k: 3.0137 * k + 0.37)
_OFFSETS = st.integers(-4, 4).map(lambda k: 0.8317 * k + 0.1139)
_SPEEDS = st.integers(-2, 12).map(lambda k: 2.9173 * k)
_DRIFTS = st.sampled_from([0.0, 0.0, 0.5371, -0.5371])
_KINDS = ["car", "truck", "bicycle", "motorcycle", "pedestrian"]
_SIZES = {"car": (4.2, 1.9), "truck": (9.1, 2.5), "bicycle": (1.7, 0.6), "motorcycle": (2.1, 0.8)}


def lanes(count, **more):
    """Lanes 1 to ``count`` side by side from the right, 400 m along the x axis."""
    return [
        straight(
            k,
            -100,
            300,
            y=WIDTH_M * (k - 1),
            width=WIDTH_M,
            left_of=k + 1 if k < count else None,
            right_of=k - 1 if k > 1 else None,
            **more,
        )
        for k in range(1, count + 1)
    ]


@st.composite
def _participants(draw, number, count, steps):
    kind = draw(st.sampled_from(_KINDS))
    length, width = _SIZES.get(kind, (0.5, 0.5))
    x = draw(_PLACES)
    y = WIDTH_M * draw(st.integers(0, count - 1)) + draw(_OFFSETS)
    along, across = draw(_SPEEDS), draw(_DRIFTS)
    first = draw(st.integers(0, steps - 2))
    places = {
        k: (x + along * STEP_S * (k - first), y + across * STEP_S * (k - first))
        for k in range(first, steps)
    }
    heading = 3.14159 if along < 0 else 0.0
    return vehicle(
        number, places, kind, length=length, width=width, speed=abs(along), heading=heading
    )


@st.composite
def scenes(draw, most=5, steps=6):
    """A road of one to three lanes and a few participants, who keep straight on or drift."""
    count = draw(st.integers(1, 3))
    people = [
        draw(_participants(number, count, steps))
        for number in range(1, draw(st.integers(2, most)) + 1)
    ]
    ends = [(61.0, -6.0), (61.0, WIDTH_M * count + 4.0)]
    zebra = [lanelet(9, ends, types=frozenset({"crosswalk"}))] if draw(st.booleans()) else []
    return recording([*lanes(count), *zebra], people, step_s=STEP_S)
