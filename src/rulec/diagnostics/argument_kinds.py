"""Type checks of the arguments of public functions, by their annotations."""

from __future__ import annotations

import ast
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, fields
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache, wraps
from inspect import Parameter, signature
from itertools import chain, islice, repeat
from math import isfinite
from numbers import Rational, Real
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar, cast

AnyFunction = TypeVar("AnyFunction", bound=Callable[..., Any])

WAYS_OUT = {
    "Assumptions": 'rulec.Assumptions(ends="cut")',
    "CompiledRulebook": "rulec.compile_rulebook(name_or_path) makes one",
    "ExampleRun": "rulec.test(rulebook) makes one",
    "Maneuver": "maneuvers.cheapest(1) has one",
    "Maneuvers": "rulec.find_maneuvers(scenario, rules) finds them",
    "NavigationGraph": "rulec.navigation_graph(scenario) makes one",
    "Recording": "rulec.recording_from_columns(tracks, lanes) makes one of a data frame, "
    "rulec.read_recording(path) reads one",
    "RequestedDrives": 'rulec.RequestedDrives(egos=["12"])',
    "Rulebook": "rulec.load_rulebook(name_or_path) reads one",
    "Scenario": "rulec.load_scenario(name_or_path) reads one",
    "Trace": "rulec.read_traces(path) yields those of a file",
    "TrafficWorld": "rulec.TrafficWorld(recording, ego)",
    "Violation": "rulec.verify(trace, rules).violations has them",
}
"""Type of an argument -> how to get a value of that type."""

_ALIASES = {
    "AdjacencyName": "str",
    "Before": "Trace | Monitor | Mapping | SavedPast",
    "ExtentName": "str",
    "GroupKey": "str",
    "Kind": "str",
    "Ending": "str",
    "LaneMark": "str",
    "LanguageCode": "str",
    "PartitionName": "str",
    "PictureFormat": "str",
    "Prediction": "str",
    "Rules": "str | Path | CompiledRulebook | Rulebook",
    "Side": "str",
    "Spread": "Callable",
    "Theme": "str",
}
_UNSAID = {"None", "SavedPast"}
"""Types that errors do not name: None, and a type passed only by commands."""

_ANYTHING = {"Any", "ArrayLike", "Points", "object"}


def checked_kinds(function: AnyFunction) -> AnyFunction:
    """Make a function raise TypeError for arguments whose types differ from its annotations.

    The error names the argument, the expected type and how to get a value of it. Items of lists are
    checked as well, and items of iterators when they are consumed.
    """
    parameters = signature(function).parameters.values()
    annotated = [_annotation(parameter) for parameter in parameters]
    by_name = dict(annotated)
    more = [parameter for parameter in parameters if parameter.kind is Parameter.VAR_POSITIONAL]
    others = _annotation(more[0]) if more else ("", "")

    @wraps(function)
    def checked(*given: Any, **named: Any) -> Any:
        in_order = [
            expected(*known, value)
            for known, value in zip(chain(annotated, repeat(others)), given, strict=False)
        ]
        by_names = {
            name: expected(name, by_name.get(name, ""), value) for name, value in named.items()
        }
        return function(*in_order, **by_names)

    return cast("AnyFunction", checked)


def expected(name: str, annotation: str, value: Any) -> Any:
    """The value if its type fits the annotation; otherwise raises TypeError with a way out.

    Raises ValueError for a str that is not one of the literals listed. Where a sequence is
    expected, an iterator, an array or a column is returned as a tuple; where a path is expected, a
    path-like object as a Path.
    """
    if not annotation or not _kinds(annotation):
        return value
    kind = _fitting(annotation, cast("Hashable", type(value)))
    if kind is None:
        raise _unexpected(name, annotation, value)
    if kind.name == "Literal" and repr(str(value)) not in kind.phrase:
        raise ValueError(f"`{name}` is {kind.phrase}, not {value!r}")
    if kind.name == "Path" and not isinstance(value, Path):
        try:
            return Path(value)
        except TypeError:  # a path of bytes
            raise _unexpected(name, annotation, value) from None
    if not kind.items:
        return value
    if isinstance(value, Mapping):
        for part, own in zip(("keys", "values"), kind.items, strict=True):
            for _ in _checked_items(f"{name}.{part}()", own, iter(getattr(value, part)())):
                pass
        return value
    try:
        given = iter(value)
    except TypeError:  # an array of one number
        raise _unexpected(name, annotation, value) from None
    items = _checked_items(name, kind.items[0], given)
    if not isinstance(value, Sequence | Set):
        is_array = hasattr(type(value), "ndim")
        return items if kind.name == "Iterable" and not is_array else tuple(items)
    # All items of a range have the same type, and there may be too many to check.
    for _ in islice(items, 1) if isinstance(value, range) else items:
        pass
    return value


def expected_fields(record: Any) -> None:
    """Raise TypeError if a dataclass's field has another type than declared."""
    for field in fields(record):
        expected(field.name, str(field.type), getattr(record, field.name))


def finite(name: str, value: Fraction | float | None) -> None:
    """Raise TypeError for a value that is no number, ValueError for an infinite one or NaN."""
    if expected(name, "float | None", value) is not None and not is_finite(value or 0):
        raise ValueError(f"`{name}` is a finite number, not {_short_number(value or 0)}")


def is_finite(value: Fraction | float) -> bool:
    """Whether a number is finite and within the range of floats."""
    try:
        return isfinite(value)
    except (OverflowError, ValueError):
        return False


def _short_number(value: Fraction | float) -> str:
    return str(value) if isinstance(value, float) else "one beyond all floats"


def _checked_items(name: str, annotation: str, items: Iterator[Any]) -> Iterator[Any]:
    for number, item in enumerate(items):
        yield expected(f"{name}[{number}]", annotation, item)


def _unexpected(name: str, annotation: str, value: object) -> TypeError:
    kinds = _kinds(annotation)
    items = [inner for kind in kinds for own in kind.items for inner in _kinds(own)]
    names = [kind.name for kind in (*kinds, *items)]
    ways = [WAYS_OUT[name] for name in names if name in WAYS_OUT]
    phrases = [kind.phrase for kind in kinds if kind.name not in _UNSAID]
    listed = " or ".join(filter(None, (", ".join(phrases[:-1]), phrases[-1])))
    way_out = f": {ways[0]}" if ways else ""
    return TypeError(f"`{name}` is {listed}, not {type(value).__name__}{way_out}")


@dataclass(frozen=True, slots=True)
class _Kind:
    """One alternative of an annotation: which types fit, and the annotations of its items.

    ``items`` has one annotation, for a mapping one for its keys and one for its values.
    """

    name: str
    phrase: str
    holds: Callable[[type], bool]
    items: tuple[str, ...] = ()


@lru_cache(maxsize=1 << 12)
def _fitting(annotation: str, given: Hashable) -> _Kind | None:
    """The alternative that fits a type and demands least of items; None if none fits."""
    fitting = [kind for kind in _kinds(annotation) if kind.holds(cast("type", given))]
    return min(fitting, key=lambda kind: kind.items, default=None)


def _annotation(parameter: Parameter) -> tuple[str, str]:
    text = parameter.annotation
    is_open = parameter.kind is Parameter.VAR_KEYWORD or not isinstance(text, str)
    return parameter.name, "" if is_open else text


@lru_cache(maxsize=1 << 10)
def _kinds(annotation: str) -> tuple[_Kind, ...]:
    """The alternatives of an annotation; empty if any value is allowed."""
    if not annotation:
        return ()
    kinds = list(_alternatives(ast.parse(annotation, mode="eval").body))
    return () if any(kind.name in _ANYTHING for kind in kinds) else tuple(kinds)


def _alternatives(node: ast.expr) -> Iterator[_Kind]:
    if isinstance(node, ast.BinOp):
        yield from _alternatives(node.left)
        yield from _alternatives(node.right)
    elif isinstance(node, ast.Subscript):
        own = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        yield _parametrized(ast.unparse(node.value), [ast.unparse(expr) for expr in own])
    elif (name := ast.unparse(node).rpartition(".")[2]) in _ALIASES:
        yield from _kinds(_ALIASES[name])
    elif name in _PLAIN:
        yield _Kind(name, *_PLAIN[name])
    else:
        # The name stands for a class: importing the classes of all annotations would take 300 ms.
        yield _Kind(
            name,
            _with_article(name),
            lambda given: name in [base.__name__ for base in given.__mro__],
        )


def _with_article(name: str) -> str:
    if name.endswith("s"):
        return name
    return f"an {name}" if name[0] in "AEIOU" else f"a {name}"


def _parametrized(name: str, items: Sequence[str]) -> _Kind:
    if name == "Literal":
        return _Kind(name, f"one of {', '.join(items)}", lambda given: issubclass(given, str))
    if name in _PLAIN:
        is_plain = name == "Mapping" and {*items} <= _PLAIN.keys() | _ALIASES.keys() | _ANYTHING
        return _Kind(name, *_PLAIN[name], tuple(items) if is_plain else ())
    if name in ("Collection", "Iterable", "Sequence"):
        return _Kind(name, f"an iterable of {items[0].partition(' ')[0]}", _is_listed, tuple(items))
    return _Kind("Any", "", lambda _: True)


def _is_listed(given: type) -> bool:
    return issubclass(given, Iterable) and not issubclass(given, str | bytes | Mapping)


def _is_whole(given: type) -> bool:
    # Arrays of one number have `__index__`, others do not
    return hasattr(given, "__index__") and "ndarray" not in [
        parent.__name__ for parent in given.__mro__
    ]


_PLAIN: dict[str, tuple[str, Callable[[type], bool]]] = {
    "Callable": ("a function", lambda given: issubclass(given, cast("type", Callable))),
    "Fraction": ("a Fraction", lambda given: issubclass(given, Rational | Decimal)),
    "Mapping": ("a dict", lambda given: issubclass(given, Mapping)),
    "None": ("None", lambda given: given is type(None)),
    "Path": ("a path", lambda given: issubclass(given, PathLike)),
    "bool": ("True or False", lambda given: given.__name__ in ("bool", "bool_")),
    "frozenset": ("a frozenset", lambda given: issubclass(given, Set)),
    "float": ("a number", lambda given: issubclass(given, Real)),
    "int": ("a whole number", _is_whole),
    "str": ("a str", lambda given: issubclass(given, str)),
    "tuple": ("a tuple", lambda given: _is_listed(given) and issubclass(given, Sequence)),
}
