"""Stretches of traces in arrays, alone or sharing columns, have the states of the whole ones."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_arrays import TraceArrays, stretches_of
from rulec.trace.trace_model import present_in

ABOUT = frozenset({"gap", "near"})
WORLD = {"speed", "light"}
NAMES = ABOUT | WORLD
OBJECTS = "abc"


@st.composite
def spans(draw, n_states):
    """The objects of a trace, with the first and the last state of each."""
    some = draw(st.lists(st.sampled_from(OBJECTS), unique=True))
    ends = st.lists(st.integers(0, n_states - 1), min_size=2, max_size=2).map(sorted)
    return {name: tuple(draw(ends)) for name in some}


@st.composite
def traces_together(draw):
    """Traces whose columns are the same arrays; of a single one they are its own."""
    lengths = draw(st.lists(st.integers(1, 4), min_size=1, max_size=4))
    present = [draw(spans(n_states)) for n_states in lengths]
    of_objects = [[last - first + 1 for first, last in own.values()] for own in present]
    states, objects, cells = (
        np.cumsum([0, *sizes]).tolist()
        for sizes in (lengths, map(len, of_objects), map(sum, of_objects))
    )

    def flags(count):
        return np.array(draw(st.lists(st.booleans(), min_size=count, max_size=count)), dtype=bool)

    low = np.arange(cells[-1], dtype=float)
    world = {"speed": np.arange(states[-1], dtype=float), "light": flags(states[-1]).astype(int)}
    columns = {
        "world": world,
        "about": {"gap": low, "near": flags(cells[-1])},
        "unknown": {"light": flags(states[-1]), "near": flags(cells[-1])},
        "absent": {"speed": flags(states[-1])},
        "bounds": {"gap": (low, low + flags(cells[-1]))},
        "only": {"near": flags(objects[-1])},
    }

    def part(key, number):
        own = [slice(*ends[number : number + 2]) for ends in (states, cells, objects)]
        places = own[2:] * 2 if key == "only" else own[:2]
        return SharedColumns(columns[key], ABOUT, *places)

    return [
        TraceArrays(
            str(number),
            0.5,
            lengths[number],
            dict.fromkeys(own, "car"),
            np.array(list(own.values()), dtype=np.intp).reshape(-1, 2),
            texts={"light": ("red", "green")},
            **(columns if len(lengths) == 1 else {key: part(key, number) for key in columns}),
        )
        for number, own in enumerate(present)
    ]


def cut(trace, states, names):
    """The stretch of a trace of states."""
    there = [present_in(number, trace.objects, trace.present) for number in states]
    stays = {
        name: [place for place, own in enumerate(there) if name in own] for name in trace.objects
    }
    stays = {name: (own[0], own[-1]) for name, own in stays.items() if own}
    return replace(
        trace,
        objects={name: kind for name, kind in trace.objects.items() if name in stays},
        present={name: own for name, own in stays.items() if own != (0, len(states) - 1)},
        states=tuple(
            {name: value for name, value in trace.states[number].items() if name in names}
            for number in states
        ),
    )


@given(st.data())
def test_stretches_have_the_states_of_the_whole(data):
    traces = data.draw(traces_together())
    chosen = data.draw(st.lists(st.integers(0, len(traces) - 1), min_size=1, max_size=5))
    asked = [traces[number] for number in chosen]
    stretches = []
    for trace in asked:
        first = data.draw(st.integers(0, trace.n_states - 1))
        stretches.append(range(first, data.draw(st.integers(first + 1, trace.n_states))))
    names = data.draw(st.sets(st.sampled_from(sorted(NAMES))))
    found = stretches_of(asked, stretches, names)
    whole = [own.trace() for own in asked]
    expected = [cut(own, states, names) for own, states in zip(whole, stretches, strict=True)]
    assert [own.trace() for own in found] == expected
    # What shared columns still does, and can be judged without being put together
    if len(traces) > 1:
        assert len({id(own.world.columns) for own in found}) == 1
        for own, following in pairwise(found):
            assert own.about.is_before(following.about)
