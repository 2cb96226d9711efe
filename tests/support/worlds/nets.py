"""Road nets of simulated worlds, made by SUMO's netgenerate and netconvert."""

import math
import random
import re
import subprocess
from pathlib import Path

USUAL_MPS, SLOW_MPS = 13.89, 8.33
TOWN, COUNTRY = "highway.residential", "highway.secondary"
"""Types of roads: what the net tells of where they are, which of the latter is nothing."""
_GENERATED = ("--no-turnarounds", "--no-warnings", "--default.speed", f"{USUAL_MPS}")
_GENERATED += ("--default.type", TOWN)
_GREEN_S, _ALL_RED_S = 14, 2


def make_net(sumo, layout, file, seed, lefthand):
    """Write the net of a layout. ``sumo``: the folder of SUMO's programs."""
    pick = random.Random(seed)
    hand = ["--lefthand"] if lefthand else []
    if layout in _GENERATORS:
        words = [sumo / "netgenerate", *_GENERATORS[layout](pick), *_GENERATED, *hand, "-o", file]
        _run(words)
    else:
        for ending, text in _PLAIN[layout](pick, lefthand).items():
            Path(f"{file}.{ending}").write_text(text, encoding="utf-8")
        parts = [part for name, option in _PARTS for part in _part(file, name, option)]
        _run([sumo / "netconvert", *parts, "--no-turnarounds", "--no-warnings", *hand, "-o", file])
        for name, _ in _PARTS:
            Path(f"{file}.{name}").unlink(missing_ok=True)
    _shift_lights(file, pick)
    _without_head(file)


_PARTS = (("nod", "-n"), ("edg", "-e"), ("con", "-x"))


def _part(file, name, option):
    there = Path(f"{file}.{name}")
    return [option, there] if there.exists() else []


def _run(words):
    subprocess.run(list(map(str, words)), check=True, capture_output=True)


def _shift_lights(file, pick):
    """Each light's programme begins at a time of its own."""
    text = file.read_text(encoding="utf-8")
    text = re.sub(
        r'(<tlLogic [^>]*offset=")0"', lambda found: f'{found[1]}{pick.randrange(-30, 30)}"', text
    )
    file.write_text(text, encoding="utf-8")


def _without_head(file):
    """The comment at the head has paths of the machine where the net was made."""
    text = file.read_text(encoding="utf-8")
    file.write_text(re.sub(r"<!--.*?-->\s*", "", text, flags=re.DOTALL), encoding="utf-8")


# What netgenerate makes


def _lengths(pick):
    return str(pick.randrange(90, 140))


def _lights():
    return ["--tls.green.time", str(_GREEN_S), "--tls.allred.time", str(_ALL_RED_S)]


def _grid(kind, *more):
    def words(pick):
        length = _lengths(pick)
        size = ["--grid", "--grid.number", "2", "--grid.length", length]
        size += ["--grid.attach-length", length]
        return [*size, "--default-junction-type", kind, *more]

    return words


def _spider(pick):
    arms, radius = pick.choice(("3", "4", "5")), str(pick.randrange(80, 110))
    shape = ["--spider", "--spider.arm-number", arms, "--spider.circle-number", "1"]
    shape += ["--spider.space-radius", radius, "--spider.attach-length", "110"]
    shape.append("--spider.omit-center")
    return [*shape, "--default-junction-type", "traffic_light", *_lights()]


def _town(pick):
    """Five by five junctions with lights, on roads of two lanes."""
    size = ["--grid", "--grid.number", "5", "--grid.length", "200", "--grid.attach-length", "150"]
    return [
        *(*size, "--default.lanenumber", "2"),
        *("--default-junction-type", "traffic_light", *_lights()),
    ]


_GENERATORS = {
    "town": _town,
    "lights": _grid("traffic_light", *_lights()),
    "wide_lights": _grid("traffic_light", "--default.lanenumber", "2", *_lights()),
    "right_before_left": _grid("right_before_left"),
    "allway_stop": _grid("allway_stop"),
    "spider": _spider,
}


# What netconvert makes of nodes and edges


def _nodes(rows):
    rows = "\n".join(f"<node {row}/>" for row in rows)
    return f"<nodes>\n{rows}\n</nodes>\n"


def _edges(rows, ends=""):
    rows = "\n".join(f"<edge {row}/>" for row in rows)
    return f"<edges>\n{rows}\n{ends}</edges>\n"


def _both_ways(one, other, what):
    yield f'id="{one}_{other}" from="{one}" to="{other}" {what}'
    yield f'id="{other}_{one}" from="{other}" to="{one}" {what}'


def _priority(kind):
    """A main road along x, and two roads across it that have to give way or to stop."""

    def files(pick, lefthand):
        gap, length = pick.randrange(110, 160), pick.randrange(110, 150)
        tilt = pick.uniform(-25, 25)
        nodes = [f'id="w" x="{-gap}" y="0"', f'id="e" x="{2 * gap}" y="0"']
        edges = []
        what = f'numLanes="1" speed="{USUAL_MPS}" type="{COUNTRY}"'
        for name, x in (("a", 0), ("b", gap)):
            nodes.append(f'id="{name}" x="{x}" y="0" type="{kind}"')
            nodes.append(f'id="n{name}" x="{x + tilt}" y="{length}"')
            nodes.append(f'id="s{name}" x="{x - tilt}" y="{-length}"')
            edges += _both_ways(f"n{name}", name, f'priority="1" {what}')
            edges += _both_ways(name, f"s{name}", f'priority="1" {what}')
        for one, other in (("w", "a"), ("a", "b"), ("b", "e")):
            edges += _both_ways(one, other, f'priority="9" {what}')
        return {"nod": _nodes(nodes), "edg": _edges(edges)}

    return files


def _roundabout(pick, lefthand):
    """Four roads that lead to a ring."""
    radius, length = pick.randrange(16, 24), pick.randrange(110, 140)
    nodes, edges, names, town = [], [], ["e", "n", "w", "s"], f'type="{TOWN}"'
    for k, name in enumerate(names):
        turn = math.radians(90 * k + pick.uniform(-10, 10))
        x, y = math.cos(turn), math.sin(turn)
        nodes.append(f'id="r{name}" x="{radius * x:.2f}" y="{radius * y:.2f}" type="priority"')
        nodes.append(f'id="{name}" x="{length * x:.2f}" y="{length * y:.2f}"')
        edges += _both_ways(
            name, f"r{name}", f'priority="2" numLanes="1" speed="{SLOW_MPS}" {town}'
        )
    order = names[::-1] if lefthand else names
    for one, other in zip(order, [*order[1:], order[0]], strict=True):
        bend = _arc(radius, names.index(one) * 90, -90 if lefthand else 90)
        edges.append(
            f'id="r{one}_r{other}" from="r{one}" to="r{other}" priority="5" numLanes="1" '
            f'speed="{SLOW_MPS}" shape="{bend}" {town}'
        )
    ring = " ".join(f"r{name}" for name in order)
    loop = " ".join(f"r{a}_r{b}" for a, b in zip(order, [*order[1:], order[0]], strict=True))
    return {
        "nod": _nodes(nodes),
        "edg": _edges(edges, f'<roundabout nodes="{ring}" edges="{loop}"/>\n'),
    }


def _arc(radius, begin, sweep):
    """Places along an arc, a sixth of its sweep at both ends left to the nodes."""
    turns = [math.radians(begin + sweep * share / 6) for share in range(1, 6)]
    return " ".join(f"{radius * math.cos(t):.2f},{radius * math.sin(t):.2f}" for t in turns)


def _zebra(pick, lefthand):
    """A road with pavements and two zebra crossings."""
    gap = pick.randrange(110, 150)
    nodes = [f'id="n{k}" x="{k * gap}" y="0"' for k in range(4)]
    for k in (1, 2):
        nodes[k] += ' type="priority"'
    lanes = pick.choice((1, 2))
    what = f'priority="3" numLanes="{lanes}" speed="{USUAL_MPS}" sidewalkWidth="2" type="{TOWN}"'
    edges = [row for k in range(3) for row in _both_ways(f"n{k}", f"n{k + 1}", what)]
    walks = "".join(
        f'<crossing node="n{k}" edges="n{k - 1}_n{k} n{k}_n{k - 1}" priority="true" width="4"/>\n'
        for k in (1, 2)
    )
    rows = f"<connections>\n{walks}</connections>\n"
    return {"nod": _nodes(nodes), "edg": _edges(edges), "con": rows}


def _motorway(pick, lefthand):
    """One carriageway of three lanes."""
    length = pick.randrange(1400, 1800)
    nodes = ['id="a" x="0" y="0"', f'id="b" x="{length}" y="{pick.randrange(0, 200)}"']
    what = 'numLanes="3" speed="33.33" type="highway.motorway" priority="9"'
    return {"nod": _nodes(nodes), "edg": _edges([f'id="a_b" from="a" to="b" {what}'])}


def _merge(pick, lefthand):
    """A carriageway of three lanes that a ramp joins, and the lane farthest from it ends later."""
    first, beside, then = pick.randrange(350, 500), pick.randrange(200, 300), 500
    places = {"a": 0, "b": first, "c": first + beside, "d": first + beside + then}
    places["e"] = places["d"] + pick.randrange(400, 600)
    aside = 80 if lefthand else -80
    nodes = [f'id="{name}" x="{x}" y="0"' for name, x in places.items()]
    nodes.append(f'id="r" x="{first - 350}" y="{aside}"')
    what = 'speed="33.33" type="highway.motorway" priority="9"'
    edges = [
        f'id="{one}_{other}" from="{one}" to="{other}" numLanes="{lanes}" {what}'
        for one, other, lanes in (("a", "b", 3), ("b", "c", 4), ("c", "d", 3), ("d", "e", 2))
    ]
    ramp = 'numLanes="1" speed="22.22" type="highway.motorway_link" priority="5"'
    edges.append(f'id="r_b" from="r" to="b" {ramp}')
    ways = [("r_b", "b_c", 0, 0), *(("a_b", "b_c", k, k + 1) for k in range(3))]
    ways += [("b_c", "c_d", k + 1, k) for k in range(3)]
    ways += [("c_d", "d_e", k, k) for k in range(2)]
    rows = "".join(
        f'<connection from="{one}" to="{other}" fromLane="{lane}" toLane="{on}"/>\n'
        for one, other, lane, on in ways
    )
    rows = f"<connections>\n{rows}</connections>\n"
    return {"nod": _nodes(nodes), "edg": _edges(edges), "con": rows}


_PLAIN = {
    "priority": _priority("priority"),
    "priority_stop": _priority("priority_stop"),
    "roundabout": _roundabout,
    "zebra": _zebra,
    "motorway": _motorway,
    "merge": _merge,
}
