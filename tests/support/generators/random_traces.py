"""Random traces over the vocabulary of the random rulebooks, by a source of chance."""

from dataclasses import replace

from rulec.trace import Trace
from support.builders.full_vocabulary import WORLD
from support.oracles.presence import part, stays_of, there

KINDS = {"a": "car", "b": "thing", "c": "car"}
NUMBERS = [0, 1, 0.1, 0.3, -0.5, 1.5, 2, 0.30000000000000004, 2.0, 1e300]
VALUES = {
    "place": ["near", "far", "gone"],
    "light": ["red", "green"],
    "speed": NUMBERS,
    "pace": NUMBERS,
    "gap": NUMBERS,
    "apart": NUMBERS,
}


def state_of(chance, objects, *, gaps):
    state = {}
    for name, declaration in WORLD.declarations.items():
        if declaration.default is not None and chance.random() < 0.3:
            continue
        if gaps and chance.random() < 0.1:
            continue
        values = VALUES.get(name, [True, False])
        said = said_about(chance, values, objects, len(declaration.parameters))
        if said != {}:
            state[name] = said
    return state


def said_about(chance, values, objects, n_objects):
    if n_objects == 0:
        return chance.choice(values)
    return {name: said_about(chance, values, objects, n_objects - 1) for name in objects}


def only(state, there):
    """What a state says of the world and of those who are there."""
    return {
        name: of_these(value, there) if isinstance(value, dict) else value
        for name, value in state.items()
    }


def of_these(value, there):
    if not isinstance(value, dict):
        return value
    return {name: of_these(inner, there) for name, inner in value.items() if name in there}


def traces(chance, step_s):
    """Of one or two shapes; objects come late and leave early, and states are met again."""
    found = []
    for shape in range(chance.randint(1, 2)):
        objects, present, pool = drawn_shape(chance)
        shortest = shortest_of(present)
        for number in range(chance.randint(1, 4)):
            word = chance.choices(pool, k=chance.randint(shortest, max(shortest, 6)))
            found.append(drawn(f"{shape}.{number}", step_s, objects, word, present))
    return found


def drawn_shape(chance):
    """Objects, when they are there, and states that are met in all traces of theirs."""
    objects = {name: KINDS[name] for name in sorted(chance.sample("abc", chance.randint(0, 3)))}
    gaps = chance.random() < 0.3
    pool = [state_of(chance, objects, gaps=gaps) for _ in range(chance.randint(1, 5))]
    present = {}
    for name in objects:
        if chance.random() < 0.3:
            first = chance.randint(0, 2)
            present[name] = (first, first + chance.randint(0, 2))
    return objects, present, pool


def shortest_of(present):
    return max([1, *(last + 1 for _, last in present.values())])


def drawn(name, step_s, objects, word, present):
    trace = Trace(name, float(step_s), objects, tuple(word), present)
    said = tuple(only(state, there(trace, n)) for n, state in enumerate(word))
    return replace(trace, states=said)


def beginnings(chance, step_s, n_traces, longest=12):
    """All beginnings of traces of one shape, none of them twice.

    They come in rows: those of one trace together, the shortest first.
    """
    objects, present, pool = drawn_shape(chance)
    length = max(longest, shortest_of(present))
    stays = {name: present.get(name, (0, length)) for name in objects}
    who = [
        tuple(name for name in stays if stays[name][0] <= n <= stays[name][1])
        for n in range(length)
    ]
    # A state of the pool, of the same objects, is one thing in all of these traces
    said = {those: [only(state, those) for state in pool] for those in who}
    rows, known = [], set()
    for number in range(n_traces):
        word = chance.choices(range(len(pool)), k=length)
        states = tuple(said[who[n]][one] for n, one in enumerate(word))
        whole = Trace(f"{number}", float(step_s), objects, states, present)
        new = [n for n in range(length) if tuple(word[: n + 1]) not in known]
        known |= {tuple(word[: n + 1]) for n in new}
        if new:
            parts = [(n, part(whole, stays_of(whole), 0, n)) for n in new]
            rows.append([replace(one, id=f"{number}.{n}") for n, one in parts])
    return rows
