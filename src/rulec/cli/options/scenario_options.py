"""Options for a scenario's partition, for recorded scenes and for recorded drives."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rulec.cli.options.output_options import RenamedOption, input_format_option
from rulec.cli.options.shared_options import choice_option, combined, finite
from rulec.cli.options.shell_completion import complete_scenarios
from rulec.cli.options.standard_input import file_named
from rulec.monitoring.assumptions import Assumptions
from rulec.recordings.format_table import FORMATS
from rulec.recordings.recording_format import RecordingSource
from rulec.trace import Value
from rulec.trace.trace_model import Ending
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.extraction.selection import RequestedDrives
    from rulec.scenario import Scenario
    from rulec.trace.formats.trace_files import Format

TRACE_FORMATS: tuple[Format, ...] = ("jsonl", "csv", "parquet")
"""The formats of traces, listed here to avoid an import for --help."""

_WEIGHT = re.compile(r"[01]|0?\.[0-9]{1,9}")


def _prediction(
    context: click.Context, parameter: click.Parameter, value: str
) -> str | dict[str, Fraction]:
    # Late import, not for --help: scenarios' formats (30 ms).
    from rulec.scenario.scenario_model import PREDICTIONS, is_distribution

    known = " or ".join(f"`{kind}`" for kind in PREDICTIONS)
    if value in PREDICTIONS:
        return value
    fractions: dict[str, Fraction] = {}
    for part in value.split(","):
        kind, _, weight = (piece.strip() for piece in part.partition("="))
        if kind not in PREDICTIONS or kind in fractions:
            raise click.BadParameter(f"it has to be {known}, or each of them once with a weight")
        fractions[kind] = Fraction(weight) if _WEIGHT.fullmatch(weight) else Fraction(0)
        if not fractions[kind]:
            raise click.BadParameter(f"`{part}` has to end in a weight above 0, such as `=0.7`")
    if not is_distribution(sum(fractions.values(), Fraction(0))):
        raise click.BadParameter("the weights have to add up to 1")
    return fractions


_roads_options = combined(
    [
        click.option(
            "--map",
            "map_path",
            cls=RenamedOption,
            former=["--net"],
            metavar="FILE",
            type=click.Path(dir_okay=False, path_type=Path),
            help="The map, for recorded traffic that contains no roads.  [default: for SUMO data, "
            "the net that the file names, or the only .net.xml file beside it]",
        ),
        click.option(
            "--scenario",
            "scenario_id",
            metavar="ID",
            help="Read only this recording of a file that contains several.",
        ),
        click.option(
            "--frame-rate",
            "frame_rate",
            metavar="HZ",
            type=click.FloatRange(min=0, min_open=True),
            callback=finite,
            help="Frames a second of recorded traffic: of a table with the column `frame`, or to "
            "confirm time steps that speeds contradict.",
        ),
    ]
)

_RECORDING_FORMATS = tuple(form.name for form in FORMATS)
_SHOWN = "[default: detected from the file]"

recording_options = combined(
    [
        _roads_options,
        input_format_option(
            _RECORDING_FORMATS, f"recorded traffic, one of `rulec list formats`.  {_SHOWN}"
        ),
    ]
)
"""Options for the source of recorded traffic, consumed by ``recording_source``."""

recording_or_trace_options = combined(
    [
        _roads_options,
        input_format_option(
            (*_RECORDING_FORMATS, *TRACE_FORMATS),
            "traces (jsonl, csv or parquet) or of recorded traffic (one of `rulec list formats`).  "
            "[default: detected from the file; for traces its ending, else jsonl]",
            former=["--format"],
        ),
    ]
)
"""The same for files that may also be traces."""


def trace_format(options: Mapping[str, Any]) -> Format | None:
    """The format of traces given by ``--input-format``, if any."""
    name = options["input_format"]
    return name if name in TRACE_FORMATS else None


def recording_source(file: str | Path, options: dict[str, Any]) -> RecordingSource:
    """The source of a file; consumes the values of ``recording_options``."""
    names = ("map_path", "input_format", "scenario_id", "frame_rate")
    return RecordingSource(Path(file), *(options.pop(name) for name in names))


def read_scene(scenario: str, options: dict[str, Any]) -> Scenario:
    """Load the scenario; consumes the options for recorded scenarios.

    Raises RulecError.
    """
    # Late import, not for --help: scenarios' formats (30 ms).
    from rulec.scenario import Choice, load_scenario

    choice = Choice(**{field: options.pop(field) for field in Choice.__dataclass_fields__})
    return load_scenario(file_named(scenario), choice)


cell_options = combined(
    [
        click.option(
            "--step", "step_s", type=float, metavar="S", help="The planning interval, in s."
        ),
        click.option(
            "--horizon", "horizon_s", type=float, metavar="T", help="The planning horizon, in s."
        ),
        click.option(
            "--partition",
            type=click.Choice(["paper", "fine"]),
            help="Divide the space around an obstacle into four regions (paper) or eight (fine).  "
            "[default: what the rulebook needs; paper without a rulebook]",
        ),
        click.option(
            "--extent",
            type=click.Choice(["lane", "clearance", "body"]),
            help="How much space an obstacle occupies across the road: `lane` is every lane it "
            "touches; `clearance` is the same, except where ego fits beside it within a lane; "
            "`body` is the area its body sweeps plus half of ego's width on either side.  "
            "[default: clearance in a recorded scene with bounds, else lane]",
        ),
        choice_option(
            "--adjacency",
            ["touch", "edge", "forward"],
            "Which cells are neighbours: those that touch, even in a single point; those that "
            "share an edge; or those that share an edge and do not lie only behind.",
        ),
        click.option(
            "--bounds",
            metavar="BOUNDS",
            help="Keep only maneuvers that ego can drive within these motion bounds: a vehicle "
            "type, as in `truck`, numbers, as in `braking=6,acceleration=3`, or both; `none` keeps "
            "all paths through cells.  [default: the scenario's own; in recorded scenes those of "
            "ego's vehicle type]",
        ),
        # The options that choose from a recorded scene, named like the fields of `Choice`.
        click.option(
            "--ego",
            metavar="ID",
            help="Recorded scenes: the vehicle or planning problem to take as ego.  [default: the "
            "first planning problem]",
        ),
        click.option(
            "--at-time",
            "at_s",
            type=float,
            callback=finite,
            metavar="S",
            help="Recorded scenes: the time to start from, in s.  [default: that of the planning "
            "problem, or when the vehicle first appears]",
        ),
        click.option(
            "--reference",
            metavar="LANELET",
            help="Recorded scenes: the lanelet whose centre line is the reference line along the "
            "road.  [default: the one ego is on]",
        ),
        click.option(
            "--prediction",
            callback=_prediction,
            default="recorded",
            show_default=True,
            metavar="KIND",
            help="Recorded scenes: other traffic moves as `recorded`, or with `constant` "
            "acceleration, or either with a probability, as in `recorded=0.7,constant=0.3`.",
        ),
        click.option(
            "--ego-width",
            "ego_width_m",
            type=click.FloatRange(min=0, max=100),
            callback=finite,
            metavar="M",
            help="Recorded scenes: ego's width in m, used with `--extent clearance` and `body`.  "
            "[default: the width of the recorded vehicle, if ego is one; else the one in its "
            "bounds with `clearance`, and a point with `body`]",
        ),
        click.option(
            "--congested-below",
            "congested_below_kmh",
            type=click.FloatRange(min=0),
            callback=finite,
            default=30.0,
            show_default=True,
            metavar="KMH",
            help="Recorded scenes: below this median speed traffic counts as congested.",
        ),
        recording_options,
    ]
)
"""Options for cutting scenarios into cells, and those that ``read_scene`` consumes."""

graph_options = combined(
    [click.argument("scenario", shell_complete=complete_scenarios), cell_options]
)
"""The argument for one scenario, and how it is cut into cells."""

scenarios_argument = click.argument(
    "scenarios",
    nargs=-1,
    required=True,
    metavar="SCENARIO...",
    shell_complete=complete_scenarios,
)

reading_options = combined(
    [
        click.option(
            "--assume",
            "assumed",
            multiple=True,
            metavar="NAME=VALUE",
            help="A value to assume wherever the scenario does not provide one, such as "
            "built_up=true; or `defaults`, which gives unknown values their default.",
        ),
        click.option(
            "--told-only",
            is_flag=True,
            help="Treat values that the scenario does not mention as unknown instead of giving "
            "them their default.",
        ),
    ]
)
"""Options for values missing in a scenario, consumed by ``scene_reading``."""

egos_option = click.option(
    "--ego",
    "egos",
    multiple=True,
    metavar="ID",
    help="Recorded traffic: use only this vehicle's drive.  [default: every vehicle's]",
)

drives_options = combined(
    [
        click.option(
            "--assume",
            "assumed",
            multiple=True,
            metavar="NAME=VALUE",
            help="A value to assume, such as built_up=true: in traces wherever they do not provide "
            "one, in recorded traffic always. Or `defaults`: missing values get their default, and "
            "every trace is complete.",
        ),
        click.option(
            "--threshold",
            "thresholds",
            multiple=True,
            metavar="NAME=NUMBER",
            help="Recorded traffic: set a threshold used to derive words, such as near_m=200.",
        ),
        click.option(
            "--as-recorded",
            is_flag=True,
            help="Recorded traffic: do not mirror it, even if the rulebook's traffic keeps to the "
            "other side of the road.",
        ),
    ]
)
"""Options for turning a recording's drives into traces, consumed by ``requested_drives``."""


_NAMES = {
    "egos": "--ego",
    "assumed": "--assume",
    "thresholds": "--threshold",
    "map_path": "--map",
    "scenario_id": "--scenario",
}
"""The options that are not called as their values are."""


def given_drives_options(options: Mapping[str, Any]) -> Iterator[str]:
    """The options for drives that are given, each with its value, as on a command line."""
    for name, value in options.items():
        for one in value if isinstance(value, tuple) else [value] if value else []:
            yield _NAMES.get(name) or f"--{name.replace('_', '-')}"
            if one is not True:
                yield str(one)


def check_thresholds(texts: Sequence[str]) -> None:
    """Check thresholds before any work. Raises click.UsageError."""
    if texts:
        # Late import, only for recordings: NumPy and shapely (150 ms).
        from rulec.extraction.traffic_thresholds import threshold_options

        try:
            threshold_options(texts)
        except ValueError as problem:
            raise click.UsageError(_sentence(problem)) from None


def requested_drives(
    egos: tuple[str, ...], options: Mapping[str, Any], vocabulary: Vocabulary | None
) -> RequestedDrives:
    """The drives of these vehicles; consumes the values of ``drives_options``.

    Raises:
        click.UsageError: an assumption or a threshold is invalid.
    """
    # Late import, only for recordings: NumPy and shapely (150 ms).
    from rulec.extraction.selection import RequestedDrives, assumption_options
    from rulec.extraction.traffic_thresholds import threshold_options

    if options["assumed"] and vocabulary is None:
        raise click.UsageError("--assume needs a rulebook that has these words: --rulebook R")
    texts = [text for text in options["assumed"] if text != "defaults"]
    try:
        return RequestedDrives(
            egos,
            threshold_options(options["thresholds"]),
            {} if vocabulary is None else assumption_options(texts, vocabulary),
            options["as_recorded"],
            len(texts) < len(options["assumed"]),
        )
    except ValueError as problem:
        raise click.UsageError(_sentence(problem)) from None


def scene_reading(options: dict[str, Any], vocabulary: Vocabulary | None) -> dict[str, Any]:
    """Keyword arguments of ``find_maneuvers``; consumes the values of ``reading_options``.

    Raises:
        click.UsageError: an assumption is invalid, contradicts another, or lacks a rulebook.
    """
    assumed, told_only = options.pop("assumed"), options.pop("told_only")
    if told_only and "defaults" in assumed:
        raise click.UsageError("--told-only and --assume defaults say the opposite of each other.")
    if not assumed and not told_only:
        return {}
    if vocabulary is None:
        option = "--assume" if assumed else "--told-only"
        raise click.UsageError(f"{option} needs a rulebook that has the words: --rulebook R")
    return {"assumptions": assumptions(None, assumed, vocabulary), "told_only": told_only}


def assumptions(ends: Ending | None, texts: Sequence[str], vocabulary: Vocabulary) -> Assumptions:
    """Assumptions about traces. Raises click.UsageError."""
    values: Mapping[str, Value] = {}
    if named := [text for text in texts if text != "defaults"]:
        # Late import, only if values are assumed: NumPy and shapely (150 ms).
        from rulec.extraction.selection import assumption_options

        try:
            values = assumption_options(named, vocabulary)
        except ValueError as problem:
            raise click.UsageError(_sentence(problem)) from None
    return Assumptions(ends, values, len(named) < len(texts))


def _sentence(problem: ValueError) -> str:
    """The message of an error as a sentence, without a second mark after a question mark."""
    text = str(problem)
    return text if text.endswith("?") else f"{text}."
