"""Scenarios by name or from a file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.diagnostics import Source, SourceLocation, did_you_mean, named
from rulec.diagnostics.fault_messages import contained
from rulec.files.read_files import decoded, opened, what_reads
from rulec.recordings.recording_files import is_recording, read_recording
from rulec.recordings.recording_format import RECORDING, RecordingSource
from rulec.recordings.recording_messages import OTHER_CHOICE
from rulec.resources import scenarios_folder
from rulec.scenario.scenario_messages import NOT_A_SCENARIO, UNKNOWN_SCENARIO
from rulec.scenario.scenario_model import Choice, Scenario
from rulec.scenario.toml.conversion import to_scenario
from rulec.scenario.toml.toml_tables import TomlFile
from rulec.toml import parsed_toml

if TYPE_CHECKING:
    from rulec.recordings.recording import Recording


def read_scene(path: Path, choice: Choice) -> Scenario:
    """The scenario of a recording, seen from the chosen ego.

    Raises RulecError: as for ``read_recording``, R0612 if what is chosen is not in the file.
    """
    own = (choice.map_path, choice.input_format, choice.scenario_id, choice.frame_rate)
    return scene_of(read_recording(RecordingSource(path, *own)), choice, path)


def scene_of(recording: Recording, choice: Choice, file: Path) -> Scenario:
    """The scenario of a recording, seen from the chosen ego; ``file`` is named in messages.

    Raises RulecError: R0612 if what is chosen is not in it.
    """
    # Imported late: TOML scenarios do not need NumPy and Shapely, which recordings do
    from rulec.scenario.recorded.recorded_scene import seen_from_ego

    try:
        return seen_from_ego(recording, choice, str(file))
    except ValueError as reason:
        raise RECORDING.refused(file, f"its road is invalid: {reason}") from None


LARGEST_BYTES = 4_000_000

_OF_TRACES = (".jsonl", ".ndjson", ".csv")

_HOW = "numbers are written `1.5`, texts in quotes, tables `[road]`, lists of tables `[[obstacle]]`"


def available_scenarios() -> tuple[str, ...]:
    """The names of the built-in scenarios, in alphabetical order."""
    return tuple(sorted(path.stem for path in scenarios_folder().glob("*.toml")))


def load_scenario(name_or_path: str | os.PathLike[str], choice: Choice | None = None) -> Scenario:
    """Load a scenario by its built-in name, or from a file: TOML, or recorded traffic.

    Built-in names have precedence; ``./s1`` is always a file. ``choice`` selects ego and its road
    in a recorded scene. See ``docs/scenarios.md``. Raises RulecError R0601 for an unknown name,
    R0701 for a file that cannot be read, R0101 and R0602 to R0606 for mistakes in the file, all
    reported together; R0610 to R0615 for recorded traffic, R0613 also for a ``choice`` where the
    file offers none.
    """
    name = os.fspath(name_or_path)
    known = available_scenarios()
    if isinstance(name_or_path, str) and name.casefold() in known:
        return read_scenario(scenarios_folder() / f"{name.casefold()}.toml", choice)
    looks_like_a_path = not isinstance(name_or_path, str) or os.sep in name or "." in name
    if looks_like_a_path or _exists(name):
        return read_scenario(Path(name), choice)
    raise UNKNOWN_SCENARIO.error(
        None,
        f"there is no scenario `{name}`",
        expected=f"expected a built-in scenario ({named(known)}) or the path of a file",
        help=did_you_mean(name, known) or "give one of these names, or a file's path",
    )


def read_scenario(path: Path, choice: Choice | None = None) -> Scenario:
    """The scenario in a file. Raises RulecError like ``load_scenario``."""
    with contained("not read", SourceLocation(str(path))):
        return _read_scenario(path, choice)


def _read_scenario(path: Path, choice: Choice | None) -> Scenario:
    if is_recording(str(path)):
        return read_scene(path, choice or Choice())
    if choice not in (None, Choice()):
        raise OTHER_CHOICE.error(
            SourceLocation(str(path)),
            f"`{path.stem}` itself defines ego and the road, so they cannot be chosen",
            help="leave out the options for recorded scenes, or edit the scenario's file",
        )
    source = _text(path)
    reads = what_reads(str(path))
    if (reads and "scenario" not in reads) or path.suffix in _OF_TRACES:
        raise NOT_A_SCENARIO.error(
            SourceLocation(str(path)),
            "this is not a scenario",
            help=reads or "maneuvers need a scenario, such as `s2`, or recorded traffic",
        )
    return to_scenario(parsed_toml(source, NOT_A_SCENARIO, _HOW), path.stem, TomlFile(source))


def _exists(name: str) -> bool:
    try:
        return bool(name) and Path(name).exists()
    except (OSError, ValueError):
        return False


def _text(path: Path) -> Source:
    way_out = f"check the path; built-in scenarios are {named(available_scenarios())}"
    with opened(path, way_out) as stream:
        content = stream.read(LARGEST_BYTES + 1)
    if len(content) > LARGEST_BYTES:
        raise NOT_A_SCENARIO.error(
            SourceLocation(str(path)),
            f"the file is too large: at most {LARGEST_BYTES:,} bytes are read",
            help="keep the obstacles near ego, and the part of their motion that matters",
        )
    return decoded(str(path), content)
