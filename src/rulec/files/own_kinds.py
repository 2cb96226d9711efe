"""Files of rulec's own kinds, which other verbs than the one at hand read."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import Final

from rulec.diagnostics import RulecError
from rulec.files.read_files import opened

_HEAD_BYTES: Final = 4096
_KINDS: Final = (
    (rb'"format": "rulec comp', "it is a compiled rulebook: `rulec verify TRAFFIC -r {}` uses it"),
    (rb"\A(?:\s|#.*)*(?:rulebook|vocabulary)\s", "it is a source of rules: see `rulec check {}`"),
    (rb'"outcome": ?|\Akind,.*,outcome,', "it has findings, which `rulec rates {}` counts"),
    (rb'"satisfied": ?', "it has verdicts of `rulec verify`; give what was judged"),
    (rb'"states": ?|\Atrace,step,', "it has traces, which `rulec verify {} -r de` judges"),
    (rb"(?m)^\[+(?:road|obstacle)", "it is a scenario, for `rulec maneuvers {} -r esterle2019`"),
)
"""What is found at the beginning of a file, and what to do with it."""


def what_reads(file: str) -> str:
    """Help that says what a file of rulec's own is, and which verb reads it; empty for others."""
    head = b""
    with suppress(RulecError, ValueError), opened(Path(file)) as stream:
        head = stream.read(_HEAD_BYTES)
    return next((text.format(file) for sign, text in _KINDS if re.search(sign, head)), "")
