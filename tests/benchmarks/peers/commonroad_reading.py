"""CommonRoad files read by commonroad-io. A job is a list of paths; the answer counts obstacles."""

import io
import json
import sys
import warnings
from contextlib import redirect_stderr, redirect_stdout

from commonroad.common.file_reader import CommonRoadFileReader
from serving import serve

files = json.loads(sys.stdin.readline())


def read():
    """What it says on the way would be taken for the answer."""
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scenes = [CommonRoadFileReader(file).open()[0] for file in files]
    return sum(len(scene.obstacles) for scene in scenes)


serve(read)
