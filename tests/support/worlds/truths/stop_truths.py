"""Stop signs: whether who crosses the line has stood at it in the ten seconds before."""

from support.worlds.facts import Fact, runs
from support.worlds.truths.priority_truths import stop_give_way_facts

_BEFORE_S = 10.0
_STOOD_MPS, _ROLLED_MPS = 0.1, 0.4
_STOOD_S = 0.8
_AT_LINE_M, _BEFORE_LINE_M = 4.0, 12.0
"""Who stands farther back has not stopped at the line; in between one may dispute it."""

_SIGNED = frozenset("sw")
"""SUMO's letters: a stop sign, and an all-way stop."""


_AND_GIVES_WAY = frozenset({"gb", "fr"})
"""Books whose rule on stop signs asks for both."""


def stop_facts(world):
    """Who crosses the line of a stop sign without having stood, or before others if it must not."""
    yield from _does_not_stop(world)
    if world.book in _AND_GIVES_WAY:
        yield from stop_give_way_facts(world, "stop_sign")


def _does_not_stop(world):
    for crossing in world.crossings:
        if not _signed(world, crossing.link):
            continue
        track, row = crossing.track, crossing.row
        first = max(0, row - round(_BEFORE_S / world.step_s))
        speed = track.column("speed")[first : row + 1]
        away = -world.along(crossing)[first : row + 1]
        stood = any(
            (end - begin + 1) * world.step_s >= _STOOD_S
            for begin, end in runs((speed < _STOOD_MPS) & (away <= _AT_LINE_M))
        )
        if not stood:
            at = world.time(track, row)
            # Who was not there for ten seconds may have stood before it came
            slowest = speed[away <= _BEFORE_LINE_M].min()
            sure = slowest > _ROLLED_MPS and row * world.step_s > 2.0
            yield Fact(track.id, "stop_sign", at, at, bool(sure))


def _signed(world, link):
    """True if there is a sign: all ways from the lane have to stop."""
    ways = [one for one in world.net.links.values() if one.start == link.start]
    return all(one.state in _SIGNED for one in ways)
