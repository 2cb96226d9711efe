"""Dataclasses whose methods are written when they are first called.

To write the methods of a frozen dataclass takes Python 0.4 ms, ten times as long as to make the
class, and a command imports two hundred of them; for each module that commands start with this is
the decorator to use. It changes nothing else. Type checkers see the standard library's own.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
    from inspect import Signature
else:

    def dataclass(
        cls: type | None = None,
        /,
        *,
        frozen: bool = False,
        eq: bool = True,
        slots: bool = False,
        kw_only: bool = False,
    ) -> Any:
        """The standard library's decorator, with these of its options."""

        def made(cls: type) -> type:
            if any(map(dataclasses.is_dataclass, cls.__bases__)):
                options = {"frozen": frozen, "eq": eq, "slots": slots, "kw_only": kw_only}
                return dataclasses.dataclass(cls, **options)
            own = frozenset(vars(cls))
            if "__eq__" in own and vars(cls)["__hash__"] is None:
                own -= {"__hash__"}  # of which Python says only that nobody has written it
            cls = dataclasses.dataclass(
                cls, init=False, repr=False, eq=False, slots=slots, kw_only=kw_only
            )
            _add_methods(cls, own, frozen=frozen, eq=eq)
            return cls

        return made if cls is None else made(cls)


def _add_methods(cls: Any, own: frozenset[str], *, frozen: bool, eq: bool) -> None:
    """Give a class those methods that its options ask for and that it has not of its ``own``."""
    cls.__dataclass_params__.frozen, cls.__dataclass_params__.eq = frozen, eq
    _put_off(cls, own, "__init__", _initializer)
    cls.__signature__ = _Signature()
    _put_off(cls, own, "__repr__", _by_twin, eq=False, init=False)
    if eq:
        _put_off(cls, own, "__eq__", _by_twin, repr=False, init=False)
        if frozen:
            options = {"repr": False, "init": False, "unsafe_hash": True}
            _put_off(cls, own, "__hash__", _by_twin, **options)
        elif "__hash__" not in own:
            cls.__hash__ = None
    if frozen:
        cls.__setattr__, cls.__delattr__ = _refuse_change, _refuse_removal
        if "__slots__" in vars(cls) and "__getstate__" not in own:
            cls.__getstate__, cls.__setstate__ = _state, _restore


class _Factory:
    """Stands in a signature for what a factory makes, as the library's own does."""

    def __repr__(self) -> str:
        return "<factory>"


_FACTORY = _Factory()

Writer = Callable[..., Callable[..., Any]]


def _put_off(cls: Any, own: frozenset[str], name: str, write: Writer, **options: bool) -> None:
    """Let a method be written when it is first called."""
    if name in own:
        return

    def first(self: object, *args: Any, **kwargs: Any) -> Any:
        method = write(cls, name, **options)
        setattr(cls, name, method)
        return method(self, *args, **kwargs)

    first.write = lambda: write(cls, name, **options)  # type: ignore[attr-defined]
    first.__name__ = name
    first.__qualname__ = f"{cls.__qualname__}.{name}"
    setattr(cls, name, first)


def _initializer(cls: Any, name: str) -> Callable[..., Any]:
    """``__init__``, which also a frozen object lets set its fields."""
    known: dict[str, Any] = {"_set": object.__setattr__, "_factory": _FACTORY}
    parameters: list[str] = []
    named: list[str] = []
    lines: list[str] = []
    for one in fields(cls):
        value = _value(one, known)
        if one.init:
            default = "" if one.default is MISSING else f" = _default_{one.name}"
            default = default if one.default_factory is MISSING else " = _factory"
            (named if one.kw_only else parameters).append(f"{one.name}{default}")
        if value:
            lines.append(f"_set(self, {one.name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    head = ", ".join(["self", *parameters, *(["*", *named] if named else [])])
    body = "\n    ".join(lines or ["pass"])
    exec(f"def {name}({head}):\n    {body}\n", known)
    method: Callable[..., Any] = known[name]
    method.__qualname__ = f"{cls.__qualname__}.{name}"
    method.__module__ = cls.__module__
    method.__annotations__ = {one.name: one.type for one in fields(cls) if one.init}
    method.__annotations__["return"] = None
    return method


def _value(one: Field[Any], known: dict[str, Any]) -> str:
    """What a field is set to, as Python; empty for one that nobody sets here."""
    if one.default_factory is not MISSING:
        known[f"_make_{one.name}"] = one.default_factory
        made = f"_make_{one.name}()"
        return f"{made} if {one.name} is _factory else {one.name}" if one.init else made
    if one.default is not MISSING:
        known[f"_default_{one.name}"] = one.default
        return one.name if one.init else f"_default_{one.name}"
    return one.name if one.init else ""


def _by_twin(cls: Any, name: str, **options: bool) -> Callable[..., Any]:
    """The method that the standard library writes for a class of the same fields."""
    namespace: dict[str, Any] = {
        "__annotations__": {one.name: object for one in fields(cls)},
        "__qualname__": cls.__qualname__,
        "__doc__": "",
    }
    for one in fields(cls):
        namespace[one.name] = dataclasses.field(repr=one.repr, hash=one.hash, compare=one.compare)
    twin: type = dataclasses.dataclass(type(cls.__name__, (), namespace), **options)
    method: Callable[..., Any] = vars(twin)[name]
    return method


def _refuse_change(_: object, name: str, __: object) -> None:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_removal(_: object, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[Any]:
    return [getattr(self, name) for name in self.__dataclass_fields__]


def _restore(self: Any, state: list[Any]) -> None:
    for name, value in zip(self.__dataclass_fields__, state, strict=True):
        object.__setattr__(self, name, value)


class _Signature:
    """What the class is called with, for those who ask."""

    def __get__(self, _: object, cls: Any) -> Signature:
        # 10 ms, and hardly anybody asks.
        from inspect import signature

        method = vars(cls).get("__init__", cls.__init__)
        written = method.write() if hasattr(method, "write") else method
        own = signature(written)
        return own.replace(parameters=list(own.parameters.values())[1:])
