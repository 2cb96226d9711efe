"""The caches shipped with the rulebooks, so that first calls need not parse or compile them.

They hold the trees of all sources, and the machines of all rulebooks that commands request: at the
steps of their examples and at common steps, by both compilers, and for cut words.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from hashlib import sha256
from pathlib import Path
from typing import Any
from unittest.mock import patch

from rulec.automata import compiler, prefix_machines, second_compiler
from rulec.automata.compiler import CompilerTime
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.step_compilation import StepCompiler
from rulec.automata.worker import machine_cache
from rulec.cache.keeping import keeping
from rulec.cache.shipped_bytes import ShippedBytes, shipped, shipped_file, shipped_key, shipped_text
from rulec.diagnostics import RulecError, Source
from rulec.resources import rulebooks_folder
from rulec.rulebook.batch.batch_format import formatted
from rulec.rulebook.loader import read_rulebook
from rulec.syntax.caching import tree_cache
from rulec.syntax.parser import parse

STEPS_S = (None, Fraction(1), Fraction(1, 2), Fraction(1, 10))
"""The steps of the shipped machines; None means the steps of the rules' own examples."""

_AT_20_HZ, _AT_25_HZ, _AT_30_HZ = Fraction(1, 20), Fraction(1, 25), Fraction(1, 30)
STEPS_OF: Mapping[str, Sequence[Fraction]] = {
    "de": (_AT_20_HZ, _AT_25_HZ, _AT_30_HZ),
    "us": (_AT_20_HZ, _AT_30_HZ),
    "us-nv": (_AT_20_HZ,),
    "cn": (_AT_30_HZ,),
}
"""More steps, from data sets: highD and its relatives film German roads at 25 Hz, openDD at 30.

nuPlan has American roads, including Nevada, at 20 Hz, CitySim at 30, AD4CHE Chinese ones at 30;
many simulators use 20.
"""

_BOOKS = shipped_key("which rulebooks, of which texts")
TRIED = ("esterle2019", "de")
"""For these rulebooks each check tests whether all machines that commands request are there."""


@dataclass(frozen=True, slots=True)
class Book:
    """A rulebook's share: digests of its source texts, and the beginnings of its keys."""

    texts: dict[str, str]
    keys: list[str] = field(default_factory=list)


def trees_text() -> bytes:
    """The content of the file of trees."""
    entries = {}
    for path in _sources():
        source = Source(path.name, path.read_text(encoding="utf-8"))
        file, mistakes = parse(source)
        assert not mistakes, path
        data = path.read_bytes()
        assert formatted(path.name, path, data).after == data, f"{path} is not in form"
        entries[shipped_key(source.text)] = tree_cache.as_bytes(file, source)
    return shipped_text(entries, tree_cache.MAKERS)


def are_trees_current() -> bool:
    """Whether the shipped trees match the current sources and code."""
    keys = {shipped_key(path.read_text(encoding="utf-8")) for path in _sources()}
    return _there(tree_cache).keys == keys


def machines_text() -> bytes:
    """The content of the file of machines; unchanged rulebooks keep the machines that they have."""
    there = _there(machine_cache)
    entries: dict[bytes, bytes] = {}
    books: dict[str, Book] = {}
    known = _books(there)
    whole = {key.hex()[:_SHOWN]: key for key in there.keys}
    for name in names():
        book = known.get(name)
        if book is not None and _is_as_it_was(book) and name not in TRIED:
            own = {whole[short]: there.recall(whole[short]) or b"" for short in book.keys}
        else:
            own, texts = asked_for(name)
            book = Book(texts, sorted(key.hex()[:_SHOWN] for key in own))
        entries |= own
        books[name] = book
    entries[_BOOKS] = json.dumps(
        {name: [book.texts, book.keys] for name, book in books.items()}, separators=(",", ":")
    ).encode()
    return shipped_text(entries, machine_cache.MAKERS)


def are_machines_current() -> bool:
    """Whether the shipped machines match the current sources and code.

    Which machines commands request is checked for a few rulebooks only.
    """
    there = _there(machine_cache)
    known = _books(there)
    return (
        [*known] == names()
        and all(map(_is_as_it_was, known.values()))
        and all(asked_for(name)[0].keys() <= there.keys for name in TRIED)
    )


def asked_for(name: str) -> tuple[dict[bytes, bytes], dict[str, str]]:
    """All machines that commands request for a rulebook, and digests of its source texts."""
    with keeping(), _recorded() as entries:
        rulebook = read_rulebook(name).rulebook
        steps = StepCompiler(rulebook)
        for step in (*STEPS_S, *STEPS_OF.get(name, ())):
            try:
                compiled = steps.at_own_steps() if step is None else steps(step)
            except RulecError:
                continue  # a bound is not a multiple of the step
            second_compiler.certified(compiled)
            prefix_machines.prefix_machines(compiled)
    return entries, {one.name: one.sha256 for one in rulebook.sources}


@contextmanager
def _recorded() -> Iterator[dict[bytes, bytes]]:
    entries: dict[bytes, bytes] = {}
    ask = compiler.answers_to

    def asked(
        jobs: Sequence[Job], *, choice: str | None = None, **rest: Any
    ) -> tuple[list[Done | Failed | None], str]:
        answers, spot = ask(jobs, choice=choice, **rest | {"time": CompilerTime(math.inf)})
        for job, answer in zip(jobs, answers, strict=True):
            if isinstance(answer, Done) and answer.machine.reads == job.reads:
                key = machine_cache.machine_key(choice or "", job)
                # Only the tables of the second compiler are needed.
                entries[key] = machine_cache.as_bytes(answer, spot, with_text=not choice)
        return answers, spot

    prefix_machines._KNOWN.clear()
    with (
        patch.object(compiler, "answers_to", asked),
        patch.object(prefix_machines, "answers_to", asked),
    ):
        yield entries


_SHOWN = 12


def names() -> list[str]:
    """All shipped rulebooks, in alphabetical order."""
    return [path.stem for path in _sources() if path.parent.name == path.stem]


def _sources() -> list[Path]:
    return sorted(rulebooks_folder().rglob("*.rules"))


def _there(kind: Any) -> ShippedBytes:
    shipped.cache_clear()
    return shipped(kind.SHIPPED, kind.MAKERS)


def _books(there: ShippedBytes) -> dict[str, Book]:
    data = there.recall(_BOOKS)
    return {} if data is None else {name: Book(*one) for name, one in json.loads(data).items()}


def _is_as_it_was(book: Book) -> bool:
    now = _digests()
    return all(now.get(name) == digest for name, digest in book.texts.items())


def _digests() -> dict[str, str]:
    """The digests of all sources, by their base names."""
    return {path.name: sha256(path.read_bytes()).hexdigest() for path in _sources()}


SHIPPED: Mapping[str, tuple[Callable[[], bytes], Callable[[], bool]]] = {
    f"rulebooks/{shipped_file(tree_cache.SHIPPED).name}": (trees_text, are_trees_current),
    f"rulebooks/{shipped_file(machine_cache.SHIPPED).name}": (machines_text, are_machines_current),
}
"""Path from the root -> the functions that generate its content and check that it is current."""
