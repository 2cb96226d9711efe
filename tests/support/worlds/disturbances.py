"""The same recording as others would have made it: mirrored, with noise, at other frame rates."""

import random
import xml.etree.ElementTree as ElementTree
from bisect import bisect_right
from dataclasses import dataclass

from support.worlds.simulate import WorldFiles

_BODIES = ("vehicle", "person")
_INDICATORS = 3


def _copied(files, folder):
    folder.mkdir(parents=True, exist_ok=True)
    copy = WorldFiles(folder)
    copy.net.write_bytes(files.net.read_bytes())
    copy.routes.write_bytes(files.routes.read_bytes())
    return copy


def _bodies(tree):
    return (one for moment in tree.getroot() for one in moment if one.tag in _BODIES)


def thinned(files, folder, every=2):
    """One moment in so many: half the work, and no less to see."""
    copy = _copied(files, folder)
    tree = ElementTree.parse(files.data)
    root = tree.getroot()
    for number, moment in enumerate(list(root)):
        if number % every:
            root.remove(moment)
    tree.write(copy.data)
    return copy


def with_noise(files, folder, noise_m=0.0, rounded_m=0.0, seed=1):
    """Places with normal noise of each state's own, or rounded; speeds are left as they are."""
    copy, pick = _copied(files, folder), random.Random(seed)
    tree = ElementTree.parse(files.data)
    for one in _bodies(tree):
        for axis in ("x", "y"):
            place = float(one.get(axis)) + pick.gauss(0.0, noise_m)
            place = round(place / rounded_m) * rounded_m if rounded_m else place
            one.set(axis, f"{place:.3f}")
    tree.write(copy.data)
    return copy


def mirrored(files, folder):
    """The mirror image: traffic keeps to the other side, and everybody does the same."""
    copy = _copied(files, folder)
    net = ElementTree.parse(files.net)
    side = net.getroot().get("lefthand") in ("true", "1")
    net.getroot().set("lefthand", "false" if side else "true")
    for one in net.iter():
        for name in ("shape", "outlineShape"):
            if one.get(name):
                one.set(name, " ".join(map(_mirrored_place, one.get(name).split())))
        if one.tag == "junction":
            one.set("y", str(-float(one.get("y"))))
    net.write(copy.net)
    data = ElementTree.parse(files.data)
    for one in _bodies(data):
        one.set("y", f"{-float(one.get('y')):.3f}")
        one.set("angle", f"{(180.0 - float(one.get('angle'))) % 360.0:.3f}")
        if one.get("signals"):
            bits = int(one.get("signals"))
            swapped = {1: 2, 2: 1}.get(bits & _INDICATORS, bits & _INDICATORS)
            one.set("signals", str(bits & ~_INDICATORS | swapped))
    data.write(copy.data)
    return copy


def _mirrored_place(place):
    x, y, *more = place.split(",")
    return ",".join((x, f"{-float(y):.2f}", *more))


@dataclass(frozen=True, slots=True)
class _State:
    time: float
    attributes: dict


def at_frames(files, folder, frames_per_s):
    """The same motion seen so many times a second, with straight motion between its states.

    SUMO steps in whole milliseconds; times here are whole microseconds, as near as can be.
    """
    copy = _copied(files, folder)
    tracks, last = {}, 0.0
    for moment in ElementTree.parse(files.data).getroot():
        last = float(moment.get("time"))
        for one in moment:
            key = one.tag, one.get("id")
            tracks.setdefault(key, []).append(_State(last, dict(one.attrib)))
    frame_s = round(1e6 / frames_per_s) / 1e6
    root = ElementTree.Element("fcd-export")
    for number in range(int(last / frame_s) + 1):
        time = number * frame_s
        moment = ElementTree.SubElement(root, "timestep", time=f"{time:.6f}")
        for (tag, _), states in tracks.items():
            if states[0].time <= time <= states[-1].time:
                ElementTree.SubElement(moment, tag, _between(states, time))
    ElementTree.ElementTree(root).write(copy.data)
    return copy


def _between(states, time):
    k = bisect_right(states, time, key=lambda state: state.time) - 1
    before, after = states[k], states[min(k + 1, len(states) - 1)]
    span = after.time - before.time
    share = (time - before.time) / span if span else 0.0
    found = dict(before.attributes)
    for name in ("x", "y", "speed", "acceleration", "angle"):
        if name in found:
            one, other = float(found[name]), float(after.attributes[name])
            step = other - one
            step = (step + 180.0) % 360.0 - 180.0 if name == "angle" else step
            value = one + share * step
            found[name] = f"{value % 360.0 if name == 'angle' else value:.3f}"
    return found
