"""Compiled rulebooks as sent to workers: the bytes of a file, read once in each process."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TypeAlias

from rulec.automata.bundle.bundle_file import from_json, read_signed
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.fleet.fleet_messages import not_compiled

CompiledRules: TypeAlias = str | Path | bytes | CompiledRulebook
"""The path of a compiled file, its content, or a rulebook already compiled or read."""

_MOST_KEPT = 4


@dataclass(frozen=True, slots=True)
class CarriedRulebook:
    """A rulebook to send to other processes; ``name`` is its file's name in messages."""

    content: bytes | CompiledRulebook
    name: str

    def read(self) -> CompiledRulebook:
        """The rulebook; a file is parsed once per process. Raises RulecError R0404."""
        if isinstance(self.content, CompiledRulebook):
            return self.content
        return _read(self.content, self.name)


@lru_cache(maxsize=_MOST_KEPT)
def _read(content: bytes, name: str) -> CompiledRulebook:
    return from_json(content, name)


def carried(rules: CompiledRules) -> CarriedRulebook:
    """A rulebook to send to other processes. Raises RulecError R0404, R0701, R0711 for a source."""
    if isinstance(rules, CompiledRulebook):
        return CarriedRulebook(rules, rules.name)
    if isinstance(rules, bytes):
        result = CarriedRulebook(rules, "compiled rulebook")
    else:
        if Path(rules).suffix != ".json":
            raise not_compiled(str(rules))
        result = CarriedRulebook(read_signed(Path(rules)), str(rules))
    result.read()
    return result
