"""Cache of compiled rulebooks, valid while everything that they were compiled from is unchanged.

One entry for each rulebook and step; programs that import rulec keep them, too. Machines for cut
traces are added once made.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.bundle.cut_machines import StoredPrefixes
from rulec.automata.bundle.stored_rulebook import COMPILATIONS, Compilation
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.stored_objects import KeptObjects
from rulec.diagnostics import Diagnostic, RulecError
from rulec.resource_limits import CompilerTime
from rulec.rulebook.files.search_path import Dependency
from rulec.rulebook.reading.reading_cache import BookQuestion, basis_of
from rulec.rulebook.reading.rulebook_reader import load_rulebook

if TYPE_CHECKING:
    from rulec.automata.outcome_machine import OutcomeMachine
    from rulec.automata.step_compilation import StepCompiler
    from rulec.rulebook.rulebook_model import Rulebook

_Part = TypeVar("_Part")

MOST_FILES = 100
"""The greatest number of files kept; those unused for the longest time are removed first."""

_COMPILED = KeptObjects(KeptBytes("tables", MOST_FILES, always=True), COMPILATIONS)

_OWN = "own"
"""In place of a step: the steps of the rules' own examples."""


def recalled(
    question: BookQuestion,
) -> tuple[CompiledRulebook, tuple[Diagnostic, ...]] | None:
    """The cached rulebook with its warnings; None if it has to be compiled."""
    file = _Entry(question, _OWN)
    known = file.read()
    if known is None or known.rulebook is None or known.basis.texts(question) is None:
        return None
    text = replace(known, rulebook=None)
    compiled = replace(known.rulebook, origin=_ReadAgain(question))
    return _cached(compiled, CachedSteps(question, text, compiled), file), text.warnings


def remembered(
    question: BookQuestion,
    compiled: CompiledRulebook,
    steps: StepCompiler,
    warnings: Sequence[Diagnostic],
    dependencies: Sequence[Dependency],
) -> CompiledRulebook:
    """Cache a newly compiled rulebook; what is later compiled from it is cached, too."""
    basis = basis_of(question, dependencies, compiled.as_of)
    text = Compilation(basis, warnings=tuple(warnings))
    file = _Entry(question, _OWN)
    file.write(text, compiled)
    return _cached(compiled, CachedSteps(question, text, compiled, steps), file)


@dataclass(frozen=True, slots=True)
class _Entry:
    """An entry of the cache; ``given`` are objects that are not stored, and needed to read it."""

    question: BookQuestion
    step: str
    given: tuple[object, ...] = ()

    @property
    def _key(self) -> str:
        return _COMPILED.files.key(*self.question.place(), self.step)

    def read(self) -> Compilation | None:
        compilation = _COMPILED.recall(self._key, self.given)
        return compilation if isinstance(compilation, Compilation) else None

    def write(self, text: Compilation, compiled: CompiledRulebook) -> None:
        prefixes = compiled.prefixes if isinstance(compiled.prefixes, StoredPrefixes) else None
        compiled = replace(compiled, origin=None, recompile=None, prefixes=prefixes)
        _COMPILED.keep({self._key: replace(text, rulebook=compiled)}, self.given)


def _cached(compiled: CompiledRulebook, steps: CachedSteps, file: _Entry) -> CompiledRulebook:
    known = compiled.prefixes if isinstance(compiled.prefixes, StoredPrefixes) else None
    return replace(compiled, recompile=steps, prefixes=CachedPrefixes(file, steps, known))


@dataclass(frozen=True, slots=True)
class _ReadAgain:
    """The ``Origin`` of a cached rulebook."""

    question: BookQuestion

    def __call__(self) -> Rulebook:
        """The rulebook, read from its source. Raises RulecError."""
        question = self.question
        return load_rulebook(question.name, question.search_path, question.at)


class CachedSteps:
    """A ``Recompiler`` that asks the cache first; its files share parts with the ``own`` rulebook.

    ``own`` is the rulebook for the steps of the rules' own examples.
    """

    def __init__(
        self,
        question: BookQuestion,
        text: Compilation,
        own: CompiledRulebook,
        steps: StepCompiler | None = None,
    ) -> None:
        self._question = question
        self._text = replace(text, warnings=())
        self._own = own
        self._given = own.vocabulary, own.axioms, own.sources, *own.rules
        self._steps = steps
        self.time = CompilerTime() if steps is None else steps.time
        """The time that compilers have for all of its steps and machines."""
        self._answers: dict[Fraction, CompiledRulebook | RulecError] = {}

    def __reduce__(self) -> tuple[type[CachedSteps], tuple[object, ...]]:
        own = replace(self._own, origin=None, recompile=None, prefixes=None)
        return CachedSteps, (self._question, self._text, own)

    def __call__(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook for a step. Raises RulecError as ``StepCompiler``."""
        if step_s not in self._answers:
            if len(self._answers) >= MOST_FILES:
                self._answers.clear()
            self._answers[step_s] = self._load(step_s)
        answer = self._answers[step_s]
        if isinstance(answer, RulecError):
            raise answer
        return answer

    def judgeable_at(self, step_s: Fraction) -> CompiledRulebook:
        """The rulebook without rules too large for the step; which these are is not cached."""
        return self._compiler().judgeable_at(step_s)

    def _load(self, step_s: Fraction) -> CompiledRulebook | RulecError:
        file = _Entry(self._question, str(step_s), self._given)
        text = self._text
        known = file.read()
        if known and known.rulebook and known.basis == text.basis:
            return _cached(replace(known.rulebook, origin=self._own.origin), self, file)
        try:
            compiled = _sharing(self._compiler()(step_s), self._own)
        except RulecError as error:
            # Not cached: machines that are too large and a missing Spot, which may change.
            return error
        # The source may have changed since the rulebook was read from the cache.
        if compiled.sources == self._own.sources:
            file.write(text, compiled)
        return _cached(compiled, self, file)

    def _compiler(self) -> StepCompiler:
        if self._steps is None:
            # The parser takes 60 ms to import: only where the cache has no answer.
            from rulec.automata.step_compilation import StepCompiler

            self._steps = StepCompiler(_ReadAgain(self._question)(), self.time)
        return self._steps


def _sharing(compiled: CompiledRulebook, own: CompiledRulebook) -> CompiledRulebook:
    """The rulebook, reusing the objects of ``own`` wherever they are equal."""
    known = {rule.name: rule for rule in own.rules}
    return replace(
        compiled,
        vocabulary=_one_of(compiled.vocabulary, own.vocabulary),
        axioms=_one_of(compiled.axioms, own.axioms),
        sources=_one_of(compiled.sources, own.sources),
        rules=tuple([_one_rule(rule, known.get(rule.name, rule)) for rule in compiled.rules]),
    )


def _one_of(this: _Part, other: _Part) -> _Part:
    return other if this == other else this


def _one_rule(this: CompiledRule, other: CompiledRule) -> CompiledRule:
    return _one_of(this, other) if this.certificate == other.certificate else this


@dataclass(slots=True)
class CachedPrefixes:
    """A ``PrefixCompiler`` that adds its machines to the file of their rulebook."""

    _file: _Entry
    _steps: CachedSteps
    _stored: StoredPrefixes | None = None

    def __call__(self, rulebook: CompiledRulebook) -> Mapping[str, OutcomeMachine | None]:
        """The machines of the rulebook's rules. Raises RulecError R0403 if Spot is missing."""
        known = self._stored or StoredPrefixes({})
        rules = tuple([rule for rule in rulebook.rules if rule.name not in known.entries])
        if not rules:
            return known(rulebook)
        # The compiler takes 30 ms to import: only where the cache has no machines.
        from rulec.automata.prefix_machines import prefix_machines, timed_cuts

        lacking = replace(rulebook, rules=rules)
        machines = prefix_machines(lacking, self._steps.time)
        whole = self._file.read()
        if whole is not None and whole.rulebook is not None:
            ordered = {name: own and own.in_order() for name, own in machines.items()}
            self._stored = known = StoredPrefixes(
                {**known.entries, **ordered}, {**known.timed, **timed_cuts(lacking)}
            )
            if {rule.name for rule in whole.rulebook.rules}.issuperset(known.entries):
                self._file.write(whole, replace(whole.rulebook, prefixes=known))
        return {**known(rulebook), **machines}
