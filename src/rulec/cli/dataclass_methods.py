"""Dataclasses whose methods are written when first called, only for the program `rulec`.

A command imports hundreds of dataclasses and makes objects of few. Python writes and compiles six
methods for each on import, which is a fifth of the time of a short command. Here each method is
written on first use; from then on it is an ordinary function. Programs that import rulec as a
library get ordinary dataclasses.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import MISSING, FrozenInstanceError, fields
from functools import partial
from inspect import get_annotations  # also imported by `dataclasses`
from reprlib import recursive_repr
from typing import Any

_AS_PYTHON_DOES = dataclasses.dataclass
_KNOWN = {"frozen", "slots", "eq", "kw_only"}
"""The options that rulec's dataclasses use; classes with others are left to Python."""


def write_when_called() -> None:
    """Make the dataclasses of rulec that are imported from now on write their methods late."""
    dataclasses.dataclass = dataclass


def dataclass(given: type | None = None, /, **options: bool) -> Any:
    """As ``dataclasses.dataclass``, but the methods of rulec's classes are written late."""

    def made(cls: type) -> type:
        if options.keys() <= _KNOWN and _is_plain(cls):
            return _late(cls, **options)
        return _AS_PYTHON_DOES(cls, **options)

    return made if given is None else made(given)


def _is_plain(cls: type) -> bool:
    annotations = map(str, get_annotations(cls).values())
    return cls.__module__.startswith("rulec.") and not any(
        "InitVar" in annotation for annotation in annotations
    )


def _late(
    given: type,
    *,
    frozen: bool = False,
    slots: bool = False,
    eq: bool = True,
    kw_only: bool = False,
) -> type:
    own = {**given.__dict__}
    if own.get("__hash__") is None:
        own.pop("__hash__", None)  # Python adds it to classes with an `__eq__`
    if given.__doc__ is None:
        given.__doc__ = given.__name__  # otherwise Python would compute a signature
    make = _AS_PYTHON_DOES(init=False, repr=False, eq=False, slots=slots, kw_only=kw_only)
    cls: type = make(given)
    methods: dict[str, object] = {
        "__init__": _Unwritten(cls, "__init__", partial(_init_text, frozen=frozen)),
        "__repr__": _of_one(_Unwritten(cls, "__repr__", _repr_text)),
    }
    if eq:
        methods["__eq__"] = _of_two(_Unwritten(cls, "__eq__", _eq_text))
        hashed = _of_one(_Unwritten(cls, "__hash__", _hash_text)) if frozen else None
        methods["__hash__"] = hashed
    if frozen:
        methods["__setattr__"] = _refusing(cls, "assign to", "__setattr__")
        methods["__delattr__"] = _refusing(cls, "delete", "__delattr__")
        if slots:
            methods |= {"__getstate__": _state, "__setstate__": _set_state}
    for name, method in methods.items():
        if name not in own:
            setattr(cls, name, method)
    return cls


@dataclasses.dataclass(slots=True)
class _Unwritten:
    """A method that is not written yet."""

    cls: type
    name: str
    text: Callable[[type, dict[str, object]], str]

    def __get__(self, item: object, owner: type) -> object:
        return self.written().__get__(item, owner)

    def written(self) -> Any:
        """The method, which replaces this object from now on."""
        names: dict[str, object] = {"_MISSING": MISSING, "_set": object.__setattr__}
        exec(self.text(self.cls, names), names)
        method: Any = names[self.name]
        method.__qualname__ = f"{self.cls.__qualname__}.{self.name}"
        method.__module__ = self.cls.__module__
        if self.name == "__repr__":
            method = recursive_repr()(method)
        setattr(self.cls, self.name, method)
        return method


# Whoever makes an object gets what is raised while `__init__` is looked up. Python looks the other
# methods up to compare, hash or show objects, and drops whatever is raised while it does so, such
# as by Ctrl-C. So these are found as functions, and written when they are called.


def _of_one(method: _Unwritten) -> Callable[[Any], Any]:
    """A method without arguments, which the first call writes."""

    def call(self: Any) -> Any:
        return method.written()(self)

    _name_after(method, call)
    return call


def _of_two(method: _Unwritten) -> Callable[[Any, Any], Any]:
    """A method with one argument, which the first call writes."""

    def call(self: Any, other: Any) -> Any:
        return method.written()(self, other)

    _name_after(method, call)
    return call


def _name_after(method: _Unwritten, call: Any) -> None:
    call.__name__ = method.name
    call.__qualname__ = f"{method.cls.__qualname__}.{method.name}"
    call.__module__ = method.cls.__module__


def _init_text(cls: type, names: dict[str, object], *, frozen: bool) -> str:
    """The method's source text; ``names`` receives the defaults that it refers to."""
    parameters: dict[bool, list[str]] = {False: [], True: []}
    lines = []
    for field in fields(cls):
        name = field.name
        names |= {f"_value_{name}": field.default, f"_make_{name}": field.default_factory}
        is_made = field.default_factory is not MISSING
        value = f"_make_{name}()"
        if field.init:
            default = "_MISSING" if is_made else f"_value_{name}"
            is_optional = is_made or field.default is not MISSING
            parameters[field.kw_only is True].append(f"{name}={default}" if is_optional else name)
            value = f"{value} if {name} is _MISSING else {name}" if is_made else name
        elif not is_made:
            if field.default is MISSING or "__slots__" not in cls.__dict__:
                continue
            value = f"_value_{name}"
        lines.append(f"_set(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    by_name = ["*", *parameters[True]] if parameters[True] else []
    return _function("__init__", ["self", *parameters[False], *by_name], lines or ["pass"])


def _repr_text(cls: type, _: dict[str, object]) -> str:
    text = ", ".join(f"{field.name}={{self.{field.name}!r}}" for field in fields(cls) if field.repr)
    return _function("__repr__", ["self"], [f"return f'{{self.__class__.__qualname__}}({text})'"])


def _eq_text(cls: type, _: dict[str, object]) -> str:
    compared = [field.name for field in fields(cls) if field.compare]
    same = f"{_tuple('self', compared)} == {_tuple('other', compared)}"
    lines = [f"return {same} if other.__class__ is self.__class__ else NotImplemented"]
    return _function("__eq__", ["self", "other"], lines)


def _hash_text(cls: type, _: dict[str, object]) -> str:
    hashed = [
        field.name for field in fields(cls) if (field.compare if field.hash is None else field.hash)
    ]
    return _function("__hash__", ["self"], [f"return hash({_tuple('self', hashed)})"])


def _tuple(item: str, names: Sequence[str]) -> str:
    return f"({''.join(f'{item}.{name}, ' for name in names)})"


def _function(name: str, parameters: Sequence[str], lines: Sequence[str]) -> str:
    return "\n ".join([f"def {name}({', '.join(parameters)}):", *lines])


def _refusing(cls: type, deed: str, method: str) -> Callable[..., None]:
    """A method that protects a frozen object; derived classes may have more attributes."""

    def refuse(self: object, name: str, *value: object) -> None:
        if type(self) is cls or any(field.name == name for field in fields(cls)):
            raise FrozenInstanceError(f"cannot {deed} field {name!r}")
        getattr(super(cls, self), method)(name, *value)

    return refuse


def _state(self: Any) -> list[object]:
    return [getattr(self, field.name) for field in fields(self)]


def _set_state(self: Any, state: Sequence[object]) -> None:
    for field, value in zip(fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)
