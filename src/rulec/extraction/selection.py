"""The drives that a user requests: egos, thresholds and assumptions, also parsed from texts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from rulec.diagnostics import SourceLocation, did_you_mean, first_of
from rulec.diagnostics.argument_kinds import expected
from rulec.extraction.drives import Drives
from rulec.extraction.possible_types import PossibleTypes
from rulec.extraction.recording_parts import RecordingPart, egos_of, recording_parts
from rulec.extraction.traces.recorded_drive import Drive, DrivePlaces, NoDrive
from rulec.extraction.traces.to_trace import TraceWriter
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.extraction.traffic_thresholds import USUAL, Thresholds, check_chosen
from rulec.recordings.doubts.crowds import refuse_crowd
from rulec.recordings.mending.mended_recording import mended
from rulec.recordings.recording import Recording, Side
from rulec.recordings.recording_messages import NOT_IN_RECORDING
from rulec.rulebook.rulebook_model import Traffic
from rulec.trace import Value
from rulec.trace.trace_arrays import TraceArrays
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary

_MOST_NAMED = 12


@dataclass(frozen=True, slots=True)
class RequestedDrives:
    """A choice of egos and thresholds, and what is assumed.

    Empty ``egos`` means all vehicles. ``assumed`` values hold in every state. ``as_recorded``: do
    not mirror a recording of traffic on the other side than the rulebook's. ``defaults``: unknown
    values take their defaults, and the trace is complete where the recording ends.
    """

    __repr__ = short_repr

    egos: tuple[str, ...] = ()
    thresholds: Thresholds = USUAL
    assumed: Mapping[str, Value] = field(default_factory=dict)
    as_recorded: bool = False
    defaults: bool = False

    def __post_init__(self) -> None:
        # A single ego is allowed, and so are ids that are numbers in the file
        given: object = expected("egos", "str | int | Iterable[str | int]", self.egos)
        expected("thresholds", "Thresholds", self.thresholds)
        check_chosen(self.thresholds)
        expected("assumed", "Mapping", self.assumed)
        egos = (given,) if isinstance(given, str) or not isinstance(given, Iterable) else self.egos
        object.__setattr__(self, "egos", tuple(map(str, egos)))


@dataclass(slots=True)
class _PartLookedAt:
    """A part's drives, and those of ``doubtful`` egos if unknown types were one or another."""

    part: RecordingPart
    drives: Drives
    doubtful: frozenset[str] = frozenset()
    others: Sequence[Drives] = ()

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of an ego, each with the traces of its others."""
        if ego not in self.doubtful:
            return self.drives.of(ego)
        return with_drives_otherwise(self.drives.of(ego), [other.of(ego) for other in self.others])


def with_drives_otherwise(
    drives: Iterable[Drive | NoDrive], others: Iterable[Iterable[Drive | NoDrive]]
) -> Iterator[Drive | NoDrive]:
    """The drives with the traces of each of the ``others`` that are as long."""
    every = [list(other) for other in others]
    traces = [{x.arrays.id: x.arrays for x in other if isinstance(x, Drive)} for other in every]
    # A drive is known only if it is known with each of the types
    lost = {x.ego: x for other in every for x in other if isinstance(x, NoDrive) and x.fault}
    for drive in drives:
        if isinstance(drive, Drive):
            otherwise = replace(drive, otherwise=_like(drive, traces))
            yield lost.get(drive.arrays.id) or lost.get(drive.ego) or otherwise
        else:
            yield drive


def _like(drive: Drive, others: Sequence[Mapping[str, TraceArrays]]) -> tuple[TraceArrays, ...]:
    """The traces of a drive that are as long as it is."""
    found = [own[drive.arrays.id] for own in others if drive.arrays.id in own]
    return tuple([trace for trace in found if trace.n_states == drive.arrays.n_states])


@dataclass(slots=True)
class SelectedDrives:
    """The drives of ``egos`` and the ``recording`` that they are from, perhaps mirrored.

    A long recording is processed in ``parts``, kept as recorded, one at a time.
    """

    recording: Recording
    mirrored: bool
    egos: tuple[str, ...]
    parts: tuple[RecordingPart, ...] = field(repr=False)
    _drives_of: Callable[..., Drives] = field(repr=False)
    _unknown_reach_m: float | None = field(repr=False)
    _looked_at: _PartLookedAt | None = field(default=None, repr=False)

    def __iter__(self) -> Iterator[Drive | NoDrive]:
        """All drives, in the order of the file."""
        return (drive for ego in self.egos for drive in self.of(ego))

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of one vehicle, computed when they are asked for."""
        if self._looked_at is None or ego not in self._looked_at.part.egos:
            part = next(part for part in self.parts if ego in part.egos)
            # Free the old part first, so that there are never two in memory
            self._looked_at = None
            self._looked_at = self._look_at(part)
        found = self._looked_at.of(ego)
        return map(_where_recorded, found) if self.mirrored else found

    def _look_at(self, part: RecordingPart) -> _PartLookedAt:
        if part.recording.whole is None:
            seen = self.recording
        else:
            seen = mirrored_recording(part.recording) if self.mirrored else part.recording
        drives = self._drives_of(seen, expected=part.egos)
        if self._unknown_reach_m is None:
            return _PartLookedAt(part, drives)
        types = PossibleTypes(seen)
        near = types.near(part.egos, self._unknown_reach_m)
        others = [self._drives_of(other, expected=near) for other in types.recordings() if near]
        return _PartLookedAt(part, drives, frozenset(near), others)

    def kinds(self) -> dict[str, type]:
        """The Python type of each signal, the same for all drives; empty if there is no drive."""
        drives = (drive for drive in self if isinstance(drive, Drive))
        first = next(drives, None)
        # Drives of vehicles that were not requested have the same types
        return self._drives_of(self.recording).kinds() if first is None else dict(first.kinds)

    def told_words(self) -> frozenset[str]:
        """The words that at least one of these drives supplies."""
        return frozenset().union(*(drive.words for drive in self if isinstance(drive, Drive)))


def _where_recorded(drive: Drive | NoDrive) -> Drive | NoDrive:
    """A drive of a mirrored recording, with its places as in the file: only words are mirrored."""
    if isinstance(drive, NoDrive) or not isinstance(drive.places, DrivePlaces):
        return drive
    return replace(drive, places=drive.places.mirrored())


def chosen_side(
    recording: Recording, request: RequestedDrives, traffic: Traffic
) -> tuple[Side, bool]:
    """The side of traffic for which rules are read, and whether the recording is mirrored to it."""
    side = traffic or recording.side or "right"
    return side, recording.side not in (None, side) and not request.as_recorded


def selected_drives(
    recording: Recording,
    request: RequestedDrives,
    file: str,
    traffic: Traffic = "",
    vocabulary: Vocabulary | None = None,
    *,
    names: frozenset[str] | None = None,
    possible_types: bool = False,
) -> SelectedDrives:
    """The drives of a recording in a vocabulary's words, for rules for a side of ``traffic``.

    With ``possible_types`` they have the traces that there would be if participants of unknown type
    had one that they may have.

    Raises RulecError R0612 for a vehicle that the recording does not contain, or if it has no
    vehicle that drives; R0502 or R0503 for an assumption that does not fit the vocabulary.
    """
    side, mirrored = chosen_side(recording, request, traffic)
    writer = TraceWriter(vocabulary, names, request.assumed, request.defaults)
    recording = mended(with_night_assumed(recording, request.assumed), request.thresholds.away_s)
    known = egos_of(recording)
    if not known and not request.egos:
        raise NOT_IN_RECORDING.error(
            SourceLocation(file),
            f"no vehicle drives in it: {_who_is_there(recording)}",
            help="use a recording that contains moving vehicles",
        )
    for ego in request.egos:
        if ego not in known:
            raise NOT_IN_RECORDING.error(
                SourceLocation(file),
                f"there is no vehicle `{ego}` that drives",
                help=did_you_mean(ego, known) or _examples(known),
            )
    refuse_crowd(recording, file)
    egos = tuple(ego for ego in known if not request.egos or ego in request.egos)
    parts = recording_parts(recording, egos, request.thresholds)
    drives_of = partial(Drives, side=side, thresholds=request.thresholds, writer=writer)
    if mirrored:
        recording = mirrored_recording(recording)
    in_doubt = possible_types and not request.defaults
    # At junctions also those count that come on other roads
    reach_m = 2 * request.thresholds.near_m if in_doubt else None
    return SelectedDrives(recording, mirrored, egos, parts, drives_of, _unknown_reach_m=reach_m)


def with_night_assumed(recording: Recording, assumed: Mapping[str, Value]) -> Recording:
    """The recording in the assumed ``night`` or day, on which it depends what its lamps tell."""
    night = assumed.get("night")
    if not isinstance(night, bool) or night == recording.weather.night:
        return recording
    return replace(recording, weather=replace(recording.weather, night=night))


def _who_is_there(recording: Recording) -> str:
    standing = sum(body.standing for body in recording.participants)
    others = len(recording.participants) - standing
    if not standing + others:
        return "it contains a road but no participants"
    return f"of its participants, {standing} never move and {others} are on foot or of unknown type"


def _examples(known: tuple[str, ...]) -> str:
    if not known:
        return "nobody in this file does"
    return f"choose {first_of([f'`{name}`' for name in known], _MOST_NAMED, 'or one of')}"
