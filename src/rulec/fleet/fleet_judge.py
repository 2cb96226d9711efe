"""A callable that judges tables of drives, and can be sent to the workers of any engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias

from rulec.automata.bundle.bundle_file import from_json, read_signed
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.extraction.selection import RequestedDrives
from rulec.fleet.drive_rows import DriveRows, judged_by
from rulec.fleet.finding_columns import arrow_table
from rulec.fleet.fleet_messages import not_compiled, unnamed_drives
from rulec.fleet.table_recordings import (
    SeenKeys,
    TraceTableJudge,
    TrackTableJudge,
    keys_of,
    kind_of,
)
from rulec.monitoring.assumptions import Assumptions
from rulec.recordings.road_map import RoadMap
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.arrow.parquet import arrow
from rulec.trace.trace_model import Ending


class FleetJudge:
    """Judges all drives of an Arrow table and returns the table of findings.

    ``rules`` is a compiled rulebook: the path of its file, its content, or what
    ``rulec.compile_rulebook`` returns. ``road_map`` is the map for tracks, ``request`` sets the
    thresholds and assumptions for drives, ``ends`` says how traces end. A drive that lacks rows is
    refused (R0709), or reported in the table if tables are ``grouped`` by drive.
    """

    __name__ = "FleetJudge"
    """Ray needs it: it names what it maps by a function's name."""

    def __init__(
        self,
        rules: CompiledRules,
        road_map: RoadMap | str | Path | None = None,
        *,
        request: RequestedDrives | None = None,
        ends: Ending | None = None,
        grouped: bool = False,
    ) -> None:
        # Workers get the content of the file, because they may not have the file.
        self._rules = carried(rules)
        self._roads = str(road_map) if isinstance(road_map, Path) else road_map
        self._request = request or RequestedDrives()
        self._ends = ends
        self._grouped = grouped
        self._seen = SeenKeys()

    def __call__(self, table: Any) -> Any:
        """The findings (``rulec.fleet.arrow_schema``) in a table of tracks or traces.

        There are no side effects: the same table gives the same findings, wherever and however
        often it is judged. Raises RulecError R0706 without pyarrow, R0709 for a drive that is cut,
        R0710 for a table of something else, or one whose drives have names that are not UTF-8.
        """
        table = _as_table(table)
        if not table.num_rows:
            return arrow_table([])
        rules = self._rules.read()
        to_rows = DriveRows(rules, judged_by(rules, self._request, self._ends or ""))
        seen = None if self._grouped else self._seen
        kind = kind_of(table.column_names)
        _check_names(table, keys_of(table.column_names, kind))
        if kind == "tracks":
            tracks = TrackTableJudge(to_rows, self._request, self._roads, seen)
            return arrow_table(tracks.rows(table))
        assumed = Assumptions(self._ends, self._request.assumed, self._request.defaults)
        return arrow_table(TraceTableJudge(to_rows, assumed, seen).rows(table))

    def __repr__(self) -> str:
        return f"FleetJudge({self._rules.name!r})"


def _check_names(table: Any, keys: Sequence[str]) -> None:
    if why := arrow_tables.not_utf8(table, keys):
        raise unnamed_drives(why)


def _as_table(table: Any) -> Any:
    """A table or record batch as a table without view types. Raises TypeError."""
    pyarrow, _ = arrow("the table of drives")
    if isinstance(table, pyarrow.RecordBatch):
        table = pyarrow.Table.from_batches([table])
    if not isinstance(table, pyarrow.Table):
        raise TypeError(
            f"a pyarrow.Table is judged, not a {type(table).__name__}; with Ray's map_batches and "
            "map_groups give batch_format='pyarrow'"
        )
    return arrow_tables.with_plain_texts(table)


CompiledRules: TypeAlias = str | Path | bytes | CompiledRulebook
"""The path of a compiled file, its content, or a rulebook already compiled or read."""

_MOST_KEPT = 4


@dataclass(frozen=True, slots=True)
class CarriedRulebook:
    """A rulebook to send to other processes; ``name`` is its file's name in messages."""

    content: bytes | CompiledRulebook
    name: str

    def read(self) -> CompiledRulebook:
        """The rulebook; a file is parsed once per process. Raises RulecError R0404."""
        if isinstance(self.content, CompiledRulebook):
            return self.content
        return _read(self.content, self.name)


@lru_cache(maxsize=_MOST_KEPT)
def _read(content: bytes, name: str) -> CompiledRulebook:
    return from_json(content, name)


def carried(rules: CompiledRules) -> CarriedRulebook:
    """A rulebook to send to other processes. Raises RulecError R0404, R0701, R0711 for a source."""
    if isinstance(rules, CompiledRulebook):
        return CarriedRulebook(rules, rules.name)
    if isinstance(rules, bytes):
        result = CarriedRulebook(rules, "compiled rulebook")
    else:
        if Path(rules).suffix != ".json":
            raise not_compiled(str(rules))
        result = CarriedRulebook(read_signed(Path(rules)), str(rules))
    result.read()
    return result
