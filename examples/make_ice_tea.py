"""Makes the two sample files of `nlcontrol fit`: touches of an ice tea box that never was.

The touches follow from `TRUE` by the exact tier of the object models, with noise on top; what a
fit finds in the files can so be compared with it. Run it to write the files anew beside it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from objectmodels import BoxModel
from objectmodels.mechanics.push_thresholds import tilt_level

SEED = 5
TRUE = BoxModel(
    name="ice tea box",
    size=(0.09, 0.09, 0.23),
    mass=0.85,
    friction=0.32,
    finger_friction=0.75,
    com=(0.003, -0.002, 0.09),
    support="corners",
)
FORCE_NOISE, FRICTION_SPREAD, TURN_NOISE, TILT_NOISE = 0.01, 0.04, 0.5, 0.3  # shares; degrees
LOW, HIGH = 0.04, 0.21  # of contacts [m]
SIDES = {"front": (-1.0, 0.0), "back": (1.0, 0.0), "left": (0.0, 1.0), "right": (0.0, -1.0)}

HEADER = f"""\
# SYNTHETIC data: no robot measured this. Made by examples/make_ice_tea.py, seed {SEED}, from a box
# of {TRUE.mass} kg on its corners, centre of mass at {TRUE.com} m, friction {TRUE.finger_friction} at
# the finger and {TRUE.friction} at the table, varying by {FRICTION_SPREAD:.0%}; noise of forces {FORCE_NOISE:.0%}.
"""  # noqa: E501


def place(side: str, lateral: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """A contact in B and the direction straight in; lateral along ẑ × normal [m]."""
    x, y = SIDES[side]
    normal = np.array([x, y, 0.0])
    # Adding zero turns −0.0 into 0.0 in the files.
    return 0.045 * normal + [-y * lateral, x * lateral, height] + 0.0, 0.0 - normal


def balance(side: str, tilt: float) -> float:
    """Moment that holds the box tilted about the far edge of its base [N·m]."""
    _, u = place(side, 0.0, 0.0)
    b = 0.045 - u[:2] @ TRUE.com[:2]
    return float(TRUE.weight * (b * np.cos(tilt) - TRUE.com[2] * np.sin(tilt)))


def slide(side: str, lateral: float, height: float, friction: float) -> tuple[float, float]:
    """Force [N] and turn rate [°/m] of a straight push at which a box of that friction slides."""
    point, u = place(side, lateral, height)
    t = TRUE.model_copy(update={"friction": friction}).thresholds([point], [u], exact=True)
    assert t.outcome[0] == "slide"
    return float(t.slide[0]), float(np.degrees(t.twist[0, 2]))


def trials(rng: np.random.Generator) -> str:
    """The file with a row for each touch."""
    lines = [
        "repetition,moved,x_m,y_m,z_m,force_n,ux,uy,uz,tilt_deg,turn_deg,travel_m,nx,ny,nz,note"
    ]

    def row(
        moved: str, side: str, at: tuple[float, float], force: float, rest: str, note: str
    ) -> None:
        point, u = place(side, *at)
        size = force * (1.0 + FORCE_NOISE * rng.standard_normal())
        numbers = ",".join(f"{v:.4f}" for v in (*point, size, *u))
        lines.append(f"{repetition},{moved},{numbers},{rest},{note}")

    for repetition in range(3):
        for side, lateral in (("front", 0.0), ("front", 0.035), ("left", 0.0), ("left", -0.035)):
            mu = TRUE.friction * (1.0 + FRICTION_SPREAD * rng.standard_normal())
            force, rate = slide(side, lateral, LOW, mu)
            turn = 0.03 * rate + TURN_NOISE * rng.standard_normal()
            row("slide", side, (lateral, LOW), force, f",{turn:.2f},0.03,,,", f"low on the {side}")
        for side in SIDES:
            row(
                "topple",
                side,
                (0.0, HIGH),
                balance(side, 0.0) / HIGH,
                ",,,,,",
                f"high on the {side}",
            )
        for degrees in (6.0, 12.0):
            angle = np.radians(degrees)  # the finger sticks to the face and rises with it
            force = balance("front", angle) / (0.09 * np.sin(angle) + HIGH * np.cos(angle))
            tilt = degrees + TILT_NOISE * rng.standard_normal()
            row("topple", "front", (0.0, HIGH), force, f"{tilt:.2f},,,,,", "held tilted")
        ratio = TRUE.finger_friction * (1.0 + 0.05 * rng.standard_normal())
        along = np.array([1.0, ratio, 0.0]) / np.hypot(1.0, ratio)
        numbers = ",".join(f"{v:.4f}" for v in (-0.045, 0.0, 0.05, 2.0, *along))
        lines.append(f"{repetition},slip,{numbers},,,,-1,0,0,the finger slipped along the front")
    return HEADER + "\n".join(lines) + "\n"


def series(rng: np.random.Generator) -> str:
    """The file of recordings: the finger is loaded, then it moves the box at 10 mm/s."""
    lines = ["trial,moved,time_s,fx_n,fy_n,fz_n,x_m,y_m,z_m,yaw_deg,tilt_deg"]
    touches = (
        ("slide", "front", 0.0), ("slide", "front", 0.035), ("slide", "left", -0.035),
        ("topple", "front", 0.0), ("topple", "back", 0.0), ("topple", "left", 0.0),
        ("topple", "right", 0.0),
    )  # fmt: skip
    for number, (moved, side, lateral) in enumerate(touches, 1):
        height = LOW if moved == "slide" else HIGH
        point, u = place(side, lateral, height)
        mu = TRUE.friction * (1.0 + FRICTION_SPREAD * rng.standard_normal())
        onset, rate = (
            slide(side, lateral, LOW, mu) if moved == "slide" else (balance(side, 0.0) / HIGH, 0.0)
        )
        begin = 0.4 + onset / 8.0  # the force rises by 8 N/s
        for t in np.arange(0.0, begin + 2.5, 0.04):
            way = 0.010 * max(t - begin, 0.0)
            # A tilted box slides along the finger, which stays level.
            tilt = tilt_level(HIGH, 0.09, way) if moved == "topple" else 0.0
            force = balance(side, tilt) / HIGH if tilt else min(8.0 * max(t - 0.4, 0.0), onset)
            f = force * (1.0 + FORCE_NOISE * rng.standard_normal()) * u
            f += 0.01 * rng.standard_normal(3)
            tip = point + (way + 0.0001 * min(force, onset)) * u + 2e-5 * rng.standard_normal(3)
            angles = rate * way + 0.1 * rng.standard_normal(), np.degrees(tilt)
            values = (*f, *tip)
            numbers = ",".join(f"{v:.5f}" for v in values) + f",{angles[0]:.2f},{angles[1]:.2f}"
            lines.append(f"{number},{moved},{t:.2f},{numbers}")
    return HEADER + "\n".join(lines) + "\n"


def main(folder: Path = Path(__file__).parent) -> None:
    """Writes both files."""
    rng = np.random.default_rng(SEED)
    (folder / "ice_tea_trials.csv").write_text(trials(rng), encoding="utf-8")
    (folder / "ice_tea_series.csv").write_text(series(rng), encoding="utf-8")


if __name__ == "__main__":
    main()
