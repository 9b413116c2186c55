#!/usr/bin/env python3
"""Writes ur5e_forward_kinematics.json: poses of the UR5e's attachment_site in the MuJoCo model, at random configurations.

Usage: python ur5e_forward_kinematics.py UR5E_XML   (needs mujoco==3.17.0, numpy; the model is that of MuJoCo Menagerie)
"""

import json
import pathlib
import sys

import mujoco
import numpy as np

COUNT = 1000
SEED = 20240229

model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
site = model.site("attachment_site").id
random = np.random.default_rng(SEED)
rows = []
for _ in range(COUNT):
    # Nine decimals, so that the file holds exactly the configuration that was used.
    configuration = np.round(random.uniform(model.jnt_range[:, 0], model.jnt_range[:, 1]), 9)
    data.qpos[:] = configuration
    mujoco.mj_kinematics(model, data)
    quaternion_wxyz = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion_wxyz, data.site_xmat[site])
    w, x, y, z = quaternion_wxyz
    rows.append(configuration.tolist() + [round(v, 12) for v in [*data.site_xpos[site], x, y, z, w]])

target = pathlib.Path(__file__).with_suffix(".json")
lines = ",\n".join(json.dumps(row) for row in rows)
joints = [model.joint(i).name for i in range(model.njnt)]
target.write_text(f'{{"joints": {json.dumps(joints)},\n"columns": "q1..q6, x, y, z, qx, qy, qz, qw",\n"rows": [\n{lines}\n]}}\n')
