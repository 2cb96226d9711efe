"""Who is there in which state of a trace."""

from rulec.trace import Trace


def there(trace, n):
    """Who is there in a state, and the type of each."""
    stays = stays_of(trace)
    return {name: trace.objects[name] for name, (one, last) in stays.items() if one <= n <= last}


def stays_of(trace):
    """The first and last state of each object."""
    always = (0, len(trace.states) - 1)
    return {name: trace.present.get(name, always) for name in trace.objects}


def part(trace, stays, first, last):
    """The states from one to another, and those who are there in some of them."""
    stays = {
        name: (max(one, first) - first, min(end, last) - first)
        for name, (one, end) in stays.items()
        if max(one, first) <= min(end, last)
    }
    objects = {name: trace.objects[name] for name in stays}
    return Trace(trace.id, trace.step_s, objects, trace.states[first : last + 1], stays)
