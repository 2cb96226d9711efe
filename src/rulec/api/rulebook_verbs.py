"""Verbs about rulebooks: read, compile, write, check, test."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from rulec.api import lazy_imports as lazy
from rulec.api.session_settings import SessionSettings
from rulec.diagnostics.argument_kinds import finite

if TYPE_CHECKING:
    from rulec.api.rulebook_compilation import Rules
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.book_tests.example_coverage import RuleCoverage
    from rulec.book_tests.example_runs import ExampleRun
    from rulec.rulebook.batch.batch_check import Checked
    from rulec.rulebook.rulebook_model import Rulebook
    from rulec.validation.file_proof import RuleProof
    from rulec.vocabulary import Vocabulary


class RulebookVerbs(SessionSettings):
    """The verbs of a session that are about rulebooks."""

    def load_rulebook(self, reference: str | Path) -> Rulebook:
        """Read a rulebook: names resolved, types checked, not compiled.

        ``reference`` is a name, looked up in the search path and among the rulebooks that ship with
        rulec; or a path, which contains a ``/`` or ends in ``.rules``. Raises RulecError with every
        mistake in it, in the rulebooks that it extends and in their vocabularies.
        """
        loaded = lazy.read_rulebook(reference, self.search_path, self.at)
        self._warn(loaded.warnings)
        return loaded.rulebook

    def parse_rulebook(self, text: str, name: str = "<text>") -> Rulebook:
        """Parse a rulebook's text, called ``name`` in messages. Raises RulecError."""
        return lazy.parse_rulebook(text, name, self._folders(), self.at)

    def load_vocabulary(self, name: str) -> Vocabulary:
        """Read a vocabulary by its name. Raises RulecError."""
        return lazy.load_vocabulary(name, self._folders())

    def compile_rulebook(
        self,
        reference: Rules,
        *,
        step_s: Fraction | float | None = None,
    ) -> CompiledRulebook:
        """Compile a rulebook: name, path of source or compiled file, or Rulebook.

        Without ``step_s`` it adapts to the step of the traces to judge; with it, it is for this
        step (s) alone; a float means its decimal notation.

        Raises:
            RulecError: mistakes in the source; R0401 to R0403 if there is no automaton, R0507 if it
                was compiled for another step.
        """
        return lazy.compile_rulebook(reference, self.search_path, self._warn, step_s, self.at)

    compile = compile_rulebook

    def write_compiled(
        self,
        rulebook: CompiledRulebook,
        folder: str | Path,
        *,
        certificate: bool = True,
        clocks: bool = False,
    ) -> tuple[Path, ...]:
        """Write RULE.hoa for every rule and RULEBOOK.json; returns the paths.

        With ``clocks`` the automata are for any step: their bounds in seconds are clocks. With
        ``certificate`` rules compiled by Spot are also compiled by a second compiler, and the file
        says which tables are equal. Raises RulecError, R0417 if some are not.
        """
        # A rulebook with two steps could not judge any trace.
        rulebook = lazy.with_automata(rulebook.at_one_step())
        if certificate:
            rulebook = lazy.second_compiler.certified(rulebook)
        texts_of = lazy.second_compiler.with_clocked_automata(rulebook) if clocks else None
        paths = lazy.write_compiled(rulebook, Path(folder), texts_of, lazy.timed_cuts)
        return tuple(paths)

    def write_monitor(
        self,
        rules: Rules,
        folder: str | Path,
        objects: Mapping[str, int] | None = None,
        *,
        prove: bool = False,
        language: Literal["c", "rust", "ros2"] = "c",
    ) -> tuple[Path, ...]:
        """Write a monitor in C99: header, source, Makefile, CMakeLists.txt; returns the paths.

        In another ``language`` it is a Rust crate, or a ROS 2 package around the C code.

        ``objects`` is the greatest number of objects at a time, by type; the default is 16 of each
        type that has no supertype. With ``prove`` it is compiled and compared with its tables
        before it is written, with a report. Raises RulecError R0750 if no such monitor is possible,
        and with ``prove`` R0751 to R0753.
        """
        compiled = self._compiled(rules)
        paths = lazy.write_monitor(
            compiled, Path(folder), objects or {}, prove=prove, language=language
        )
        return tuple(paths)

    def write_ltl(
        self,
        reference: str | Path | Rulebook,
        folder: str | Path,
        step_s: float | Fraction | None = None,
    ) -> tuple[Path, ...]:
        """Write a rulebook's formulas in LTL, for Spot, PRISM and nuXmv; returns the paths.

        ``step_s`` is the number of seconds between two states; None for the step of the rules'
        examples. Raises RulecError R0754.
        """
        finite("step_s", step_s)
        step = None if step_s is None else lazy.exact_step(step_s)
        rulebook = self.load_rulebook(reference) if isinstance(reference, str | Path) else reference
        steps = [rule.step_s for rule in rulebook.rules if lazy.has_seconds(rule.formula)]
        if step is None and steps:
            step = lazy.longest_divisor(steps)
        return tuple(lazy.write_ltl(rulebook, lazy.compiler.lower(rulebook, step), Path(folder)))

    def verify_compiled(self, path: str | Path) -> tuple[RuleProof, ...]:
        """Compare the tables in a compiled rulebook's file with its formulas, without Spot.

        Returns one result for each rule, which is proved if its ``because`` is empty. Raises
        RulecError: R0701, and for a file that is not a compiled rulebook, or damaged.
        """
        return tuple(lazy.proofs_of_file(Path(path)))

    def check(self, *references: str | Path) -> Checked:
        """List all diagnostics of rulebooks and vocabularies, without raising them.

        Each is a name, a file, or a folder (all .rules files in it).
        """
        names = [str(reference) for reference in references]
        return lazy.batch_check.check(names, bytes, self._folders(), self.at)

    def format(self, text: str, name: str = "<text>") -> str:
        """A rulebook's or vocabulary's text in the canonical form. Raises RulecError."""
        return lazy.batch_format.formatted(
            name, None, text.encode("utf-8", "surrogatepass")
        ).after.decode()

    def test(self, reference: str | Path, pattern: str | None = None) -> ExampleRun:
        """Run a rulebook's examples whose RULE or RULE/LABEL matches the pattern."""
        patterns = () if pattern is None else (pattern,)
        return lazy.run_examples(
            lazy.ExampleRequest(self.search_path, self.at, patterns), reference
        )

    def coverage(self, run: ExampleRun) -> tuple[RuleCoverage, ...]:
        """Measure what the examples of a run cover, rule by rule."""
        return lazy.example_coverage.coverage(run)
