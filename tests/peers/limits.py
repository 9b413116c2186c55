"""Reads joint limits from the robot's YAML (or JSON) file and its URDF."""

import xml.etree.ElementTree

import yaml

KEYS = {"velocity": "velocity_rad_s", "acceleration": "acceleration_rad_s2", "jerk": "jerk_rad_s3"}


def read_limits(file, urdf=None):
    """{joint: {velocity, acceleration, jerk}}; the lower velocity counts where both files give one."""
    with open(file, encoding="utf-8") as text:
        joints = yaml.safe_load(text)["joints"]
    urdf_velocity = urdf_velocities(urdf) if urdf else {}
    limits = {}
    for name, given in joints.items():
        limits[name] = {kind: given[key] for kind, key in KEYS.items() if key in given}
        velocities = [limits[name].get("velocity"), urdf_velocity.get(name)]
        velocities = [velocity for velocity in velocities if velocity is not None]
        if velocities:
            limits[name]["velocity"] = min(velocities)
        for kind in KEYS:
            if not limits[name].get(kind, 0.0) > 0.0:
                raise ValueError(f"joint {name} has no {kind} limit above zero")
    return limits


def urdf_velocities(urdf):
    root = xml.etree.ElementTree.parse(urdf).getroot()
    joints = ((joint.get("name"), joint.find("limit")) for joint in root.iter("joint"))
    return {name: float(limit.get("velocity")) for name, limit in joints if limit is not None}
