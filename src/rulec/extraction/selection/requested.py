"""The drives of a recording that a user requests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rulec.diagnostics import SourceLocation, did_you_mean, named
from rulec.extraction.drives import Drives, NoDrive
from rulec.extraction.to_trace import Drive, TraceWriter
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.extraction.traffic_thresholds import USUAL, Thresholds
from rulec.rulebook.rulebook_model import Traffic
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.scenario_messages import NOT_IN_RECORDING
from rulec.trace import Value
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class RequestedDrives:
    """A choice of egos and thresholds, and what is assumed.

    No ``egos`` are all vehicles. ``assumed`` holds in every state. ``as_recorded``: a recording of
    traffic on the other side than the rulebook's is not mirrored.
    """

    __repr__ = short_repr

    egos: tuple[str, ...] = ()
    thresholds: Thresholds = USUAL
    assumed: Mapping[str, Value] = field(default_factory=dict)
    as_recorded: bool = False


@dataclass(frozen=True, slots=True)
class SelectedDrives:
    """The drives of ``egos`` and the ``recording`` they are from, perhaps mirrored."""

    recording: Recording
    mirrored: bool
    egos: tuple[str, ...]
    drives: Drives

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of one vehicle, computed when they are asked for."""
        return self.drives.of(ego)


def selected_drives(
    recording: Recording,
    wanted: RequestedDrives,
    file: str,
    traffic: Traffic = "",
    vocabulary: Vocabulary | None = None,
    *,
    names: frozenset[str] | None = None,
) -> SelectedDrives:
    """The drives of a recording, in a vocabulary's words.

    The rules are for a given side of traffic.

    Raises:
        RulecError: R0612 for a vehicle that is not there.
    """
    side = traffic or recording.side or "right"
    mirrored = recording.side not in (None, side) and not wanted.as_recorded
    if mirrored:
        recording = mirrored_recording(recording)
    writer = TraceWriter(vocabulary, names, wanted.assumed)
    drives = Drives(recording, side, wanted.thresholds, writer)
    return SelectedDrives(recording, mirrored, _chosen(drives.egos(), wanted.egos, file), drives)


def _chosen(known: tuple[str, ...], wanted: tuple[str, ...], file: str) -> tuple[str, ...]:
    for ego in wanted:
        if ego not in known:
            raise NOT_IN_RECORDING.error(
                SourceLocation(file),
                f"there is no vehicle `{ego}` that drives",
                help=did_you_mean(ego, known) or _examples(known),
            )
    return tuple(ego for ego in known if not wanted or ego in wanted)


_MOST_NAMED = 12


def _examples(known: tuple[str, ...]) -> str:
    if not known:
        return "nobody in this file does"
    more = f", or one of {len(known) - _MOST_NAMED} more" if len(known) > _MOST_NAMED else ""
    return f"choose {named(known[:_MOST_NAMED])}{more}"
