"""Lines of lanes lie where the standard's formulas have them, in a second evaluation of these."""

from collections import defaultdict
from math import pi

import numpy as np
import pytest
import shapely

from rulec.recordings.opendrive.opendrive_map import read_opendrive_map
from support.builders.opendrive_files import (
    XODR,
    cubic,
    document,
    geometry,
    lane,
    road,
    section,
    written,
)
from support.oracles.opendrive_curves import lane_curves, reference_gaps

NEAR_M = 0.01
NARROWEST_M = 0.05


def farthest(file):
    """How far (m) lanes' middles are from their curves, or these from them, at most.

    The lanelets lead along the road as the lanes are driven.
    """
    of_lane = defaultdict(list)
    for lanelet in read_opendrive_map(file).lanelets.values():
        if "crosswalk" not in lanelet.types:
            number, _, lane, *back = lanelet.id.split(".")
            of_lane[number, int(lane), bool(back)].append(lanelet)
    curves = defaultdict(list)
    for curve in lane_curves(file):
        if curve.kind != "none" and curve.width.max() > NARROWEST_M and np.ptp(curve.s) > NEAR_M:
            curves[curve.road, curve.lane, False].append(curve)
            if curve.kind == "bidirectional":
                curves[curve.road, curve.lane, True].append(curve)
    assert of_lane.keys() == curves.keys()
    worst = 0.0
    for key, own in curves.items():
        dense = shapely.MultiLineString([x.middle for x in own])
        lines = shapely.MultiLineString([x.centre for x in of_lane[key]])
        s, places = np.concatenate([x.s for x in own]), np.concatenate([x.middle for x in own])
        # Where it has no width a lane is not there
        wide = np.concatenate([x.width for x in own]) > NARROWEST_M
        away = shapely.distance(lines, shapely.points(places[wide]))
        back = shapely.distance(dense, shapely.points(shapely.get_coordinates(lines)))
        worst = max(worst, float(away.max()), float(back.max()))
        for lanelet in of_lane[key]:
            ends = [np.hypot(*(places - end).T).argmin() for end in lanelet.centre[[0, -1]]]
            start, end = s[ends]
            assert (end > start) == (own[0].forward != key[2])
    return worst


LANES = section(
    lane(
        2,
        width=cubic("width", "sOffset", 0, 2, 0.01) + cubic("width", "sOffset", 30, 2.3, 0, 0.001),
    ),
    lane(1),
    lane(-1, width=cubic("width", "sOffset", 0, 3, 0.1, -0.003, 0.00002)),
    lane(-2, kind="sidewalk", width=2),
)
SHAPES = {
    "line": "<line/>",
    "arc": '<arc curvature="0.05"/>',
    "a bend to the right": '<arc curvature="-0.1"/>',
    "a spiral into a bend": '<spiral curvStart="0" curvEnd="0.08"/>',
    "a spiral from bend to bend": '<spiral curvStart="-0.12" curvEnd="0.1"/>',
    "a spiral that hardly bends": '<spiral curvStart="1e-9" curvEnd="-1e-8"/>',
    "a spiral of one curvature": '<spiral curvStart="0.02" curvEnd="0.02"/>',
    "poly3": cubic("poly3", "x", 0, 0, 0, 0.01, -0.0001),
    "paramPoly3 by length": '<paramPoly3 pRange="arcLength" aU="0" bU="1" cU="-0.0005" dU="0" '
    'aV="0" bV="0" cV="0.02" dV="-0.0003"/>',
    "paramPoly3 from 0 to 1": '<paramPoly3 pRange="normalized" aU="0" bU="30" cU="25" dU="-7" '
    'aV="0" bV="0" cV="40" dV="-25"/>',
    "paramPoly3 that does not say": '<paramPoly3 aU="0" bU="55" cU="0" dU="0" '
    'aV="0" bV="0" cV="20" dV="-5"/>',
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_shapes(tmp_path, shape):
    plan = geometry(shape, x=10, y=-20, hdg=2.5, length=60)
    file = written(tmp_path, document(road(1, LANES, plan=plan, length=60)))
    assert farthest(file) < NEAR_M


def test_a_quarter_of_a_circle(tmp_path):
    """By hand: radius 20 m around (0, 20); its right lane's middle is 1.75 m farther out."""
    plan = geometry('<arc curvature="0.05"/>', length=10 * pi)
    file = written(tmp_path, document(road(1, section(lane(-1)), plan=plan, length=10 * pi)))
    (lanelet,) = read_opendrive_map(file).lanelets.values()
    assert np.hypot(*(lanelet.centre - (0, 20)).T) == pytest.approx(21.75)
    assert lanelet.centre[0] == pytest.approx((0, -1.75))
    assert lanelet.centre[-1] == pytest.approx((21.75, 20))
    assert np.hypot(*(lanelet.left - (0, 20)).T) == pytest.approx(20)
    assert np.hypot(*(lanelet.right - (0, 20)).T) == pytest.approx(23.5)


def test_a_clothoid(tmp_path):
    """By hand: Fresnel's integrals C(1) = 0.779893..., S(1) = 0.438259... (Abramowitz, Stegun 7.7).

    With a curvature of pi s the heading is pi s²/2, and places are C(s), S(s).
    """
    plan = geometry(f'<spiral curvStart="0" curvEnd="{pi}"/>', length=1)
    lanes = section(lane(-1, width=0.1))
    file = written(tmp_path, document(road(1, lanes, plan=plan, length=1)))
    (lanelet,) = read_opendrive_map(file).lanelets.values()
    assert lanelet.left[-1] == pytest.approx((0.7798934004, 0.4382591474), abs=1e-9)


def test_several_shapes_and_a_shifted_centre(tmp_path):
    plan = geometry(length=40) + geometry('<arc curvature="0.02"/>', s=40, x=40, length=60)
    offsets = cubic("laneOffset", "s", 0, 0.5) + cubic("laneOffset", "s", 20, 0.5, 0, 0.003, -4e-5)
    text = document(road(1, LANES, plan=plan, offsets=offsets))
    assert farthest(written(tmp_path, text)) < NEAR_M


def test_borders_instead_of_widths(tmp_path):
    """They count from the centre, whatever lies between."""
    borders = [cubic("border", "sOffset", 0, a, b) for a, b in ((3, 0.02), (6.5, 0), (-3, -0.01))]
    lanes = section(*(lane(n, width=x) for n, x in zip((1, 2, -1), borders, strict=True)))
    file = written(tmp_path, document(road(1, lanes)))
    assert farthest(file) < NEAR_M
    found = read_opendrive_map(file).lanelets
    assert found["1.0.2"].right[-1] == pytest.approx((0, 6.5))
    assert found["1.0.2"].left[0] == pytest.approx((100, 5))
    assert found["1.0.-1"].right[-1] == pytest.approx((100, -4))


def test_lines_have_as_many_places(tmp_path):
    plan = geometry('<spiral curvStart="-0.12" curvEnd="0.1"/>', length=60)
    file = written(tmp_path, document(road(1, LANES, plan=plan, length=60)))
    for lanelet in read_opendrive_map(file).lanelets.values():
        assert len(lanelet.left) == len(lanelet.right) == len(lanelet.centre)
        assert (lanelet.left + lanelet.right) / 2 == pytest.approx(lanelet.centre)


@pytest.mark.skipif(not XODR, reason="OpenDRIVE's maps are not here: set RULEC_RECORDINGS")
@pytest.mark.parametrize("file", XODR, ids=lambda file: file.stem)
def test_real_maps(file):
    # Where pieces fit together a wrong formula would show
    assert max(reference_gaps(file), default=0.0) < 0.05
    assert farthest(file) < NEAR_M
