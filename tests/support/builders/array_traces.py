"""Traces with states as traces in arrays, where these can say the same."""

import numpy as np

from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Enumeration, Quantity, Signal
from rulec.vocabulary.partial_values import UNKNOWN, Interval

NOTHING = object()


class CannotSayError(Exception):
    """Arrays are for values that fit, of the world or of single objects that are there."""


def in_arrays(trace, vocabulary):
    """The trace in arrays. Raises CannotSayError."""
    if not trace.states or not all(isinstance(state, dict) for state in trace.states):
        raise CannotSayError
    last = len(trace.states) - 1
    spans = [trace.present.get(name, (0, last)) for name in trace.objects]
    if any(not 0 <= first <= end <= last for first, end in spans):
        raise CannotSayError
    parts = {"world": {}, "about": {}, "texts": {}, "unknown": {}}
    parts |= {"absent": {}, "bounds": {}, "only": {}}
    for name in sorted(set().union(*trace.states)):
        declaration = vocabulary.declarations.get(name)
        if declaration is None or len(declaration.parameters) > 1:
            raise CannotSayError
        said = [state.get(name, NOTHING) for state in trace.states]
        if declaration.parameters:
            rows = about_objects(said, trace, spans, (vocabulary, declaration.parameters[0]))
            said_of = [any(x is not NOTHING for x in row) for row in rows]
            parts["only"][name] = np.array(said_of, dtype=bool)
            said = [value for row in rows for value in row]
        parts["about" if declaration.parameters else "world"][name] = column(
            name, said, declaration, parts
        )
    return TraceArrays(
        trace.id,
        trace.step_s,
        len(trace.states),
        trace.objects,
        np.array(spans, dtype=np.intp).reshape(-1, 2),
        **parts,
        ends=trace.ends,
        told=trace.told,
    )


def about_objects(said, trace, spans, kinds):
    """What is said of each object in the states in which it is there."""
    vocabulary, kind = kinds
    found = [[NOTHING] * (last - first + 1) for first, last in spans]
    places = {name: place for place, name in enumerate(trace.objects)}
    for number, values in enumerate(said):
        if values is UNKNOWN:
            there = [name for name in places if in_span(number, spans[places[name]])]
            own = [x for x in there if vocabulary.is_subtype(trace.objects[x], kind)]
            values = dict.fromkeys(own, UNKNOWN)
        if values is NOTHING:
            continue
        if not isinstance(values, dict):
            raise CannotSayError
        for item, value in values.items():
            if item not in places or not in_span(number, spans[places[item]]):
                raise CannotSayError
            found[places[item]][number - spans[places[item]][0]] = value
    return found


def in_span(number, span):
    return span[0] <= number <= span[1]


def column(name, values, declaration, parts):
    """The values as numbers; what is special of them is put into the other ``parts``."""
    for part, what in (("unknown", UNKNOWN), ("absent", NOTHING)):
        flags = np.array([value is what for value in values], dtype=bool)
        if flags.any():
            parts[part][name] = flags
    known = [value for value in values if value is not UNKNOWN and value is not NOTHING]
    match declaration:
        case Enumeration():
            # In another order than the declared one
            texts = tuple(reversed(declaration.values))
            if not all(isinstance(value, str) and value in texts for value in known):
                raise CannotSayError
            parts["texts"][name] = texts
            return np.array([texts.index(x) if isinstance(x, str) else 0 for x in values], np.uint8)
        case Signal():
            if not all(isinstance(value, bool) for value in known):
                raise CannotSayError
            return np.array([value is True for value in values], dtype=bool)
        case Quantity():
            if not all(type(value) in (int, float, Interval) for value in known):
                raise CannotSayError
    # Of nobody there are none
    low, high = np.array([ends_of(value) for value in values], dtype=float).reshape(-1, 2).T
    if not np.isfinite(low + high).all():
        raise CannotSayError
    if any(isinstance(value, Interval) for value in known):
        parts["bounds"][name] = (low, high)
    return low


def ends_of(value):
    if isinstance(value, Interval):
        return value.low, value.high
    return (value, value) if type(value) in (int, float) else (0.0, 0.0)
