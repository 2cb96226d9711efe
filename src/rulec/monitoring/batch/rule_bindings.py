"""Every rule of a rulebook, for every binding of its variables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.binding import bindings
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True, eq=False)
class RuleBinding:
    """Rule bound to ``objects`` from step ``first`` to ``last`` (inclusive).

    ``last`` is None for each trace's own end. Bindings are compared by identity: they are keys.
    """

    rule: CompiledRule
    objects: Mapping[str, str]
    first: int
    last: int | None

    @property
    def stretch(self) -> tuple[int, int | None]:
        """The first and the last step."""
        return self.first, self.last


def rule_bindings(
    rules: Sequence[CompiledRule],
    vocabulary: Vocabulary,
    objects: Mapping[str, str],
    present: Mapping[str, tuple[int, int]],
    n_steps: int,
) -> Iterator[RuleBinding]:
    """All bindings of rules to objects, for at most ``n_steps`` states.

    In the order in which a verdict lists violations. All traces have the steps that ``present``
    speaks of.
    """
    for rule in rules:
        for binding in bindings(rule, vocabulary, objects, present, n_steps):
            ends_early = any(item in present for item in binding.objects.values())
            last = binding.last if ends_early else None
            yield RuleBinding(rule, binding.objects, binding.first, last)
