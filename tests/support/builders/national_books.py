"""The national rulebooks that ship, each read and compiled once, and what of them is on a topic."""

from functools import cache
from pathlib import Path
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import Source
from rulec.resources import rulebooks_folder
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from rulec.rulebook.rulebook_model import Loaded, Rule
from rulec.toml import parsed_toml
from rulec.trace import Trace

NO_LAW = {"vocabulary", "schemas", "esterle2019"}

FOLDER = rulebooks_folder()
NATIONAL = sorted(
    path.stem
    for path in FOLDER.glob("*/*.rules")
    if path.stem == path.parent.name and path.stem not in NO_LAW
)
_SITUATIONS = Path(__file__).parents[2] / "law"
CASES: list[dict[str, Any]] = [
    case
    for path in sorted(_SITUATIONS.glob("*.toml"))
    for case in parsed_toml(Source(path.name, path.read_text(encoding="utf-8")), "R0704", "")[
        "case"
    ]
]
"""The situations of all files in `tests/law`."""


@cache
def read(name: str) -> Loaded:
    return read_rulebook(FOLDER / name / f"{name}.rules")


@cache
def compiled(name: str) -> CompiledRulebook:
    return compile_rulebook(read(name).rulebook)


def rules_on(name: str, topics: list[str]) -> list[Rule]:
    """The rules of a book with a topic's name, or with one that goes on from it."""
    return [
        rule
        for rule in read(name).rulebook.rules
        if any(rule.name == topic or rule.name.startswith(f"{topic}_") for topic in topics)
    ]


def trace_of(case: dict[str, Any], traffic: str) -> Trace:
    """The case as a trace; near and far are the sides that they are where traffic drives so."""
    near, far = ("right_of", "left_of") if traffic == "right" else ("left_of", "right_of")
    sides = {"near": near, "far": far, "same_lane": "same_lane"}
    states = []
    for said in case["states"]:
        state = {**case["throughout"]}
        for name, value in said.items():
            both = isinstance(value, dict) and name in state
            state[name] = {**state[name], **value} if both else value
        if "lateral" in state:
            state["lateral"] = {one: sides[side] for one, side in state["lateral"].items()}
        states.append(state)
    return Trace(case["id"], 1.0, case["objects"], tuple(states))
