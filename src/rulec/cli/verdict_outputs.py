"""Destinations of verdicts: text, JSON Lines and findings, printed or in files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from typing import IO

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.output_options import Endings, Output, endings_of
from rulec.cli.output import answer_lines, output_stream
from rulec.report.findings.finding_formats import ENDINGS, FindingWriter
from rulec.report.text.console import print_line, print_result
from rulec.report.text.terminal_text import counted

FORMATS: Endings = {**endings_of("text", "json"), **ENDINGS}
"""Text, verdicts as one line of JSON per trace or drive, or findings in many formats."""


class VerdictOutputs:
    """Takes everything to be written, and passes to each output its part.

    If no output is standard output, text not written to a file is printed there.
    """

    def __init__(self) -> None:
        self.to_rows: lazy.DriveRows | None = None
        """The builder of rows of drives and rules, if tables of findings include them."""
        self.texts: list[Callable[[str], None]] = []
        self.lines: list[Callable[[str], None]] = []
        self.writers: list[FindingWriter] = []
        """What takes the text, JSON lines and findings; none of them where they are not wanted."""
        self.n_findings = 0
        self._heading = ""

    def text(self, text: str) -> None:
        """Take a part of the text."""
        for write in self.texts:
            if self._heading:
                write(self._heading)
            write(text)
        self._heading = ""

    def heading(self, text: str) -> None:
        """Take what stands above the next part of the text, if there is one."""
        self._heading = text

    def line(self, line: str) -> None:
        """Take a line of JSON."""
        for write in self.lines:
            write(line)

    def add(self, findings: lazy.RecordingFindings) -> None:
        """Take the findings of a recording, or of a file of traces. Raises RulecError."""
        self.n_findings += len(findings.findings)
        for writer in self.writers:
            writer.add(findings)


def finding_writer(
    form: str, stream: IO[bytes], about: lazy.FindingContext, name: str
) -> FindingWriter:
    """The writer of a format, for a stream called ``name`` in messages.

    Raises RulecError R0706 if Parquet is not available.
    """
    match form:
        case "junit":
            return lazy.JUnitWriter(stream, about)
        case "sarif":
            return lazy.SarifWriter(stream, about)
        case "mcap":
            return lazy.McapWriter(stream, about, name)
        case _:
            return lazy.FindingTable(form, stream, name, about.columns)


@contextmanager
def verdict_outputs(
    to: Sequence[Output],
    rules: lazy.CompiledRulebook,
    *,
    with_rows: bool = False,
    strict: bool = False,
) -> Iterator[VerdictOutputs]:
    """Outputs that are written completely when the block succeeds, and otherwise not at all.

    ``with_rows``: whether tables of findings also have rows of drives and rules. ``strict``:
    whether hard rules that are open count as violated.

    Raises RulecError R0702 if a file cannot be written, R0706.
    """
    columns: Mapping[str, type] | None = None
    if with_rows:
        columns = lazy.COLUMNS
    outputs = VerdictOutputs()
    written: list[Output] = []
    with ExitStack() as files:
        for output in to:
            if output.is_file:
                written.append(output)
            if output.form in ("text", "json"):
                lines = outputs.texts if output.form == "text" else outputs.lines
                lines.append(files.enter_context(answer_lines(output)))
            else:
                stream, name = files.enter_context(output_stream(output))
                about = lazy.FindingContext(rules, columns=columns, strict=strict)
                outputs.writers.append(finding_writer(output.form, stream, about, name))
        if len(written) == len(to) and not outputs.texts:
            outputs.texts.append(print_result)
        yield outputs
        for writer in outputs.writers:
            writer.close()
    if len(written) == len(to):
        for output in written:
            is_whole = output.form in ("text", "json")
            content = "the answer" if is_whole else counted(outputs.n_findings, "finding")
            print_line(f"wrote {content} to {output.path}")
