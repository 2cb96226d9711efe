"""What an audit finds, and what it does not."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.analysis.audit.law_text import law_text
from rulec.analysis.audit.rulebook_audit import (
    Audit,
    AuditCounts,
    AuditFinding,
    CitedArticle,
    articles_of,
    audit,
    audit_changes,
    compare_audits,
)
from rulec.analysis.lineage.book_lineage import read_with_lineage
from rulec.analysis.lineage.rule_lineage import BookHeader, BookLineage, LineageStep, RuleHistory
from rulec.diagnostics import Source
from rulec.logic.formula import Constant
from rulec.rulebook.rulebook_model import Rule
from support.builders import rulebook_family as island


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return island.write(tmp_path_factory.mktemp("books"))


def audited(path, at, failing=(), **laws):
    loaded, lineage, _ = read_with_lineage(path, at=at)
    return audit(loaded.rulebook, lineage, failing, **laws)


def found(one, kind):
    return [(each.name, each.note) for each in one.findings if each.kind == kind]


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("uncited", [("own", "")]),
        ("inherited", [("kept", "mainland § 9"), ("softer", "mainland § 2")]),
        (
            "untested",
            [
                ("softer", "no example that it accepts or rejects"),
                ("agreed", "no example that it rejects"),
                ("own", "no example that it rejects"),
            ],
        ),
        ("failing", [("own", "example 1")]),
        ("unverified", [("softer", "")]),
        ("secondary", [("changed", "")]),
        ("unstated", [("own", "")]),
        ("soft-only", [("§ 2", "softer")]),
        ("softened", [("softer", "only recommended")]),
        ("dropped", [("taken_out", "by island: there are no sirens")]),
        (
            "silent",
            [
                ("left_open", "as island is: nobody knows"),
                ("parking", "as island is: left to the villages"),
            ],
        ),
        ("dated", [("own", "in force from 2024-06-01")]),
        ("out-of-force", [("expired", "in force until 2000-01-01")]),
        ("to-do", [("§ 12", "Fees")]),
        ("unlisted", [("agreed", "§ 11")]),
        ("not-found", [("agreed", "§ 11: act.md has no § 11")]),
        ("unread", [("agreed", "custom: it names no article to look up")]),
        ("law-changed", [("changed", "§ 10a: was “slow.”, is “slower.”")]),
        ("unused", [("unused_word", "")]),
    ],
)
def test_every_kind(path, kind, expected):
    law, law_now = (
        law_text(Source("act.md", f"### § 10a Slowness\n\nBe {how}.\n"))
        for how in ("slow", "slower")
    )
    one = audited(path, "2024-06-01", [("own", "1")], law=law, law_now=law_now)
    assert found(one, kind) == expected
    assert (one.counts.cites_found, one.counts.cites_looked_for) == (1, 2)


def test_every_kind_is_tested():
    (cases,) = [mark for mark in test_every_kind.pytestmark if mark.name == "parametrize"]
    assert [kind for kind, _ in cases.args[1]] == list(KINDS)


def test_what_is_there(path):
    one = audited(path, "2024-06-01")
    assert (one.rulebook, one.law, one.at) == ("village", "Island Act", "2024-06-01")
    # kept, changed, softer, agreed, own; two examples each of kept and changed, one of agreed and
    # of own. Verified is what island says of agreed, not what mainland says of kept; changed has an
    # article of island's, agreed is confirmed, own is its own. Of the four articles, those of kept
    # and softer are mainland's.
    assert one.counts == AuditCounts(
        5, 4, 1, 4, 2, 1, 6, 4, 4, 3, confirmed=3, inherited_articles=2
    )
    # The nearest law first, in each the smallest number.
    assert one.articles == (
        CitedArticle("island", "§ 10a", ("changed",)),
        CitedArticle("island", "§ 11, custom", ("agreed",)),
        CitedArticle("mainland", "§ 2", ("softer",)),
        CitedArticle("mainland", "§ 9", ("kept",)),
    )


def test_a_day_on_which_a_rule_is_not_yet_in_force(path):
    one = audited(path, "2024-05-31")
    assert ("own", "in force from 2024-06-01") in found(one, "out-of-force")
    assert found(one, "uncited") == found(one, "dated") == []


def test_a_parameter_whose_value_is_dated(path):
    one = audited(path.with_stem("mainland"), "2022-01-01")
    assert found(one, "dated") == [("pace", "25 km/h in force from 2022-01-01")]
    assert found(one, "softened") == found(one, "soft-only") == []


def test_a_rule_made_hard_again_is_not_softened(path):
    again = path.with_stem("strict_village")
    again.write_text("rulebook strict_village\nextends island\noverride hard rule softer { }\n")
    assert found(audited(again, "2024-01-01"), "softened") == []


def test_articles_in_the_order_of_their_numbers():
    cites = ["Art. 11.6", "Art. 9", "Art. 11.10", "Art. 9", "", "9", "Annex"]
    rules = [Rule(f"r{at}", "hard", (), Constant(True), cite) for at, cite in enumerate(cites)]
    steps = [
        RuleHistory(one.name, (LineageStep("b", "declared", None, gives_law=True),))
        for one in rules
    ]
    found = articles_of(rules, BookLineage((BookHeader("b"),), tuple(steps), ()))
    assert [(one.cite, one.rules) for one in found] == [
        ("Annex", ("r6",)),
        ("Art. 9", ("r1", "r3")),
        ("Art. 11.6", ("r0",)),
        ("Art. 11.10", ("r2",)),
        ("9", ("r5",)),
    ]


def made(name, *findings):
    return Audit(name, "", "", "", "2024-01-01", AuditCounts(), (), findings)


A, B = AuditFinding("uncited", "a"), AuditFinding("uncited", "b")


def test_what_has_changed():
    found = audit_changes(
        made("x", A, replace(B, kind="dated")), made("x", replace(A, note="n"), B)
    )
    assert found.appeared == (replace(B, kind="dated"),)
    assert found.vanished == (B,)


findings = st.lists(st.builds(AuditFinding, st.sampled_from(list(KINDS)), st.sampled_from("abc")))


@given(findings, findings)
def test_changes_lead_from_the_old_to_the_new(old, new):
    found = audit_changes(made("x", *new), made("x", *old))
    assert set(new) == set(old) - set(found.vanished) | set(found.appeared)
    assert set(found.appeared).isdisjoint(old)
    assert set(found.vanished).isdisjoint(new)


def test_each_rulebook_is_compared_with_itself():
    found = compare_audits([made("x", A), made("y", A)], [made("y", B), made("x", A)])
    assert (found["x"].appeared, found["x"].vanished) == ((), ())
    assert (found["y"].appeared, found["y"].vanished) == ((A,), (B,))


def test_one_rulebook_can_be_compared_with_any_other():
    assert compare_audits([made("x", A)], [made("y", A)])["x"].appeared == ()


def test_to_a_rulebook_without_an_older_audit_everything_is_new():
    found = compare_audits([made("x", A), made("y", A)], [made("x", A)])
    assert (found["x"].appeared, found["y"].appeared) == ((), (A,))


def test_the_silence_of_another_book_is_said_to_be_its_own(tmp_path):
    (tmp_path / "treaty.rules").write_text(
        "rulebook treaty\nuse road\n"
        'silent on zipper because "no rule"\nsilent on parking because "x"\n'
    )
    own = tmp_path / "land.rules"
    own.write_text('rulebook land\nextends treaty\nsilent on parking because "our own reason"\n')
    assert found(audited(own, ""), "silent") == [
        ("zipper", "as treaty is: no rule"),
        ("parking", "our own reason"),
    ]
