"""States, each with the objects that are there, as one trace."""

from rulec.trace import Trace


def as_trace(journey, step_s=1.0):
    """The trace in which each stay of an object has a name of its own, such as ``a 2``."""
    objects, present, renamed, stays = {}, {}, [], {}
    before = {}
    for number, (state, there) in enumerate(journey):
        names = {}
        for name, kind in there.items():
            if name not in before:
                stays[name] = stays.get(name, -1) + 1
            names[name] = f"{name} {stays[name]}"
            objects[names[name]] = kind
            first, _ = present.get(names[name], (number, number))
            present[names[name]] = (first, number)
        before = there
        renamed.append({key: _renamed(value, names) for key, value in state.items()})
    return Trace("t", step_s, objects, tuple(renamed), present)


def _renamed(value, names):
    if not isinstance(value, dict):
        return value
    return {names.get(name, name): _renamed(inner, names) for name, inner in value.items()}
