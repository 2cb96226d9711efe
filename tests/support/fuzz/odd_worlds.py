"""Target of odd recordings: through every verb that takes one, as data and as files."""

import shutil
from functools import cache

import numpy as np

import rulec
from rulec.extraction.drives import Drive, Drives
from rulec.extraction.recording_parts import egos_of
from rulec.recordings.mending.mended_recording import mended
from support.generators.odd_recordings import WRITERS, odd_recording

BOOKS = ("de", "gb", "us-ca", "jp", "fr")
LIGHT_BOOKS = ("esterle2019", "vienna")


@cache
def book(name, step_s):
    """A rulebook for a time step; of a country only for steps that others have, too."""
    return rulec.compile_rulebook(name, step_s=step_s)


def in_every_word(recording, pick):
    """All words of all drives."""
    drives = Drives(mended(recording), pick.choice(("left", "right")))
    for ego in drives.egos():
        for drive in drives.of(ego):
            if isinstance(drive, Drive):
                assert len(drive.trace.states) == drive.arrays.n_states


def verified(recording, pick):
    """Verdicts, with what they rest on."""
    names = BOOKS if recording.step_s == 0.5 else LIGHT_BOOKS
    rules = book(pick.choice(names), recording.step_s)
    for one in rulec.verify_recording(recording, rules).answers():
        assert one


def scored(recording, pick):
    """Futures of somebody, at any time."""
    rules = book(pick.choice(BOOKS if recording.step_s == 0.5 else LIGHT_BOOKS), recording.step_s)
    egos = [body.id for body in recording.participants] or ["1"]
    steps = [step for body in recording.participants for step in body.states] or [0]
    now = pick.choice((None, None, pick.choice(steps) * recording.step_s))
    world = rulec.TrafficWorld(recording, pick.choice(egos), now_s=now)
    count, past = pick.choice((1, 2, 8)), world.past
    x, y, heading, speed = past[-1] if len(past) else (0.0, 0.0, 0.0, 5.0)
    candidates = []
    for _ in range(3):
        gain, turn = pick.uniform(-4, 3), pick.choice((0.0, 0.0, 0.2, -0.2))
        t = recording.step_s * np.arange(1, count + 1)
        way, way_heading = np.maximum(speed * t + gain * t**2 / 2, 0.0), heading + turn * t
        places = x + way * np.cos(way_heading), y + way * np.sin(way_heading)
        candidates.append(np.column_stack((*places, way_heading, 0 * t + speed)))
    if pick.random() < 0.2:
        candidates[0][:, :2] = candidates[0][0, :2]
    found = rulec.score(np.array(candidates), world, rules, after=past[-pick.choice((1, 3, 99)) :])
    assert len(found.rows()) == len(found.reward()) == 3
    for number in range(3):
        assert found.margins(number) is not None
        assert found.candidates[number].drives is not None


def maneuvered(recording, pick):
    """Maneuvers of somebody, at any time."""
    egos = [body.id for body in recording.participants] or ["1"]
    steps = [step for body in recording.participants for step in body.states] or [0]
    at_s = pick.choice((None, pick.choice(steps) * recording.step_s))
    choice = rulec.Choice(ego=pick.choice((*egos, None)), at_s=at_s)
    scene = rulec.load_scenario(recording, choice)
    found = rulec.find_maneuvers(scene, pick.choice(("esterle2019", "esterle2019", "de")))
    assert found.cheapest(1) is not None


def monitored(recording, pick):
    """States one after the other."""
    rules = book(pick.choice(LIGHT_BOOKS), recording.step_s)
    for one in rulec.verify_recording(recording, rules).answers():
        if not isinstance(one, rulec.DriveVerdict):
            continue
        trace = one.drive.trace
        monitor = rulec.Monitor(rules, recording.step_s, cut=True, told=trace.told)
        for number, state in enumerate(trace.states):
            ranges = {name: trace.present.get(name, (0, number)) for name in trace.objects}
            there = {name for name, (begin, end) in ranges.items() if begin <= number <= end}
            objects = {name: kind for name, kind in trace.objects.items() if name in there}
            monitor.step(state, objects)


def drawn(recording, pick):
    """A picture or a page."""
    rules = book(pick.choice(LIGHT_BOOKS), recording.step_s)
    ego = pick.choice(("", *egos_of(recording)))
    form = pick.choice(("svg", "html"))
    assert rulec.draw_drive(recording, rules, ego, form=form)


VERBS = {
    verb.__name__: verb for verb in (in_every_word, verified, scored, maneuvered, monitored, drawn)
}
_TRIED = (in_every_word, in_every_word, verified, scored, scored, maneuvered, monitored, drawn)


def odd_worlds(place, pick):
    """An odd recording, as data for the verbs of Python or as a file for those of the command."""
    recording = odd_recording(pick)
    if pick.random() < 0.6:
        return in_python(pick.choice(_TRIED), recording, pick)
    folder = place.folder / "odd"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    file = str(WRITERS[pick.choice(list(WRITERS))](folder, recording, pick))
    match pick.randrange(8):
        case 0:
            return ["find", "(v: vehicle) b(v)", file, "-u", "paper"]
        case 1:
            return ["draw", "drive", file, "-r", "vienna", "-o", str(folder / "drive.html")]
        case 2:
            return ["maneuvers", file, "-r", "esterle2019"]
        case 3 | 4:
            return ["maneuvers", "--traces", file, "--recorded", "-o", str(folder / "made.jsonl")]
        case 5:
            out = str(folder / "fleet")
            return ["fleet", file, "-r", "esterle2019", "-o", out, "-j", "1"]
        case _:
            return ["verify", file, "-r", pick.choice(("vienna", "esterle2019")), "--json"]


def in_python(verb, recording, pick):
    """What a command would come to that did this; its name is that of the verb."""

    def tried():
        try:
            verb(recording, pick)
        except rulec.RulecError as error:
            return 2 if str(error) else 70
        return 0

    tried.__qualname__ = f"{verb.__name__}({recording.name}, {recording.step_s:g} s)"
    return tried
