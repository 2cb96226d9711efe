"""What states speak of that give values to the same names, and their values in one order.

Nearly all states of a drive do. What is to be looked at, and where it lies, is worked out once, so
that a state is taken apart far more quickly than any state could be.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.monitoring.online.breakpoints import Floors
from rulec.monitoring.online.encoded_values import Told, check_of, default_told, values_of
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

Items: TypeAlias = tuple[str, ...]
"""Objects, in the order of parameters or of a rule's variables."""

Key: TypeAlias = Callable[[Any], Hashable]
"""What states are known by. Raises as ``Outline.told``."""

_Part: TypeAlias = Callable[[Any], Told]


class StateShape:
    """The outline of states that give values to the same names while the same objects are there.

    ``places`` says by name and objects in which part of a state a value stands, and where there;
    ``sizes`` are the parts' sizes. The first ``n_world`` ones are about the world, each other one
    about one of the ``names``. By their ``key`` states are known; from what is ``told`` of a state
    it is ``key_of``.

    Raises:
        LookupError: such a state needs a closer look, as if there is no declaration of a name.
    """

    def __init__(
        self,
        names: Sequence[str],
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
        floors: Floors,
    ) -> None:
        about = [vocabulary.declarations[name] for name in names]
        self.names = frozenset(names)
        self.places: dict[tuple[str, Items], tuple[int, int]] = {}
        self.sizes: list[int] = []
        self._n_names = len(names)
        self._parts: list[_Part] = []
        for alike in _about_the_world(about):
            values = values_of([one.name for one in alike])
            self._add(_checked(values, alike[0], floors), [(one.name, ()) for one in alike])
        self.n_world = len(self._parts)
        for one in about:
            if one.parameters:
                fitting = [
                    tuple(
                        [name for name, own in objects.items() if vocabulary.is_subtype(own, kind)]
                    )
                    for kind in one.parameters
                ]
                told = _of_objects(one, fitting, floors)
                items = [(one.name, chosen) for chosen in _distinct(fitting)]
                self._add(_inside(one.name, told), items)
        self.key: Key = self.told
        self.key_of: Callable[[tuple[Told, ...]], Hashable] = lambda told: told
        if len(self._parts) == 1:
            # In one go, because there may be nothing else to do.
            self.key_of = lambda told: told[0]
            self.key = _key_of_one_part(self._parts[0], self._n_names)
            if isinstance(about[0], Enumeration) and len(about[0].parameters) == 1:
                (there,) = fitting
                if there:
                    self.key = _key_of_one_relation(about[0].name, there)
                if len(there) == 1:
                    self.key_of = lambda told: told[0][0]

    def _add(self, part: _Part, values: Sequence[tuple[str, Items]]) -> None:
        self.places |= {one: (len(self._parts), place) for place, one in enumerate(values)}
        self.sizes.append(len(values))
        self._parts.append(part)

    def told(self, state: Any) -> tuple[Told, ...]:
        """The parts of a state. States in which they are alike are alike for every rule.

        Raises a LookupError or a TypeError if the state has another outline, or needs a closer
        look. Values of enumerations may be wrong.
        """
        if type(state) is not dict or len(state) != self._n_names:
            raise LookupError
        return tuple([part(state) for part in self._parts])


def _key_of_one_part(part: _Part, n_names: int) -> Key:
    def key(state: Any) -> Hashable:
        if type(state) is dict and len(state) == n_names:
            return part(state)
        raise LookupError

    return key


def _key_of_one_relation(name: str, items: Items) -> Key:
    """Of a single object the key is its value."""
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
    values: Key = itemgetter(*items)

    def key(state: Any) -> Hashable:
        if type(state) is dict and len(state) == 1:
            given = state[name]
            if type(given) is dict and len(given) == n_items:
                return values(given)
        raise LookupError

    return key


def _about_the_world(about: Sequence[Declaration]) -> Iterator[list[Declaration]]:
    """Those that can be checked together, together."""
    of_world = [one for one in about if not one.parameters]
    for kind in (Enumeration, Signal):
        alike: list[Declaration] = [one for one in of_world if isinstance(one, kind)]
        if alike:
            yield alike
    for one in of_world:
        if isinstance(one, Quantity):
            yield [one]


def _distinct(fitting: Sequence[Items], before: Items = ()) -> Iterator[Items]:
    """Every choice of distinct objects, one from each."""
    if not fitting:
        yield before
        return
    for item in fitting[0]:
        if item not in before:
            yield from _distinct(fitting[1:], (*before, item))


def _checked(values: _Part, one: Declaration, floors: Floors) -> _Part:
    if isinstance(one, Enumeration):
        return values
    check = check_of(one, floors)
    return lambda given: check(values(given))


def _inside(name: str, told: _Part) -> _Part:
    return lambda given: told(given[name])


def _of_objects(
    one: Declaration, fitting: Sequence[Items], floors: Floors, before: Items = ()
) -> _Part:
    """What is told of every choice of distinct objects, in order, from what is given of some."""
    items = tuple([item for item in fitting[0] if item not in before])
    if len(fitting) > 1:
        inner = [(item, _of_objects(one, fitting[1:], floors, (*before, item))) for item in items]
        return _of_more_objects(inner)
    all_told, n_items = _checked(values_of(items), one, floors), len(items)
    check, default = check_of(one, floors), default_told(one, floors)

    def told(given: Any) -> Told:
        if type(given) is not dict:
            raise LookupError
        if len(given) == n_items:
            return all_told(given)
        some = dict(zip(given, check(tuple(given.values())), strict=True))
        found = tuple([some.pop(item, default) for item in items])
        # Of whom else is something given?
        if some:
            raise LookupError
        return found

    return told


def _of_more_objects(inner: Sequence[tuple[str, _Part]]) -> _Part:
    known = frozenset([item for item, _ in inner])

    def told(given: Any) -> Told:
        if type(given) is dict and known.issuperset(given):
            return tuple([value for item, part in inner for value in part(given.get(item, {}))])
        raise LookupError

    return told
