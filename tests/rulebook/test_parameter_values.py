"""The value of a parameter that several rulebooks of a chain set."""

from fractions import Fraction
from pathlib import Path

import pytest

from rulec.logic.formula import Comparison, Unary
from rulec.rulebook.reading.rulebook_reader import load_rulebook

TEXTS = {
    "general": """rulebook general
quantity gap in m default 0
param shortest : length = 1 m
hard rule keep { require always gap > shortest }
""",
    "middle": "rulebook middle\nextends general\nset shortest = 3 m\n",
    "near": "rulebook near\nextends middle\nset shortest = 2 m in force from 2020-01-01\n",
    "nearest": "rulebook nearest\nextends near\n",
}


@pytest.mark.parametrize(
    ("name", "day", "metres"),
    [
        ("general", "2021-01-01", 1),
        ("middle", "2021-01-01", 3),
        ("near", "2021-01-01", 2),
        ("nearest", "2021-01-01", 2),
        ("near", "2019-01-01", 3),
    ],
)
def test_nearest_rulebook_with_a_value_in_force_sets_a_parameter(
    tmp_path: Path, name: str, day: str, metres: int
) -> None:
    for book, text in TEXTS.items():
        (tmp_path / f"{book}.rules").write_text(text)
    (rule,) = load_rulebook(tmp_path / f"{name}.rules", at=day).rules
    assert isinstance(rule.formula, Unary)
    assert isinstance(rule.formula.operand, Comparison)
    assert rule.formula.operand.limit == Fraction(metres)
