"""Shapes of states: the names with values, and the places of these values.

Nearly all states of a drive have the same shape. What to look at, and where it lies, is determined
once per shape, so that encoding a state is fast.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.monitoring.online.encoding.encoded_values import (
    Breakpoints,
    Encoded,
    encoded_default,
    encoder_of,
)
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.vocabulary_model import choices, fitting_objects

Items: TypeAlias = tuple[str, ...]
"""Objects, in the order of parameters or of a rule's variables."""

StateKey: TypeAlias = Callable[[Any], Hashable]
"""The key of a state in caches. Raises as ``StateShape.encode``."""

_EncodePart: TypeAlias = Callable[[Any], Encoded]


class StateShape:
    """The shape of states with values for one set of names and objects.

    ``places`` has, by name and objects, the part of an encoded state that contains the value, and
    its place there; ``sizes`` are the parts' sizes. The first ``n_world`` parts are about the
    world, each other part about one of the ``names``. ``key`` gives a state's key, ``key_of`` the
    same from the encoded state. Raises LookupError if such states need closer inspection, for
    instance if a name is not declared.
    """

    def __init__(
        self,
        names: Sequence[str],
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
        breakpoints: Breakpoints,
    ) -> None:
        declarations = [vocabulary.declarations[name] for name in names]
        self.objects, self.vocabulary, self.breakpoints = objects, vocabulary, breakpoints
        self.names = frozenset(names)
        self.places: dict[tuple[str, Items], tuple[int, int]] = {}
        self.sizes: list[int] = []
        self._n_names = len(names)
        self._parts: list[_EncodePart] = []
        for alike in _about_the_world(declarations):
            given = values_at([declaration.name for declaration in alike])
            encode = _encoded(given, alike[0], breakpoints)
            self._add(encode, [(declaration.name, ()) for declaration in alike])
        self.n_world = len(self._parts)
        of_kind: dict[str, Items] = {}
        chosen: dict[tuple[str, ...], Sequence[Items]] = {}
        for declaration in declarations:
            if kinds := declaration.parameters:
                for kind in kinds:
                    if kind not in of_kind:
                        of_kind[kind] = tuple(fitting_objects(kind, objects, vocabulary))
                if kinds not in chosen:
                    chosen[kinds] = tuple(choices(kinds, objects, vocabulary))
                fitting = [of_kind[kind] for kind in kinds]
                encode = _of_objects(declaration, fitting, breakpoints)
                values = [(declaration.name, items) for items in chosen[kinds]]
                self._add(_inside(declaration.name, encode), values)
        self.key: StateKey = self.encode
        self.key_of: Callable[[tuple[Encoded, ...]], Hashable] = lambda encoded: encoded
        if len(self._parts) == 1:
            # All at once, because often nothing else has to be done.
            self.key_of = lambda encoded: encoded[0]
            self.key = _key_of_one_part(self._parts[0], self._n_names)
            (declaration, *_) = declarations
            if isinstance(declaration, Enumeration) and len(declaration.parameters) == 1:
                (present,) = fitting
                if present:
                    self.key = _key_of_one_relation(declaration.name, present)
                if len(present) == 1:
                    self.key_of = lambda encoded: encoded[0][0]

    def _add(self, part: _EncodePart, values: Sequence[tuple[str, Items]]) -> None:
        self.places |= {value: (len(self._parts), place) for place, value in enumerate(values)}
        self.sizes.append(len(values))
        self._parts.append(part)

    def encode(self, state: Any) -> tuple[Encoded, ...]:
        """Encode a state in parts; equal parts are equivalent for every rule.

        Raises LookupError or TypeError if the state has another shape or needs closer inspection.
        """
        if type(state) is not dict or len(state) != self._n_names:
            raise LookupError
        return tuple([part(state) for part in self._parts])


def _key_of_one_part(part: _EncodePart, n_names: int) -> StateKey:
    def key(state: Any) -> Hashable:
        if type(state) is dict and len(state) == n_names:
            return part(state)
        raise LookupError

    return key


def _key_of_one_relation(name: str, items: Items) -> StateKey:
    """The key of a name about a single object: its value."""
    n_items = len(items)
    (item, *others) = items

    def key_of_one_item(state: Any) -> Hashable:
        if type(state) is dict and len(state) == 1:
            given = state[name]
            if type(given) is dict and len(given) == 1:
                value: Hashable = given[item]
                return value
        raise LookupError

    if not others:
        return key_of_one_item
    values: StateKey = itemgetter(*items)

    def key(state: Any) -> Hashable:
        if type(state) is dict and len(state) == 1:
            given = state[name]
            if type(given) is dict and len(given) == n_items:
                return values(given)
        raise LookupError

    return key


def _about_the_world(declarations: Sequence[Declaration]) -> Iterator[list[Declaration]]:
    of_world = [declaration for declaration in declarations if not declaration.parameters]
    for kind in (Enumeration, Signal):
        alike: list[Declaration] = [own for own in of_world if isinstance(own, kind)]
        if alike:
            yield alike
    for declaration in of_world:
        if isinstance(declaration, Quantity):
            yield [declaration]


def _encoded(
    values: _EncodePart, declaration: Declaration, breakpoints: Breakpoints
) -> _EncodePart:
    if isinstance(declaration, Enumeration):
        return values
    encode = encoder_of(declaration, breakpoints)
    return lambda given: encode(values(given))


def _inside(name: str, encode: _EncodePart) -> _EncodePart:
    return lambda given: encode(given[name])


def _of_objects(
    declaration: Declaration,
    fitting: Sequence[Items],
    breakpoints: Breakpoints,
    before: Items = (),
) -> _EncodePart:
    """The encoder of a name's values for all choices of distinct objects."""
    items = tuple([item for item in fitting[0] if item not in before])
    if len(fitting) > 1:
        return _of_more_objects(
            {
                item: _of_objects(declaration, fitting[1:], breakpoints, (*before, item))
                for item in items
            }
        )
    encode_all, n_items = _encoded(values_at(items), declaration, breakpoints), len(items)
    encode = encoder_of(declaration, breakpoints)
    default = encoded_default(declaration, breakpoints)

    def encode_objects(given: Any) -> Encoded:
        if type(given) is not dict:
            raise LookupError
        if len(given) == n_items:
            return encode_all(given)
        some = dict(zip(given, encode(tuple(given.values())), strict=True))
        values = tuple([some.pop(item, default) for item in items])
        # The remaining values are about other names.
        if some:
            raise LookupError
        return values

    return encode_objects


def _of_more_objects(inner: Mapping[str, _EncodePart]) -> _EncodePart:
    parts = list(inner.items())

    def encode_objects(given: Any) -> Encoded:
        if type(given) is dict and inner.keys() >= given.keys():
            return tuple([value for item, part in parts for value in part(given.get(item, {}))])
        raise LookupError

    return encode_objects
