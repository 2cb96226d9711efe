"""The registry of codes: every one is raised somewhere and asked for by some test."""

from pathlib import Path

import pytest

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.codes import CODES

ROOT = Path(__file__).resolve().parents[2]
SOURCES = "".join(
    path.read_text()
    for path in (ROOT / "src").rglob("*.py")
    if path.name != "codes.py" and path.parent.name != "explanations"
)
TESTS = "".join(
    path.read_text()
    for pattern in ("*.py", "*.expected")
    for path in (ROOT / "tests").rglob(pattern)
)


@pytest.mark.parametrize("code", CODES)
def test_a_code_is_raised_and_tested(code):
    assert f'"{code}"' in SOURCES
    assert code in TESTS


def test_a_code_that_is_not_registered_cannot_be_used():
    with pytest.raises(ValueError, match="R9999"):
        Diagnostic("R9999", "what is this?")
