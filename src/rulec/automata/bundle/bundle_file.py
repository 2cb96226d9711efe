"""The compiled rulebook as a file: JSON, version 3, described in docs/compiled.md."""

from __future__ import annotations

import codecs
import json
import re
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from rulec.automata.bundle.bundle_check import checked
from rulec.automata.bundle.bundle_messages import DAMAGED_BUNDLE
from rulec.automata.bundle.bundle_schema import WRITTEN_AS, File, Header
from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.json_problems import json_words
from rulec.files import make_folder, opened, written_whole
from rulec.logic.codec import terms_to_data, to_data
from rulec.logic.printing import in_words

FORMAT = "rulec compiled rulebook"
VERSION = 3


def to_json(rulebook: CompiledRulebook) -> str:
    """The file's text: indented, with every row of numbers on a line of its own."""
    vocabulary = rulebook.vocabulary
    data = {
        "format": FORMAT,
        "version": VERSION,
        "rulec": rulebook.rulec,
        "spot": rulebook.spot,
        "name": rulebook.name,
        "title": rulebook.title,
        "law": rulebook.law,
        "as_of": rulebook.as_of,
        "sources": rulebook.sources,
        "semantics": rulebook.semantics,
        "traffic": rulebook.traffic,
        "levels": rulebook.levels,
        "priorities": sorted(rulebook.priorities),
        "extends": rulebook.extends,
        "at": rulebook.at,
        "vocabulary": {
            "name": vocabulary.name,
            "types": {item.name: item.parent for item in vocabulary.types.values()},
            "declarations": [
                {"kind": type(item).__name__.lower(), **msgspec.to_builtins(item)}
                for item in vocabulary.declarations.values()
            ],
        },
        "facts": [_fact(fact) for fact in rulebook.axioms],
        "rules": [_rule(rule) for rule in rulebook.rules],
    }
    text = json.dumps(msgspec.to_builtins(data), indent=1, ensure_ascii=False)
    return _STRING_OR_ROW.sub(_on_one_line, text) + "\n"


_STRING_OR_ROW = re.compile(r'"(?:[^"\\]|\\.)*"|\[\s[^\[\]{}"]*\]')
"""A string, or a list of neither lists, objects nor strings, over several lines."""


def _on_one_line(found: re.Match[str]) -> str:
    return found[0] if found[0].startswith('"') else re.sub(r"\s+", " ", found[0])


def _fact(fact: CompiledAxiom) -> dict[str, Any]:
    place = fact.place
    return {
        "variables": [(variable.name, variable.type) for variable in fact.variables],
        "formula": in_words(fact.formula),
        "tree": to_data(fact.formula),
        # Where it is written on this machine is no business of others.
        "file": "" if place is None else Path(place.file).name,
        "line": None if place is None else place.line,
    }


def _rule(rule: CompiledRule) -> dict[str, Any]:
    return {
        "name": rule.name,
        "strength": rule.strength,
        "level": rule.level,
        "weight": str(rule.weight),
        "variables": [(variable.name, variable.type) for variable in rule.variables],
        "cite": rule.cite,
        "says": rule.says,
        "source": rule.source,
        "certainty": rule.certainty,
        "book": rule.book,
        "step_s": None if rule.step_s is None else str(rule.step_s),
        "formula": in_words(rule.formula),
        "tree": to_data(rule.formula),
        "machine": {
            **{
                WRITTEN_AS.get(name, name): value
                for name, value in msgspec.to_builtins(replace(rule.machine, reads=())).items()
            },
            "reads": [read_to_data(read) for read in rule.machine.reads],
        },
        "hoa": rule.hoa,
    }


def read_to_data(read: Read | NumberRead) -> dict[str, Any]:
    """A read as the file has it."""
    match read:
        case Read():
            return {"kind": "state", **msgspec.to_builtins(read)}
        case NumberRead(terms, thresholds):
            return {
                "kind": "number",
                "terms": terms_to_data(terms),
                "thresholds": [
                    {"limit": str(one.limit), "inclusive": one.inclusive} for one in thresholds
                ],
            }


def from_json(data: bytes, file: str) -> CompiledRulebook:
    """Read a compiled rulebook, checking everything that running relies on.

    Raises:
        RulecError: R0404 if it is not a compiled rulebook, of a version that this rulec does not
            read, or damaged.
    """
    data = data.removeprefix(codecs.BOM_UTF8)
    try:
        header = msgspec.json.decode(data, type=Header)
    except msgspec.MsgspecError as problem:
        raise _damaged(file, f"this is not a compiled rulebook: {json_words(problem)}") from None
    except (RecursionError, UnicodeDecodeError):
        raise _damaged(file, "this is not a compiled rulebook") from None
    if header.version != VERSION:
        raise _damaged(
            file,
            f"this compiled rulebook is of version {header.version}; "
            f"this rulec reads version {VERSION}",
        )
    try:
        read = msgspec.json.decode(data, type=File)
        return checked(read)
    except (msgspec.MsgspecError, ValueError) as problem:
        raise _damaged(file, f"this compiled rulebook is damaged: {json_words(problem)}") from None


def _damaged(file: str, message: str) -> RulecError:
    return DAMAGED_BUNDLE.error(
        SourceLocation(file), message, help="compile it again from its source with `rulec compile`"
    )


def read_compiled(path: Path) -> CompiledRulebook:
    """Read a compiled rulebook's file. Raises RulecError: R0701, R0404."""
    with opened(path) as stream:
        return from_json(stream.read(), str(path))


def write_compiled(rulebook: CompiledRulebook, folder: Path) -> list[Path]:
    """Write ``RULE.hoa`` for every rule and ``RULEBOOK.json`` into a folder, made if need be.

    All of them are written before the first appears, so that they fit together.

    Returns:
        The files, the compiled rulebook last.

    Raises:
        RulecError: R0702.
    """
    make_folder(folder)
    texts = {folder / f"{rule.name}.hoa": rule.hoa for rule in rulebook.rules}
    texts[folder / f"{rulebook.name}.json"] = to_json(rulebook)
    with ExitStack() as files:
        for path, text in texts.items():
            stream = files.enter_context(written_whole(path))
            stream.write(text.encode())
    return list(texts)
