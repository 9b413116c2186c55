# %% [markdown]
# # From a bag to a plot
#
# A recording with poses in no particular order becomes an ordered curve, a joint trajectory for an arm, and a picture of both. Run it
# as a program (`python bag_to_plot.py BAG PICTURE`) or cell by cell in an editor that knows `# %%`.

# %%
import sys

import matplotlib.pyplot as plt
import numpy as np

import reorder

bag, picture = sys.argv[1:3] if len(sys.argv) >= 3 else ("tests/data/lasa_gshape", "plot.png")

# %% Read: poses are rows of x, y, z, qx, qy, qz, qw, in m.
(recorded,) = reorder.read_poses(bag)
print(f"{len(recorded)} poses in frame {recorded.frame_id!r} on {recorded.topic}")

# %% Order: the verdict says how far it may be trusted.
found = reorder.order(recorded.poses)
print(f"{found.topology}, {found.verdict}, one radian counts as {found.metres_per_radian:.3f} m")
for doubt in found.doubts:
    print(f"  rows {doubt.at[0]} and {doubt.at[1]}: {doubt.why}")

# %% Interpolate: a C2 curve through the distinct poses.
through = recorded.poses[found.distinct]
spline = reorder.fit(through, metres_per_radian=found.metres_per_radian)
t = np.linspace(*spline.domain, 1000)
curve, twist, acceleration = spline.at(t)

# %% Plan: an audited trajectory, or a refusal that says why.
try:
    plan = reorder.plan(recorded.poses, "ur5e", frame_id=recorded.frame_id, metres_per_radian=found.metres_per_radian)
    print(f"{plan.trajectory.duration_s:.2f} s, {plan.audit['max_ratio']['velocity']:.0%} of the velocity limits")
except reorder.Refusal as refusal:
    plan = None
    print(f"refused: {refusal}")

# %% Draw.
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.5))
# The plane in which the curve is widest.
_, _, axes = np.linalg.svd(curve[:, :3] - curve[:, :3].mean(axis=0), full_matrices=False)
flat, points = curve[:, :3] @ axes[:2].T, through[:, :3] @ axes[:2].T
left.plot(*flat.T, color="0.6", lw=1)
left.scatter(*points.T, c=np.arange(len(points)), s=12)
left.set(title=f"{len(recorded)} poses, {found.verdict}", xlabel="m", ylabel="m", aspect="equal")
if plan is not None:
    right.plot(plan.trajectory.times, plan.trajectory.positions, label=plan.trajectory.joint_names)
    right.set(title="joint trajectory", xlabel="t / s", ylabel="rad")
    right.legend(fontsize=7)
figure.tight_layout()
figure.savefig(picture, dpi=120)
print(picture)
