"""A finding: what is violated, open or not judged, by whom, when and by how much."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, get_type_hints

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.verdict import OpenVerdict, RuleNotJudged, Violation
from rulec.report.json_document import JsonDocument, made_class
from rulec.report.text.terminal_text import cut
from rulec.rulebook.rulebook_model import cited_law
from rulec.value_display import short_repr
from rulec.version import __version__

Outcome = Literal["violated", "open", "not_judged"]

LONGEST_SHOWN = 120
"""The most characters of a finding's sentence in its ``repr``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictFinding:
    """A rule that a vehicle violates, whose outcome is open, or that could not be judged.

    ``file`` and ``recording`` name the source; for traces ``recording`` is empty. ``rulebook`` with
    this ``rulebook_hash`` has the text of ``law`` of the day ``as_of``. Without a ``rule``, the
    file was not judged; ``sentence`` says what it demands. ``vehicle`` is the drive or trace, empty
    for all of them; ``other`` are the objects that the rule is about. A violation lasts ``from_s``
    to ``to_s`` (s of the recording); an open one would be somewhere in between. It is decided
    ``at_s``: from then on the rule cannot be kept. ``measure`` is the comparison that decides most
    narrowly, of ``value`` with ``limit``; ``by`` is the difference in ``unit``, ``by_at_least``
    what of it is certain. A violation holds whatever is unknown; ``rests_on`` what was
    ``measured`` alone, or also on what the user ``assumed`` or a ``default``. ``open_on`` are the
    unknown names on which an outcome depends, ``because`` is the reason. ``x``, ``y`` (m) and
    ``lanelet`` are the vehicle's position ``at_s``. ``inherited_from`` is the rulebook that the
    rule comes from, if its own rulebook has not confirmed it as its law; otherwise empty.
    """

    file: str
    recording: str = ""
    rulebook: str = ""
    rulebook_hash: str = ""
    law: str = ""
    as_of: str = ""
    rule: str = ""
    provision: str = ""
    sentence: str = ""
    inherited_from: str = ""
    strength: Literal["hard", "soft", ""] = ""
    outcome: Outcome
    vehicle: str = ""
    other: tuple[str, ...] = ()
    from_s: float | None = None
    to_s: float | None = None
    at_s: float | None = None
    value: float | None = None
    limit: float | None = None
    by: float | None = None
    by_at_least: float | None = None
    unit: str = ""
    measure: str = ""
    rests_on: Literal["measured", "assumed", "default", ""] = ""
    open_on: tuple[str, ...] = ()
    because: str = ""
    x: float | None = None
    y: float | None = None
    lanelet: str = ""

    def __repr__(self) -> str:
        return f"VerdictFinding({cut(self.says, LONGEST_SHOWN)})"

    def row(self) -> dict[str, Any]:
        """The values of all columns."""
        return {name: getattr(self, name) for name in COLUMNS}

    @property
    def when(self) -> str:
        """When a violation lasts, such as ``1.3-4 s``; empty if it has no times."""
        if self.from_s is None:
            return ""
        ends = self.to_s not in (None, self.from_s)
        return f"{self.from_s:g}-{self.to_s:g} s" if ends else f"{self.from_s:g} s"

    @property
    def in_short(self) -> str:
        """Towards whom it is violated, and by how much, as far as there is something to say."""
        others = [name for name in self.other if f"({name})" not in self.measure]
        about = f"towards {', '.join(others)}" if others else ""
        return ": ".join(filter(None, (about, self.measure)))

    @property
    def says(self) -> str:
        """The finding as a sentence."""
        if not self.rule:
            return self.because
        law = cited_law(self.provision, self.inherited_from)
        title = f"{self.rule} [{law}]" if law else self.rule
        about = f" towards {', '.join(self.other)}" if self.other else ""
        vehicle = self.vehicle or "every vehicle"
        if self.outcome == "violated":
            narrow = f": {self.measure}" if self.measure else ""
            return f"{vehicle} violates {title}{about}{time_in_words(self)}{narrow}"
        on = f": depends on {', '.join(self.open_on)}" if self.open_on else ""
        why = f" ({self.because})" if self.because else ""
        if self.outcome == "open":
            return f"whether {vehicle} violates {title}{about} is open{on}{why}"
        return f"{title} is not judged for {vehicle}{on}{why}"


def named_rule(rule: CompiledRule) -> dict[str, Any]:
    """The columns of a finding that identify its rule and the law that it comes from."""
    return {
        "rule": rule.name,
        "provision": rule.cite,
        "sentence": rule.says,
        "inherited_from": rule.inherited_from,
        "strength": rule.strength,
    }


def measured(margins: Iterable[Margin]) -> dict[str, Any]:
    """The columns for the comparison that decides most narrowly; empty if there is none."""
    every = list(margins)
    if not every:
        return {}
    # Metres and km/h compare only as shares of what is compared.
    are_alike = len({margin.unit for margin in every}) == 1
    margin = min(every, key=lambda margin: margin.by if are_alike else margin.share)
    rounded = margin.rounded()
    return {
        "value": None if margin.value_bounds else rounded.value,
        "limit": None if margin.limit_bounds else rounded.limit,
        "by": rounded.by,
        "by_at_least": rounded.at_least,
        "unit": margin.unit,
        "measure": str(margin),
    }


class FindingSource:
    """What findings come from: a file, perhaps a recording in it, and a rulebook.

    Makes the findings of what becomes of the rules for a vehicle.
    """

    def __init__(self, rules: CompiledRulebook, file: str, recording: str = "") -> None:
        edition = edition_of(rules)._asdict()
        law = {name: edition[name] for name in ("rulebook", "rulebook_hash", "law", "as_of")}
        self._shared = {"file": file, "recording": recording, **law}
        self._rules = {rule.name: rule for rule in rules.rules}

    def violated(
        self, violation: Violation, vehicle: str, margins: Iterable[Margin], **evidence: Any
    ) -> VerdictFinding:
        """A violation; ``evidence`` are the columns of its times, its place and its grounds."""
        return self._finding(violation, "violated", vehicle, **measured(margins), **evidence)

    def left_open(
        self, result: OpenVerdict, vehicle: str, from_s: float | None, to_s: float | None
    ) -> VerdictFinding:
        """An open verdict on a drive that lasts ``from_s`` to ``to_s``."""
        return self._finding(
            result,
            "open",
            vehicle,
            other=tuple(result.binding.values()),
            from_s=from_s,
            to_s=to_s,
            open_on=tuple(result.depends_on),
            because=", ".join(result.because),
        )

    def not_judged(self, rule: RuleNotJudged, vehicle: str) -> VerdictFinding:
        """A rule that could not be judged."""
        lacking = tuple(rule.untold)
        return self._finding(rule, "not_judged", vehicle, open_on=lacking, because=rule.why)

    def nothing_judged(self, vehicle: str, why: str) -> VerdictFinding:
        """A vehicle for which no rule could be judged."""
        return VerdictFinding(outcome="not_judged", vehicle=vehicle, because=why, **self._shared)

    def _finding(
        self,
        result: Violation | OpenVerdict | RuleNotJudged,
        outcome: Outcome,
        vehicle: str,
        **columns: Any,
    ) -> VerdictFinding:
        rule = self._rules.get(result.rule)
        # A rule that is too large at the recording's step is not among the compiled rules.
        about = named_rule(rule) if rule else {"rule": result.rule, "strength": result.strength}
        return VerdictFinding(outcome=outcome, vehicle=vehicle, **columns, **about, **self._shared)


def time_in_words(finding: VerdictFinding) -> str:
    """When the finding is decided and how long it lasts, in words."""
    if finding.from_s is None:
        return ""
    at = finding.from_s if finding.at_s is None else finding.at_s
    if finding.to_s in (None, finding.from_s):
        return f" at {at:g} s"
    return f" at {at:g} s (from {finding.from_s:g} s to {finding.to_s:g} s)"


FindingLine = made_class(
    "FindingLine",
    get_type_hints(VerdictFinding),
    "A finding: a rule that is ``violated``, ``open`` or ``not_judged``.\n\n"
    "Fields that do not apply are null, an empty ``inherited_from`` means that the rule is the "
    "rulebook's\nown law.\n",
    JsonDocument,
)
"""A finding in JSON."""
_COLUMN_TYPES = {"tuple[str, ...]": list, "float | None": float}
COLUMNS: Mapping[str, type] = {
    field.name: _COLUMN_TYPES.get(str(field.type), str) for field in fields(VerdictFinding)
}
"""The columns of tables of findings, with the types of their values."""
EMPTY_CELLS: Mapping[type, str | tuple[str, ...]] = {str: "", list: ()}
"""The value of a column of a type where it does not apply; for a number it is None."""


@dataclass(frozen=True, slots=True)
class RecordingFindings:
    """The findings of a recording or a file of traces, and the names of its judged ``drives``.

    Without drives, and with a finding without a rule, nothing could be judged. ``rows`` are those
    of drives, rules and findings, if they are wanted (``FindingContext.columns``).
    """

    __repr__ = short_repr

    file: str
    recording: str
    drives: tuple[str, ...]
    findings: tuple[VerdictFinding, ...]
    rows: tuple[Mapping[str, object], ...] = ()

    @property
    def title(self) -> str:
        """The file, with the recording's name if it has one."""
        return f"{self.file}: {self.recording}" if self.recording else self.file

    @property
    def by_rule(self) -> Mapping[str, Sequence[VerdictFinding]]:
        """The findings of each rule; those without a rule are under ``""``."""
        by_rule: dict[str, list[VerdictFinding]] = {}
        for finding in self.findings:
            by_rule.setdefault(finding.rule, []).append(finding)
        return by_rule

    @property
    def failure(self) -> str:
        """Why nothing could be judged; empty if something was."""
        whole = (finding.because for finding in self.findings if not finding.rule)
        return next(whole, "") if not self.drives else ""


@dataclass(frozen=True)
class FindingContext:
    """What all findings share: the rulebook and the version of rulec.

    With ``columns``, tables have rows of drives, rules and findings with these columns. If
    ``strict``, hard rules that are open count as violated.
    """

    rulebook: CompiledRulebook
    version: str = __version__
    columns: Mapping[str, type] | None = None
    strict: bool = False

    def is_failure(self, finding: VerdictFinding) -> bool:
        """Whether a finding fails a run of continuous integration, like the exit status."""
        fails = finding.outcome == "violated" or (self.strict and finding.outcome == "open")
        return fails and finding.strength == "hard"

    @property
    def rules(self) -> Mapping[str, CompiledRule]:
        """The rules by name."""
        return {rule.name: rule for rule in self.rulebook.rules}

    @property
    def edition(self) -> Mapping[str, str]:
        """The law and the hash of the rulebook, with their names."""
        return edition_of(self.rulebook)._asdict()
