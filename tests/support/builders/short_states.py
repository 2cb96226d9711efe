"""States written as the names that are true in them."""

from rulec.vocabulary.partial_values import UNKNOWN


def state_of(text):
    """``red ?go behind(a)`` as a state in which these are true, and go is unknown."""
    state = {}
    for word in text.split():
        value = UNKNOWN if word.startswith("?") else True
        name, _, item = word.lstrip("?").rstrip(")").partition("(")
        if item:
            state.setdefault(name, {})[item] = value
        else:
            state[name] = value
    return state
