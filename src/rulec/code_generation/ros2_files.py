"""A ROS 2 package around the monitor in C: messages, node, launch file, build files.

Messages: ROS 2, "Interfaces", https://docs.ros.org/en/rolling/Concepts/Basic/About-Interfaces.html.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from keyword import kwlist
from pathlib import Path

from rulec.code_generation.c_files import c_header, c_source, head_lines, in_own_names
from rulec.code_generation.input_fields import RULE, TYPE, FieldSpelling
from rulec.code_generation.monitor_layout import MonitorLayout
from rulec.code_generation.written_names import Identifiers, in_comment, prefix_of
from rulec.files.text_templates import Places, filled
from rulec.vocabulary import Declaration, Quantity

_TEXTS = Path(__file__).parent / "ros2_texts"

_SPELLING = FieldSpelling("uint8", "float64", "255", "1.0e300")
"""A number beyond 2^53, so that a field left at this default is an unknown number."""


def ros2_texts(layout: MonitorLayout) -> dict[str, str]:
    """The files of the package, by their paths in its folder."""
    name = prefix_of(layout.rulebook.name)
    named = {"name": name}
    return {
        "package.xml": filled(_TEXTS / "package.xml.in", named),
        "CMakeLists.txt": filled(_TEXTS / "CMakeLists.txt.in", named),
        "launch/monitor.launch.py": filled(_TEXTS / "monitor.launch.py.in", named),
        "msg/Object.msg": _message("Object", _object_fields(layout), layout, *_types(layout)),
        "msg/State.msg": _message("State", _state_fields(layout), layout, *_values(layout, 0)),
        "msg/Verdict.msg": _message("Verdict", (), layout, *_rules(layout)),
        f"src/{name}.h": c_header(layout),
        f"src/{name}.c": c_source(layout),
        "src/core.hpp": _core(layout),
        "src/node.cpp": in_own_names(filled(_TEXTS / "node.cpp", named), layout),
    }


def message_fields(layout: MonitorLayout) -> dict[str, str]:
    """The message field for each name: lower case, no two underscores in a row."""
    # Python's keywords cannot be field names of its message classes.
    taken = Identifiers(("header", "id", "type", "objects", *kwlist))
    return {item.name: taken.of(item.name.lower()) for item in layout.fields.read}


def _message(kind: str, fields: Iterable[str], layout: MonitorLayout, *constants: str) -> str:
    head = (f"# {line}".rstrip() for line in head_lines(layout))
    places: Places = {"head": head, "constants": constants, "fields": fields}
    return filled(_TEXTS / f"{kind}.msg", {**places, "rules": len(layout.rules)})


def _object_fields(layout: MonitorLayout) -> Iterator[str]:
    return (_field(item, layout) for item in layout.fields.about(1))


def _state_fields(layout: MonitorLayout) -> Iterator[str]:
    yield from (_field(item, layout) for item in layout.fields.about(0))
    yield from (_field(item, layout, several=True) for item in layout.fields.about(2))


def _field(item: Declaration, layout: MonitorLayout, *, several: bool = False) -> str:
    kind, name = _SPELLING.kind(item), message_fields(layout)[item.name]
    about = f"  # {in_comment(item.name)}"
    if isinstance(item, Quantity):
        about += in_comment(f", in {item.unit}")
    if several:
        all_of = f"for all choices of {len(item.parameters)} objects"
        return f"{kind}[] {name}{about}: {all_of}, the last index varying fastest; or empty"
    return f"{kind} {name} {_SPELLING.initial(item)}{about}"


def _types(layout: MonitorLayout) -> Iterator[str]:
    fields = layout.fields
    yield from (f"uint8 {name}={number}" for name, number in fields.numbered(TYPE, fields.types))
    yield from _values(layout, 1)


def _values(layout: MonitorLayout, about: int) -> Iterator[str]:
    for item in layout.fields.enumerations():
        if item in layout.fields.about(about):
            for name, number in layout.fields.numbered(item.name, item.values):
                yield f"uint8 {name}={number}"


def _rules(layout: MonitorLayout) -> Iterator[str]:
    fields = layout.fields
    return (f"uint16 {name}={number}" for name, number in fields.numbered(RULE, fields.rules))


def _core(layout: MonitorLayout) -> str:
    fields, messages = layout.fields, message_fields(layout)
    names = fields.identifiers
    places = {
        "name": prefix_of(layout.rulebook.name),
        "own": (
            f"objects_[one].{names[item.name]} = said.{messages[item.name]};"
            for item in fields.about(1)
        ),
        "world": [
            *(
                f"input.{names[item.name]} = state.{messages[item.name]};"
                for item in fields.about(0)
            ),
            *(
                line
                for item in fields.about(2)
                for line in _several(names[item.name], messages[item.name], len(item.parameters))
            ),
        ],
    }
    return in_own_names(filled(_TEXTS / "core.hpp", places), layout)


def _several(field: str, own: str, n_objects: int) -> Iterator[str]:
    """The values of a name about several objects, refused unless there is one for each choice."""
    n = " * ".join(["objects_.size()"] * n_objects)
    yield f"if (!state.{own}.empty() && state.{own}.size() != {n}) {{"
    yield "    return verdict.status = RULEC_NULL;"
    yield "}"
    yield f"input.{field} = state.{own}.empty() ? nullptr : state.{own}.data();"
