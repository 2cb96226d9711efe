"""An example as a table: states in columns, subjects in rows."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.logic.english.atom_phrases import listed, spoken
from rulec.rulebook.rulebook_model import Example
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

NOTHING = "–"
"""What stands where a state does not say something that has no default either."""


@dataclass(frozen=True, slots=True)
class ExampleTable:
    """Rows of an example: a subject, and its value in each state.

    A value in parentheses is a default: the state does not mention it.
    """

    n_states: int
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def example_table(example: Example, vocabulary: Vocabulary) -> ExampleTable:
    """The example's table, with rows in order of first mention."""
    mentioned = dict.fromkeys(key for state in example.states for key in state)
    rows = []
    for name, objects in mentioned:
        item = vocabulary.declarations[name]
        cells = tuple(
            _value(item, state[name, objects]) if (name, objects) in state else _default(item)
            for state in example.states
        )
        rows.append((_about(item, objects), cells))
    return ExampleTable(len(example.states), tuple(rows))


def _about(item: Declaration, objects: tuple[str, ...]) -> str:
    unit = f", {item.unit}" if isinstance(item, Quantity) else ""
    of = f" of {listed(objects)}" if objects else ""
    return f"{spoken(item.name)}{of}{unit}"


def _value(item: Declaration, value: bool | str | float) -> str:
    match item, value:
        case Signal(), _:
            return "yes" if value else "no"
        case Enumeration(), _:
            return spoken(str(value))
        case _:
            return repr(float(value)).removesuffix(".0")


def _default(item: Declaration) -> str:
    return NOTHING if item.default is None else f"({_value(item, item.default)})"
