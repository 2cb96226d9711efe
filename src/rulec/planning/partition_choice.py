"""The partition that supplies the relations which a rulebook reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError, named
from rulec.logic.free_names import names_in
from rulec.planning.planning_messages import TWO_PARTITIONS
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.partition import PartitionName
    from rulec.rulebook.rulebook_model import Rulebook

RELATIONS_OF: dict[PartitionName, tuple[str, ...]] = {
    "paper": ("position",),
    "fine": ("station", "lateral"),
}
"""The relations that only one partition supplies."""

SUPPLIED = {"surface", *RELATIONS_OF["paper"], *RELATIONS_OF["fine"]}
"""The names that partitions supply."""


def partition_for(
    rules: Rulebook | CompiledRulebook, wanted: PartitionName | None
) -> PartitionName:
    """The wanted partition, or the one that the rules need.

    Raises:
        RulecError: R0405 if the rules need another one, or two.
    """
    read = {name for rule in rules.rules for name in names_in(rule.formula)}
    needed = {
        name: [relation for relation in relations if relation in read]
        for name, relations in RELATIONS_OF.items()
        if read.intersection(relations)
    }
    if len(needed) > 1:
        raise _no_partition(
            f"rulebook `{rules.name}` reads {named(needed['paper'])} and {named(needed['fine'])}, "
            "which no one partition supplies",
            "say it with `station` and `lateral` alone: they tell apart all that `position` does",
        )
    for name, relations in needed.items():
        if wanted not in (None, name):
            raise _no_partition(
                f"rulebook `{rules.name}` reads {named(relations)}, which the partition "
                f"`{wanted}` does not supply",
                f"use the partition `{name}`, or leave the choice to the rulebook",
            )
        return name
    return wanted or _spoken_of(rules.vocabulary)


def _spoken_of(vocabulary: Vocabulary) -> PartitionName:
    """Partition whose relations a vocabulary declares."""
    declared = {name for name in vocabulary.declarations if name in RELATIONS_OF["fine"]}
    return "fine" if declared else "paper"


def _no_partition(message: str, way_out: str) -> RulecError:
    return TWO_PARTITIONS.error(None, message, help=way_out)
