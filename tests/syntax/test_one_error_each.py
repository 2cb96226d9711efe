"""As many errors as mistakes, each where its mistake is."""

from hypothesis import given

from rulec.diagnostics import RulecError
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.rulebook.loader import parse_rulebook
from support.generators.broken_rulebooks import FOOTER, HEADER, broken_rulebooks, rule_parts


def test_without_mistakes_there_is_no_error():
    parts = [*HEADER, *rule_parts(1), *rule_parts(2), *FOOTER]
    rulebook = parse_rulebook("\n".join(part.right for part in parts))
    assert [rule.name for rule in rulebook.rules] == ["R1", "R2"]


@given(broken_rulebooks())
def test_each_mistake_is_one_error_in_its_place(case):
    text, places = case
    try:
        parse_rulebook(text)
        found = ()
    except RulecError as error:
        found = [one for one in error.diagnostics if one.severity == "error"]
    shown = f"{text}\n{render_diagnostics(found)}"
    assert len(found) == len(places), shown
    for one, (first, last) in zip(found, places, strict=True):
        assert first <= one.place.line <= last, shown


def test_every_way_to_be_wrong_is_one_error():
    plain = [*HEADER, *rule_parts(1), *rule_parts(2), *FOOTER]
    for position, part in enumerate(plain):
        for wrong in part.wrong:
            lines = [one.right for one in plain]
            lines[position] = wrong
            try:
                parse_rulebook("\n".join(lines))
                found = ()
            except RulecError as error:
                found = [one for one in error.diagnostics if one.severity == "error"]
            assert len(found) == 1, f"{wrong}\n{render_diagnostics(found)}"
            assert position + 1 <= found[0].place.line <= position + 2, wrong
