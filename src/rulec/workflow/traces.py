"""From a file to traces, and from recorded traffic to what its vehicles are judged by."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rulec.diagnostics import Place, RulecError
from rulec.files import opened
from rulec.trace import Trace
from rulec.workflow.rulebooks import machines

if TYPE_CHECKING:
    from rulec.automata.any_step import AnyStep
    from rulec.automata.compiled import CompiledRulebook
    from rulec.drives.judging import JudgedRecording
    from rulec.drives.wanted import Wanted
    from rulec.rulebook.model import Rulebook
    from rulec.runtime.before import Before
    from rulec.scenario.recorded.recording import Recording


def read_traces(path: str | Path) -> Iterator[Trace | RulecError]:
    """The traces of a file one by one; in place of a bad one, what is wrong with it.

    The end of its name says its format: `.csv`, `.parquet`, anything else is JSON Lines.
    """
    from rulec.trace.formats import format_of, read_chunks

    with opened(Path(path)) as stream:
        for chunk in read_chunks(stream, str(path), format_of(str(path))):
            yield from chunk


def judge_recording(
    recording: str | Path | Recording,
    rulebook: str | Path | Rulebook | CompiledRulebook | AnyStep,
    wanted: Wanted | None = None,
    net: str | Path | None = None,
) -> JudgedRecording:
    """What the vehicles of recorded traffic did, given by path or itself, judged by a rulebook.

    ``net`` is for SUMO's data. Raises RulecError.
    """
    from rulec.drives.judging import JudgedRecording
    from rulec.drives.wanted import Wanted
    from rulec.scenario.recordings import read_recording

    if isinstance(recording, str | Path):
        file = str(recording)
        recording = read_recording(Path(file), None if net is None else Path(net))
    else:
        file = recording.name
    return JudgedRecording(recording, machines(rulebook), wanted or Wanted(), file)


def read_past(path: Path) -> Before:
    """The one trace of a file, or a saved monitor's snapshot (.json). Raises RulecError."""
    from rulec.runtime.before import only_trace
    from rulec.runtime.online.file import read_saved

    if path.suffix == ".json":
        saved: Mapping[str, Any] = read_saved(path)
        return saved
    return only_trace(read_traces(path), Place(str(path)))
