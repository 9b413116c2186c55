"""Publishes the poses of a bag again and again, as a scanner does, until it is killed.

    publish_steadily.py BAG [--rate HZ]
"""

import argparse

import rclpy

from recorded_poses import read_pose_array
from sender import Sender


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("bag")
    parser.add_argument("--rate", type=float, default=4.0)
    options = parser.parse_args()
    frame_id, rows = read_pose_array(options.bag)
    rclpy.init()
    node = rclpy.create_node("scanner")
    sender = Sender(node, frame_id, rows, options.rate)
    # The same ones, or their plan would never end where planning takes longer than a period.
    sender.arrays = sender.arrays[:1]
    sender.start()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
