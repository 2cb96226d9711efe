"""Random rulebooks with constants, and traces in which these are the same in all states."""

from dataclasses import replace

from rulec.vocabulary import Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.full_vocabulary import WORLD
from support.generators.blurred_traces import places_of
from support.oracles.completion_oracle import put


def with_some_constant(chance, book):
    names = chance.sample(list(WORLD.declarations), 3)
    declarations = {
        name: replace(item, constant=name in names) for name, item in WORLD.declarations.items()
    }
    return replace(book, vocabulary=Vocabulary("world", WORLD.types, declarations))


def steady(trace, constants):
    """The trace whose states that say something of a constant all say what the first one says."""
    said, states = {}, list(trace.states)
    for number, name, objects in places_of(trace):
        if name in constants:
            value = of(trace.states[number][name], objects)
            value = said.setdefault((name, objects), value)
            states[number] = put(states[number], name, objects, value)
    return replace(trace, states=tuple(states))


def of(value, objects):
    for item in objects:
        value = value[item]
    return value


def with_unknown_constants(chance, trace, constants):
    """A few of these wholly unknown; of numbers one at most, perhaps an interval."""
    subjects = list(
        {(name, objects): 0 for _, name, objects in places_of(trace) if name in constants}
    )
    numeric = [x for x in subjects if isinstance(WORLD.declarations[x[0]], Quantity)]
    others = [x for x in subjects if x not in numeric]
    chance.shuffle(numeric)
    chance.shuffle(others)
    states = list(trace.states)
    for name, objects in [*numeric[:1], *others[:3]]:
        value = UNKNOWN
        if (name, objects) in numeric and chance.random() < 0.5:
            value = Interval(*sorted(chance.choices([0, 0.1, 0.3, 1, 1.5, 2, -0.5], k=2)))
        for number, where, items in places_of(trace):
            if (where, items) == (name, objects):
                states[number] = put(states[number], name, objects, value)
    return replace(trace, states=tuple(states))
