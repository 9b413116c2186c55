"""Writes and reads 1e5 PoseStamped with rosbags: `write FOLDER` makes the bags mcap and sqlite3 in it, `read FOLDER` prints the
seconds that each takes to be read, every message decoded."""

import json
import sys
import time
from pathlib import Path

from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

KIND = "geometry_msgs/msg/PoseStamped"
COUNT = 100_000
store = get_typestore(Stores.ROS2_JAZZY)
types = store.types


def write(bag, plugin):
    with Writer(bag, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/tool", KIND, typestore=store)
        for k in range(COUNT):
            stamp = types["builtin_interfaces/msg/Time"](sec=k // 100, nanosec=k % 100 * 10_000_000)
            pose = types["geometry_msgs/msg/Pose"](
                position=types["geometry_msgs/msg/Point"](x=0.001 * k, y=0.5, z=1.0 / (1 + k)),
                orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.6, z=0.0, w=0.8),
            )
            header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="base_link")
            writer.write(connection, 10_000_000 * k, store.serialize_cdr(types[KIND](header=header, pose=pose), KIND))


def read(bag):
    started = time.perf_counter()
    count, total = 0, 0.0
    with Reader(bag) as reader:
        for connection, _, data in reader.messages():
            message = store.deserialize_cdr(data, connection.msgtype)
            total += message.pose.position.x + message.pose.orientation.w + len(message.header.frame_id)
            count += 1
    assert count == COUNT and total > 0
    return time.perf_counter() - started


command, folder = sys.argv[1], Path(sys.argv[2])
plugins = {"mcap": StoragePlugin.MCAP, "sqlite3": StoragePlugin.SQLITE3}
if command == "write":
    for name, plugin in plugins.items():
        if not (folder / name / "metadata.yaml").exists():
            write(folder / name, plugin)
else:
    print(json.dumps({f"{name} s": read(folder / name) for name in plugins}))
