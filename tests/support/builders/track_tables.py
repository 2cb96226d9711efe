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


INTERACTION_HEAD = "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy,psi_rad,length,width"
WALKERS_HEAD = "track_id,frame_id,timestamp_ms,agent_type,x,y,vx,vy"


def interaction_row(k, x=10.0):
    """A car of INTERACTION's that drives 10 m/s along the x axis."""
    return f"1,{k},{100 * k},car,{x + k},0,10,0,0,4.2,1.9"


def interaction_files():
    """A car, and somebody on foot, with their lanes: texts by name."""
    cars = [interaction_row(k) for k in range(1, 9)]
    walkers = [f"P1,{k},{100 * k},pedestrian/bicycle,30,{k * 0.13},0,1.3" for k in range(1, 9)]
    return {
        "vehicle_tracks_007.csv": table(INTERACTION_HEAD, *cars),
        "pedestrian_tracks_007.csv": table(WALKERS_HEAD, *walkers),
        "lanes.csv": LANES,
    }


def interaction_cases():
    """A file of INTERACTION's with two cases."""
    rows = [f"{case}.0,{interaction_row(k, 10.0 * case)}" for case in (1, 2) for k in range(1, 5)]
    return table(f"case_id,{INTERACTION_HEAD}", *rows)


NGSIM_HEAD = (
    "Vehicle_ID,Frame_ID,Total_Frames,Global_Time,Local_X,Local_Y,Global_X,Global_Y,v_Length,"
    "v_Width,v_Class,v_Vel,v_Acc,Lane_ID,Preceding,Following,Space_Headway,Time_Headway"
)


def ngsim_row(k, vehicle=2):
    """A car of 14.3 feet whose front is 100 feet along the road, at 40 feet a second."""
    time = 1118846980200 + 100 * k
    return f"{vehicle},{13 + k},437,{time},6.0,{100 + 4 * k},0,0,14.3,6.4,2,40.0,0.0,1,0,0,0,0"


def omega_prime():
    """A bus at 10 m/s, and somebody who stands at 3 m beside its way, in OMEGA-PRIME's columns."""
    head = (
        "total_nanos,idx,x,y,z,vel_x,vel_y,vel_z,acc_x,acc_y,acc_z,length,width,height,roll,pitch,"
        "yaw,type,role,subtype"
    )
    bus = [
        f"{k * 33000000},0,{10 + k / 3},0,0,10,0,0,1,0,0,12,2.5,3,0,0,0,2,6,12" for k in range(9)
    ]
    walker = [f"{k * 33000000},1,20,3,0,0,0,0,0,0,0,.5,.5,2,0,0,1.5,3,-1,-1" for k in range(9)]
    return table(head, *bus, *walker)


EVERY_COLUMN_OF_LANES = table(
    "lane,x,y,width,limit_kmh,left_mark,right_mark,type,signs,successors,left_lane,"
    "junction,foes,first,stop_line,side",
    "a,0,0,3,50,broken,solid,urban busLane,stop,b c,d,,,,1,left",
    "a,50,0,5,,,,,,,,,,,,",
    *(f"{name},{x},0,3,,,,,,,,j,c,c,,left" for name in "bc" for x in (50, 60)),
    *(f"d,{x},4,3,,,,,,,,,,,,left" for x in (0, 50)),
)
"""Lanes with all that can be said: ``b`` and ``c`` lead on from ``a``, ``d`` is left of it."""
