"""Where verdicts go: text, lines of JSON and findings, to standard output and to files."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

import click

from rulec.cli.options.output_options import Endings, chosen_format
from rulec.cli.output import counted
from rulec.files import written_whole
from rulec.report.text.console import print_result
from rulec.report.verdict_findings.finding_writers import BINARY, ENDINGS, finding_writer

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.report.verdict_findings.finding_writers import FindingWriter
    from rulec.report.verdict_findings.verdict_finding import FoundInRecording

FORMATS: Endings = {"text": (".txt",), "json": (".json",), **ENDINGS}
"""Text, verdicts as a line of JSON for each trace or drive, or findings in many formats."""

Sink = tuple[str, str]
"""The path of a file, or `-`, and a format."""


def chosen_sinks(
    outputs: Sequence[str], output_format: str | None, inputs: Sequence[str], *, json_output: bool
) -> list[Sink]:
    """Files with their formats; without any, standard output.

    Raises:
        click.UsageError: a file that does not say its format, or that would be overwritten.
    """
    if len(outputs) > 1 and (output_format or json_output):
        raise click.UsageError("With several files each says its own format, by its ending.")
    sinks = [
        (output, chosen_format(FORMATS, output, output_format, json_output=json_output))
        for output in outputs or ("-",)
    ]
    for output, form in sinks:
        if output == "-" and form in BINARY and sys.stdout.isatty():
            raise click.UsageError(f"{form} is no text: write it to a file, with -o FILE")
        if any(Path(output).resolve() == Path(one).resolve() for one in inputs if one != "-"):
            raise click.UsageError(f"`{output}` is read, and would be overwritten.")
    if sum(output == "-" for output, _ in sinks) > 1:
        raise click.UsageError("standard output takes one format.")
    return sinks


class VerdictOutputs:
    """Takes what there is to say, and writes what each output wants of it.

    Where no output is standard output, that shows the text, but for what a file has of it.
    """

    def __init__(self) -> None:
        self._text: list[Callable[[str], None]] = []
        self._lines: list[Callable[[str], None]] = []
        self._writers: list[tuple[FindingWriter, str]] = []
        self._findings = 0

    @property
    def wants_text(self) -> bool:
        """True if somebody reads the text."""
        return bool(self._text)

    @property
    def wants_lines(self) -> bool:
        """True if somebody reads JSON."""
        return bool(self._lines)

    @property
    def wants_findings(self) -> bool:
        """True if somebody reads findings."""
        return bool(self._writers)

    def text(self, text: str) -> None:
        """Take a part of the text."""
        for write in self._text:
            write(text)

    def line(self, line: str) -> None:
        """Take a line of JSON."""
        for write in self._lines:
            write(line)

    def found(self, found: FoundInRecording) -> None:
        """Take the findings of a recording, or of a file of traces. Raises RulecError."""
        self._findings += len(found.findings)
        for writer, _ in self._writers:
            writer.add(found)


@contextmanager
def verdict_outputs(sinks: Sequence[Sink], rules: CompiledRulebook) -> Iterator[VerdictOutputs]:
    """Outputs that are written whole when the block succeeds, and not at all else.

    Raises RulecError R0702 if a file cannot be written, R0706.
    """
    # The types of rulebooks, and msgspec: not for --help.
    from rulec.report.verdict_findings.verdict_finding import FindingsOf

    outputs = VerdictOutputs()
    written: list[tuple[str, str]] = []
    with ExitStack() as files:
        for path, form in sinks:
            if path == "-" and form in ("text", "json"):
                (outputs._text if form == "text" else outputs._lines).append(print_result)
                continue
            stream: IO[bytes] = sys.stdout.buffer
            name = "standard output"
            if path != "-":
                stream, name = files.enter_context(written_whole(Path(path))), path
                written.append((path, form))
            if form in ("text", "json"):
                lines = outputs._text if form == "text" else outputs._lines
                lines.append(_line_writer(stream))
            else:
                writer = finding_writer(form, stream, FindingsOf(rules), name)
                outputs._writers.append((writer, name))
        if all(path != "-" for path, _ in sinks) and not outputs._text:
            outputs._text.append(print_result)
        yield outputs
        for writer, _ in outputs._writers:
            writer.close()
    if len(written) == len(sinks):
        for path, form in written:
            is_whole = form in ("text", "json")
            what = "the answer" if is_whole else counted(outputs._findings, "finding")
            print_result(f"wrote {what} to {path}")


def _line_writer(stream: IO[bytes]) -> Callable[[str], None]:
    def write(text: str) -> None:
        stream.write(f"{click.unstyle(text)}\n".encode("utf-8", "backslashreplace"))

    return write
