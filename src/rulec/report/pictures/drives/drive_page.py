"""A drive as a self-contained page: all moments, a slider, the violations as a list.

A scene is compact data for its page: centimetres and milliradians, as differences.
"""

from __future__ import annotations

import json
from html import escape
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.files.text_templates import filled
from rulec.recordings.recording import Points
from rulec.report.pictures.drawing.picture_formats import as_svg, style_of
from rulec.report.pictures.drawing.styles import DARK, LIGHT, Theme
from rulec.report.pictures.drives.drive_picture import drive_picture
from rulec.report.pictures.drives.drive_scene import Body, DriveScene, SceneViolation
from rulec.report.pictures.trace_ribbon import RibbonRow, in_words, value_style
from rulec.report.text.html_page import policy
from rulec.report.text.terminal_text import visible


def drive_page(
    scene: DriveScene, state: int, violation: SceneViolation | None, theme: Theme = "auto"
) -> str:
    """The page, opened at a state; without its script it shows the picture of that state."""
    title = escape(visible(scene.title))
    chosen = -1 if violation is None else scene.violations.index(violation)
    data = scene_data(scene) | {"state": state, "chosen": chosen}
    # Escaped, so that the data cannot close the element that contains it.
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    fixed = "" if theme == "auto" else f' data-theme="{theme}"'
    picture = drive_picture(scene, state, violation)
    style, script = f"\n{_colours()}{_beside('drive_page.css')}", f"\n{_beside('drive_page.js')}"
    values = {
        "title": title,
        "policy": policy([style, style_of(picture, theme)], [script]),
        "fixed": fixed,
        "style": style,
        "notes": "".join(f"<p>{escape(visible(note))}</p>" for note in scene.notes),
        "last": str(scene.states - 1),
        "picture": as_svg(picture, theme),
        "data": text,
        "script": script,
    }
    return filled(Path(__file__).with_name("drive_page.html"), values)


def _beside(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _colours() -> str:
    light, dark = (
        "".join(f"--{name}:{colour};" for name, colour in colours.items())
        for colours in (LIGHT, DARK)
    )
    return (
        f":root{{{light}}}\n"
        f"@media (prefers-color-scheme: dark) {{ :root:not([data-theme=light]){{{dark}}} }}\n"
        f":root[data-theme=dark]{{{dark}}}\n"
    )


_CM = 100
_MRAD = 1000


def scene_data(scene: DriveScene) -> dict[str, Any]:
    """The scene: static content, bodies by state, violations."""
    return {
        "ego": scene.ego,
        "start": scene.start_s,
        "step": scene.step_s,
        "states": scene.states,
        "areas": [[area.surface, area.tip, _line(area.ring)] for area in scene.areas],
        "marks": [[mark.kind, _line(mark.line)] for mark in scene.marks],
        "lights": [[_line(light.line), light.colours] for light in scene.lights],
        "signs": [
            [*(round(x, 2) for x in sign.place), sign.text, sign.name] for sign in scene.signs
        ],
        "bodies": [_body(body) for body in scene.bodies],
        "violations": [_violation(violation) for violation in scene.violations],
    }


def _line(points: Points) -> list[int]:
    """Points as differences in cm, without points that are equal to the one before."""
    places = np.rint(points * _CM).astype(int)
    kept = places[np.append(True, np.any(np.diff(places, axis=0) != 0, axis=1))]
    steps: list[int] = np.diff(kept, axis=0, prepend=0).ravel().tolist()
    return steps


def _steps(values: NDArray[float64]) -> list[int]:
    """Whole numbers as differences; a missing value repeats the one before."""
    known = np.maximum.accumulate(np.where(np.isnan(values), 0, np.arange(len(values))))
    steps: list[int] = np.diff(np.rint(values[known]).astype(int), prepend=0).tolist()
    return steps


def _body(body: Body) -> dict[str, Any]:
    x, y, heading = body.poses.T
    gone = np.isnan(x)
    runs = [[gone_, len(list(run))] for gone_, run in groupby(gone.tolist())]
    turned = np.where(gone, np.nan, heading)
    turned[~gone] = np.unwrap(turned[~gone])
    standing = len(body.shapes) == 1 and bool((np.abs(np.ptp(body.poses, axis=0)) < 5e-3).all())
    rows = slice(0, 1) if standing else slice(None)
    return {
        "id": body.id,
        "type": body.type,
        "first": body.first,
        "states": len(x),
        "runs": runs if gone.any() else [],
        "x": _steps(x[rows] * _CM),
        "y": _steps(y[rows] * _CM),
        "turn": _steps(turned[rows] * _MRAD),
        "speed": _steps(body.speeds[rows]),
        "shapes": [_line(shape) for shape in body.shapes],
        "shape": np.diff(body.shape[rows], prepend=0).tolist() if len(body.shapes) > 1 else [],
    }


def _violation(violation: SceneViolation) -> dict[str, Any]:
    links = violation.links
    first, last = _span(links)
    return {
        "rule": violation.rule,
        "strength": violation.strength,
        "state": violation.state,
        "time": violation.time_s,
        "title": violation.title,
        "short": violation.short,
        "says": violation.says,
        "against": violation.against,
        "measured": violation.measured,
        "first": first,
        "links": [_steps(column * _CM) for column in links[first:last].T],
        "gaps": [violation.gap_text(state) for state in range(first, last)],
        "rows": [
            _row(row)
            | {"decides": row.title.split(" in ")[0] in violation.decides}
            | {"narrowly": violation.narrowly.get(row.title, ())}
            for row in violation.read.rows
        ],
    }


def _span(links: NDArray[float64]) -> tuple[int, int]:
    known = np.flatnonzero(~np.isnan(links[:, 0]))
    return (int(known[0]), int(known[-1]) + 1) if len(known) else (0, 0)


def _row(row: RibbonRow) -> dict[str, Any]:
    """A row as runs: last state, value, style, bounds; no value where the object is absent."""
    number = not row.values
    runs: list[list[Any]] = []
    for run in row.runs:
        end: list[Any] = [run.last]
        if run.unknown:
            end += [None, "unknown"]
        elif run.value is not None:
            end += [round(float(run.value), 2)] if number else [in_words(run.value)]
            end += ["curve" if number else value_style(row, run.value)]
            end += [run.bounds] if run.bounds else []
        if runs and runs[-1][1:] == end[1:]:
            runs.pop()
        runs.append(end)
    return {"title": row.title, "number": number, "runs": runs}
