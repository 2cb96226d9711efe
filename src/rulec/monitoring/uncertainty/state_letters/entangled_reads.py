"""A rule's reads that may depend on each other, by what is known of their values.

Most rules count at most what is true of the objects that they are bound to, as in `some other: car
(other = x and parked(other))`. The joint digits of such reads are looked up by the state's values,
whatever the objects are called; for other rules by the values of all objects.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic.kleene import Unknown, holds
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import joint_digits
from rulec.monitoring.uncertainty.state_letters.counted_crowd import (
    count_in,
    crowd_of,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import (
    Letters,
    names_of_read,
    read_digits,
)
from rulec.monitoring.uncertainty.state_letters.reads_apart import (
    KnownParts,
    ReadsApart,
)
from rulec.monitoring.uncertainty.state_letters.related_facts import (
    fits_or_not,
    instances_of,
    is_of_one,
    keeps_to_its_objects,
    related_facts,
)
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    Subject,
    subjects_in,
    subjects_of_read,
)
from rulec.rulebook.rules.axiom_instances import counts
from rulec.vocabulary import Quantity, Vocabulary
from rulec.vocabulary.partial_values import PartialValue

MOST_KNOWN = 1 << 14
"""How many values keep their letters before all are discarded."""

MOST_COUNTED = 16
"""With more objects it is not determined for each one whether it counts."""


@dataclass(frozen=True, slots=True)
class NothingKnown:
    """A state of which only the objects present are known."""

    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def value(self, name: str, items: tuple[str, ...]) -> bool | float | str | Unknown:
        """Unknown."""
        return Unknown(name, items)

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """Unknown."""
        return Unknown(name, items)

    def given(self, name: str, items: tuple[str, ...]) -> None:
        """Unknown."""


class EntangledReads:
    """Reads of a rule that are counts, or that share values or axioms.

    They are evaluated for a binding's objects, with ``everybody`` possibly present. ``numbers`` are
    their places among the rule's reads, ``subjects`` what they depend on. Local reads depend only
    on the rule's own objects; their subjects are variables, with a ``binding`` of each to itself.
    If none of the ``shared`` subjects is unknown, and no other one an interval, each read may have
    any of its digits independently of the others. ``joint_letters`` has the possible joint digits
    as cubes, and whether each of them is possible.
    """

    def __init__(
        self,
        rule: CompiledRule,
        binding: Mapping[str, str],
        axioms: Sequence[CompiledAxiom],
        everybody: NothingKnown,
        *,
        known: KnownParts | None = None,
        is_local: bool = False,
    ) -> None:
        reads = rule.machine.reads
        self.is_local = is_local
        self._binding = binding
        self._axioms = axioms = related_facts(names_read_by(rule), axioms)
        self._everybody = everybody
        deciding = _deciding_subjects if is_local else subjects_of_read
        about = [set(deciding(read, binding, everybody)) for read in reads]
        facts = set[Subject]().union(*[x.about(everybody) for x in instances_of(axioms, everybody)])
        places = Counter(subject for own in (*about, facts) for subject in own)
        self.numbers = tuple(
            n
            for n, read in enumerate(reads)
            if count_in(read) or any(places[subject] > 1 for subject in about[n])
        )
        self._reads = [reads[n] for n in self.numbers]
        self._ready = [read_digits(read) for read in self._reads]
        read = set[Subject]().union(*[about[n] for n in self.numbers])
        self.subjects = tuple(sorted(read | facts if read & facts else read))
        often = Counter(name for own in self._reads for name in deciding(own, binding, everybody))
        self.shared = facts.union(subject for subject, n in often.items() if n > 1)
        for n in self.numbers:
            if _is_coarse(reads[n]):
                self.shared |= about[n]
        # Axioms about several objects restrict how many of them may count.
        self._crowd = None
        if not is_local and all(map(is_of_one, axioms)):
            bound = frozenset(binding.values())
            self._crowd = crowd_of(self._reads, self.subjects, bound, everybody.objects)
        self._apart = None
        if known is not None and (is_local or self._are_few_words()):
            self._apart = ReadsApart(
                self._reads,
                self.subjects,
                binding,
                axioms,
                everybody,
                known=known,
                counts_divided=not is_local,
            )
        self.joint_letters: list[tuple[Letters, bool]] = []
        self._numbers: dict[tuple[Letters, bool], int] = {}
        self._known: dict[tuple[object, ...], int] = {}

    def _are_few_words(self) -> bool:
        """Whether each object of a few may be examined by itself, being counted by words."""
        declared = self._everybody.vocabulary.declarations
        return (
            len(self._everybody.objects) <= MOST_COUNTED
            and not any(isinstance(declared[name], Quantity) for name, _ in self.subjects)
            and all(isinstance(read, Read) or _is_plain(read) for read in self._reads)
        )

    def subjects_of(self, objects: Mapping[str, str]) -> list[Subject]:
        """The subjects for a binding's objects."""
        if not self.is_local:
            return list(self.subjects)
        return [(name, tuple([objects[item] for item in items])) for name, items in self.subjects]

    def number(
        self, values: tuple[PartialValue | None, ...], there: Mapping[str, str] | None = None
    ) -> int:
        """The place in ``joint_letters`` for these values of the subjects.

        Unless the reads are local it matters which objects are ``there``. Raises MissingValueError.
        """
        if there is None:
            return self._place_of(values, values, self._everybody.objects)
        if self._apart is not None and len(there) == len(self._everybody.objects):
            # Missing values and contradictions of axioms are found below.
            with suppress(LookupError, MissingValueError):
                return self._place(self._apart.letters_of(values))
        if self._crowd is None:
            return self._place_of((values, *there), values, there)
        if values:
            key, few = self._crowd.few(values, there)
            return self._place_of(key, values, few)
        # Only who is there matters, and these are the same in many states
        alone = (*there,)
        if alone not in self._known:
            key, few = self._crowd.few(values, there)
            self._known[alone] = self._place_of(key, values, few)
        return self._known[alone]

    def _place_of(
        self,
        key: tuple[object, ...],
        values: tuple[PartialValue | None, ...],
        there: Mapping[str, str],
    ) -> int:
        known = self._known.get(key)
        if known is None:
            joint = self._letters(values, there)
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            known = self._known[key] = self._place(joint)
        return known

    def _place(self, joint: tuple[Letters, bool]) -> int:
        place = self._numbers.setdefault(joint, len(self.joint_letters))
        if place == len(self.joint_letters):
            self.joint_letters.append(joint)
        return place

    def _letters(
        self, values: Sequence[PartialValue | None], there: Mapping[str, str]
    ) -> tuple[Letters, bool]:
        if self._apart is not None and self.is_local:
            # The first missing value is found below.
            with suppress(MissingValueError):
                return self._apart.letters(self._apart.key(values))
        given = with_values({}, dict(zip(self.subjects, values, strict=True)))
        state = StateView(given, there, self._everybody.vocabulary)
        digits = [read.in_state(self._binding, state) for read in self._ready]
        if all(own & (own - 1) == 0 for own in digits):
            return (tuple(digits),), True
        facts = instances_of(self._axioms, state)
        joint = joint_digits(self._reads, self._binding, state, facts)
        letters = [tuple([1 << digit for digit in letter]) for letter in sorted(joint.digits)]
        return tuple(letters), joint.exact


def local_reads(rule: CompiledRule, rulebook: CompiledRulebook) -> EntangledReads | None:
    """The entangled reads of a rule, if they depend only on its own objects."""
    known: dict[str, EntangledReads | None] = rulebook.prepared.setdefault(EntangledReads, {})
    if rule.name not in known:
        parts = known_parts(rulebook)
        known[rule.name] = _local_reads(rule, rulebook.axioms, rulebook.vocabulary, parts)
    return known[rule.name]


def known_parts(rulebook: CompiledRulebook) -> KnownParts:
    """The cached parts of a rulebook's rules."""
    parts: KnownParts = rulebook.prepared.setdefault(KnownParts, KnownParts())
    return parts


def _local_reads(
    rule: CompiledRule,
    axioms: Sequence[CompiledAxiom],
    vocabulary: Vocabulary,
    parts: KnownParts,
) -> EntangledReads | None:
    facts = related_facts(names_read_by(rule), axioms)
    if not all(
        keeps_to_its_objects(fact) and fits_or_not(fact, rule.variables, vocabulary)
        for fact in facts
    ):
        return None
    if not all(_is_local(read, rule, vocabulary) for read in rule.machine.reads):
        return None
    own = {variable.name: variable.type for variable in rule.variables}
    binding = {name: name for name in own}
    return EntangledReads(
        rule, binding, facts, NothingKnown(own, vocabulary), known=parts, is_local=True
    )


def names_read_by(rule: CompiledRule) -> frozenset[str]:
    """The names that the reads of a rule depend on."""
    return frozenset(name for read in rule.machine.reads for name in names_of_read(read))


def _is_coarse(read: Read | NumberRead) -> bool:
    """Whether a count may skip digits between its least and its greatest possible one."""
    count = count_in(read)
    if count is None or not isinstance(read, NumberRead):
        return False
    return len(read.thresholds) > 1 or not _is_plain(read)


def _is_plain(read: NumberRead) -> bool:
    """Whether a number is that of the objects with some values."""
    count = count_in(read)
    return count is not None and len(read.terms) == 1 and not counts(count.body)


def _deciding_subjects(
    read: Read | NumberRead, binding: Mapping[str, str], everybody: NothingKnown
) -> Iterator[Subject]:
    """What a read depends on, with repetitions; for a count, what decides whether objects count."""
    count = count_in(read)
    if count is None:
        yield from subjects_of_read(read, binding, everybody)
        return
    vocabulary = everybody.vocabulary
    for item, kind in everybody.objects.items():
        inner = {**binding, count.variable: item}
        if vocabulary.is_subtype(kind, count.type) and isinstance(
            holds(count.body, inner, everybody), Unknown
        ):
            yield from subjects_in(count.body, inner, everybody)


def _is_local(read: Read | NumberRead, rule: CompiledRule, vocabulary: Vocabulary) -> bool:
    """Whether a read depends only on the objects that the rule is bound to."""
    count = count_in(read)
    if count is None:
        return True
    if counts(count.body):
        return False
    variables = {variable.name: variable.type for variable in rule.variables}
    for kind in variables.values():
        both = ({kind, count.type} <= set(vocabulary.ancestors(own)) for own in vocabulary.types)
        # Otherwise the object's type decides whether it counts.
        if not vocabulary.is_subtype(kind, count.type) and any(both):
            return False
    # Names of variables contain no space.
    strangers = {f"some {kind}": kind for kind in vocabulary.types}
    everybody = NothingKnown({**variables, **strangers}, vocabulary)
    binding = {name: name for name in variables}
    assert isinstance(read, NumberRead)
    return len(read.terms) == 1 and not any(
        vocabulary.is_subtype(kind, count.type)
        and holds(count.body, {**binding, count.variable: item}, everybody) is not False
        for item, kind in strangers.items()
    )
