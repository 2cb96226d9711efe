"""Dataclasses whose methods are written when they are first called, held against the library's."""

import copy
import dataclasses
import inspect
import pickle
from dataclasses import FrozenInstanceError, field, fields, replace

import pytest

from rulec.lazy_dataclass import dataclass

WAYS = {
    "frozen": {"frozen": True},
    "frozen, in slots": {"frozen": True, "slots": True},
    "without eq": {"frozen": True, "slots": True, "eq": False},
    "by keyword": {"frozen": True, "slots": True, "kw_only": True},
    "to be changed": {"slots": True},
    "plain": {},
}


def made(decorator, options):
    """The class as it is made by a decorator."""

    class Place:
        """A place."""

        name: str
        size: float = 1.5
        tags: list[str] = field(default_factory=list)
        hidden: int = field(default=7, repr=False, compare=False)
        whole: str = field(init=False)

        def __post_init__(self):
            object.__setattr__(self, "whole", f"{self.name}!")

        def loud(self):
            return self.whole.upper()

    return decorator(**options)(Place)


ARGUMENTS = [
    ((), {"name": "a"}),
    ((), {"name": "a", "size": 2, "tags": ["x"], "hidden": 0}),
    (("a",), {}),
    (("a", 2, ["x"], 0), {}),
    ((), {}),
    (("a",), {"name": "b"}),
    (("a", 2, [], 0, 1), {}),
    ((), {"name": "a", "sice": 2}),
]


def outcome(ask, *arguments):
    """The answer, or the error that there is in its place."""
    try:
        return ask(*arguments)
    except Exception as error:
        return type(error), str(error)


def about(cls):
    """What can be seen of a class, and of its objects."""
    one, same, other = cls(name="a"), cls(name="a", hidden=0), cls(name="b")
    yield [(each.name, each.init, each.kw_only) for each in fields(cls)]
    yield cls.__match_args__, cls.__doc__, hasattr(one, "__dict__")
    yield [str(inspect.signature(cls).replace(return_annotation=None)) for _ in range(2)]
    for args, kwargs in ARGUMENTS:
        yield outcome(lambda args, kwargs: repr(cls(*args, **kwargs)), args, kwargs)
    yield repr(one), one == same, one == other, one != same, one == "a", one.loud()
    yield outcome(lambda: hash(one) == hash(same))
    yield repr(replace(one, size=3)), repr(copy.copy(one)), repr(copy.deepcopy(one))
    yield outcome(setattr, one, "size", 3), outcome(delattr, other, "tags"), one.size
    yield dataclasses.asdict(same), dataclasses.is_dataclass(cls)
    yield one.tags is same.tags


@pytest.mark.parametrize("way", WAYS)
def test_it_is_the_same_as_that_of_the_library(way):
    ours, theirs = (made(one, WAYS[way]) for one in (dataclass, dataclasses.dataclass))
    for mine, other in zip(about(ours), about(theirs), strict=True):
        assert mine == other


@dataclass(frozen=True, slots=True)
class Point:
    x: int
    y: int = 0


@dataclasses.dataclass(frozen=True, slots=True)
class Corner(Point):
    z: int = 1


@dataclass(frozen=True, slots=True)
class Edge(Corner):
    to: Point = Point(1)


def test_objects_are_sent_to_processes():
    for one in (Point(1, 2), Corner(1, 2, 3), Edge(4)):
        again = pickle.loads(pickle.dumps(one))
        assert again == one
        assert type(again) is type(one)
        assert hash(again) == hash(one)


def test_classes_of_both_kinds_build_upon_each_other():
    assert repr(Edge(1, 2)) == "Edge(x=1, y=2, z=1, to=Point(x=1, y=0))"
    assert Corner(1) != Edge(1)
    with pytest.raises(FrozenInstanceError, match="cannot assign to field 'y'"):
        Edge(1).y = 3


def test_what_a_class_writes_itself_stays():
    @dataclass(frozen=True, slots=True)
    class Own:
        x: int

        def __eq__(self, other):
            return other == "anything"

        def __hash__(self):
            return 5

        def __repr__(self):
            return "own"

    assert (Own(1) == "anything", hash(Own(1)), repr(Own(1))) == (True, 5, "own")


@pytest.mark.parametrize("decorator", [dataclass, dataclasses.dataclass])
def test_a_hash_that_nobody_has_written(decorator):
    @decorator(frozen=True)
    class Alike:
        x: int

        def __eq__(self, other):
            return True

    assert hash(Alike(1)) == hash(Alike(1)) != hash(Alike(2))
