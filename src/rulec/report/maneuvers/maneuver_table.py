"""A table of satisfying maneuvers by scenario or by rulebook."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rulec.planning import Maneuvers
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import cut, shown_count, stacked_tables, table_lines, visible


@dataclass(frozen=True, slots=True)
class ManeuverCounts:
    """A scenario's counts by one rulebook; ``is_judged``: a hard rule could be judged."""

    scenario: str
    rulebook: str
    maneuvers: int
    satisfying: int
    open: int
    violating: int
    is_judged: bool

    @classmethod
    def of(cls, scenario: str, maneuvers: Maneuvers) -> ManeuverCounts:
        """The counts of maneuvers; ``scenario`` is its name on the command line."""
        return cls(
            scenario=scenario,
            rulebook=maneuvers.rules.name,
            maneuvers=maneuvers.traces,
            satisfying=maneuvers.satisfying,
            open=maneuvers.open,
            violating=maneuvers.violating,
            is_judged=maneuvers.judges,
        )


def as_text(counts: Sequence[ManeuverCounts], width: int = PAGE_WIDTH) -> str:
    """A table with a row for each scenario and rulebook."""
    rows = [("scenario", "by", "maneuvers", "satisfying", "open", "violating")]
    for count in counts:
        numbers = (count.satisfying, count.open, count.violating)
        cells = map(shown_count, numbers) if count.is_judged else ["not judged"] * len(numbers)
        rows.append(
            (visible(count.scenario), visible(count.rulebook), shown_count(count.maneuvers), *cells)
        )
    too_wide = max(map(len, table_lines(rows, right=range(2, 6)))) - width
    longest = max(len(row[0]) for row in rows)
    rows = [(cut(row[0], longest - max(too_wide, 0)), *row[1:]) for row in rows]
    if too_wide < longest:
        return "\n".join(table_lines(rows, right=range(2, 6), ruled=[0]))
    return "\n".join(stacked_tables(rows, width, ruled=[0]))
