"""Display of values: short ``repr``, rows of plain dicts, Arrow, HTML."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any

from rulec.resources import install_command

LONGEST_REPR = 160
"""The most characters of a ``repr``, which has no line break."""

MOST_HTML_ROWS = 200
"""The most rows of a table in a notebook."""

_LONGEST_VALUE = 60
_MOST_ITEMS = 3
_ENTITIES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#x27;"})


def short_repr(value: Any) -> str:
    """A dataclass's ``repr`` in one line, with long values shortened."""
    name = type(value).__name__
    pairs = [f"{field}={brief(item)}" for field, item in _items(value)]
    text = ", ".join(pairs)
    if len(name) + len(text) + 2 > LONGEST_REPR:
        text = text[: LONGEST_REPR - len(name) - 3] + "…"
    return f"{name}({text})"


def _items(value: Any) -> list[tuple[str, Any]]:
    if is_dataclass(value):
        return [(field.name, getattr(value, field.name)) for field in fields(value) if field.repr]
    return [(name, getattr(value, name)) for name in value.__struct_fields__]


def brief(value: object) -> str:
    """A value in a few words, however long it is and however deeply its lists are nested."""
    try:
        return _brief(value)
    except (RecursionError, ValueError):  # or an integer with thousands of digits
        return f"({type(value).__name__})"


def _brief(value: object) -> str:
    if isinstance(value, str | bytes):
        text = repr(value[:_LONGEST_VALUE])
        return text if len(value) <= _LONGEST_VALUE else f"{text[:-1]}…{text[-1]}"
    if isinstance(value, Collection) and _size(value) > _MOST_ITEMS:
        return f"<{len(value):,} items>"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_brief(k)}: {_brief(v)}" for k, v in value.items()) + "}"
    if type(value) is tuple:
        items = [_brief(item) for item in value]
        return f"({items[0]},)" if len(items) == 1 else f"({', '.join(items)})"
    text = " ".join(repr(value).split())
    if len(text) > _LONGEST_VALUE and "(" in text:
        return f"{text[: text.index('(')]}(…)"
    return text if len(text) <= _LONGEST_VALUE else text[:_LONGEST_VALUE] + "…"


def _size(value: Collection[object]) -> int:
    try:
        return len(value)
    except TypeError:  # an array without axes
        return 0


def short_count(number: int) -> str:
    """A count in readable form, however large."""
    return f"{number:,}" if number < 10**15 else "more than 10^15"


class Rows:
    """A list of items that is shown as rows of a table."""

    __slots__ = ()

    @abstractmethod
    def rows(self) -> Sequence[dict[str, Any]]:
        """Rows as dicts with equal keys and plain values."""

    def to_arrow(self) -> Any:
        """The rows as a ``pyarrow.Table``; ImportError if pyarrow is not installed."""
        try:
            arrow = import_module("pyarrow")
        except ImportError as error:
            raise ImportError(
                f"an Arrow table takes pyarrow: {install_command('parquet')}"
            ) from error
        rows = self.rows()
        columns: dict[str, Any] = {}
        for name in rows[0] if rows else ():
            values = [row[name] for row in rows]
            if any(isinstance(value, dict) for value in values):
                pairs = [
                    value and [(key, str(item)) for key, item in value.items()] for value in values
                ]
                columns[name] = arrow.array(pairs, arrow.map_(arrow.string(), arrow.string()))
            else:
                columns[name] = arrow.array(values)
        return arrow.table(columns)

    def to_frame(self) -> Any:
        """The rows as a ``pandas.DataFrame``; ImportError if pandas is not installed."""
        try:
            pandas = import_module("pandas")
        except ImportError as error:
            raise ImportError("a data frame takes pandas: pip install pandas") from error
        return pandas.DataFrame(self.rows())

    def _repr_html_(self) -> str:
        rows = self.rows()
        text = f"<p><code>{_escaped(repr(self))}</code></p>"
        if not rows:
            return text
        lines = [_line("th", rows[0].keys())]
        lines += [_line("td", map(_in_cell, row.values())) for row in rows[:MOST_HTML_ROWS]]
        more = len(rows) - MOST_HTML_ROWS
        rest = f"<p>and {more:,} more</p>" if more > 0 else ""
        return f"{text}<table>{''.join(lines)}</table>{rest}"


def _line(tag: str, cells: Any) -> str:
    return "<tr>" + "".join(f"<{tag}>{_escaped(cell)}</{tag}>" for cell in cells) + "</tr>"


def _escaped(content: object) -> str:
    """Text for HTML; its own module would take 1 ms, and only notebooks ask for HTML."""
    return str(content).translate(_ENTITIES)


def _in_cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, Mapping):
        return ", ".join(f"{key}={item}" for key, item in value.items())
    return value
