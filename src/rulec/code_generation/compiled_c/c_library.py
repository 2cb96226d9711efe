"""A monitor in C, compiled by the user's compiler and stepped from Python."""

from __future__ import annotations

import ctypes
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rulec.code_generation.c_files import c_header, c_source, in_own_names
from rulec.code_generation.code_messages import (
    compiler_failed,
    no_compiler,
    unreadable_command,
)
from rulec.code_generation.monitor_layout import VERDICTS, MonitorLayout
from rulec.code_generation.written_names import prefix_of
from rulec.files.written_files import TEMPORARY, temporary_files
from rulec.monitoring.online.four_valued import FourValued, RunningVerdict, within
from rulec.trace import State
from rulec.vocabulary import Declaration, Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES

FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic")

UNKNOWN_CODE = 255
UNKNOWN_NUMBER = float("nan")

_HARNESS = Path(__file__).parent.parent / "c_texts" / "harness.c"


def compiler() -> list[str]:
    """The command of the C compiler: ``CC``, or ``cc``. Raises RulecError R0751."""
    named = os.environ.get("CC", "")
    try:
        command = shlex.split(named) or ["cc"]
    except ValueError as problem:
        raise unreadable_command(named, str(problem)) from None
    if shutil.which(command[0]) is None:
        raise no_compiler(command[0])
    return command


def run_compiler(command: list[str], folder: Path) -> str:
    """Run a compiler in a folder and return its command line. Raises RulecError R0752."""
    line = shlex.join(command)
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, timeout=300, check=False)
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise compiler_failed(line, str(problem)) from None
    if done.returncode:
        # Compilers write in the user's language and encoding.
        raise compiler_failed(line, done.stderr.decode(errors="replace"), done.returncode)
    return line


def loaded(library: Path, command: str) -> ctypes.CDLL:
    """Load a library that a command has written. Raises RulecError R0752 if it is not loadable."""
    try:
        return ctypes.CDLL(str(library))
    except OSError as problem:
        reason = str(problem).replace(f"{library.parent}/", "")
        raise compiler_failed(
            command, f"it has written no library for this Python: {reason}"
        ) from None


def first_line_of(command: list[str]) -> str:
    """The first line of a program's output; empty if there is none."""
    try:
        done = subprocess.run(command, capture_output=True, timeout=60, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return next(iter(done.stdout.decode(errors="replace").splitlines()), "")


class CLibrary:
    """A monitor's source, compiled together with the functions that a proof calls.

    ``source`` defaults to that of the layout.

    Raises RulecError R0751 if there is no compiler, R0752 if it fails, R0723 if there is no room
    for temporary files.
    """

    def __init__(
        self, layout: MonitorLayout, source: str | None = None, *, optimised: bool = True
    ) -> None:
        self.layout = layout
        self._level = "-O2" if optimised else "-O0"
        self._prefix = prefix_of(layout.rulebook.name)
        with temporary_files(), tempfile.TemporaryDirectory(prefix=TEMPORARY) as folder:
            self._library = loaded(self._compiled(Path(folder), source), self.command)
        self.object_type, self.input_type = structures(layout)
        self.call("state_size").restype = ctypes.c_size_t
        self.call("kept_size").restype = ctypes.c_size_t
        self.call("step").restype = ctypes.c_uint8

    def _compiled(self, folder: Path, source: str | None) -> Path:
        layout, name = self.layout, self._prefix
        harness = in_own_names(_HARNESS.read_text(encoding="utf-8"), layout)
        text = (c_source(layout) if source is None else source) + harness
        (folder / f"{name}.h").write_text(c_header(layout), "utf-8")
        (folder / f"{name}.c").write_text(text, "utf-8")
        flags = [*FLAGS, self._level, "-fPIC", "-shared", f"{name}.c", "-o", f"{name}.so"]
        self.compiler_version = first_line_of([*compiler(), "--version"])
        self.command = run_compiler([*compiler(), *flags], folder)
        return folder / f"{name}.so"

    def call(self, name: str) -> Any:
        """A function of the library."""
        return getattr(self._library, f"{self._prefix}_{name}")

    def input_of(
        self, state: State, objects: Mapping[str, str], ids: dict[str, int]
    ) -> ctypes.Structure:
        """The input with the values of a state, or else defaults; new objects get ``ids``."""
        return _input_of(self, state, objects, ids)


def structures(layout: MonitorLayout) -> tuple[type[ctypes.Structure], type[ctypes.Structure]]:
    """The structures of an object and of an input, as in the header."""
    fields = layout.fields

    own = [(fields.identifiers[item.name], _kind(item)) for item in fields.about(1)]
    given = [("id", ctypes.c_uint32), ("type", ctypes.c_uint8), *own]
    object_type = type("CObject", (ctypes.Structure,), {"_fields_": given})
    pointer: Any = ctypes.POINTER(object_type)
    world = [(fields.identifiers[item.name], _kind(item)) for item in fields.about(0)]
    several = [
        (fields.identifiers[item.name], ctypes.POINTER(_kind(item))) for item in fields.about(2)
    ]
    given = [("n_objects", ctypes.c_size_t), ("objects", pointer), *world, *several]
    return object_type, type("CInput", (ctypes.Structure,), {"_fields_": given})


@dataclass(frozen=True, slots=True)
class CAnswer:
    """The result of a step of a monitor in C: its ``status``, and verdicts if that is 0."""

    status: int
    verdict: RunningVerdict
    rules: Mapping[str, RunningVerdict]
    violations: int
    left_out: int


class CMonitor:
    """A monitor in C, stepped with states like Python's monitor."""

    def __init__(self, library: CLibrary) -> None:
        self._library = library
        self.state = ctypes.create_string_buffer(library.call("state_size")())
        n_rules = len(library.layout.rules)
        # Two bytes for the rulebook and for each rule, then two 32-bit numbers.
        self.answer = ctypes.create_string_buffer(2 + 2 * n_rules + 16)
        self._ids: dict[str, int] = {}
        library.call("init")(self.state)

    def take(self, given: ctypes.Structure) -> int:
        """Take the next state, given as C input; the status."""
        step = self._library.call("step")
        return int(step(self.state, ctypes.byref(given), self.answer))

    def step(self, state: State, objects: Mapping[str, str]) -> CAnswer:
        """Take the next state."""
        library = self._library
        return self.last_answer(self.take(library.input_of(state, objects, self._ids)))

    def says(self, verdicts: bytes, n_violations: int | None = None) -> bool:
        """Whether the last step returned these verdicts, and this number of violations.

        The verdicts are the rulebook's and then each rule's: the best, and the worst.
        """
        end = (len(verdicts) + 3) // 4 * 4
        answer = self.answer.raw[: end + 4]
        counted = n_violations is None or int.from_bytes(answer[end:], "little") == n_violations
        return answer.startswith(verdicts) and counted

    def last_answer(self, status: int) -> CAnswer:
        """The result of the last step, which had this status."""
        answer = self.answer.raw
        names = [own.rule.name for own in self._library.layout.rules]
        verdicts = [
            within(_four(answer[place]), _four(answer[place + 1]))
            for place in range(0, 2 * len(names) + 2, 2)
        ]
        end = (2 * len(names) + 2 + 3) // 4 * 4
        numbers = [int.from_bytes(answer[at : at + 4], "little") for at in (end, end + 4)]
        return CAnswer(
            status, verdicts[0], dict(zip(names, verdicts[1:], strict=True)), numbers[0], numbers[1]
        )


def _four(number: int) -> FourValued:
    return VERDICTS[number & 3]


def _input_of(
    library: CLibrary, state: State, objects: Mapping[str, str], ids: dict[str, int]
) -> ctypes.Structure:
    fields = library.layout.fields
    names = list(objects)
    seated = (library.object_type * max(1, len(names)))()
    given: Any = library.input_type()
    given.n_objects = len(names)
    given.objects = ctypes.cast(seated, ctypes.POINTER(library.object_type))
    for seat, name in zip(seated, names, strict=False):
        seat.id = ids.setdefault(name, len(ids) + 1)
        seat.type = fields.types.index(objects[name])
        for item in fields.about(1):
            setattr(
                seat, fields.identifiers[item.name], _code(item, value_given(state, item, [name]))
            )
    for item in fields.about(0):
        setattr(given, fields.identifiers[item.name], _code(item, value_given(state, item, [])))
    for item in fields.about(2):
        places: list[list[str]] = [[]]
        for _ in item.parameters:
            places = [[*before, name] for before in places for name in names]
        kind: Any = _kind(item)
        values = [_code(item, value_given(state, item, place)) for place in places]
        setattr(given, fields.identifiers[item.name], (kind * max(1, len(values)))(*values))
    return given  # type: ignore[no-any-return]


def _kind(item: Declaration) -> Any:
    return ctypes.c_double if isinstance(item, Quantity) else ctypes.c_uint8


def value_given(state: State, item: Declaration, names: Sequence[str]) -> Any:
    """The value that a state gives of some objects, else the default."""
    value: Any = state.get(item.name)
    for name in names:
        if value is None or value is UNKNOWN:
            break
        value = value.get(name)
    return item.default if value is None else value


def _code(item: Declaration, value: Any) -> float | int:
    if isinstance(item, Quantity):
        is_near = value is not None and type(value) not in UNKNOWN_TYPES and abs(value) < 1e300
        return float(value) if is_near else UNKNOWN_NUMBER
    if value is None or value is UNKNOWN:
        return UNKNOWN_CODE
    return item.values.index(value) if isinstance(item, Enumeration) else int(value)
