"""Rulebooks in the README and the documentation are in the form that `rulec fmt` gives them."""

import re
from pathlib import Path

import pytest

from rulec.diagnostics import Source
from rulec.syntax.formatting import format_source

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = [
    pytest.param(text, id=f"{page.name}-{number}")
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    for number, text in enumerate(
        re.findall(
            r"^```rulec(?: vocabulary| file)?\n(.*?)^```",
            page.read_text(encoding="utf-8"),
            re.DOTALL | re.MULTILINE,
        )
    )
]


@pytest.mark.parametrize("text", SAMPLES)
def test_samples_are_in_form(text):
    assert format_source(Source("sample", text)) == text


def test_there_are_samples():
    assert len(SAMPLES) >= 8
