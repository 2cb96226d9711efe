"""A look at an XML file before a library takes it: is it CommonRoad, and can it do no harm?

Documents that define entities are refused at the definition, before anything is expanded or
fetched.
"""

from __future__ import annotations

from pathlib import Path
from xml.parsers.expat import ExpatError, ParserCreate, errors

from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.files import opened

LARGEST_BYTES = 200_000_000
VERSIONS = ("2018b", "2020a")
_BLOCK = 1 << 16


def check_commonroad(path: Path) -> None:
    """Raise RulecError unless the file is well-formed XML of CommonRoad's, without definitions.

    Raises:
        RulecError: R0610 for a file that is none, R0701 for one that cannot be read.
    """
    parser = ParserCreate()
    seen: list[str] = []

    def begin(name: str, attributes: dict[str, str]) -> None:
        if seen:
            return
        seen.append(name)
        if name != "commonRoad":
            raise refused(
                path,
                f"it is XML, but of `{_short(name)}`, not of `commonRoad`",
                parser.CurrentLineNumber,
            )
        version = attributes.get("commonRoadVersion", "")
        if version not in VERSIONS:
            raise refused(
                path,
                f"its `commonRoadVersion` is `{_short(version)}`",
                parser.CurrentLineNumber,
                expected=f"expected {' or '.join(VERSIONS)}",
            )

    def definition(*_: object) -> None:
        raise refused(
            path,
            "it has a `DOCTYPE`, which CommonRoad has not, and which could define anything",
            parser.CurrentLineNumber,
            help_text="take the `<!DOCTYPE …>` out",
        )

    parser.StartElementHandler = begin
    parser.StartDoctypeDeclHandler = definition
    size = 0
    try:
        with opened(path) as stream:
            while block := stream.read(_BLOCK):
                size += len(block)
                if size > LARGEST_BYTES:
                    message = f"it is too large: at most {LARGEST_BYTES:,} bytes are read"
                    raise refused(path, message, None)
                parser.Parse(block, False)
        parser.Parse(b"", True)
    except ExpatError as problem:
        message = f"it is not well-formed XML: {errors.messages[problem.code]}"
        raise refused(path, message, problem.lineno) from None


def refused(
    path: Path, why: str, line: int | None, *, expected: str = "", help_text: str = ""
) -> RulecError:
    """Why a file is no CommonRoad scenario (R0610), and on which line that shows, if on one."""
    place = Place(str(path)) if line is None else Place(str(path), line)
    return RulecError(
        Diagnostic(
            "R0610",
            f"the file cannot be read as a CommonRoad scenario: {why}",
            place,
            expected=expected,
            help=help_text or "CommonRoad's format is described at https://commonroad.in.tum.de",
        )
    )


def _short(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in text[:40])
