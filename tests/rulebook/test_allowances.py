"""Comments that allow the warnings of their line."""

import pytest

from rulec.rulebook.loader import diagnose

BOOK = "rulebook a\nsignal p\nparam pace = 7 km/h{}\nhard rule r {{ require always p }}{}\n"


def codes(behind_pace="", behind_rule=""):
    text = BOOK.format(behind_pace, behind_rule)
    return [finding.code for finding in diagnose("a.rules", text.encode()).findings]


@pytest.mark.parametrize(
    "comment",
    [
        "  # rulec: allow R0208 because a later rule reads it",
        "  # the walking pace; rulec said so  # rulec: allow R0360, R0208 because of both",
        "  #rulec:  allow  R0208  because  so",
    ],
)
def test_a_warning_is_allowed_with_a_reason(comment):
    assert codes() == ["R0208"]
    assert "R0208" not in codes(comment)


@pytest.mark.parametrize(
    "comment", ["  # rulec: allow R0208", "  # rulec: allow R0208 because", "  # allow R0208"]
)
def test_without_a_reason_it_stays(comment):
    found = codes(comment)
    assert found == ["R0208", "R0219"] if "rulec" in comment else ["R0208"]


def test_what_is_not_found_is_not_allowed():
    assert codes("", "  # rulec: allow R0208 because elsewhere") == ["R0208", "R0219"]
    # No code begins so
    assert codes("", "  # rulec: allow R0999 because of it") == ["R0208", "R0219"]
    # Whether an analysis, or a test, finds something here is not known.
    assert codes("", "  # rulec: allow R0801, R0408 because of the tests") == ["R0208"]


def test_an_error_is_not_allowed():
    text = "rulebook a\nhard rule r { require nope }  # rulec: allow R0202 because I say so\n"
    found = [finding.code for finding in diagnose("a.rules", text.encode()).findings]
    assert found == ["R0202"]  # and where there are errors, not all warnings are known


def test_in_a_vocabulary_it_is_looked_at_as_well():
    text = "vocabulary a { signal p }  # rulec: allow R0208 because it may be\n"
    assert [one.code for one in diagnose("a.rules", text.encode()).findings] == ["R0219"]
