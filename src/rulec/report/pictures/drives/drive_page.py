"""A drive as a self-contained page: all moments, a slider, the violations as a list."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path

from rulec.files.text_templates import filled
from rulec.report.pictures.drawing.picture_formats import as_svg, style_of
from rulec.report.pictures.drawing.styles import DARK, LIGHT, Theme
from rulec.report.pictures.drives.drive_picture import drive_picture
from rulec.report.pictures.drives.drive_scene import DriveScene, SceneViolation
from rulec.report.pictures.drives.scene_json import scene_data
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
