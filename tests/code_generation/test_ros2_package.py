"""The package for ROS 2: its node, built against a stub, replays states that an MCAP file has."""

import ast
import json
import re
import shutil
import subprocess
from pathlib import Path
from random import Random
from xml.etree import ElementTree

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

import rulec
from rulec.api.named_monitor import Monitor
from rulec.code_generation.monitor_layout import VERDICTS, monitor_layout
from rulec.code_generation.proof.random_drives import drives
from rulec.code_generation.ros2_files import message_fields, ros2_texts
from rulec.monitoring.online.four_valued import best_of, worst_of
from rulec.vocabulary import Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.monitored_books import WATCHED

STUB = Path(__file__).parent / "ros2_stub"
KINDS = {
    "uint8": "unsigned char",
    "uint16": "unsigned short",
    "uint32": "unsigned int",
    "float64": "double",
    "std_msgs/Header": "int",
    "Object": "Object",
}
FIELD = re.compile(r"([\w/]+)(\[\d*\])? (\w+)(?: ([^=\s#]\S*))?(?:  # .*)?")


@pytest.fixture(scope="module")
def layout():
    return monitor_layout(rulec.compile_rulebook(rulec.parse_rulebook(WATCHED), step_s=1), {})


def message_lines(text):
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def structure(name, text):
    """A message as C++, and how it is read from lines of numbers."""
    fields, reads = [], []
    for line in message_lines(text):
        if re.fullmatch(r"uint\d+ [A-Z][A-Z0-9_]*=\d+", line):
            continue
        kind, size, field, default = FIELD.fullmatch(line).groups()
        assert re.fullmatch("[a-z](_?[a-z0-9])*", field)
        own = KINDS[kind]
        if size == "[]":
            own = f"std::vector<{own}>"
        elif size:
            own = f"std::array<{own}, {size[1:-1]}>"
        fields.append(f"    {own} {field}{{{default or ''}}};")
        reads.append(f"    is = is && read(to.{field});")
    read = [
        f"inline bool read({name} &to)",
        "{",
        "    bool is = true;",
        *reads,
        "    return is;",
        "}",
    ]
    return "\n".join([f"struct {name} {{", *fields, "};", *(read if name != "Verdict" else [])])


READING = """\
#pragma once
#include <array>
#include <cstddef>
#include <iostream>
#include <vector>
template <typename Number> bool read(Number &to)
{
    double found;
    const bool is = static_cast<bool>(std::cin >> found);
    to = static_cast<Number>(found);
    return is;
}
struct Object;
inline bool read(Object &to);
template <typename Item> bool read(std::vector<Item> &to)
{
    std::size_t n = 0;
    bool is = read(n);
    to.resize(is ? n : 0);
    for (Item &item : to) {
        is = is && read(item);
    }
    return is;
}
"""
WRITING = """
inline void written(const Verdict &verdict)
{
    std::printf("%d %d %d", verdict.status, verdict.best, verdict.worst);
    for (std::size_t rule = 0; rule < verdict.rules_best.size(); rule++) {
        std::printf(" %d %d", verdict.rules_best[rule], verdict.rules_worst[rule]);
    }
    std::printf("\\n");
}
"""


def number(item, value):
    if value is None or value is UNKNOWN:
        return 1e300 if isinstance(item, Quantity) else 255
    return item.values.index(value) if isinstance(item, Enumeration) else float(value)


def said(state, item, names):
    value = state.get(item.name)
    for name in names:
        value = value.get(name) if isinstance(value, dict) else value
    return number(item, item.default if value is None else value)


def message(layout, state, objects, ids):
    """A state as a message in JSON."""
    fields, called = layout.fields, message_fields(layout)
    own = {"header": 0, "objects": []}
    for name, kind in objects.items():
        about = {called[item.name]: said(state, item, [name]) for item in fields.about(1)}
        number_of = ids.setdefault(name, len(ids) + 1)
        own["objects"].append({"id": number_of, "type": fields.types.index(kind), **about})
    own |= {called[item.name]: said(state, item, []) for item in fields.about(0)}
    for item in fields.about(2):
        own[called[item.name]] = [said(state, item, [x, y]) for x in objects for y in objects]
    return own


def numbers(value):
    if isinstance(value, dict):
        return [x for item in value.values() for x in numbers(item)]
    if isinstance(value, list):
        return [len(value), *[x for item in value for x in numbers(item)]]
    return [value]


@pytest.mark.skipif(
    None in map(shutil.which, ("cc", "c++")), reason="there is no C compiler, or none of C++"
)
def test_the_node_replays_recorded_states(layout, tmp_path):
    drive = max(drives(layout, Random(3), 60, 0.1), key=len)
    assert len(drive) > 8
    recorded, ids = tmp_path / "states.mcap", {}
    with recorded.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("State", "jsonschema", b"{}")
        channel = writer.register_channel("state", "json", schema)
        for n, (state, objects) in enumerate(drive):
            data = json.dumps(message(layout, state, objects, ids)).encode()
            writer.add_message(channel, n, data, n)
        writer.finish()
    texts = ros2_texts(layout)
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    headers = tmp_path / "stub" / "watched_monitor" / "msg"
    headers.mkdir(parents=True)
    opening = "namespace watched_monitor { namespace msg {\n"
    structures = [
        structure(name, texts[f"msg/{name}.msg"]) for name in ("Object", "State", "Verdict")
    ]
    whole = READING.replace("struct Object;\ninline bool read(Object &to);\n", "")
    body = f"{whole}{opening}using ::read;\n{chr(10).join(structures)}{WRITING}}} }}\n"
    for name in ("object", "state", "verdict"):
        (headers / f"{name}.hpp").write_text('#include "all.hpp"\n', encoding="utf-8")
    (headers / "all.hpp").write_text(body, encoding="utf-8")
    source = tmp_path / "src" / "watched"
    flags = ["-Wall", "-Wextra", "-Werror", "-I", str(tmp_path / "stub"), "-I", str(STUB)]
    subprocess.run(["cc", "-std=c99", "-c", f"{source}.c", "-o", f"{source}.o"], check=True)
    node = [str(source.with_name("node.cpp")), f"{source}.o", "-o", str(tmp_path / "node")]
    subprocess.run(["c++", "-std=c++17", *flags, *node], check=True)
    with recorded.open("rb") as stream:
        read = [json.loads(one.data) for _, _, one in make_reader(stream).iter_messages()]
    given = "\n".join(" ".join(map(repr, numbers(one))) for one in read)
    done = subprocess.run(
        [tmp_path / "node"], input=given, capture_output=True, text=True, check=True
    )
    lines = [list(map(int, line.split())) for line in done.stdout.splitlines()]
    monitor = Monitor(layout.rulebook)
    assert len(lines) == len(drive)
    for line, (state, objects) in zip(lines, drive, strict=True):
        expected = monitor.step(state, objects)
        pairs = [line[at : at + 2] for at in range(1, len(line), 2)]
        verdicts = [expected.verdict, *[expected.rules[own.rule.name] for own in layout.rules]]
        assert line[0] == 0
        # Not all is known, but no value is compared with two limits: no range is wider.
        assert pairs[1:] == [
            [VERDICTS.index(best_of(one)), VERDICTS.index(worst_of(one))] for one in verdicts[1:]
        ]


def test_what_the_package_says_of_itself(layout):
    texts = ros2_texts(layout)
    root = ElementTree.fromstring(texts["package.xml"])
    assert root.findtext("name") == "watched_monitor"
    wanted = {one.text for one in root.iter() if one.tag.endswith("depend")}
    found = set(re.findall(r"find_package\((\w+)", texts["CMakeLists.txt"]))
    assert found <= wanted | {"ament_cmake"}
    for name in re.findall(r"(?:msg|src)/[\w.]+", texts["CMakeLists.txt"]):
        assert name in texts
    launched = ast.parse(texts["launch/monitor.launch.py"])
    assert "generate_launch_description" in {getattr(one, "name", "") for one in launched.body}
