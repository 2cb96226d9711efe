"""What each national rulebook says of concrete situations is what its law says."""

from typing import Any

import pytest

from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.verdict import NotJudged, Verdict
from support.builders.national_books import CASES, NATIONAL, compiled, read, rules_on, trace_of

FOUND_SINCE = {
    ("T16", "at"): ["allowed"],
    ("T16", "au-nsw"): ["allowed"],
    ("T9", "au-nsw"): ["forbidden", "r. 160(2)"],
    ("T10", "au-nsw"): ["forbidden", "r. 164"],
    ("T10", "us-ca"): ["forbidden", "§ 21756"],
    ("LB19", "us-ca"): ["forbidden", "§ 21655.1"],
    ("L91", "in"): ["allowed"],
    ("BC-N20", "kr"): ["forbidden", "art. 38(1)"],
    ("T7", "jp"): ["allowed"],
    ("X5", "jp"): ["allowed"],
    ("X6", "jp"): ["allowed"],
    ("L29", "jp"): ["allowed"],
    ("RF44", "pl"): ["forbidden", "art. 28(3) p. 3"],
    **{
        (case, "it"): ["allowed"]
        for case in (
            *("X1", "X2", "X4", "X104", "X105", "X107", "X109", "X112", "X117", "X118", "X120"),
            *("BD-R17", "BD-E11", "BA-M1", "ST-it-7", "OV3"),
        )
    },
}
"""What a law says where who wrote the case found no rule, and one was read since.

Austria: § 26a(2) of the StVO binds in built-up areas alone; so does New South Wales's r. 77, and
its r. 164 wants who is beside a tram at a stop to wait, and its r. 160(2) nobody to pass one on
its right. California: § 21756 wants who comes up behind a streetcar at its stop to wait behind it,
and lets nobody past a safety zone faster than 10 mph; § 21655.1 keeps lanes for buses free.
India: regulation 12(1)(f) of 2017 lets one turn left at red. Italy: who gets past on the right
without leaving its lane does not overtake, by the highway police, Cass. civ. 4820/1979 and art.
346(1) of the regulation, which none of these had read. Japan: art. 18(3) on passing cycles is in
force since 2026-04-01. Korea: art. 38(1) wants a signal from whoever drives onto a roundabout.
Poland: art. 28(3) lets no vehicle be overtaken on a level crossing, and a cycle is one.
"""


def said_of(cases: list[dict[str, Any]], name: str) -> list[str]:
    """The verdict of a rulebook on each case's own topics."""
    traffic = read(name).rulebook.traffic
    verdicts = verify_many([trace_of(case, traffic) for case in cases], compiled(name))
    return [
        _on_topic(verdict, {rule.name for rule in rules_on(name, case["topics"])})
        for case, verdict in zip(cases, verdicts, strict=True)
    ]


def _on_topic(verdict: Verdict | NotJudged, on_topic: set[str]) -> str:
    if isinstance(verdict, NotJudged):
        return str(verdict)
    if not on_topic:
        return "silent"
    strengths = {one.strength for one in verdict.violations if one.rule in on_topic}
    if "hard" in strengths:
        return "forbidden"
    return "advised against" if strengths else "allowed"


@pytest.mark.parametrize("name", NATIONAL)
def test_a_book_says_of_cases_what_its_law_says(name: str) -> None:
    cases = [case for case in CASES if name in case["verdicts"]]
    wrong = [
        f"{case['id']}: {found}, and not {expected[0]}"
        for case, found in zip(cases, said_of(cases, name), strict=True)
        if found != (expected := FOUND_SINCE.get((case["id"], name), case["verdicts"][name]))[0]
    ]
    assert wrong == []


def test_a_case_names_the_article_where_something_is_not_allowed() -> None:
    n_articles = {"forbidden": 1, "advised against": 1, "allowed": 0, "silent": 0}
    odd = [
        (case["id"], verdict)
        for case in CASES
        for verdict in case["verdicts"].values()
        if n_articles.get(verdict[0]) != len(verdict) - 1
    ]
    assert odd == []


def test_all_cases_of_the_survey_ask_the_same_books() -> None:
    asked = {tuple(case["verdicts"]) for case in CASES if case["id"].startswith("T")}
    assert asked == {("vienna", "de", "at", "fr", "nl", "se", "pl", "gb", "jp", "us-ca", "au-nsw")}


def test_every_book_is_asked() -> None:
    assert {name for case in CASES for name in case["verdicts"]} >= set(NATIONAL)


def test_a_silence_on_a_topic_has_its_reason() -> None:
    for case in CASES:
        for name in set(NATIONAL) & set(case["verdicts"]):
            if FOUND_SINCE.get((case["id"], name), case["verdicts"][name]) == ["silent"]:
                remarks = read(name).rulebook.remarks
                silences = {one.name for one in remarks if one.kind == "silent" and one.because}
                assert silences >= set(case["topics"]), f"{name} on {case['id']}"
