"""The column names at the beginning of a file, and the format that they belong to.

This does not need NumPy, since traces may be CSV, too, and start without it.
"""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.csv_head import PARQUET, is_number, is_parquet, names_in
from rulec.recordings.recording_format import RECORDING, Glance
from rulec.trace.formats import arrow as arrow_tables

TABLES = (".csv", ".tsv", ".txt", *PARQUET)
SAME_NAME = 0.85
"""So similar is the name of a column to one that is known that it is meant."""

_HEADLESS_NGSIM = (18, 24)
_TRACK = {"track", "track_id", "trackid", "id", "object_id", "vehicle_id"}
_TIME = {f"{name}{unit}" for name in ("t", "time") for unit in ("", "_s", "_ms", "_us", "_ns")}
_TIME |= {"timestamp_ms", "timestamp_us", "timestamp_ns"}
_LANE = {"lane", "lane_id", "lanelet", "lanelet_id"}


def head_of(glance: Glance) -> tuple[str, ...]:
    """The column names of a table in lower case; none if it seems not to be a table."""
    if not glance.name.endswith(TABLES):
        return ()
    if not is_parquet(glance.name, glance.head):
        return names_in(glance.head)
    try:
        names = arrow_tables.parquet_names(
            glance.path, lambda why, **_: RECORDING.refused(glance.path, why)
        )
    except RulecError:
        # Whoever reads it next says what is wrong
        return ()
    return tuple(name.casefold() for name in names)


def is_track_head(names: Sequence[str]) -> bool:
    """Whether column names are those of tracks, possibly with one misspelt.

    The reader explains that units after names, as in ``x [m]``, must be left out.
    """
    given = {name.partition("[")[0].partition("(")[0].strip() for name in names}
    if "trace" in given:
        return False
    x, y = ({name, f"{name}_m", f"front_{name}"} & given for name in "xy")
    known = sum(map(bool, (x, y, _TRACK & given, _TIME & given)))
    return known >= 3 or bool(x and y and {"speed", "heading"} & given)


def is_fcd_head(names: Sequence[str]) -> bool:
    """Whether column names are those of SUMO's floating-car data."""
    return "timestep_time" in names and bool({"vehicle_id", "person_id"} & {*names})


def is_lane_head(names: Sequence[str]) -> bool:
    """Whether column names are those of lanes, not of findings that have similar columns."""
    given = {*names}
    x, y = ({name, f"{name}_m"} & given for name in "xy")
    return bool(_LANE & given and x and y) and not (_TIME | {"trace", "rule"}) & given


HIGHD = (
    {"frame", "id", "x", "y", "xvelocity", "laneid", "precedingid"},
    {"id", "initialframe", "drivingdirection"},
    {"upperlanemarkings", "framerate"},
)
LEVELX = (
    {"trackid", "frame", "xcenter", "ycenter"},
    {"trackid", "initialframe", "class"},
    {"orthopxtometer", "framerate"},
)
INTERACTION = ({"track_id", "frame_id", "timestamp_ms", "agent_type", "x", "y", "vx", "vy"},)
OMEGA_PRIME = ({"total_nanos", "idx", "x", "y", "yaw"},)
"""Columns of the files of a data set, by which each is recognised; inD, rounD, exiD and uniD have
those of ``LEVELX``."""


def has_columns(names: Sequence[str], files: Sequence[set[str]]) -> bool:
    """Whether column names are those of one of a data set's files."""
    return any(columns <= {*names} for columns in files)


def is_ngsim_head(names: Sequence[str]) -> bool:
    """True if a first line is NGSIM's: names of columns, or as many numbers as there are."""
    if {"vehicle_id", "global_time", "local_x", "local_y"} <= {*names}:
        return True
    return len(names) in _HEADLESS_NGSIM and all(map(is_number, names))
