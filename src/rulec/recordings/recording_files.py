"""Recorded traffic from files of any format."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.diagnostics import RulecError, SourceLocation, did_you_mean, first_of, named
from rulec.diagnostics.fault_messages import contained
from rulec.files.read_files import is_folder, opened, what_reads
from rulec.recordings.encodings.csv_head import PARQUET
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.safe_xml import is_xml
from rulec.recordings.format_table import FORMATS
from rulec.recordings.map_files import MAP_FORMATS
from rulec.recordings.recording_format import (
    RECORDING,
    Glance,
    RecordingFormat,
    RecordingSource,
)
from rulec.recordings.recording_messages import NOT_IN_RECORDING, OTHER_CHOICE
from rulec.trace.formats import arrow as arrow_tables

if TYPE_CHECKING:
    from rulec.recordings.recording import Recording

_MOST_NAMED = 5


def is_recording(file: str) -> bool:
    """Whether a file's name or first bytes show recorded traffic.

    XML of unknown format counts as a recording, since nothing else that rulec reads is XML. So do a
    map, for which ``read_recordings`` has a better error than a reader of traces, and a file that
    cannot be opened, so that the reader reports why and continues with the others.
    """
    glance = Glance(Path(file))
    try:
        with contained():
            known = any(form.recognises(glance) for form in (*FORMATS, *MAP_FORMATS))
    except RulecError:
        return not glance.path.is_dir()
    return known or is_xml(glance.path)


_BESIDE_SUMO = ("routes", "additional", "configuration")
"""The kinds of XML that SUMO reads beside a net."""


def is_beside_recordings(file: str) -> bool:
    """Whether a file is a map, or is read along with a recording without being named in it.

    False for a file that cannot be opened.
    """
    glance = Glance(Path(file))
    with suppress(RulecError), contained():
        is_read_along = any(
            form.recognises(glance) and form.is_companion(glance) for form in FORMATS
        )
        is_map = any(form.recognises(glance) for form in MAP_FORMATS)
        return is_read_along or is_map or glance.root in _BESIDE_SUMO
    return False


def read_recordings(source: RecordingSource) -> Iterator[Recording]:
    """The recordings in a file, one after the other; most formats have one per file.

    Raises RulecError R0610 for a file that is not valid in its apparent format, R0612 for a
    scenario that is not in it, R0613 for a map where none is needed, R0614 and R0615 for a missing
    or wrong map, R0701 if a file cannot be opened, R0790 for a fault of rulec.
    """
    names = [form.name for form in FORMATS]
    if source.form is not None and source.form not in names:
        raise ValueError(f"`form` is one of {', '.join(names)}, not {source.form!r}")
    # NumPy, only for those who have recordings.
    from rulec.recordings.doubts.examination import examination_of

    place = SourceLocation(str(source.path))
    with contained("not read", place):
        form = _format_of(source)
        examined = examination_of(source, takes_map=form.takes_map)
        if source.map_path is not None and not form.takes_map:
            raise OTHER_CHOICE.error(
                place,
                f"`{source.path.name}` has its own roads, and takes no map",
                help="leave out --map, which is for recordings without roads of their own",
            )
        if source.scenario_id is None:
            yield from map(examined, form.read(source))
            return
        names = list(form.names(source.path)) if form.names is not None else []
        if form.names is None or source.scenario_id in names:
            for recording in form.read(source):
                if recording.name == source.scenario_id:
                    yield examined(recording)
                    return
                names.append(recording.name)
        raise NOT_IN_RECORDING.error(
            place,
            f"there is no scenario `{source.scenario_id}` in the file",
            help=did_you_mean(source.scenario_id, names) or f"choose {_some(names)}",
        )


def read_recording(source: RecordingSource) -> Recording:
    """The only recording in a file, or the one that is named.

    Raises RulecError: as for ``read_recordings``, R0612 also if there are several.
    """
    recordings = read_recordings(source)
    recording = next(recordings)
    other = next(recordings, None)
    if other is not None:
        raise NOT_IN_RECORDING.error(
            SourceLocation(str(source.path)),
            f"there are several recordings in the file, {named([recording.name, other.name])} "
            "to begin with",
            help=f"choose one, as with `--scenario {recording.name}`",
        )
    return recording


_OTHERS_OF_SUMO = frozenset({"netstate", "emission-export", "tripinfos", "summary", "tlsStates"})
_FCD_INSTEAD = "SUMO writes who was where when with the option --fcd-output"


def _format_of(source: RecordingSource) -> RecordingFormat:
    if not os.path.lexists(source.path):
        # Such as of too long a name, of which many questions end in an OSError
        with opened(source.path):
            pass
    glance = Glance(source.path)
    for form in FORMATS:
        if source.form == form.name or (source.form is None and form.recognises(glance)):
            return form
    for kind in MAP_FORMATS:
        if kind.recognises(glance):
            way_out = "give the recording, and this file with --map"
            why = f"it is a map ({kind.title}), with nobody on its roads"
            raise RECORDING.refused(source.path, why, help_text=way_out)
    if glance.root:
        why = f"it is XML of `{short(glance.root)}`"
        way_out = _FCD_INSTEAD if glance.root in _OTHERS_OF_SUMO else ""
        expected = "expected `commonRoad` or `fcd-export`"
        raise RECORDING.refused(source.path, why, expected=expected, help_text=way_out)
    check_readable(source.path)
    raise RECORDING.refused(
        source.path, "it is of no known format", help_text=what_reads(str(source.path))
    )


def check_readable(path: Path) -> None:
    """Refuse a missing file, or one that is not Parquet despite its extension.

    Raises RulecError R0610, R0701, R0706.
    """
    if is_folder(path):
        return
    with opened(path):
        pass
    if path.name.lower().endswith(PARQUET):
        arrow_tables.parquet_names(path, lambda why, **more: RECORDING.refused(path, why, **more))


def _some(names: list[str]) -> str:
    return first_of([f"`{name}`" for name in names], _MOST_NAMED, "or one of")
