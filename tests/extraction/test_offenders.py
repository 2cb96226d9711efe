"""Offences made on purpose, each beside its innocent twin, which differs in the fact that decides.

Tracks are driven by formulas along made roads, so that what happens is known. Verdicts are those of
three books, on both sides of traffic.
"""

import numpy as np
import pytest

import rulec
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.crossroads import STEP_S, crossroads, driven

KINDS = {"limit_mps": 36.0, "types": ("highway", "interstate", "mainCarriageWay")}
MOTORWAY = [
    rulec.build_lanelet("near", [(0, 0), (2000, 0)], left_of="far", **KINDS),
    rulec.build_lanelet("far", [(0, 3.5), (2000, 3.5)], right_of="near", **KINDS),
]
COUNTRY = [
    rulec.build_lanelet("on", [(0, 0), (2000, 0)], limit_mps=28.0, types=("country",)),
    rulec.build_lanelet("back", [(2000, 3.5), (0, 3.5)], limit_mps=28.0, types=("country",)),
]
CROSSING = rulec.build_lanelet("walk", [(500, -8), (500, 12)], width=4.0, types=("crosswalk",))


def violated(lanes, bodies, book, side):
    """The rules that ego surely violates."""
    complete = ("YIELD", "PRIORITY", "STOP", "light", "arrivals")
    found = rulec.build_recording(lanes, bodies, step_s=STEP_S, side="right", complete=complete)
    found = mirrored_recording(found) if side == "left" else found
    (row,) = rulec.verify_recording(found, book, rulec.RequestedDrives(("ego",))).rows()
    return set(row["violated"])


def cuts_in(offends):
    """Ego goes back 5 m ahead of one that brakes by 3 m/s² for it, or does not have to."""
    ahead = 9.5 if offends else 60.0
    ego = driven("ego", [(0, 30.0)], (10, 1000 + ahead), [(0, 3.5), (8.5, 3.5), (11.5, 0.0)])
    speeds = [(0, 26.0), (10.3, 26.0), (11.8, 21.5)] if offends else [(0, 26.0)]
    return MOTORWAY, [ego, driven("other", speeds, (10, 1000))]


def pulls_out(offends):
    """One overtakes ego, and brakes by 3 m/s² as ego comes out before it; or it is past by then."""
    ys = [(0, 0.0), (8, 0.0), (10.5, 3.5)]
    ego = driven("ego", [(0, 15.0)], (8, 500), ys)
    slow = driven("slow", [(0, 12.0)], (8, 545))
    speeds = [(0, 24.0), (8.3, 24.0), (11.3, 15.0)] if offends else [(0, 24.0)]
    out = [(0, 0.0), (3, 0.0), (5.5, 3.5)] if offends else [(0, 3.5), (7, 3.5), (9, 0.0)]
    other = driven("other", speeds, (8, 485 if offends else 600), out)
    return COUNTRY, [ego, slow, other]


def gives_no_way(offends):
    """Ego crosses before a cycle that brakes for it early, at 6 m/s to 2; or that is far yet."""
    ego = driven("ego", [(0, 9.0), (4, 0.0), (8, 0.0), (14, 9.0)], (6, -11.0), [(0, -1.75)])
    speeds = [(0, 6.0), (9.0, 6.0), (10.8, 2.0), (13, 2.0), (15, 6.0)] if offends else [(0, 6.0)]
    at = (9.0, -19.0) if offends else (9.0, -90.0)
    cycle = driven("cycle", speeds, at, [(0, -2.6)], "bicycle", turned=1)
    return crossroads(), [ego, cycle]


def stands_at_zebra(offends):
    """Ego stands 3 m before it for 14 s, with nobody about; or somebody waits there."""
    ego = driven(
        "ego", [(0, 12.0), (2, 12.0), (5, 0.0), (19, 0.0), (24, 12.0)], (6, 492.7), seconds=26
    )
    t = np.arange(260) * STEP_S
    y = np.full(len(t), 60.0) if offends else np.interp(t, [0, 3, 20, 26], [-7, -3.0, -3.0, 6])
    walker = rulec.build_participant("walker", "pedestrian", t, t * 0 + 500.0, y, step_s=STEP_S)
    return [*COUNTRY, CROSSING], [ego, walker]


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("made", "rules"),
    [
        (cuts_in, {"de": "safe_return", "gb": "safe_return", "us-ca": "safe_return"}),
        (pulls_out, {"de": "pulling_out", "gb": "pulling_out"}),
        (gives_no_way, dict.fromkeys(("de", "gb", "us-ca"), "give_way_sign")),
        (stands_at_zebra, {"de": "no_stopping_before_crossings", "gb": "no_stopping"}),
    ],
)
def test_the_offender_is_found_and_its_twin_is_not(made, rules, side):
    for book, rule in rules.items():
        found = {offends: violated(*made(offends), book, side) for offends in (True, False)}
        assert (rule in found[True], rule in found[False]) == (True, False), (book, found)
