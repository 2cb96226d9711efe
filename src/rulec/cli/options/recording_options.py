"""Options for recorded traffic, for traces, and for the drives that are made of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.output_options import RenamedOption, input_format_option
from rulec.cli.options.shared_options import finite
from rulec.cli.options.verb_class import gathered, option
from rulec.recordings.format_table import FORMATS
from rulec.recordings.recording_format import RecordingSource
from rulec.trace import Value
from rulec.trace.trace_model import Ending
from rulec.vocabulary import Vocabulary

TRACE_FORMATS: tuple[lazy.Format, ...] = ("jsonl", "csv", "parquet")
"""The formats of traces, listed here to avoid an import for --help."""

_RECORDING_FORMATS = tuple(form.name for form in FORMATS)


@dataclass(frozen=True, kw_only=True)
class RecordingOptions:
    """How to read recorded traffic, or traces."""

    map_path: Path | None = option(
        "--map",
        cls=RenamedOption,
        former=["--net"],
        metavar="FILE",
        type=click.Path(dir_okay=False, path_type=Path),
        help="The map, for recorded traffic that contains no roads.  [default: for SUMO data, "
        "the net that the file names, or the only .net.xml file beside it]",
    )
    scenario_id: str | None = option(
        "--scenario",
        metavar="ID",
        help="Read only this recording of a file that contains several.",
    )
    frame_rate: float | None = option(
        "--frame-rate",
        metavar="HZ",
        type=click.FloatRange(min=0, min_open=True),
        callback=finite,
        help="Frames a second of recorded traffic: of a table with the column `frame`, or to "
        "confirm time steps that speeds contradict.",
    )
    input_format: str | None = input_format_option(
        _RECORDING_FORMATS,
        "recorded traffic, one of `rulec list formats`.  [default: detected from the file]",
    )

    @property
    def trace_format(self) -> lazy.Format | None:
        """The format of traces that is given, if any."""
        return next((form for form in TRACE_FORMATS if form == self.input_format), None)

    def source(self, file: str | Path) -> RecordingSource:
        """The source of a file."""
        form, scenario = self.input_format, self.scenario_id
        return RecordingSource(Path(file), self.map_path, form, scenario, self.frame_rate)


@dataclass(frozen=True, kw_only=True)
class RecordingOrTraceOptions(RecordingOptions):
    """The same for files that may also be traces."""

    input_format: str | None = input_format_option(
        (*_RECORDING_FORMATS, *TRACE_FORMATS),
        "traces (jsonl, csv or parquet) or of recorded traffic (one of `rulec list formats`).  "
        "[default: detected from the file; for traces its ending, else jsonl]",
        former=["--format"],
    )


@dataclass(frozen=True, kw_only=True)
class DrivesOptions:
    """How the drives of a recording become traces, and what is assumed about traces."""

    assumed: tuple[str, ...] = option(
        "--assume",
        multiple=True,
        metavar="NAME=VALUE",
        help="A value to assume, such as built_up=true: in traces wherever they do not provide "
        "one, in recorded traffic always. Or `defaults`: missing values get their default, and "
        "every trace is complete.",
    )
    thresholds: tuple[str, ...] = option(
        "--threshold",
        multiple=True,
        metavar="NAME=NUMBER",
        help="Recorded traffic: set a threshold used to derive words, such as near_m=200.",
    )
    as_recorded: bool = option(
        "--as-recorded",
        is_flag=True,
        help="Recorded traffic: do not mirror it, even if the rulebook's traffic keeps to the "
        "other side of the road.",
    )

    def read_thresholds(self) -> lazy.Thresholds:
        """The thresholds. Raises click.UsageError."""
        with _refused():
            return lazy.threshold_options(self.thresholds)

    def requested(
        self, egos: tuple[str, ...], vocabulary: Vocabulary | None
    ) -> lazy.RequestedDrives:
        """The drives of these vehicles.

        Raises:
            click.UsageError: an assumption or a threshold is invalid.
        """
        if self.assumed and vocabulary is None:
            raise click.UsageError("--assume needs a rulebook that has these words: --rulebook R")
        thresholds = self.read_thresholds()
        values, defaults = ({}, False) if vocabulary is None else _assumed(self.assumed, vocabulary)
        return lazy.RequestedDrives(egos, thresholds, values, self.as_recorded, defaults)


egos_option = option(
    "--ego",
    multiple=True,
    metavar="ID",
    help="Recorded traffic: use only this vehicle's drive.  [default: every vehicle's]",
)

recording_options = gathered(RecordingOptions)
recording_or_trace_options = gathered(RecordingOrTraceOptions)
drives_options = gathered(DrivesOptions)


@dataclass(frozen=True, kw_only=True)
class TrafficOptions:
    """Which vehicles' drives, and how recorded traffic or traces are read."""

    egos: tuple[str, ...] = egos_option
    drives: DrivesOptions = drives_options
    recorded: RecordingOptions = recording_or_trace_options

    def requested(self, vocabulary: Vocabulary) -> lazy.RequestedDrives:
        """The drives, whose words are of a vocabulary. Raises click.UsageError."""
        return self.drives.requested(self.egos, vocabulary)


traffic_options = gathered(TrafficOptions)

_NAMES = {
    "assumed": "--assume",
    "thresholds": "--threshold",
    "map_path": "--map",
    "scenario_id": "--scenario",
}
"""The options that are not called as their values are."""


def as_typed(*given: RecordingOptions | DrivesOptions) -> Iterator[str]:
    """The options that are given, each with its value, as on a command line."""
    values = ((one.name, getattr(own, one.name)) for own in given for one in fields(own))
    for name, value in values:
        for one in value if isinstance(value, tuple) else [value] if value else []:
            yield _NAMES.get(name) or f"--{name.replace('_', '-')}"
            if one is not True:
                yield str(one)


def assumptions(
    ends: Ending | None, texts: Sequence[str], vocabulary: Vocabulary
) -> lazy.Assumptions:
    """Assumptions about traces. Raises click.UsageError."""
    return lazy.Assumptions(ends, *_assumed(texts, vocabulary))


def _assumed(texts: Sequence[str], vocabulary: Vocabulary) -> tuple[Mapping[str, Value], bool]:
    """The values to assume, and whether missing ones get their default."""
    named = [text for text in texts if text != "defaults"]
    with _refused():
        values = lazy.assumption_options(named, vocabulary) if named else {}
    return values, len(named) < len(texts)


@contextmanager
def _refused() -> Iterator[None]:
    """Refuse a text of an option in which something is wrong. Raises click.UsageError."""
    try:
        yield
    except ValueError as problem:
        # A question mark ends a sentence, too
        text = str(problem)
        raise click.UsageError(text if text.endswith("?") else f"{text}.") from None
