"""The page in a real browser: the slider chooses, the keyboard moves it, dark is dark."""

import re
import shutil
import subprocess

import pytest

from rulec.cli.main import main
from support.oracles.page_policy import hash_of

BROWSER = next(
    filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None
)

pytestmark = pytest.mark.skipif(BROWSER is None, reason="there is no Chromium")


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "s2.html"
    assert main(["draw", "scene", "s2", "-r", "esterle2019", "-o", str(file)]) == 0
    return file


def run(file, *options):
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
    profile = f"--user-data-dir={file.parent / 'profile'}"
    done = subprocess.run(
        [*command, profile, *options, file.as_uri()],
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return done.stdout


def with_script(page, script):
    """The page with one more script, which its policy allows, too."""
    text = page.read_text(encoding="utf-8").replace("script-src", f"script-src {hash_of(script)}")
    return text.replace("</body>", f"<script>{script}</script></body>")


def after(page, script):
    """The page as it is when a script of somebody who uses it has run."""
    used = page.with_name("used.html")
    used.write_text(with_script(page, script), encoding="utf-8")
    dom = run(used, "--dump-dom")
    hidden = ["other" in tag for tag in re.findall(r"<figure[^>]*>", dom)]
    output = re.search(r"<output[^>]*>(.*?)</output>", dom)[1]
    return hidden, output, dom


def test_one_layer_is_shown_at_first(page):
    hidden, output, dom = after(page, "")
    assert hidden == [False, True, True, True, True]
    assert output == "0 s to 1 s"
    assert '<form id="time">' in dom, "the slider appears with the script"


def test_the_slider_chooses_the_layer(page):
    moved = "slider.value = 3; slider.dispatchEvent(new Event('input'))"
    hidden, output, dom = after(page, moved)
    assert hidden == [True, True, True, False, True]
    assert output == "3 s to 4 s"
    assert 'aria-valuetext="3 s to 4 s"' in dom


def test_all_at_once(page):
    hidden, _, _ = after(page, "document.getElementById('all').click()")
    assert hidden == [False] * 5


def test_without_its_script_the_page_shows_everything(page):
    bare = page.with_name("bare.html")
    text = page.read_text(encoding="utf-8")
    bare.write_text(re.sub(r"<script>.*</script>", "", text, flags=re.DOTALL), encoding="utf-8")
    dom = run(bare, "--dump-dom")
    assert dom.count("<figure") == 5
    assert 'class="other"' not in dom
    assert '<form id="time" hidden' in dom, "a slider that does nothing is not shown"


def test_the_slider_can_be_reached_by_keyboard(page):
    script = "slider.focus(); document.body.dataset.reached = document.activeElement.id"
    assert 'data-reached="slider"' in after(page, script)[2]


def test_dark_and_light(page, tmp_path):
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    for scheme, expected in (("0", (0x16, 0x19, 0x1D)), ("1", (255, 255, 255))):
        shot = tmp_path / "shot.png"
        settings = f"--blink-settings=preferredColorScheme={scheme}"
        run(page, settings, "--window-size=960,420", f"--screenshot={shot}")
        corner = imread(shot)[2, 2, :3]
        assert tuple(round(float(part) * 255) for part in corner) == expected


@pytest.fixture(scope="module")
def drive_page(tmp_path_factory):
    file = tmp_path_factory.mktemp("drive") / "drive.html"
    recording = ["docs/samples/following.xml", "--ego", "1", "--rule", "following_distance"]
    assert main(["draw", "drive", *recording, "-r", "de", "-o", str(file)]) == 0
    return file


def told(page, script, name):
    """The text of an element when a script of somebody who uses the page has run."""
    return re.search(rf'<\w+[^>]* id="{name}"[^>]*>(.*?)</\w+>', after_drive(page, script))[1]


def after_drive(page, script):
    used = page.with_name("used.html")
    used.write_text(with_script(page, script), encoding="utf-8")
    return run(used, "--dump-dom")


def test_no_policy_is_broken(page, drive_page):
    """The listener comes first, since what is refused is told when it is met."""
    listener = (
        "document.documentElement.dataset.refused = '';"
        "document.addEventListener('securitypolicyviolation',"
        " (event) => document.documentElement.dataset.refused += event.violatedDirective)"
    )
    for file, handled in ((page, '<form id="time">'), (drive_page, 'class="scripted"')):
        text = with_script(file, "").replace("script-src", f"script-src {hash_of(listener)}")
        head, body = text.split("<title>", 1)
        watched = file.with_name("watched.html")
        for more, refused in (("", ""), ("<i style='color: red'></i>", "style-src-attr")):
            policy, rest = body.split('content="default', 1)
            meta, rest = rest.split(">", 1)
            shown = f'{head}<title>{policy}content="default{meta}><script>{listener}</script>{rest}'
            watched.write_text(shown.replace("<main>", f"<main>{more}"), encoding="utf-8")
            dom = run(watched, "--dump-dom")
            assert f'data-refused="{refused}"' in dom
            assert handled in dom


def pressed(key, more=""):
    return f"document.dispatchEvent(new KeyboardEvent('keydown', {{key: '{key}'{more}}}));"


def test_a_drive_opens_at_its_first_violation(drive_page):
    dom = after_drive(drive_page, "")
    assert '<html lang="en" class="scripted">' in dom
    assert ">2.5 s of 5.0 s</output>" in dom
    assert dom.count('aria-current="true"') == 1
    assert "gap(2) 19.80±0.05 m &lt; 21.3±0.7 m, by at least 0.90 m" in dom
    # How long somebody has been ahead who was so when the recording began.
    assert ">3.84 to 1000<" in dom


def test_keys_of_a_drive(drive_page):
    assert told(drive_page, pressed("ArrowRight"), "time") == "3.0 s of 5.0 s"
    assert told(drive_page, pressed("ArrowRight", ", shiftKey: true"), "time") == "3.5 s of 5.0 s"
    assert told(drive_page, pressed("ArrowLeft") * 2, "time") == "1.5 s of 5.0 s"
    assert told(drive_page, pressed("End"), "time") == "5.0 s of 5.0 s"
    assert told(drive_page, pressed(" "), "play") == "Pause"


def test_a_violation_in_the_list_jumps_to_its_moment(drive_page):
    click = pressed("Home") + "document.querySelector('#violations button').click()"
    assert told(drive_page, click, "time") == "2.5 s of 5.0 s"
    assert "false: 19.80±0.05 &lt; 21.3±0.7 m" in after_drive(drive_page, click)


def test_a_drive_in_another_theme(drive_page):
    choose = "theme.value = 'dark'; theme.dispatchEvent(new Event('change'));"
    assert '<html lang="en" class="scripted" data-theme="dark">' in after_drive(drive_page, choose)
