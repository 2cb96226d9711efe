"""Methods of dataclasses that are written late do what those do that Python writes at once."""

import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from collections.abc import Callable
from types import ModuleType

import pytest

from rulec.cli import dataclass_methods
from rulec.cli.dataclass_methods import dataclass

SAMPLES = '''
from __future__ import annotations
from dataclasses import KW_ONLY, field
from functools import cached_property
from typing import ClassVar

@dataclass(frozen=True, slots=True)
class Point:
    """A point."""
    x: int
    y: int = 2

@dataclass(frozen=True, slots=True)
class Far(Point):
    z: list = field(default_factory=list, compare=False)

@dataclass(frozen=True)
class Lasting:
    x: int
    kind: ClassVar[str] = "lasting"
    hidden: int = field(default=7, init=False, repr=False)
    @cached_property
    def twice(self): return 2 * self.x

@dataclass(slots=True)
class Open:
    x: int
    filled: int = field(default=7, init=False)
    found: dict = field(default_factory=dict, init=False)
    late: int = field(init=False)
    def __post_init__(self): self.late = self.x + 1

@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Named:
    x: int
    y: int = 3

@dataclass(frozen=True)
class Mixed:
    x: object
    _: KW_ONLY
    y: int = 3
    z: int

@dataclass(frozen=True, slots=True)
class Own:
    x: int
    def __repr__(self): return "own"
    def __eq__(self, other): return True
    def __hash__(self): return 5

@dataclass(frozen=True, slots=True)
class Equal:
    x: int
    def __eq__(self, other): return True

@dataclass
class Nothing:
    pass

@dataclass
class Built:
    x: int
    def __init__(self): self.x = 1

class Tagged(Lasting):
    pass

@dataclass(order=True)
class Ordered:
    x: int
'''


def samples(decorator: Callable[..., object], name: str) -> ModuleType:
    module = ModuleType(name)
    module.dataclass = decorator
    sys.modules[name] = module
    exec(SAMPLES, module.__dict__)
    return module


LATE = samples(dataclass, "rulec.late_samples")
AT_ONCE = samples(dataclasses.dataclass, "rulec.samples_at_once")

QUESTIONS = [
    "Point(1)",
    "Point(1, 5), Point(y=5, x=1), Point.__match_args__",
    "Point()",
    "Point(1, 2, 3)",
    "Point(1, w=3)",
    "Point(1) == Point(1, 2), Point(1) == Point(2), Point(1) != Point(2), Point(1) == Far(1)",
    "hash(Point(1)) == hash(Point(1, 2)), len({Point(1), Point(1, 2), Point(2)})",
    "hash(Point([]))",
    "setattr(Point(1), 'x', 2)",
    "delattr(Point(1), 'x')",
    "dataclasses.replace(Point(1), y=9), dataclasses.asdict(Far(1)), dataclasses.astuple(Point(1))",
    "pickle.loads(pickle.dumps(Far(1, 3, [4]))), copy.copy(Far(1)), copy.deepcopy(Far(1, 2, [3]))",
    "Far(1) == Far(1, 2, [3]), Far(1).z is Far(1).z, hash(Far(1)) == hash(Far(1, 2, [3]))",
    "Point(1) < Point(2)",
    "Lasting(4), Lasting(4).twice, Lasting(4).kind, Lasting(4).hidden, hash(Lasting(4)) is None",
    "Lasting(4, 5)",
    "setattr(Tagged(4), 'more', 5), Tagged(4), Tagged(4) == Lasting(4)",
    "setattr(Tagged(4), 'x', 5)",
    "Open(1), Open(1) == Open(1), Open(1).found is Open(1).found, Open.__hash__",
    "hash(Open(1))",
    "setattr(Open(1), 'x', 5), pickle.loads(pickle.dumps(Open(3)))",
    "Named(x=1) == Named(x=1), len({Named(x=1), Named(x=1)}), Named(x=1)",
    "Named(1)",
    "Mixed(1, z=2), Mixed(Mixed(1, z=2), z=4, y=5)",
    "Mixed(1)",
    "Own(1), Own(1) == 3, hash(Own(1))",
    "Equal(1) == 3, hash(Equal(1)) == hash(Equal(1))",
    "Nothing(), Nothing() == Nothing(), Nothing.__hash__, Nothing(1)",
    "Nothing() == Nothing(), Nothing().__init__()",
    "Built(), Built.__hash__",
    "Ordered(1) < Ordered(2)",
    "[list(inspect.signature(one).parameters) for one in (Point, Far, Open, Named)]",
    "list(inspect.signature(Mixed).parameters.values())[2].kind",
    "Point.__init__.__qualname__, Point.__doc__, Point.__slots__, dataclasses.is_dataclass(Point)",
]


@pytest.mark.parametrize("question", QUESTIONS)
def test_late_methods_do_what_pythons_do(question):
    late = samples(dataclass, LATE.__name__)
    assert answer(question, late) == answer(question, AT_ONCE)


def answer(question: str, module: ModuleType) -> str:
    names = {"dataclasses": dataclasses, "inspect": inspect, "pickle": pickle, "copy": copy}
    try:
        return repr(eval(question, {**module.__dict__, **names}))
    except (TypeError, AttributeError) as problem:
        return f"{type(problem).__name__}: {problem}".replace(module.__name__, "")


def test_what_contains_itself_is_shown():
    whole = LATE.Mixed([], z=1)
    whole.x.append(whole)
    assert repr(whole) == "Mixed(x=[...], y=3, z=1)"


def test_nothing_is_written_before_it_is_looked_up():
    module = samples(dataclass, "rulec.fresh_samples")
    assert not inspect.isfunction(module.Point.__dict__["__init__"])
    module.Point(1)
    assert inspect.isfunction(module.Point.__dict__["__init__"])
    for name in ("__eq__", "__hash__", "__repr__"):
        assert is_unwritten(module.Point, name)
    assert module.Point(1) == module.Point(1)
    assert not is_unwritten(module.Point, "__eq__")


def is_unwritten(cls, name):
    return cls.__dict__[name].__code__.co_filename == dataclass_methods.__file__


@pytest.mark.parametrize(
    ("text", "use"),
    [
        ("_eq_text", lambda point: point(1) == point(2)),
        ("_eq_text", lambda point: point(1) in [point(2)]),
        ("_hash_text", lambda point: hash(point(1))),
        ("_repr_text", lambda point: repr(point(1))),
        ("_repr_text", lambda point: f"{[point(1)]}"),
    ],
)
def test_an_interrupt_while_a_method_is_written_is_not_lost(text, use, monkeypatch):
    """Python drops what is raised while it looks up how two objects compare."""

    def interrupted(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(dataclass_methods, text, interrupted)
        module = samples(dataclass, "rulec.interrupted_samples")
    with pytest.raises(KeyboardInterrupt):
        use(module.Point)


PROGRAM = """
import dataclasses, inspect, sys
from importlib import import_module
if late:
    from rulec.cli.dataclass_methods import write_when_called
    write_when_called()
from pathlib import Path
import rulec
root = Path(rulec.__file__).parent
seen = {}
for path in sorted(root.rglob("*.py")):
    name = ".".join(path.relative_to(root.parent).with_suffix("").parts).removesuffix(".__init__")
    if name.endswith("__main__") or "spot" in name or "worker" in name or ".lsp" in name:
        continue
    for item in vars(import_module(name)).values():
        if dataclasses.is_dataclass(item) and isinstance(item, type):
            seen[item.__module__, item.__qualname__] = item
for name, item in sorted(seen.items()):
    if name[0].startswith("rulec."):
        parameters = [(p.name, p.kind, p.default is p.empty)
                      for p in inspect.signature(item).parameters.values()]
        print(name, parameters, item.__hash__ is None, item.__eq__ is object.__eq__,
              item.__setattr__ is object.__setattr__, hasattr(item, "__dict__"))
"""


def test_every_dataclass_is_called_compared_and_kept_as_python_has_it():
    said = [
        subprocess.run(
            [sys.executable, "-c", f"late = {late}\n{PROGRAM}"], capture_output=True, check=True
        ).stdout.decode()
        for late in (True, False)
    ]
    assert len(said[0].splitlines()) > 600
    assert said[0] == said[1]
