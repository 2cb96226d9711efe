"""Audits that were written as JSON are read again, and nothing else is."""

import codecs

import msgspec
import pytest

from rulec.analysis.audit.rulebook_audit import Audit, AuditCounts, AuditFinding, CitedArticle
from rulec.analysis.audit.saved_audit import read_audits
from rulec.diagnostics import RulecError

AUDIT = Audit(
    *("island", "Island", "law", "2024-01-01", "2024-02-01"),
    AuditCounts(rules=2, hard=1, soft=1),
    (CitedArticle("island", "§ 1", ("r", "s")),),
    (AuditFinding("uncited", "r"), AuditFinding("unused", "w", "note")),
)


@pytest.mark.parametrize("mark", [b"", codecs.BOM_UTF8])
def test_what_was_written_is_read(tmp_path, mark):
    path = tmp_path / "audit.json"
    path.write_bytes(mark + msgspec.json.encode({"audits": [AUDIT, AUDIT], "further": 1}))
    assert read_audits(path) == (AUDIT, AUDIT)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"{}", "this is not an audit: object missing required field `audits`"),
        (b'{"audits": [', "this is not an audit: input data was truncated"),
        (b"[1]", "this is not an audit: expected an object, got a list"),
        (
            b'{"audits": 1}',
            "this is not an audit: expected a list, got a whole number (in `audits`)",
        ),
        (b'{"audits": "\xff"}', "this is not an audit"),
    ],
)
def test_anything_else_is_refused(tmp_path, data, message):
    path = tmp_path / "audit.json"
    path.write_bytes(data)
    with pytest.raises(RulecError) as error:
        read_audits(path)
    (found,) = error.value.diagnostics
    assert (found.code, found.place.file) == ("R0705", str(path))
    assert found.message.startswith(message)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(RulecError) as error:
        read_audits(tmp_path / "none.json")
    assert error.value.diagnostics[0].code == "R0701"
