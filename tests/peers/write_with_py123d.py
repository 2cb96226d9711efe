"""Writes a sensor log of Argoverse 2 as a log and a map of 123D, with py123d's own parsers.

Arguments: the log's folder, with `annotations.feather`, and a folder for what is written. Standard
output: JSON lines of what py123d reads in it: boxes (track, moment in µs, x, y, heading, length,
width), ego's middle, and lanes.
"""

import json
import sys
from pathlib import Path

from py123d.api.map.arrow.arrow_map_api import ArrowMapAPI
from py123d.api.map.arrow.arrow_map_writer import ArrowMapWriter
from py123d.api.scene.arrow.arrow_log_writer import ArrowLogWriter, SyncConfig
from py123d.api.scene.arrow.utils.log_writer_config import LogWriterConfig
from py123d.datatypes.map_objects.map_layer_types import MapLayer
from py123d.parser.av2.av2_map_parser import Av2MapParser
from py123d.parser.av2.av2_sensor_parser import Av2SensorLogParser
from py123d.parser.av2.utils import av2_constants as known

SPLIT = "av2-sensor_val"


def say(*row):
    sys.stdout.write(json.dumps(row) + "\n")


def main(log, out):
    source, logs = Path(log), Path(out) / "logs"
    parser = Av2SensorLogParser(source, SPLIT, "nearest")
    sync = SyncConfig("box_detections_se3.timestamp_us")
    writer = ArrowLogWriter(LogWriterConfig(), logs, Path(out) / "sensors", sync_config=sync)
    writer.reset(parser.get_log_metadata())
    for state in parser._iter_ego_states_se3(known.AV2_SENSOR_EGO_STATE_SE3_METADATA):
        writer.write_async(state)
        centre = state.center_se3
        say("ego", state.timestamp.time_us, centre.x, centre.y, centre.yaw)
    for boxes in parser._iter_box_detections_se3(known.AV2_SENSOR_BOX_DETECTIONS_SE3_METADATA):
        writer.write_async(boxes)
        for one in boxes:
            box, pose = one.bounding_box_se3, one.bounding_box_se3.center_se3
            name, moment = one.attributes.track_token, boxes.timestamp.time_us
            say("box", name, moment, pose.x, pose.y, pose.yaw, box.length, box.width)
    writer.close()
    maps = Av2MapParser(source, SPLIT)
    map_writer = ArrowMapWriter(True, Path(out) / "maps", logs)
    map_writer.reset(maps.get_map_metadata())
    for thing in maps.iter_map_objects():
        map_writer.write_map_object(thing)
    map_writer.close()
    api = ArrowMapAPI(logs / SPLIT / source.name / "map.arrow")
    for lane in api.get_all_map_objects_in_layer(MapLayer.LANE):
        bounds = [x.array[:, :2].tolist() for x in (lane.left_boundary, lane.right_boundary)]
        say("lane", str(lane.object_id), [str(x) for x in lane.successor_ids], *bounds)


main(*sys.argv[1:])
