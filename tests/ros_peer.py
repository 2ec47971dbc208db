"""The ROS 2 bridge against zenoh-ros2-sdk and rosbags, which implement ROS 2's types and rmw_zenoh's keys without ROS 2.

    ros_peer.py PATH/OF/squall

Plays a game in real time, exposes it to ROS 2, and acts as the other side: lists topics, receives, drives a boat, calls
services, sends invalid messages, stalls, and kills the bridge. Exits with an error at the first failed check.
"""

import json
import math
import os
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import zenoh
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from zenoh_ros2_sdk import ROS2Publisher, ROS2ServiceClient, ROS2Subscriber, get_topic_names_and_types
from zenoh_ros2_sdk.discovery import _query_liveliness
from zenoh_ros2_sdk.session import ZenohSession
from zenoh_ros2_sdk.utils import compute_service_type_hash, compute_type_hash_from_msg

LIMIT_S = 30.0
GAME = "ros_peer"
BOATS = ["blue_1", "blue_2", "red_1", "red_2"]
ODOM, FIX, IMU = "nav_msgs/msg/Odometry", "sensor_msgs/msg/NavSatFix", "sensor_msgs/msg/Imu"
MOTION = {"odom": ODOM, "fix": FIX, "imu": IMU, "velocity": "geometry_msgs/msg/TwistStamped"}
TOPICS = {
    "/clock": "rosgraph_msgs/msg/Clock",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/squall/field": "visualization_msgs/msg/MarkerArray",
    "/squall/markers": "visualization_msgs/msg/MarkerArray",
    "/squall/frame": "squall_msgs/msg/Frame",
    "/squall/blue/picture": "squall_msgs/msg/Picture",
    "/blue_1/cmd_vel": "geometry_msgs/msg/Twist",
    "/blue_1/order": "squall_msgs/msg/VehicleOrder",
    **{f"/blue_1/{name}": kind for name, kind in MOTION.items()},
    **{f"/{boat}/truth/{name}": kind for boat in BOATS for name, kind in MOTION.items()},
}
SET_BOOL, TRIGGER, RESET = "std_srvs/srv/SetBool", "std_srvs/srv/Trigger", "squall_msgs/srv/Reset"
SERVICES = {"e_stop": SET_BOOL, "halt": SET_BOOL, "pause": SET_BOOL, "step": TRIGGER, "end": TRIGGER, "reset": RESET}
DONE = "bool success\nstring message"
REQUESTS = {SET_BOOL: "bool data", TRIGGER: "uint8 structure_needs_at_least_one_member"}


def free_port():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


def wait_for(what, holds, limit_s=LIMIT_S):
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        found = holds()
        if found:
            return found
        time.sleep(0.02)
    raise SystemExit(f"{what}: not within {limit_s} s")


def check(what, holds):
    if not holds:
        raise SystemExit(f"wrong: {what}")
    print(f"  {what}", flush=True)


class Types:
    """Definitions from rosbags, and those that `squall ros messages` wrote."""

    def __init__(self, folder):
        self.store = get_typestore(Stores.ROS2_JAZZY)
        for file in sorted(Path(folder, "msg").glob("*.msg")):
            self.store.register(get_types_from_msg(file.read_text(), f"squall_msgs/msg/{file.stem}"))

    def parts(self, name):
        """The definitions of a type and of all nested ones, by name, nested ones first."""
        text, _ = self.store.generate_msgdef(name, ros_version=2)
        first, *others = text.split("=" * 80 + "\nMSG: ")
        nested = {part.split("\n", 1)[0].replace("/", "/msg/"): part.split("\n", 1)[1] for part in others}
        return {**dict(reversed(nested.items())), name: first}

    def hashes(self, name):
        """The type's hash by rosbags, and by the SDK."""
        parts = self.parts(name)
        return self.store.hash_rihs01(name), compute_type_hash_from_msg(name, parts[name], parts)


class Inbox:
    """The messages of one topic, received by the SDK."""

    def __init__(self, types, port, topic, name):
        self.messages = []
        session = ZenohSession.get_instance("127.0.0.1", port)
        register(session, types, name)
        self.peer = ROS2Subscriber(
            topic, name, self.messages.append, msg_definition=types.parts(name)[name],
            router_port=port, type_hash=types.hashes(name)[1],
        )

    def next(self, holds=lambda _: True, limit_s=LIMIT_S):
        count = len(self.messages)
        newest = lambda: next((m for m in self.messages[count:] if holds(m)), None)  # noqa: E731
        return wait_for("a message", newest, limit_s)


def register(session, types, name):
    pending = dict(types.parts(name))
    while pending:  # a type can be registered once all nested in it are
        before = len(pending)
        for part, text in list(pending.items()):
            try:
                session.register_message_type(text, part)
                del pending[part]
            except (RuntimeError, KeyError):
                continue
        if len(pending) == before:
            raise SystemExit(f"{name}: cannot register {list(pending)}")


def call(port, service, kind, **request):
    hash_of = compute_service_type_hash(kind, REQUESTS[kind], DONE)
    client = ROS2ServiceClient(
        f"/squall/{service}", kind, REQUESTS[kind], DONE, router_port=port, type_hash=hash_of, timeout=5.0
    )
    answer = client.call(**request)
    client.close()
    return answer


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


def yaw(orientation):
    return 2.0 * math.atan2(orientation.z, orientation.w)


def types_and_graph(types, port):
    print("types and graph")
    found = wait_for("all topics", lambda: (t := dict(get_topic_names_and_types(router_port=port))) and len(t) >= len(TOPICS) and t)
    check(f"the topic list has all {len(TOPICS)} topics with their types",
          found == {topic: [kind] for topic, kind in TOPICS.items()})
    session = ZenohSession.get_instance("127.0.0.1", port)
    tokens = [token for kind in ("MP", "MS") for token in _query_liveliness(session, 0, kind, 1.0)]
    own = {token["qualified_name"]: token["type_hash"] for token in tokens}
    different = {t: (own[t], types.hashes(kind)) for t, kind in TOPICS.items() if {own[t]} != set(types.hashes(kind))}
    check(f"the hashes of {len(set(TOPICS.values()))} types are those of rosbags and the SDK: {different}", not different)
    tokens = {token["qualified_name"]: token for token in _query_liveliness(session, 0, "SS", 1.0)}
    for name, kind in SERVICES.items():
        want = compute_service_type_hash(kind, REQUESTS[kind], DONE)
        check(f"the service {name} has the hash of the SDK", tokens[f"/squall/{name}"]["type_hash"] == want)


def motion(inboxes):
    print("motion")
    clock = inboxes["/clock"]
    first, start = seconds(clock.next().clock), time.monotonic()
    time.sleep(3.0)  # a loaded machine catches up in bursts
    rate = (seconds(clock.next().clock) - first) / (time.monotonic() - start)
    check(f"/clock runs at {rate:.3f} game seconds a second", abs(rate - 1.0) < 0.3)
    odom, truth = inboxes["/blue_1/odom"].next(), inboxes["/blue_1/truth/odom"].next()
    apart = math.dist([odom.pose.pose.position.x, odom.pose.pose.position.y],
                      [truth.pose.pose.position.x, truth.pose.pose.position.y])
    check(f"measured and true position are {apart:.2f} m apart, not equal", 0.0 < apart < 15.0)
    check("frames are map and blue_1/base_link", (odom.header.frame_id, odom.child_frame_id) == ("map", "blue_1/base_link"))
    fix = inboxes["/blue_1/truth/fix"].next()
    same = inboxes["/blue_1/truth/odom"].messages
    truth = next(m for m in reversed(same) if m.header.stamp == fix.header.stamp)
    east, north = truth.pose.pose.position.x, truth.pose.pose.position.y
    frame = datum()
    lat = frame[0] + math.degrees(north / frame[2])
    lon = frame[1] + math.degrees(east / (frame[3] * math.cos(math.radians(frame[0]))))
    error_m = math.hypot((fix.latitude - lat) * 111_000, (fix.longitude - lon) * 111_000 * math.cos(math.radians(lat)))
    check(f"the fix is {error_m * 1000:.1f} mm from the true position on the ellipsoid", error_m < 0.02)
    imu = inboxes["/blue_1/imu"].next()
    check(f"gravity is felt upwards: {imu.linear_acceleration.z:.2f} m/s2", 8.0 < imu.linear_acceleration.z < 11.5)


def datum():
    """Latitude, longitude and the ellipsoid's radii of curvature at the datum of the field."""
    lat_deg, lon_deg = DATUM
    e2, equator_m, sine = 6.694379990e-3, 6378137.0, math.sin(math.radians(lat_deg))
    return lat_deg, lon_deg, equator_m * (1 - e2) / (1 - e2 * sine**2) ** 1.5, equator_m / math.sqrt(1 - e2 * sine**2)


def drive(publisher, classes, x, z, time_s):
    twist, vector = classes
    for _ in range(int(time_s * 20)):
        publisher.publish(linear=vector(x=x, y=0.0, z=0.0), angular=vector(x=0.0, y=0.0, z=z))
        time.sleep(0.05)


# Topics with a yaw rate, which is positive anticlockwise.
YAW_RATES = {
    "/blue_1/truth/odom": lambda message: message.twist.twist.angular.z,
    "/blue_1/truth/velocity": lambda message: message.twist.angular.z,
    "/blue_1/imu": lambda message: message.angular_velocity.z,
}


def driving(publisher, classes, inboxes):
    print("driving")
    truth = inboxes["/blue_1/truth/odom"]
    drive(publisher, classes, 1.0, 0.0, 6.0)
    check(f"linear.x 1.0 m/s makes {truth.next().twist.twist.linear.x:.2f} m/s",
          abs(truth.messages[-1].twist.twist.linear.x - 1.0) < 0.25)
    for rate in (0.15, -0.15):
        drive(publisher, classes, 1.0, rate, 3.0)
        counts = {topic: len(inboxes[topic].messages) for topic in YAW_RATES}
        drive(publisher, classes, 1.0, rate, 5.0)
        begin = counts["/blue_1/truth/odom"]
        first, last = truth.messages[begin], truth.messages[-1]
        turned = sum(math.remainder(yaw(b.pose.pose.orientation) - yaw(a.pose.pose.orientation), 2 * math.pi)
                     for a, b in zip(truth.messages[begin:-1], truth.messages[begin + 1:]))
        got = turned / (seconds(last.header.stamp) - seconds(first.header.stamp))
        check(f"angular.z {rate} rad/s makes {got:.3f} rad/s anticlockwise", abs(got - rate) < 0.06)
        for topic, read in YAW_RATES.items():
            mean = statistics.mean(map(read, inboxes[topic].messages[counts[topic]:]))
            check(f"{topic} measures {mean:.3f} rad/s", abs(mean - got) < 0.02)
    drive(publisher, classes, 1.5, 0.0, 4.0)
    before, ended = truth.next().twist.twist.linear.x, time.monotonic()
    wait_for("the boat holds after the last twist", lambda: truth.next().twist.twist.linear.x < 0.5 * before, 8.0)
    check(f"without a twist the boat slows to half of {before:.2f} m/s in {time.monotonic() - ended:.1f} s", before > 0.8)


def services(port, inboxes):
    print("services")
    clock = inboxes["/clock"]
    check("pause answers", call(port, "pause", SET_BOOL, data=True).success)
    time.sleep(0.5)
    count = len(clock.messages)
    time.sleep(1.0)
    check("/clock stands still", len(clock.messages) == count)
    check("step answers", call(port, "step", TRIGGER, structure_needs_at_least_one_member=0).success)
    wait_for("one decision", lambda: len(clock.messages) > count, 3.0)
    time.sleep(0.5)
    check(f"a step is one decision: {len(clock.messages) - count}", len(clock.messages) == count + 1)
    check("resume answers", call(port, "pause", SET_BOOL, data=False).success)
    clock.next()
    check("the E-stop answers", call(port, "e_stop", SET_BOOL, data=True).success)
    inboxes["/squall/frame"].next(lambda frame: frame.stopped)
    check("its release answers", call(port, "e_stop", SET_BOOL, data=False).success)
    inboxes["/squall/frame"].next(lambda frame: not frame.stopped)
    count = len(clock.messages)
    check("reset answers", call(port, "reset", RESET, seed=7).success)
    times = wait_for("a game from zero on", lambda: (t := [seconds(m.clock) for m in clock.messages[count:]]) and 0.0 in t and t[-1] > 2.0 and t)
    check(f"after the reset, /clock runs from zero to {times[-1]:.1f} s", times[-1] < 10.0)


def nonsense(types, port, publisher, classes, inboxes):
    print("nonsense")
    session = ZenohSession.get_instance("127.0.0.1", port).session
    for bytes_ in (b"", b"ahoy", b"\0\1\0\0", bytes(1000), b"\0\1\0\0" + bytes(40)):
        session.put(publisher.keyexpr, bytes_)
    drive(publisher, classes, math.nan, 0.0, 0.2)
    drive(publisher, classes, -1.0, 0.0, 0.2)
    refused = inboxes["/diagnostics"].next(lambda d: "malformed" in d.status[0].message, 5.0).status[0]
    check(f"counted: {refused.message}", "5 x malformed" in refused.message and "number out of range" in refused.message)
    for service in SERVICES:
        key = next(t for t in _query_liveliness(ZenohSession.get_instance(), 0, "SS", 1.0) if t["qualified_name"].endswith(service))
        selector = f"0/squall/{service}/{key['dds_type']}/{key['type_hash']}"
        check(f"{service} does not reply to a request without an attachment",
              not [r for r in session.get(selector, payload=b"junk", timeout=0.3) if r.ok])


# Bare zenoh with as many links: a router that only forwards.
RELAY = """
import sys, time, zenoh
config = zenoh.Config()
for key, value in [("mode", '"router"'), ("scouting/multicast/enabled", "false"),
                   ("connect/endpoints", f'["{sys.argv[1]}"]'), ("listen/endpoints", f'["{sys.argv[2]}"]')]:
    config.insert_json5(key, value)
session = zenoh.open(config)
print("ready", flush=True)
time.sleep(600)
"""
# Receives frames at the sim, behind the bridge and behind the relay, in a process that decodes nothing. Prints for
# several periods how much later each frame arrived at each of them than at the sim, in ms.
RECEIVER = """
import json, os, sys, time, zenoh
arrived = [{}, {}, {}]
def receive(i, endpoint, key):
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["{endpoint}"]')
    session = zenoh.open(config)
    note = lambda sample: arrived[i].setdefault(sample.payload.to_bytes()[4:20], time.perf_counter())
    return session, session.declare_subscriber(key, note)
subscribed = [receive(i, *pair) for i, pair in enumerate(zip(sys.argv[1::2], sys.argv[2::2]))]
time.sleep(0.5)
for _ in range(6):
    [frames.clear() for frames in arrived]
    time.sleep(4.0)
    frames = list(arrived[0].items())[1:-1]
    print(json.dumps([[1e3 * (there[key] - at) for key, at in frames if key in there] for there in arrived]), flush=True)
os._exit(0)
"""


def latency(port, squall_port):
    """The delay that the bridge adds to a frame, beside that of a bare relay."""
    print("latency")
    sim, bridge, relay = (f"tcp/127.0.0.1:{number}" for number in (squall_port, port, free_port()))
    with subprocess.Popen([sys.executable, "-c", RELAY, sim, relay], stdout=subprocess.PIPE, text=True) as forwarder:
        forwarder.stdout.readline()
        frame, ros_frame = f"squall/{GAME}/frame", "0/squall/frame/squall_msgs::msg::dds_::Frame_/*"
        ends = [sim, frame, bridge, ros_frame, relay, frame]
        lines = subprocess.run([sys.executable, "-c", RECEIVER, *ends], stdout=subprocess.PIPE, text=True, check=True).stdout
        forwarder.kill()
    windows = [json.loads(line) for line in lines.splitlines()]
    check("no frame is lost", all(len(frames) == len(there) for frames, *others in windows for there in others))
    p99 = lambda times: sorted(times)[int(0.99 * len(times))]  # noqa: E731
    for i, name in ((1, "the bridge"), (2, "a bare relay")):
        shown = ", ".join(f"{statistics.median(window[i]):.3f} and {p99(window[i]):.3f}" for window in windows)
        print(f"  behind {name}, p50 and p99 in ms: {shown}")
    added_ms = min(p99(window[1]) for window in windows) - min(p99(window[2]) for window in windows)
    # The goal is 1 ms. A busy machine adds several, so that only a stall is an error.
    check(f"the bridge adds {added_ms:.3f} ms to bare zenoh, p99", added_ms <= 20.0)


def bag(types, port, folder):
    """Records live topics as a bag, and reads it."""
    print("bag")
    path, seen, lock = Path(folder) / "bag", {}, threading.Lock()
    session = ZenohSession.get_instance("127.0.0.1", port).session
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {f"0{topic}": writer.add_connection(topic, kind, typestore=types.store) for topic, kind in TOPICS.items()}

        def record(sample):
            topic = str(sample.key_expr).rsplit("/", 2)[0]
            with lock:
                seen[topic] = seen.get(topic, 0) + 1
                writer.write(connections[topic], time.time_ns(), sample.payload.to_bytes())

        subscriber = session.declare_subscriber("0/**", record)
        time.sleep(3.0)
        subscriber.undeclare()
        time.sleep(0.2)
    with AnyReader([path], default_typestore=types.store) as reader:
        read = [reader.deserialize(raw, connection.msgtype) for connection, _, raw in reader.messages()]
    check(f"a bag of {len(seen)} live topics opens, with {len(read)} messages", len(read) == sum(seen.values()) and len(seen) >= 20)


def stalled(port, squall_port):
    """A ROS 2 node that does not read, and then a bridge that dies."""
    print("stalled and killed")
    code = ("import zenoh, time\nc = zenoh.Config()\nc.insert_json5('mode', '\"client\"')\n"
            f"c.insert_json5('connect/endpoints', '[\"tcp/127.0.0.1:{port}\"]')\n"
            "s = zenoh.open(c)\nd = s.declare_subscriber('0/**', lambda _: None)\nprint('ready', flush=True)\ntime.sleep(600)")
    peer = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    peer.stdout.readline()
    peer.send_signal(signal.SIGSTOP)
    try:
        return rate_of_frames(squall_port)
    finally:
        peer.kill()
        peer.wait()


def rate_of_frames(squall_port, time_s=8.0):
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", f'["tcp/127.0.0.1:{squall_port}"]')
    times = []
    with zenoh.open(config) as bare:
        subscriber = bare.declare_subscriber(f"squall/{GAME}/frame", lambda _: times.append(time.perf_counter()))
        time.sleep(time_s)
        subscriber.undeclare()
    gap_ms = 1e3 * max(b - a for a, b in zip(times, times[1:]))
    return len(times) / time_s, gap_ms


def play(squall, folder, children):
    port, squall_port = free_port(), free_port()
    environment = {**os.environ, "XDG_RUNTIME_DIR": folder, "ROS_DOMAIN_ID": ""}

    def start(*args):
        log = open(Path(folder) / f"{len(children)}.log", "w")
        child = subprocess.Popen([squall, *args], cwd=folder, env=environment, stdout=log, stderr=log)
        children.append(child)
        return child

    subprocess.run([squall, "ros", "messages", "squall_msgs"], cwd=folder, check=True)
    types = Types(Path(folder) / "squall_msgs")
    request, answer = (Path(folder) / "squall_msgs/srv/Reset.srv").read_text().split("\n---\n")
    REQUESTS[RESET] = request
    check("a reset answers like other services", answer.strip() == DONE)
    start("sim", "surveyor_2v2", "--pace", "realtime", "--game", GAME, "--listen", f"tcp/127.0.0.1:{squall_port}", *QUIET)
    where = ["--game", GAME, "--connect", f"tcp/127.0.0.1:{squall_port}"]
    bridge = start("ros", "bridge", "--vehicle", "blue_1", "--operator", "--router", f"tcp/127.0.0.1:{port}", *where)
    start("agent", "--vehicle", *BOATS[1:], *where)
    wait_for("the bridge's router", lambda: is_open(port))
    types_and_graph(types, port)
    wanted = ["/clock", "/blue_1/odom", "/blue_1/truth/odom", "/blue_1/truth/velocity", "/blue_1/truth/fix", "/blue_1/imu", "/squall/frame",
              "/diagnostics"]
    inboxes = {topic: Inbox(types, port, topic, TOPICS[topic]) for topic in wanted}
    motion(inboxes)
    session = ZenohSession.get_instance("127.0.0.1", port)
    twist = "geometry_msgs/msg/Twist"
    register(session, types, twist)
    publisher = ROS2Publisher("/blue_1/cmd_vel", twist, types.parts(twist)[twist], router_port=port,
                              type_hash=types.hashes(twist)[1])
    classes = [session.store.types[name] for name in (twist, "geometry_msgs/msg/Vector3")]
    time.sleep(0.5)
    services(port, inboxes)
    nonsense(types, port, publisher, classes, inboxes)
    latency(port, squall_port)
    bag(types, port, folder)
    driving(publisher, classes, inboxes)
    rate, gap_ms = stalled(port, squall_port)
    check(f"with a stalled ROS 2 node the sim sends {rate:.1f} frames a second, at most {gap_ms:.0f} ms apart", gap_ms < 1500)
    bridge.kill()
    rate, gap_ms = rate_of_frames(squall_port)
    check(f"without the bridge the sim sends {rate:.1f} frames a second, at most {gap_ms:.0f} ms apart", gap_ms < 1500)


def is_open(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


# The field of surveyor_2v2, and its game without wind and waves, in which numbers can be predicted.
DATUM = (41.35480, -74.0551)
QUIET = ["--sea", "calm", "--blue", "idle", "--red", "idle"]


def main():
    squall = os.path.abspath(sys.argv[1])
    children = []
    with tempfile.TemporaryDirectory() as folder:
        try:
            play(squall, folder, children)
        except BaseException:
            for log in sorted(Path(folder).glob("*.log")):
                print(f"--- {log.name}\n{log.read_text()[-2000:]}")
            raise
        finally:
            for child in children:
                child.kill()
                child.wait()
    print("all ok")
    os._exit(0)  # the SDK's session would wait for a router that is gone


if __name__ == "__main__":
    main()
