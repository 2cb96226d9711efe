"""What nobody has written for one rulebook, as far as the rulebook's vocabulary has words for it.

Recorded traffic is such: its types are the most specific that the vocabulary knows, and names that
the vocabulary does not know, or means otherwise, are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rulec.trace.trace_model import Value
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary


def known_types(kinds: Mapping[str, Sequence[str]], vocabulary: Vocabulary) -> dict[str, str]:
    """For each object the first of its ``kinds`` that the vocabulary knows, if it knows one."""
    found = {}
    for name, words in kinds.items():
        known = next((word for word in words if word in vocabulary.types), None)
        if known is not None:
            found[name] = known
    return found


def could_mean(values: Iterable[Value], declaration: Declaration, unit: str) -> bool:
    """Could these be what the vocabulary means by the name? ``unit`` is that of numbers."""
    match declaration:
        case Signal():
            return all(isinstance(one, bool) for one in values)
        case Enumeration():
            return all(one in declaration.values for one in values)
        case Quantity():
            return declaration.unit == unit and all(type(one) in (int, float) for one in values)
