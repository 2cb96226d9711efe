"""The JSON document of maneuvers and all that stands in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from msgspec import UNSET, UnsetType

from rulec.monitoring.verdict import Violation
from rulec.partition import AdjacencyName, Envelope, ExtentName, PartitionName
from rulec.report.json_document import JsonDocument, JsonPart, Number
from rulec.report.verdicts.verdict_json import NotJudgedRule, OpenData
from rulec.rulebook.rulebook_model import Strength
from rulec.scenario.scenario_model import Surface


class DerivedSignal(JsonPart, frozen=True, kw_only=True):
    """A signal that the recording supplies, and the reason for its value."""

    value: bool | int | float | str
    because: str


class SceneData(JsonPart, frozen=True, kw_only=True):
    """Account of a recorded scene: counts of obstacles, and derived signals."""

    reference: str
    obstacles: int
    left_out: int
    mirrored: bool
    recorded_until_s: float
    remarks: Sequence[str]
    derived: Mapping[str, DerivedSignal]


class DeadEndData(JsonPart, frozen=True, kw_only=True):
    """The start of the last layer reached, what closes it, and which options would open a way."""

    last_s: float
    closed_by: Sequence[str]
    opened_by: Sequence[str]


class TrajectoryData(JsonPart, frozen=True, kw_only=True):
    """A trajectory that proves a maneuver drivable (m, m/s, m/s²), and its costs.

    ``states`` are at the ends of pieces: time, s, speed along, d, speed across. In between,
    accelerations are constant. In a recorded scene it has a ``verdict`` of its own.
    """

    greatest_acceleration: float
    greatest_braking: float
    costs: Mapping[str, float]
    states: Sequence[tuple[float, float, float, float, float]]
    verdict: TrajectoryVerdictData | UnsetType = UNSET


class TrajectoryVerdictData(JsonPart, frozen=True, kw_only=True):
    """The verdict on a trajectory as a drive in the recorded world, up to ``until_s``.

    ``satisfied``, by the rules that can be judged, is null if no hard rule is violated and one is
    open, or ego leaves the road in ``off_road`` of the recording's steps. It is ``lawful`` if it
    violates none, has ``kept`` some whose trigger it surely meets, and is ``undecided`` on none of
    these; ``not_judged`` are others of these, which lack words. A violation's ``lost_s`` is null if
    the end decides.
    """

    satisfied: bool | None
    lawful: bool
    kept: Sequence[str]
    undecided: Sequence[str]
    not_judged: Sequence[str]
    until_s: float
    violations: Sequence[ManeuverViolation]
    open: Sequence[OpenData]
    off_road: int


class LevelPenalty(JsonPart, frozen=True, kw_only=True):
    """The summed weight of violated rules by levels; null stands for no level."""

    strength: Strength
    levels: Sequence[str | None]
    weight: Number


class ManeuverViolation(JsonPart, frozen=True, kw_only=True):
    """A violated rule; ``lost_s`` is null if only the end decides.

    ``inherited_from`` names the rulebook that it comes from, if this one has not confirmed it.
    """

    rule: str
    cite: str
    binding: Mapping[str, str]
    lost_s: float | None
    strength: Strength
    level: str | None
    weight: Number
    inherited_from: str | UnsetType = UNSET


class CellData(JsonPart, frozen=True, kw_only=True):
    """A cell of the maneuver, with its relation to every obstacle."""

    cell: int
    start_s: float
    surface: Surface
    signature: Mapping[str, str | tuple[str, str]]


class BindingProbability(JsonPart, frozen=True, kw_only=True):
    """The probability that a rule is kept for some objects, or its bounds."""

    binding: Mapping[str, str]
    kept: float
    kept_at_most: float | UnsetType = UNSET


class RuleProbabilityData(JsonPart, frozen=True, kw_only=True):
    """The probability that a rule is kept, null if unknown.

    With ``kept_at_most`` both are bounds, because it depends on unknown values.
    """

    rule: str
    strength: Strength
    kept: float | None
    bindings: Sequence[BindingProbability]
    kept_at_most: float | UnsetType = UNSET


class ChancesData(JsonPart, frozen=True, kw_only=True):
    """The probabilities that no obstacle hits ego, and that rules are kept."""

    clear: float
    every_hard_rule: float | None
    rules: Sequence[RuleProbabilityData]
    every_hard_rule_at_most: float | UnsetType = UNSET


class ManeuverData(JsonPart, frozen=True, kw_only=True):
    """A maneuver: cost (1/s), margin, cells and bounds in time.

    A ranked one has ``place``, ``penalty``, ``violations``, and the number of ``members`` with that
    penalty; a class's has ``members``, a pruning's example ``violations``. If values are unknown,
    ``open`` verdicts depend on them; they count in ``penalty``, but not in ``at_least``.
    """

    place: int | UnsetType = UNSET
    penalty: Sequence[LevelPenalty] | UnsetType = UNSET
    members: int | UnsetType = UNSET
    at_least: Sequence[LevelPenalty] | UnsetType = UNSET
    violations: Sequence[ManeuverViolation] | UnsetType = UNSET
    open: Sequence[OpenData] | UnsetType = UNSET
    cost: float
    margin_s: float | None
    cells: Sequence[CellData]
    envelope: Sequence[Envelope]
    trajectory: TrajectoryData | UnsetType = UNSET
    chances: ChancesData | UnsetType = UNSET


class WorldData(JsonPart, frozen=True, kw_only=True):
    """Counts for an obstacle's less likely prediction, numbered from 1."""

    obstacle: str
    prediction: int
    weight: float
    traces: int
    satisfying: int
    open: int


class PruningData(JsonPart, frozen=True, kw_only=True):
    """Counts of maneuvers that violate a rule, and of those that violate no other hard rule.

    The latter is ``alone``. For ``open`` further maneuvers it depends on unknown values.
    """

    rule: str
    strength: Strength
    violating: int
    alone: int | None
    open: int
    example: ManeuverData | None


class ClassesData(JsonPart, frozen=True, kw_only=True):
    """The counts of homotopy classes, and the cheapest satisfying members of some.

    ``open`` counts further classes whose verdict is open. ``divided`` classes have members of
    either verdict, as they may where hard rules are ``counting_steps``.
    """

    total: int
    satisfying: int
    divided: int
    open: int
    counting_steps: Sequence[str]
    representatives: Sequence[ManeuverData]


class LawfulWay(JsonPart, frozen=True, kw_only=True):
    """A way that ego may drive lawfully, and the cells of its maneuver, by their indices.

    ``states`` are those at the beginning of each layer: time, s, speed along, d, speed across.
    """

    cells: Sequence[int]
    states: Sequence[Sequence[float]]


class ManeuversDocument(JsonDocument, frozen=True, kw_only=True):
    """The counts of maneuvers in a scenario, and the further answers requested.

    ``free`` are those all of whose trajectories keep every hard rule (``satisfying``), ``closed``
    those all of whose trajectories violate one (``violating``). Of the others, ``lawful`` are those
    tried in a recorded scene of which a trajectory keeps each hard rule whose trigger it surely
    meets, as far as these are judged, and meets some; the rest is ``undecided``. The
    ``lawful_ways`` are the gentlest of some maneuvers, besides the trajectories of those listed.

    For ``open`` maneuvers, besides those ``satisfying``, the verdict depends on ``unknown`` values;
    ``exact`` is false if there were too many cases to examine, so that some verdicts may be known
    after all. ``judged`` are the rules kept or violated for certain by at least half of the
    maneuvers, null unless cells have words. With ``bounds`` of ego's motion (m, s) maneuvers are
    paths through reachable cells, else all. ``least_braking`` (m/s²) is set if a maneuver shown
    brakes hard, and none brakes less; ``least_braking_later`` if some do, but have to brake harder
    after their end; ``in_way``, the obstacles in the way, if no trajectory was found along any to
    be listed. Names ``by_default`` are read, but not supplied by the scenario.
    """

    scenario: str
    rulebook: str
    partition: PartitionName
    adjacency: AdjacencyName
    extent: ExtentName
    step_s: float
    horizon_s: float
    nodes: int
    edges: int
    bounds: Mapping[str, float] | None
    traces: int
    free: int
    lawful: int
    closed: int
    undecided: int
    satisfying: int
    violating: int
    open: int
    exact: bool
    judged: Sequence[str] | None
    unknown: Sequence[str]
    not_judged: Sequence[NotJudgedRule]
    by_default: Sequence[str]
    dead_end: DeadEndData | None
    seconds: float
    scene: SceneData | UnsetType = UNSET
    violated_before: Sequence[Violation] | UnsetType = UNSET
    least_violating: Sequence[ManeuverData] | UnsetType = UNSET
    ranked: Sequence[ManeuverData] | UnsetType = UNSET
    maneuvers: Sequence[ManeuverData] | UnsetType = UNSET
    lawful_ways: Sequence[LawfulWay] | UnsetType = UNSET
    likeliest: float | UnsetType = UNSET
    worlds: Sequence[WorldData] | UnsetType = UNSET
    rules: Sequence[PruningData] | UnsetType = UNSET
    classes: ClassesData | UnsetType = UNSET
    least_braking: float | UnsetType = UNSET
    least_braking_later: float | UnsetType = UNSET
    in_way: Sequence[str] | UnsetType = UNSET
