"""Audits saved as JSON, for comparison with new ones."""

from __future__ import annotations

import codecs
from pathlib import Path

import msgspec

from rulec.analysis.audit.audit_messages import NOT_AN_AUDIT
from rulec.analysis.audit.rulebook_audit import Audit
from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.phrases import json_words
from rulec.files.read_files import MAX_LAW_BYTES, opened, read_whole


class _File(msgspec.Struct):
    audits: list[Audit]


def read_audits(path: Path) -> tuple[Audit, ...]:
    """Read the output of ``rulec show --audit --output-format json``. Raises R0701 or R0705."""
    with opened(path) as stream:
        data = read_whole(stream, path, MAX_LAW_BYTES).removeprefix(codecs.BOM_UTF8)
    try:
        return tuple(msgspec.json.decode(data, type=_File).audits)
    except msgspec.MsgspecError as problem:
        raise _no_audit(path, f": {json_words(problem)}") from None
    except (RecursionError, UnicodeDecodeError):
        raise _no_audit(path, "") from None


def _no_audit(path: Path, reason: str) -> RulecError:
    return NOT_AN_AUDIT.error(
        SourceLocation(str(path)),
        f"this is not an audit{reason}",
        help="write one with `rulec show --audit RULEBOOK --output-format json`",
    )
