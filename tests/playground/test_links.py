"""What a page's link is unpacked to, in node: never more than a page may have."""

import base64
import json
import shutil
import subprocess
import zlib
from pathlib import Path

import pytest

LINK = Path(__file__).parents[2] / "src/tools/playground/page/link.js"
TRIED = """
import { packed, unpacked } from "./link.mjs";
const answers = [];
for await (const part of process.stdin) for (const fragment of JSON.parse(part)) {
  try {
    answers.push(await unpacked(fragment));
  } catch (error) {
    answers.push(error.message);
  }
}
answers.push(await unpacked(await packed({ source: "a ä", tab: "test" })));
console.log(JSON.stringify(answers));
"""


def fragment(data):
    packer = zlib.compressobj(9, wbits=-15)
    packed = packer.compress(data) + packer.flush()
    return "1." + base64.urlsafe_b64encode(packed).decode().rstrip("=")


@pytest.mark.skipif(not shutil.which("node"), reason="node is not there: apt-get install nodejs")
def test_a_link_is_unpacked_within_bounds(tmp_path):
    shutil.copy(LINK, tmp_path / "link.mjs")
    (tmp_path / "tried.mjs").write_text(TRIED)
    given = {
        fragment(b'{"source": "' + b"x" * 20_000_000 + b'"}'): "more than 1,000,000 bytes",
        fragment(b"null"): "no texts",
        fragment(b'"text"'): "no texts",
        "2.AAAA": "another version",
    }
    done = subprocess.run(
        ["node", "--max-old-space-size=64", "tried.mjs"],
        cwd=tmp_path,
        input=json.dumps(list(given)),
        capture_output=True,
        text=True,
        check=True,
    )
    *refused, kept = json.loads(done.stdout)
    for words, said in zip(given.values(), refused, strict=True):
        assert words in said
    assert kept == {"source": "a ä", "tab": "test"}
