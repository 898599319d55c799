"""Turns a plan into lines of CSV for an arm whose controller takes points, speeds and forces.

The table is stated here as another camera sees it: nothing of nlcontrol's simulation is used.
"""

from __future__ import annotations

import csv
import sys

import numpy as np

from nlcontrol import Session
from nlcontrol.types import StatedObject

table = [
    StatedObject(name="ice tea box", x=0.45, y=0.0, yaw=0.2),
    StatedObject(name="mug", x=0.60, y=0.25),
]
result = Session("kitchen", objects=table).plan("push the ice tea box 10 cm away").result
guide = result.guide
if guide is None or guide.kind != "push":
    sys.exit(result.report())

tip = np.array(guide.start_W) + guide.touch_travel * np.array(guide.inward_W)
back = np.array(guide.end_W) - guide.retreat * np.array(guide.inward_W)
rows = [
    ("before the face", guide.start_W, guide.touch_speed, guide.touch_force),
    ("touch, at the latest", tip.tolist(), guide.touch_speed, guide.touch_force),
    ("end of the push", guide.end_W, guide.speed, guide.force_limit),
    ("back", back.tolist(), guide.speed, guide.touch_force),
]
out = csv.writer(sys.stdout)
out.writerow(["what", "x_m", "y_m", "z_m", "speed_m_s", "force_n"])
for what, place, speed, force in rows:
    out.writerow([what, *(f"{x:.4f}" for x in place), f"{speed:.3f}", f"{force:.2f}"])
for end in guide.stop:
    print(f"# stop when {end.text}")
