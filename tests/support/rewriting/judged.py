"""What is said of a recording, in a form that is compared with that of another one."""

import rulec
from rulec import NoDrive, RequestedDrives


def judged(recording, rules, was=None, later_s=0.0, **wanted):
    """(drive, rule) -> what is said: when it is violated, and by whom, or that it is open.

    By former ids and times; what is kept is not named. Under no rule it is when a drive begins, or
    why a vehicle has none.
    """
    former, found = was or {}, {}

    def id_of(name):
        own, number = name.rsplit("_", 1) if name not in former and "_" in name else (name, "")
        return f"{former[own]}_{number}" if own in former and number else former.get(name, name)

    for one in rulec.verify_recording(recording, rules, RequestedDrives(**wanted)).answers():
        if isinstance(one, NoDrive):
            found[id_of(one.ego), ""] = one.why
            continue
        drive, answer = id_of(one.drive.ego), one.answer
        found[drive, ""] = round(one.drive.start_s - later_s, 6)
        found |= {(drive, x.rule): "open" for x in answer.open}
        found |= {(drive, x.rule): "not judged" for x in answer.not_judged}
        for violation in answer.violations:
            at = round(one.drive.time_s(violation.step) - later_s, 6)
            own = found.get((drive, violation.rule))
            own = own if isinstance(own, frozenset) else frozenset()
            whom = tuple(map(id_of, violation.binding.values()))
            found[drive, violation.rule] = own | {(at, whom)}
    return found
