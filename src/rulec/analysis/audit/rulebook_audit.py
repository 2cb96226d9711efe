"""Audit of a rulebook: sources and examples of its rules, gaps, and coverage.

The findings are not mistakes. They are what a lawyer or a safety engineer wants to know before
relying on a rulebook.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import zip_longest
from typing import Any, Literal

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.analysis.audit.citations import Reference, each_reference, references_in, unread_note
from rulec.analysis.audit.law_text import LawText
from rulec.analysis.audit.provision_coverage import ListedProvision, provisions_of, unlisted
from rulec.analysis.lineage.book_lineage import HARDNESS
from rulec.analysis.lineage.rule_lineage import BookLineage, LineageStep
from rulec.diagnostics.diagnostic import at
from rulec.logic.free_names import names_in
from rulec.resource_limits import CITES
from rulec.rulebook.overlay.rulebook_overlay import in_force
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_in_force
from rulec.value_display import Rows, short_repr


@dataclass(frozen=True, slots=True)
class AuditFinding:
    """A finding about a rule, article, topic, parameter or word, by name."""

    __repr__ = short_repr

    kind: str
    name: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class CitedArticle:
    """A provision as rules cite it, the book in the chain that cites it, and the rules."""

    book: str
    cite: str
    rules: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class AuditCounts:
    """Counts of everything; rules are those in force.

    ``confirmed`` are those that are the rulebook's own law; ``verified`` rules are among these.
    ``articles`` are all that are cited, ``inherited_articles`` those of the laws that it extends.
    """

    rules: int = 0
    hard: int = 0
    soft: int = 0
    cited: int = 0
    tested: int = 0
    verified: int = 0
    examples: int = 0
    articles: int = 0
    words: int = 0
    words_used: int = 0
    confirmed: int = 0
    cites_looked_for: int = 0
    cites_found: int = 0
    inherited_articles: int = 0


@dataclass(frozen=True, slots=True)
class Audit(Rows):
    """All findings about a rulebook by the law of the day ``at``.

    ``provisions`` are the articles that it lists; ``law_text`` is the name of the file with the
    law's text in which citations were looked up, if any.
    """

    __repr__ = short_repr

    rulebook: str
    title: str
    law: str
    as_of: str
    at: str
    counts: AuditCounts
    articles: tuple[CitedArticle, ...]
    findings: tuple[AuditFinding, ...]
    provisions: tuple[ListedProvision, ...] = ()
    law_text: str = ""

    def rows(self) -> list[dict[str, Any]]:
        """One row per finding."""
        return [asdict(finding) for finding in self.findings]


@dataclass(frozen=True, slots=True)
class AuditChanges:
    """The findings that appeared or vanished since an older audit."""

    appeared: tuple[AuditFinding, ...] = ()
    vanished: tuple[AuditFinding, ...] = ()


def audit(
    rulebook: Rulebook,
    inherited: BookLineage,
    failing: Sequence[tuple[str, str]] = (),
    law: LawText | None = None,
    law_now: LawText | None = None,
) -> Audit:
    """The audit of a rulebook, with the lineage of its chain on the same day.

    ``failing`` are the examples that fail, if they were run: rule and label or number. ``law`` is
    the text in which citations are looked up, ``law_now`` its current version.
    """
    provisions = provisions_of(rulebook)
    checks = () if law is None else check_cites(rulebook, law, law_now)
    articles = articles_of(rulebook.rules, inherited)
    used = used_declarations(rulebook)
    words = tuple(rulebook.vocabulary.declarations)
    hard = {rule.name for rule in rulebook.rules if rule.strength == "hard"}
    findings = [
        *(finding for rule in rulebook.rules for finding in _of_rule(rule)),
        *(AuditFinding("failing", rule, f"example {name}") for rule, name in failing),
        *(
            AuditFinding("soft-only", article.cite, ", ".join(article.rules))
            for article in articles
            if hard.isdisjoint(article.rules)
        ),
        *_history(inherited, rulebook.at, rulebook.name),
        *(
            _dated(constant.name, value.since, value.until, f"{value.text} ")
            for constant in inherited.provisions
            for value in constant.settings
            if value.current and (value.since or value.until)
        ),
        *(
            AuditFinding("to-do", article.number, article.heading)
            for article in provisions
            if article.state == "to do"
        ),
        *(AuditFinding("unlisted", rule, place) for rule, place in unlisted(rulebook)),
        *(
            AuditFinding(check.result, check.rule, f"{check.place}: {check.note}")
            for check in checks
            if check.result != "found"
        ),
        *(AuditFinding("unused", name) for name in words if name not in used),
    ]
    order = list(KINDS)
    return Audit(
        rulebook=rulebook.name,
        title=rulebook.title,
        law=rulebook.law,
        as_of=rulebook.as_of,
        at=rulebook.at,
        counts=replace(
            _counts(rulebook, articles, sum(name in used for name in words)),
            cites_looked_for=sum(check.result != "unread" for check in checks),
            cites_found=sum(check.result in ("found", "law-changed") for check in checks),
            inherited_articles=sum(article.book not in inherited.own_law for article in articles),
        ),
        articles=articles,
        findings=tuple(sorted(findings, key=lambda finding: order.index(finding.kind))),
        provisions=provisions,
        law_text="" if law is None else law.name,
    )


def audit_changes(now: Audit, before: Audit) -> AuditChanges:
    """The findings that appeared or vanished between two audits; notes are not compared."""

    def only_in(first: Audit, second: Audit) -> tuple[AuditFinding, ...]:
        known = {(finding.kind, finding.name) for finding in second.findings}
        return tuple(
            finding for finding in first.findings if (finding.kind, finding.name) not in known
        )

    return AuditChanges(only_in(now, before), only_in(before, now))


def compare_audits(audits: Sequence[Audit], older: Sequence[Audit]) -> dict[str, AuditChanges]:
    """Rulebook -> changes since its older audit, or the only one given; without one all is new."""
    by_name = {saved.rulebook: saved for saved in older}
    only = older[0] if len(older) == 1 and len(audits) == 1 else None
    pairs = ((now, by_name.get(now.rulebook, only)) for now in audits)
    return {
        now.rulebook: AuditChanges(now.findings) if before is None else audit_changes(now, before)
        for now, before in pairs
    }


def used_declarations(rulebook: Rulebook) -> frozenset[str]:
    """The enumerations, signals and quantities that some rule reads."""
    return frozenset(name for rule in rulebook.rules for name in names_in(rule.formula))


def articles_of(rules: Sequence[Rule], inherited: BookLineage) -> tuple[CitedArticle, ...]:
    """The provisions that rules cite, those of the rulebook's own law before those of each base.

    Numbers within them are sorted numerically.
    """
    citing = {article.name: article.cited_by for article in inherited.rules}
    nearest = [article.name for article in reversed(inherited.books)]
    citing_rules: dict[tuple[str, str], list[str]] = {}
    for rule in rules:
        if rule.cite:
            citing_rules.setdefault((citing[rule.name], rule.cite), []).append(rule.name)
    ordered = sorted(
        citing_rules,
        key=lambda article: (nearest.index(article[0]), _natural(article[1]), article[1]),
    )
    return tuple(CitedArticle(*article, tuple(citing_rules[article])) for article in ordered)


def _natural(text: str) -> list[tuple[bool, int, str]]:
    """A sort key with which 9 comes before 11."""
    parts = ((part, part.lstrip("0")) for part in re.findall(r"[0-9]+|[^0-9]+", text))
    # Of two numbers the one with more digits is larger; compared as text, they may be of any
    # length.
    return [
        (True, len(number), number) if "0" <= part[0] <= "9" else (False, 0, part)
        for part, number in parts
    ]


def _counts(rulebook: Rulebook, articles: Sequence[CitedArticle], n_used: int) -> AuditCounts:
    rules = rulebook.rules
    n_hard = sum(rule.strength == "hard" for rule in rules)
    own = [rule for rule in rules if not rule.inherited_from]
    return AuditCounts(
        rules=len(rules),
        hard=n_hard,
        soft=len(rules) - n_hard,
        cited=sum(bool(rule.cite) for rule in rules),
        tested=sum(not _lacks(rule) for rule in rules),
        verified=sum(rule.certainty == "verified" for rule in own),
        examples=sum(len(rule.examples) for rule in rules),
        articles=len(articles),
        words=len(rulebook.vocabulary.declarations),
        words_used=n_used,
        confirmed=len(own),
    )


def _lacks(rule: Rule) -> str:
    missing = [
        word
        for word, accepts in (("accepts", True), ("rejects", False))
        if all(example.accepts is not accepts for example in rule.examples)
    ]
    return f"no example that it {' or '.join(missing)}" if missing else ""


def _of_rule(rule: Rule) -> Iterator[AuditFinding]:
    if not rule.cite:
        yield AuditFinding("uncited", rule.name, rule.says)
    if rule.inherited_from:
        note = " ".join(filter(None, (rule.inherited_from, rule.cite)))
        yield AuditFinding("inherited", rule.name, note)
    if _lacks(rule):
        yield AuditFinding("untested", rule.name, _lacks(rule))
    if rule.certainty != "verified":
        yield AuditFinding(rule.certainty or "unstated", rule.name, rule.source)
    if rule.in_force_from or rule.in_force_until:
        yield _dated(rule.name, rule.in_force_from, rule.in_force_until)


def _dated(name: str, since: str, until: str, value: str = "") -> AuditFinding:
    return AuditFinding("dated", name, value + print_in_force(tree.InForce(since, until)))


def _whose(step: LineageStep, own: str) -> str:
    """Why there is no rule, and which book says so if it is not the book named ``own``."""
    if step.book == own:
        return step.because
    whose = f"as {step.book} is" if step.deed == "silent" else f"by {step.book}"
    return ": ".join(filter(None, (whose, step.because)))


def _history(inherited: BookLineage, at: str, own: str) -> Iterator[AuditFinding]:
    for history in inherited.rules:
        last = history.last
        if last.deed in ("dropped", "silent"):
            yield AuditFinding(last.deed, history.name, _whose(last, own))
        if history.rule is None:
            continue
        softened = [
            step for step in history.steps if step.deed == "softened" and HARDNESS in step.clauses
        ]
        if softened and history.rule.strength == "soft":
            yield AuditFinding("softened", history.name, softened[-1].because)
        if history.rule.in_force is not None and not in_force(history.rule.in_force, at):
            yield AuditFinding("out-of-force", history.name, print_in_force(history.rule.in_force))


CiteResult = Literal["found", "not-found", "unread", "law-changed"]


@dataclass(frozen=True, slots=True)
class CiteCheck:
    """The result of looking up a place that a rule cites.

    ``unread`` is text that names no article, such as a custom or another law; ``law-changed`` is a
    place whose text has changed or is gone. ``note`` has details.
    """

    rule: str
    place: str
    result: CiteResult
    note: str = ""


def check_cites(
    rulebook: Rulebook, law: LawText, law_now: LawText | None = None
) -> tuple[CiteCheck, ...]:
    """Look up the citations of the rules that are the rulebook's own law, in rule order.

    With ``law_now``, places whose text there differs, apart from white space, have changed. Raises
    RulecError R0718 if all of them together are too much text to search.
    """
    own = [rule for rule in rulebook.rules if not rule.inherited_from]
    texts = [law] if law_now is None else [law, law_now]
    amount = 0
    for rule in own:
        places = list(_looked_for(rule.cite, law))
        amount += sum(text.length_of(place) for text in texts for place in places)
        CITES.within(amount, at(rule.span), f"rulebook `{rulebook.name}` up to rule `{rule.name}`")
    return tuple(check for rule in own for check in _checks(rule.name, rule.cite, law, law_now))


def _checks(rule: str, cite: str, law: LawText, law_now: LawText | None) -> Iterator[CiteCheck]:
    for reference in _looked_for(cite, law):
        text, place = law.find(reference), str(reference)
        if text is None:
            yield CiteCheck(rule, place, "not-found", law.missing(reference))
        elif law_now is None:
            yield CiteCheck(rule, place, "found")
        else:
            now = law_now.find(reference)
            if now is None:
                yield CiteCheck(rule, place, "law-changed", law_now.missing(reference))
            elif now != text:
                yield CiteCheck(rule, place, "law-changed", _difference(text, now))
            else:
                yield CiteCheck(rule, place, "found")
    for piece in references_in(cite)[1]:
        yield CiteCheck(rule, piece, "unread", unread_note(piece))


def _looked_for(cite: str, law: LawText) -> Iterator[Reference]:
    """The places that a ``cite`` names; an annex that only locates the next sign is left out."""
    places = tuple(each_reference(cite, frozenset(law.articles)))
    for place, following in zip_longest(places, places[1:]):
        if place.kind != "annex" or following is None or following.kind != "sign":
            yield place


_SHOWN = 60
"""The number of characters of a change that are shown, from where the texts differ."""


def _difference(before: str, after: str) -> str:
    """The start of the difference between two texts, from the beginning of a word."""
    pairs = zip(before, after, strict=False)
    same = next((at for at, (old, new) in enumerate(pairs) if old != new), None)
    start = min(len(before), len(after)) if same is None else same
    start = before.rfind(" ", 0, start) + 1
    was, now = (text[start : start + _SHOWN] for text in (before, after))
    return f"was “{was}”, is “{now}”"
