"""Every code of the language is produced by some bad program or by bytes that are no program."""

from pathlib import Path

import pytest

from rulec.diagnostics import RulecError
from rulec.report.findings.code_registry import all_codes
from rulec.rulebook.reading.rulebook_reader import load_rulebook

BAD = Path(__file__).parent / "bad"
START = b"rulebook a\nsignal p\nhard rule r { "
NO_PROGRAMS = {
    "R0101": b"\xff",
    "R0102": b"#" * 5_000_001,
    "R0103": b"# nothing\n",
    "R0107": START + b'says "\x1b[2J" require always p }',
    "R0111": START + b"require always " + b"!" * 201 + b"p }",
}


@pytest.mark.parametrize("code", NO_PROGRAMS)
def test_bytes_that_are_no_program(code, tmp_path):
    path = tmp_path / "a.rules"
    path.write_bytes(NO_PROGRAMS[code])
    with pytest.raises(RulecError) as caught:
        load_rulebook(path)
    assert [one.code for one in caught.value.diagnostics] == [code]


def test_every_code_has_its_program():
    shown = "".join(path.read_text(encoding="utf-8") for path in BAD.glob("*.expected"))
    of_the_language = {code for code in all_codes() if code[:3] in ("R01", "R02", "R03")}
    missing = {code for code in of_the_language if f"[{code}]" not in shown} - set(NO_PROGRAMS)
    assert missing == set()
