"""Type checks of the arguments of public functions, by their annotations."""

from __future__ import annotations

import ast
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache, wraps
from inspect import Parameter, signature
from itertools import chain, repeat
from math import isfinite
from numbers import Rational, Real
from os import PathLike
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
    "Trace": "rulec.read_traces(path) yields those of a file; recorded traffic goes to "
    "rulec.verify_recording(path, rules)",
    "TrafficWorld": "rulec.TrafficWorld(recording, ego)",
    "Violation": "rulec.verify(trace, rules).violations has them",
}
"""Kind of argument -> what gives one."""

_ALIASES = {
    "AdjacencyName": "str",
    "Before": "Trace | Monitor | Mapping | SavedPast",
    "ExtentName": "str",
    "GroupKey": "str",
    "Kind": "str",
    "LanguageCode": "str",
    "PartitionName": "str",
    "PictureFormat": "str",
    "Rules": "str | Path | CompiledRulebook | Rulebook",
    "Theme": "str",
}
_UNSAID = {"None", "SavedPast"}
"""Kinds that errors do not name: no argument at all, and what only commands give."""

_ANYTHING = {"Any", "ArrayLike", "Spread", "object"}


def checked_kinds(function: AnyFunction) -> AnyFunction:
    """Make a function raise TypeError for arguments of other kinds than its annotations say.

    The error says which argument it is, what it should be, and what gives that. Items of lists are
    looked at, too, and those of iterators when they come.
    """
    parameters = signature(function).parameters.values()
    annotated = [_annotation(one) for one in parameters]
    by_name = dict(annotated)
    more = [one for one in parameters if one.kind is Parameter.VAR_POSITIONAL]
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
    """A value that is of one of the kinds of an annotation, else TypeError with the way out."""
    if not annotation:
        return value
    items = _items(annotation, cast("Hashable", type(value)))
    if items is None:
        raise _unexpected(name, annotation, value)
    if not items:
        return value
    if isinstance(value, Iterator):
        return _checked_items(name, items, value)
    if isinstance(value, list | tuple | set) or type(value).__name__ == "ndarray":
        for _ in _checked_items(name, items, iter(value)):
            pass
    return value


def finite(name: str, value: Fraction | float | None) -> None:
    """Raise TypeError for what is no number, ValueError for one that is infinite or NaN."""
    if expected(name, "float | None", value) is not None and not isfinite(value or 0):
        raise ValueError(f"`{name}` is a finite number, not {value}")


def _checked_items(name: str, annotation: str, items: Iterator[Any]) -> Iterator[Any]:
    for number, item in enumerate(items):
        yield expected(f"{name}[{number}]", annotation, item)


def _unexpected(name: str, annotation: str, value: object) -> TypeError:
    kinds = _kinds(annotation)
    names = [one.name for kind in kinds for one in (kind, *_kinds(kind.items))]
    ways = [WAYS_OUT[name] for name in names if name in WAYS_OUT]
    said = [kind.said for kind in kinds if kind.name not in _UNSAID]
    listed = " or ".join(filter(None, (", ".join(said[:-1]), said[-1])))
    way_out = f": {ways[0]}" if ways else ""
    return TypeError(f"`{name}` is {listed}, not {type(value).__name__}{way_out}")


@dataclass(frozen=True, slots=True)
class _Kind:
    """One of an annotation's alternatives: which types are of it, and what its items are."""

    name: str
    said: str
    holds: Callable[[type], bool]
    items: str = ""


@lru_cache(maxsize=1 << 12)
def _items(annotation: str, given: Hashable) -> str | None:
    """The annotation of the items of what has a type, None if that is not expected."""
    kinds = _kinds(annotation)
    fitting = [kind.items for kind in kinds if kind.holds(cast("type", given))]
    if kinds and not fitting:
        return None
    return min(fitting, default="")


def _annotation(parameter: Parameter) -> tuple[str, str]:
    text = parameter.annotation
    is_open = parameter.kind is Parameter.VAR_KEYWORD or not isinstance(text, str)
    return parameter.name, "" if is_open else text


@lru_cache(maxsize=1 << 10)
def _kinds(annotation: str) -> tuple[_Kind, ...]:
    """The alternatives of an annotation; none if anything goes."""
    if not annotation:
        return ()
    found = list(_alternatives(ast.parse(annotation, mode="eval").body))
    return () if any(kind.name in _ANYTHING for kind in found) else tuple(found)


def _alternatives(node: ast.expr) -> Iterator[_Kind]:
    if isinstance(node, ast.BinOp):
        yield from _alternatives(node.left)
        yield from _alternatives(node.right)
    elif isinstance(node, ast.Subscript):
        yield _parametrized(ast.unparse(node.value), ast.unparse(node.slice))
    elif (name := ast.unparse(node).rpartition(".")[2]) in _ALIASES:
        yield from _kinds(_ALIASES[name])
    elif name in _PLAIN:
        yield _Kind(name, *_PLAIN[name])
    else:
        # Its name stands for a class: to import what all annotations name takes 300 ms.
        yield _Kind(
            name,
            _with_article(name),
            lambda given: name in [base.__name__ for base in given.__mro__],
        )


def _with_article(name: str) -> str:
    if name.endswith("s"):
        return name
    return f"an {name}" if name[0] in "AEIOU" else f"a {name}"


def _parametrized(name: str, items: str) -> _Kind:
    if name == "Literal":
        return _Kind(name, f"one of {items.strip('()')}", lambda given: issubclass(given, str))
    if name in _PLAIN:
        return _Kind(name, *_PLAIN[name])
    if name in ("Iterable", "Sequence"):
        return _Kind(name, f"an iterable of {items.partition(' ')[0]}", _is_listed, items)
    return _Kind("Any", "", lambda _: True)


def _is_listed(given: type) -> bool:
    return issubclass(given, Iterable) and not issubclass(given, str | bytes | Mapping)


def _is_whole(given: type) -> bool:
    # Arrays of one number are, too, and others are not
    return hasattr(given, "__index__") and given.__name__ != "ndarray"


_PLAIN: dict[str, tuple[str, Callable[[type], bool]]] = {
    "Callable": ("a function", lambda given: issubclass(given, cast("type", Callable))),
    "Fraction": ("a Fraction", lambda given: issubclass(given, Rational | Decimal)),
    "Mapping": ("a dict", lambda given: issubclass(given, Mapping)),
    "None": ("None", lambda given: given is type(None)),
    "Path": ("a path", lambda given: issubclass(given, PathLike)),
    "bool": ("True or False", lambda given: given.__name__ in ("bool", "bool_")),
    "float": ("a number", lambda given: issubclass(given, Real)),
    "int": ("a whole number", _is_whole),
    "str": ("a str", lambda given: issubclass(given, str)),
}
