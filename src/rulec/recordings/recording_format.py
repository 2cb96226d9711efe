"""Formats of recordings as data, and the source of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rulec.diagnostics.argument_kinds import expected_fields
from rulec.files.read_files import opened
from rulec.files.work_trees import is_ordinary
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.safe_xml import is_xml, root_of

if TYPE_CHECKING:
    from rulec.recordings.recording import Recording

_HEAD_BYTES = 4096

RECORDING = FileFormat(
    "recorded traffic", "`rulec list formats` lists the formats that are read, and how files look"
)


@dataclass(frozen=True, slots=True)
class RecordingSource:
    """A file of recorded traffic, and how to read it.

    ``map_path`` is the map for formats without roads, ``form`` the name of the format, None to
    detect it, ``scenario_id`` the one to read of several in the file, None for all. ``frame_rate``
    (Hz) is the stated one, which replaces a table's, and confirms that of others; None if none is.
    """

    path: Path
    map_path: Path | None = None
    form: str | None = None
    scenario_id: str | None = None
    frame_rate: float | None = None

    def __post_init__(self) -> None:
        expected_fields(self)


@dataclass(frozen=True)
class Glance:
    """What can be seen of a file at a glance."""

    path: Path

    @cached_property
    def name(self) -> str:
        """Its name in lower case, without the extension of compressed files."""
        return self.path.name.lower().removesuffix(".gz")

    @cached_property
    def head(self) -> bytes:
        """Its first bytes, decompressed if necessary; empty if it is not a file."""
        if not is_ordinary(self.path):
            return b""
        with opened(self.path) as stream:
            return stream.read(_HEAD_BYTES)

    @cached_property
    def root(self) -> str:
        """The name of its root element if it is XML, else empty.

        Raises RulecError R0610 for XML that is invalid there, R0701.
        """
        return root_of(self.path, RECORDING) if is_xml(self.path) else ""


def when_called(place: str) -> Callable[..., Any]:
    """A function of a format's own module, such as ``osi.osi_recording.read_osi``.

    It is imported when it is called: NumPy and Shapely take a while, few commands read recordings.
    """
    module, _, name = place.rpartition(".")

    def called(*given: Any) -> Any:
        return getattr(import_module(f"rulec.recordings.{module}"), name)(*given)

    return called


Roads = Literal["its own", "its own, or --map", "beside it, or --map", "with --map"]
"""Where a format's roads are: in the file, in another file, or in one that is named."""


def _reads_alone(_: Glance) -> bool:
    return False


@dataclass(frozen=True, slots=True)
class RecordingFormat:
    """A format of recorded traffic.

    ``name`` is what ``--input-format`` calls it, ``title`` its usual name; ``files`` describes the
    names of its files, and ``roads`` where the roads are. ``read`` raises RulecError. ``names``
    lists a file's recordings, if that is much faster than reading them. ``is_companion`` is true
    for a file that it recognises but reads along with another one.
    """

    name: str
    title: str
    files: str
    recognises: Callable[[Glance], bool]
    read: Callable[[RecordingSource], Iterator[Recording]]
    roads: Roads = "its own"
    names: Callable[[Path], Iterator[str]] | None = None
    is_companion: Callable[[Glance], bool] = _reads_alone

    @property
    def takes_map(self) -> bool:
        """Whether the roads may come from another file."""
        return self.roads != "its own"
