"""What coverage proposes for shipped rulebooks has the verdict that it claims, as it stands."""

import os

import pytest

import rulec
from rulec.book_tests.example_coverage import coverage
from rulec.report.tests.example_text import missing_examples

IS_LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
BOOKS = ["de", "us-ca", "nl", "jp", "se", "at", "fr", "gb", "kr", "vienna"][: 10 if IS_LONG else 4]
RULES = ["*"] if IS_LONG else ["speed_limit", "rail_side"]


def proposed(book):
    """Pairs of a rule with its variables, and the examples proposed that need no more words."""
    for pattern in RULES:
        run = rulec.test(book, pattern)
        heads = {rule.name: rule for rule in run.rulebook.rules}
        for rule in coverage(run):
            variables = ", ".join(f"{v.name}: {v.type}" for v in heads[rule.rule].variables)
            head = f"{rule.rule} ({variables})" if variables else rule.rule
            examples = missing_examples(rule, run.rulebook.vocabulary)
            yield head, [example for example in examples if not example.startswith("#")]


@pytest.mark.parametrize("book", BOOKS)
def test_all_that_is_proposed_comes_out_as_it_says(book, tmp_path):
    lines = [f"rulebook pasted\nextends {book}"]
    for head, examples in proposed(book):
        if examples:
            # Named, so that the examples that the book has are not run again.
            named = [
                example.replace("accept", f'accept "proposed {number}"', 1)
                if example.startswith("accept")
                else example.replace("reject", f'reject "proposed {number}"', 1)
                for number, example in enumerate(examples)
            ]
            lines.append("\n  ".join([f"override rule {head} {{", *named]) + "\n}")
    assert len(lines) > 1
    path = tmp_path / "pasted.rules"
    path.write_text("\n".join(lines) + "\n")
    run = rulec.test(str(path), "*/proposed *")
    failed = [f"{one.rule.name}/{one.name}" for one in run.outcomes if not one.passed]
    assert run.outcomes
    assert failed == []
