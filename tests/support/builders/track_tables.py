"""Tables of tracks and lanes, and the files of data sets, written by hand."""

import numpy as np

HEAD = "track,t,x,y"
LANES = "lane,x,y\n" + "".join(
    f"{lane},{x},{y}\n" for lane, y in (("r", 0), ("l", 3.5)) for x in (0, 200)
)
"""Two lanes along the x axis, 3.5 m apart."""


def written(folder, tracks, lanes=LANES, name="cars.csv"):
    """The path of a table of tracks, with lanes beside it."""
    if lanes:
        (folder / "lanes.csv").write_text(lanes, encoding="utf-8")
    file = folder / name
    file.write_text(tracks, encoding="utf-8")
    return file


def table(head, *rows):
    return "\n".join([head, *rows]) + "\n"


def driving(track="a", speed=10.0, *, steps=11, step_s=0.1, start=20.0, y=0.0, more=""):
    """Rows of somebody who drives along the x axis; ``more`` cells end each."""
    return [
        f"{track},{k * step_s:.4f},{start + speed * k * step_s:.4f},{y}{more}" for k in range(steps)
    ]


HIGHD_HEAD = (
    "frame,id,x,y,width,height,xVelocity,yVelocity,xAcceleration,yAcceleration,frontSightDistance,"
    "backSightDistance,dhw,thw,ttc,precedingXVelocity,precedingId,followingId,laneId"
)
HIGHD_ABOUT = (
    "id,frameRate,locationId,speedLimit,upperLaneMarkings,lowerLaneMarkings\n"
    "1,25,2,{limit},8.51;12.59;16.43,21.00;24.96;28.80\n"
)


def highd(folder, bodies, limit=-1.0):
    """highD's three files; a body has its direction, x, y, speed, and steps (25 Hz)."""
    rows, meta = (
        [HIGHD_HEAD],
        ["id,width,height,initialFrame,finalFrame,numFrames,class,drivingDirection"],
    )
    for number, (way, x, y, speed, steps) in enumerate(bodies, 1):
        velocity = -speed if way == 1 else speed
        for k in range(steps):
            place = x + velocity * k / 25
            size, motion = "4.85,2.02", f"{velocity},0.0,0.0,0.0"
            rows.append(f"{k + 1},{number},{place:.3f},{y},{size},{motion},100,100,0,0,0,0,0,0,2")
        meta.append(f"{number},4.85,2.02,1,{steps},{steps},Car,{way}")
    (folder / "01_tracksMeta.csv").write_text("\n".join(meta) + "\n")
    (folder / "01_recordingMeta.csv").write_text(HIGHD_ABOUT.format(limit=limit))
    file = folder / "01_tracks.csv"
    file.write_text("\n".join(rows) + "\n")
    return file


IND_HEAD = (
    "recordingId,trackId,frame,trackLifetime,xCenter,yCenter,heading,width,length,xVelocity,"
    "yVelocity,xAcceleration,yAcceleration,lonVelocity,latVelocity,lonAcceleration,latAcceleration"
)


def ind(folder, bodies, origin=(0.0, 0.0)):
    """inD's three files; bodies have class, size, heading (°), place, speed, steps."""
    rows, meta = (
        [IND_HEAD],
        ["recordingId,trackId,initialFrame,finalFrame,numFrames,width,length,class"],
    )
    for number, (kind, (length, width), heading, (x, y), speed, steps) in enumerate(bodies):
        vx, vy = speed * np.cos(np.radians(heading)), speed * np.sin(np.radians(heading))
        rows += [
            f"0,{number},{k},{k},{x + vx * k / 25:.5f},{y + vy * k / 25:.5f},{heading},{width},"
            f"{length},{vx:.5f},{vy:.5f},0,0,{speed},0,0.5,0"
            for k in range(steps)
        ]
        meta.append(f"0,{number},0,{steps - 1},{steps},{width},{length},{kind}")
    (folder / "00_tracksMeta.csv").write_text("\n".join(meta) + "\n")
    (folder / "00_recordingMeta.csv").write_text(
        "recordingId,locationId,frameRate,speedLimit,weekday,startTime,duration,numTracks,"
        "numVehicles,numVRUs,latLocation,lonLocation,xUtmOrigin,yUtmOrigin,orthoPxToMeter\n"
        f"0,4,25.0,13.88889,tuesday,11,1.0,1,1,0,50.78,6.13,{origin[0]},{origin[1]},0.0126\n"
    )
    file = folder / "00_tracks.csv"
    file.write_text("\n".join(rows) + "\n")
    return file
