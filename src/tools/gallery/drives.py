"""The drives of the gallery: what one sees in each, and how it is drawn."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class OwnFile:
    """A file of the checkout.

    Attributes:
        about: where its traffic comes from, in a sentence.
        net: SUMO's net, if it has no roads.
    """

    path: str
    about: str
    net: str = ""


@dataclass(frozen=True)
class Recorded:
    """A recording of others, in a public repository at one commit.

    Attributes:
        about: who recorded it, in a few words.
        licence: the SPDX identifier of the repository's licence.
        sha256: of the file's bytes.
    """

    repository: str
    commit: str
    path: str
    about: str
    licence: str
    sha256: str

    @property
    def name(self) -> str:
        """The file's name."""
        return self.path.rpartition("/")[2]


@dataclass(frozen=True)
class GalleryDrive:
    """A drive, and the violation that one sees in it.

    Attributes:
        name: of its files in the gallery.
        data: the recording.
        assumed: values of words that the recording does not contain, as ``word=value``.
    """

    name: str
    title: str
    sees: str
    data: OwnFile | Recorded
    book: str
    ego: str
    rule: str
    assumed: tuple[str, ...] = ()


def _simulated(world: str) -> OwnFile:
    """One of the simulated worlds that the tests judge."""
    files = f"tests/worlds/stored/{world}"
    about = "Simulated by Eclipse SUMO, with drivers who were told to break the law."
    return OwnFile(f"{files}.fcd.xml.gz", about, f"{files}.net.xml")


_US_101 = Recorded(
    repository="CommonRoad/commonroad-reachable-set",
    commit="5140770c8a7380a62067eaf3cfaf1fe36eb1da5d",
    path="scenarios/USA_US101-24_2_T-1.xml",
    about="recorded by NGSIM (US Department of Transportation), as a scenario of CommonRoad",
    licence="BSD-3-Clause",
    sha256="9230284ae5f5759cfe30ec024e3410a3ea11fa481864d3e7c6c9bae66b6207b3",
)
_CUT_IN = Recorded(
    repository="ika-rwth-aachen/omega-prime",
    commit="742aebd2f377c72644108a327db7f812debed6cc",
    path="example_files/alks_cut-in.osi",
    about="simulated, an example of Omega-Prime",
    licence="MPL-2.0",
    sha256="11a5de14ff210116e363446139e76e64349b4246f8d4d95be1139e35c669c5f9",
)

OWN = (
    GalleryDrive(
        name="zebra_crossing",
        title="Someone on a zebra crossing",
        sees="The car does not stop, although someone is walking on the crossing in front of it.",
        data=_simulated("zebra"),
        book="de",
        ego="pedestrian_breaker.2",
        rule="give_way_to_pedestrians",
    ),
    GalleryDrive(
        name="following",
        title="Too close behind a truck",
        sees="The car closes up on a truck until it could not stop any more if the truck braked.",
        data=OwnFile("docs/samples/following.xml", "Made by hand."),
        book="de",
        ego="1",
        rule="following_distance",
    ),
    GalleryDrive(
        name="stop_sign",
        title="A stop sign where traffic keeps left",
        sees="In Britain, the car turns into the main road without stopping at its stop sign.",
        data=_simulated("stop_signs_left"),
        book="gb",
        ego="priority_breaker.1",
        rule="stop_sign",
    ),
    GalleryDrive(
        name="red_light",
        title="A red light where traffic keeps left",
        sees="In Britain, the car crosses the line of a junction whose light is red for it.",
        data=_simulated("spider_left"),
        book="gb",
        ego="red_runner.1",
        rule="red_light",
    ),
    GalleryDrive(
        name="main_road",
        title="Into the main road, and left across it",
        sees="In France, the car gives way neither to the main road nor to who comes towards it.",
        data=_simulated("priority"),
        book="fr",
        ego="priority_breaker.5",
        rule="*",
    ),
    GalleryDrive(
        name="from_the_right",
        title="A junction without signs",
        sees="The car goes first, although another one comes from its right.",
        data=_simulated("right_before_left"),
        book="de",
        ego="priority_breaker.13",
        rule="junction_priority",
    ),
    GalleryDrive(
        name="all_way_stop",
        title="A stop sign on every road",
        sees="In California, the car turns at the junction without stopping.",
        data=_simulated("all_way_stop"),
        book="us-ca",
        ego="priority_breaker.0",
        rule="stop_sign",
    ),
    GalleryDrive(
        name="roundabout",
        title="Into a roundabout",
        sees="The car enters the roundabout in the way of one that is on it.",
        data=_simulated("roundabout"),
        book="de",
        ego="priority_breaker.4",
        rule="roundabout_priority",
    ),
    GalleryDrive(
        name="motorway",
        title="Past the right side of a slow driver",
        sees="The driver ahead stays in the left lane, so the car overtakes in the right one.",
        data=_simulated("motorway"),
        book="de",
        ego="right_overtaker.4",
        rule="near_side_passing",
    ),
)
"""Drives from the files of the checkout."""

OF_OTHERS = (
    GalleryDrive(
        name="highway_passing",
        title="A recorded highway, by another country's law",
        sees="On US 101 in Los Angeles the car overtakes on the right, as German law forbids.",
        data=_US_101,
        book="de",
        ego="67",
        rule="near_side_passing",
        assumed=("road_class=motorway", "lane_kind=through_lane"),
    ),
    GalleryDrive(
        name="highway_following",
        title="Dense traffic on the same highway",
        sees="By Californian law, the car is too close behind the one ahead for its speed.",
        data=_US_101,
        book="us-ca",
        ego="34",
        rule="following_distance",
    ),
    GalleryDrive(
        name="cut_in",
        title="A cut-in",
        sees="The car moves into the lane of another one, right in front of it; no automated lane"
        " keeping system may do so.",
        data=_CUT_IN,
        book="un-r157",
        ego="1",
        rule="lane_keeping",
        assumed=("road_class=motorway",),
    ),
)
"""Drives from recordings of others, which are not part of this project."""
