"""Reads a recording with the Python packages `mcap` and `mcap-ros2-support`, and with `rosbags`, and compares it with the
game's result.

Usage: mcap_check.py RECORDING [RESULT.json]; a gateway has no result.
"""

import io
import json
import sys
from pathlib import Path

from mcap.reader import NonSeekingReader, make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

FACTORIES = [DecoderFactory()]
# The message type that carries JSON.
TEXT = "std_msgs/msg/String"


def check(condition, what):
    if not condition:
        sys.exit(f"mcap_check: {what}")


def metadata_of(reader):
    return {record.name: record.metadata for record in reader.iter_metadata()}


def main(recording, result_path):
    data = open(recording, "rb").read()
    result = json.load(open(result_path, encoding="utf-8"))
    reader = make_reader(io.BytesIO(data), decoder_factories=FACTORIES)
    metadata = metadata_of(reader)
    check(metadata["squall"]["seed"] == str(result["seed"]), "the seed differs")
    check(metadata["result"]["digest"] == result["digest"], "the digest differs")
    scenario = json.loads(metadata["squall"]["scenario"])
    names = [vehicle["name"] for vehicle in scenario["vehicles"]]
    teams = [team["name"] for team in scenario["teams"]]

    # Every message on every topic, by the schemas in the file alone.
    counts, last, events, log_times = {}, None, 0, []
    for schema, channel, message, decoded in reader.iter_decoded_messages():
        counts[channel.topic] = counts.get(channel.topic, 0) + 1
        check(channel.message_encoding == "cdr", f"{channel.topic} is not CDR")
        check(schema.encoding == "ros2msg", f"{channel.topic} has a schema that is not a ROS 2 message")
        if schema.name == TEXT:
            is_object = isinstance(json.loads(decoded.data), dict)
            check(is_object, f"{channel.topic} has something other than an object")
            continue
        if channel.topic == "frame":
            check(len(decoded.vehicles) == len(names), "a frame has a different number of boats")
            check(decoded.stamp.version == 3, "a frame from a different version")
            last, events = decoded, events + len(decoded.events)
            log_times.append(message.log_time)
    check(last is not None and last.over, "the last frame is not the end of the game")
    check(log_times == sorted(log_times), "frames are not in order of time")
    score = dict(zip(teams, last.score))
    check(score == result["score"]["teams"], f"the score is {score}, not {result['score']['teams']}")
    check(events == len(result["events"]), f"{events} events, not {len(result['events'])}")
    check(abs(last.stamp.valid_ns * 1e-9 - result["duration_s"]) < 1e-6, "the game ends at a different time")
    check(log_times[-1] - log_times[0] == last.stamp.valid_ns, "log_time is not simulated time")
    summary = reader.get_summary()
    check(summary.statistics.message_count == sum(counts.values()), "the summary has different message counts")

    # A file truncated in the middle: the rest is readable.
    cut = NonSeekingReader(io.BytesIO(data[: len(data) // 2]), decoder_factories=FACTORIES)
    some = 0
    try:
        for _, channel, _, _ in cut.iter_decoded_messages(topics=["frame"], log_time_order=False):
            some += 1
    except Exception as end:  # noqa: BLE001: the package reports the end of the file, each version in its own words
        print(f"truncated in the middle, it ends with {type(end).__name__}")
    check(some > counts["frame"] // 4, f"of a file cut in half, only {some} of {counts['frame']} frames are left")

    # Read as a ROS 2 bag, without our code or the MCAP library.
    bag_counts, bag_score = {}, None
    with AnyReader([Path(recording)]) as bag:
        for connection, _, raw in bag.messages():
            said = bag.deserialize(raw, connection.msgtype)
            bag_counts[connection.topic] = bag_counts.get(connection.topic, 0) + 1
            if connection.topic == "frame":
                bag_score = dict(zip(teams, map(int, said.score)))
            elif connection.msgtype == TEXT:
                json.loads(said.data)
    check(bag_counts == counts, f"a bag of {bag_counts} messages, not {counts}")
    check(bag_score == score, f"in the bag the score is {bag_score}, not {score}")
    texts = sum(1 for channel in summary.channels.values() if summary.schemas[channel.schema_id].name == TEXT)
    check(texts > 0, "it contains no text")
    print(f"{recording}: {sum(counts.values())} messages on {len(counts)} topics agree; {some} frames in the first half")


def of_gateway(recording):
    """Checks a gateway's recording: both packages read the bytes of its link, and everything else is JSON."""
    data = open(recording, "rb").read()
    reader = make_reader(io.BytesIO(data), decoder_factories=FACTORIES)
    boat = metadata_of(reader)["gateway"]["vehicle"]
    counts, link = {}, {False: b"", True: b""}
    for schema, channel, _, decoded in reader.iter_decoded_messages(log_time_order=False):
        counts[channel.topic] = counts.get(channel.topic, 0) + 1
        if schema.name == TEXT:
            check(isinstance(json.loads(decoded.data), dict), f"{channel.topic} has something other than an object")
        else:
            check(channel.topic == f"link/{boat}", f"{channel.topic} is {schema.name}")
            link[decoded.outward] += bytes(decoded.data)
    check(b"$PSEAC" in link[True] and b"GGA" in link[False], "no sentences on the link")
    bag_counts = {}
    with AnyReader([Path(recording)]) as bag:
        for connection, _, raw in bag.messages():
            bag.deserialize(raw, connection.msgtype)
            bag_counts[connection.topic] = bag_counts.get(connection.topic, 0) + 1
    check(bag_counts == counts, f"a bag of {bag_counts} messages, not {counts}")
    print(f"{recording}: {sum(counts.values())} messages on {len(counts)} topics agree")


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) > 2 else of_gateway(sys.argv[1])
