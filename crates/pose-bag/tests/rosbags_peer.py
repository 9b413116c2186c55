#!/usr/bin/env python3
"""The independent peer of crate pose-bag: PyPI rosbags 0.11.9 (and mcap-ros2-support, as --reader mcap).

  rosbags_peer.py read BAG [--reader rosbags|mcap]         what is in the bag, as JSON (floats as Python repr)
  rosbags_peer.py dump BAG [--reader rosbags|mcap]         every message, a JSON line each, by topic and time
  rosbags_peer.py write BAG [--storage S] [--compression C]   the bag that tests/rosbags_fixture.rs expects
  rosbags_peer.py every BAG [--storage S] [--compression C]   a bag with messages of every type that pose-bag reads

S is mcap or sqlite3; C is none, storage (chunks of MCAP by zstd), message or file. `write` made tests/data/rosbags_*. `read` and
`dump` decode with the message definitions inside the bag.
"""

import argparse
import dataclasses
import json
from pathlib import Path

import numpy as np

START_NS = 1_700_000_000_000_000_000


def plain(value):
    """A message as nested dictionaries, whichever library made its class."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple, bytes)):
        return [plain(item) for item in value]
    if dataclasses.is_dataclass(value):
        # rosbags counts constants, which are in capitals, among the fields.
        names = [f.name for f in dataclasses.fields(value) if f.name != "__msgtype__" and not f.name.isupper()]
        return {name: plain(getattr(value, name)) for name in names}
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    return value


def rosbags_messages(bag):
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    jazzy = get_typestore(Stores.ROS2_JAZZY)
    with AnyReader([bag]) as reader:
        for connection in reader.connections:
            # A bare MCAP file has no metadata.yaml, which alone carries the hashes.
            assert connection.digest in ("", jazzy.hash_rihs01(connection.msgtype)), connection.digest
        for connection, time_ns, data in reader.messages():
            yield connection.topic, connection.msgtype, time_ns, plain(reader.deserialize(data, connection.msgtype))


def mcap_messages(bag):
    from mcap_ros2.reader import read_ros2_messages

    for path in sorted(bag.glob("*.mcap")) if bag.is_dir() else [bag]:
        for message in read_ros2_messages(path):
            yield message.channel.topic, message.schema.name, message.log_time_ns, plain(message.ros_msg)


def elements(message):
    """The poses, points or texts that a message consists of."""
    for field in ("poses", "points"):
        if field in message:
            return message[field]
    return [message]


def read(bag, reader):
    topics = {}
    for topic, message_type, time_ns, message in (rosbags_messages if reader == "rosbags" else mcap_messages)(bag):
        entry = topics.setdefault(topic, {"type": message_type, "count": 0, "elements": 0, "start_ns": time_ns})
        found = elements(message)
        entry["count"] += 1
        entry["elements"] += len(found)
        entry["end_ns"] = time_ns
        if "header" in message:
            entry["frame_id"] = message["header"]["frame_id"]
        if found:
            entry.setdefault("first", found[0])
            entry["last"] = found[-1]
    print(json.dumps({"topics": topics}, indent=1, sort_keys=True))


def dump(bag, reader):
    lines = []
    for topic, message_type, time_ns, message in (rosbags_messages if reader == "rosbags" else mcap_messages)(bag):
        lines.append((topic, time_ns, json.dumps({"topic": topic, "type": message_type, "time_ns": time_ns, "message": message})))
    for _, _, line in sorted(lines, key=lambda line: line[:2]):
        print(line)


def writer_of(bag, storage, compression):
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    writer = Writer(bag, version=9, storage_plugin=StoragePlugin[storage.upper()])
    if compression != "none":
        writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
    return writer


def filled(store, message_type, seed):
    """A message in which no two numbers are equal, with `seed` elements in every sequence."""
    from rosbags.interfaces import Nodetype

    counter = [1000 * seed]

    def value(node):
        kind, detail = node
        if kind == Nodetype.NAME:
            return message(detail)
        if kind == Nodetype.BASE:
            counter[0] += 1
            base = detail[0]
            if base == "string":
                return "text " + "x" * (counter[0] % 5)
            if base == "bool":
                return counter[0] % 2 == 1
            if base.startswith("float"):
                return float(np.float32(1.0 / counter[0])) if base == "float32" else 1.0 / counter[0]
            return counter[0] % 100
        element, length = detail
        length = length if kind == Nodetype.ARRAY else seed
        values = [value(element) for _ in range(length)]
        if element[0] == Nodetype.BASE and element[1][0] not in ("string",):
            base = element[1][0]
            return np.array(values, dtype={"bool": np.bool_}.get(base, base))
        return values

    def message(name):
        if name == "geometry_msgs/msg/Quaternion":
            # 2² + 4² + 5² + 6² = 9²
            counter[0] += 1
            return store.types[name](*[(2 / 9, 4 / 9, 5 / 9, 6 / 9)[(i + counter[0]) % 4] for i in range(4)])
        return store.types[name](**{field: value(node) for field, node in store.get_msgdef(name).fields})

    return message(message_type)


EVERY_TYPE = [
    "geometry_msgs/msg/PoseArray", "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped",
    "nav_msgs/msg/Odometry", "nav_msgs/msg/Path", "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/JointState",
    "trajectory_msgs/msg/JointTrajectory", "visualization_msgs/msg/MarkerArray", "std_msgs/msg/String",
]
MESSAGES_OF_EACH = 7


def every(bag, storage, compression):
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    with writer_of(bag, storage, compression) as writer:
        topics = [(name, writer.add_connection(f"/{name.split('/')[2]}", name, typestore=store)) for name in EVERY_TYPE]
        for k in range(MESSAGES_OF_EACH):
            for offset, (name, connection) in enumerate(topics):
                data = store.serialize_cdr(filled(store, name, k), name, little_endian=k % 2 == 0)
                writer.write(connection, START_NS + 1000 * k + offset, data)


def write(bag, storage, compression):
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    kind = store.types
    forever = QosTime(9223372036, 854775807)
    qos = Qos(
        QosHistory.KEEP_LAST, 10, QosReliability.RELIABLE, QosDurability.VOLATILE, forever, forever,
        QosLiveliness.AUTOMATIC, forever, False,
    )

    def header(time_ns, frame):
        stamp = kind["builtin_interfaces/msg/Time"](sec=time_ns // 10**9, nanosec=time_ns % 10**9)
        return kind["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)

    def pose(k):
        # 2² + 4² + 5² + 6² = 9²: a unit quaternion whose components all differ, turned round by k.
        q = [(2 / 9, 4 / 9, 5 / 9, 6 / 9)[(i + k) % 4] for i in range(4)]
        return kind["geometry_msgs/msg/Pose"](
            position=kind["geometry_msgs/msg/Point"](x=0.1 * k, y=-0.2 * k, z=1 / (1 + k)),
            orientation=kind["geometry_msgs/msg/Quaternion"](*q),
        )

    with writer_of(bag, storage, compression) as writer:
        def topic(name, message_type):
            return writer.add_connection(name, message_type, typestore=store, offered_qos_profiles=[qos])

        arrays = topic("/scan", "geometry_msgs/msg/PoseArray")
        tool = topic("/tool", "geometry_msgs/msg/PoseStamped")
        note = topic("/note", "std_msgs/msg/String")
        # The second array is big endian.
        for k, frame, count, little in [(0, "base", 7, True), (1, "a frame of odd length", 3, False)]:
            poses = [pose(100 * k + i) for i in range(count)]
            message = kind[arrays.msgtype](header=header(START_NS + k, frame), poses=poses)
            writer.write(arrays, START_NS + k, store.serialize_cdr(message, arrays.msgtype, little_endian=little))
        for k in range(5):
            time_ns = START_NS + 20_000_000 * k + 7
            message = kind[tool.msgtype](header=header(time_ns, "base"), pose=pose(k))
            writer.write(tool, time_ns, store.serialize_cdr(message, tool.msgtype))
        text = kind["std_msgs/msg/String"](data="not a pose")
        writer.write(note, START_NS + 10**9, store.serialize_cdr(text, note.msgtype))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("read", "dump", "write", "every"):
        command = commands.add_parser(name)
        command.add_argument("bag", type=Path)
        if name in ("read", "dump"):
            command.add_argument("--reader", choices=["rosbags", "mcap"], default="rosbags")
        else:
            command.add_argument("--storage", choices=["mcap", "sqlite3"], default="mcap")
            command.add_argument("--compression", choices=["none", "storage", "message", "file"], default="none")
    arguments = parser.parse_args()
    if arguments.command in ("read", "dump"):
        {"read": read, "dump": dump}[arguments.command](arguments.bag, arguments.reader)
    else:
        {"write": write, "every": every}[arguments.command](arguments.bag, arguments.storage, arguments.compression)


if __name__ == "__main__":
    main()
