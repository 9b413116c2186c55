"""Reads the one PoseArray of a recorded bag with `rosbags`, independently of our reader."""

from pathlib import Path

from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

POSE_ARRAY = "geometry_msgs/msg/PoseArray"


def read_pose_array(bag):
    """(frame_id, poses as rows x, y, z, qx, qy, qz, qw) of the only PoseArray in the bag."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Reader(Path(bag)) as reader:
        messages = [
            store.deserialize_cdr(raw, POSE_ARRAY)
            for connection, _, raw in reader.messages()
            if connection.msgtype == POSE_ARRAY
        ]
    if len(messages) != 1:
        raise ValueError(f"{bag} holds {len(messages)} PoseArrays; one is needed")
    return messages[0].header.frame_id, [pose_row(pose) for pose in messages[0].poses]


def pose_row(pose):
    """x, y, z, qx, qy, qz, qw of a geometry_msgs/Pose of rosbags or rclpy."""
    p, q = pose.position, pose.orientation
    return [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
