"""Past of a monitor, as far as it affects future verdicts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from rulec.monitoring.verdict import Violation

RuleFor: TypeAlias = tuple[str, tuple[str, ...]]
"""A rule's name, and the objects that its variables stand for."""


@dataclass(frozen=True, slots=True)
class CarriedState:
    """Machine states of objects that stay, and the permanent violations.

    ``settled`` are rules for objects that stay that are among the ``violations``.
    """

    states: Mapping[RuleFor, int] = field(default_factory=lambda: MappingProxyType({}))
    settled: frozenset[RuleFor] = frozenset()
    violations: tuple[Violation, ...] = ()


NO_PAST = CarriedState()
