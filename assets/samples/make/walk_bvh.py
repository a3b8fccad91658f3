"""Makes ../walk.bvh: thirteen frames of a brisk walk on a skeleton in Poser's joint order.

Joint numbers are positions in the file, without End Sites: 0 hip, 1 abdomen, 2 chest, 3 neckDummy, 4 neck, 5 head,
6 figureHair, 7 lCollar, 8 lShldr, 9 lForeArm, 10 lHand, 11 rCollar, 12 rShldr, 13 rForeArm, 14 rHand, 15 lThigh, 16 lShin,
17 lFoot, 18 rThigh, 19 rShin, 20 rFoot. Lengths are in centimetres, the rest pose is a T-pose, and, as is common in such
files, the rotation order differs between joints."""

import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import gait
import rig
from gait import Tread, swing

OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "walk.bvh")
TICKS, TICK = 13, 1.0 / 15.0

# name, parent, position in the model (metres), rotation order
PERSON = [
    ("hip", None, (0, 0.94, 0.0), "XZY"),
    ("abdomen", "hip", (0, 0.97, 0.0), "XZY"),
    ("chest", "abdomen", (0, 1.13, -0.012), "XZY"),
    ("neckDummy", "chest", (0, 1.395, -0.02), "XYZ"),
    ("neck", "neckDummy", (0, 1.44, -0.018), "XZY"),
    ("head", "neck", (0, 1.525, -0.002), "XZY"),
    ("figureHair", "head", (0, 1.66, 0.0), "ZYX"),
    ("lCollar", "chest", (0.03, 1.385, -0.02), "YZX"),
    ("lShldr", "lCollar", (0.175, 1.385, -0.022), "ZYX"),
    ("lForeArm", "lShldr", (0.445, 1.385, -0.026), "YZX"),
    ("lHand", "lForeArm", (0.69, 1.385, -0.022), "ZYX"),
    ("lThigh", "hip", (0.09, 0.90, 0.0), "XZY"),
    ("lShin", "lThigh", (0.095, 0.495, 0.010), "XZY"),
    ("lFoot", "lShin", (0.097, 0.085, -0.020), "XYZ"),
]
ENDS = {"figureHair": (0, 0.12, 0), "lHand": (0.17, 0, 0), "lFoot": (0.004, -0.070, 0.145)}
ORDER = "hip abdomen chest neckDummy neck head figureHair lCollar lShldr lForeArm lHand rCollar rShldr rForeArm rHand lThigh lShin lFoot rThigh rShin rFoot".split()


def skeleton():
    rows = {name: (parent, place, order) for name, parent, place, order in PERSON}
    s, orders, ends = rig.Skeleton(), {}, {}
    for name in ORDER:
        mirror = name[0] == "r" and name not in rows
        parent, place, order = rows["l" + name[1:] if mirror else name]
        if mirror:
            parent = "r" + parent[1:] if parent[0] == "l" else parent
            place = (-place[0], place[1], place[2])
        s.add(name, parent, place)
        orders[name] = order
        end = ENDS.get("l" + name[1:] if mirror else name)
        if end:
            ends[name] = (-end[0], end[1], end[2]) if mirror else end
    return s, orders, ends


def figure_of(s):
    names = {"hips": "hip", "spine": ["abdomen", "chest"], "neck": "neck", "head": "head"}
    for side, c in (("left", "l"), ("right", "r")):
        roles = {
            "shoulder": "Collar",
            "arm": "Shldr",
            "forearm": "ForeArm",
            "hand": "Hand",
            "thigh": "Thigh",
            "shin": "Shin",
            "foot": "Foot",
        }
        names.update({f"{side}.{r}": c + j for r, j in roles.items()})
    return gait.Figure(s, names)


def walk(figure):
    """A brisk walk with a stride of 0.87 s, travelling at 1.6 m/s."""
    ankle = figure.place("left.foot")
    length = 1.6 * TICKS * TICK
    tread = Tread(
        ankle,
        np.array([0, -ankle[1], -0.055]),
        np.array([0.004, -0.062, 0.125]),
        flat=0.08,
        rise=0.33,
        off=0.60,
        length=length,
        start=0.245 * length + 0.02,
        pitch=[(0.0, 20), (0.08, 0), (0.33, 0), (0.45, -18), (0.60, -58), (0.69, -44), (0.80, -5), (0.93, 20)],
        air=[
            (0, (0, 0)),
            (0.07, (0.018, 0.022)),
            (0.16, (0.034, 0.080)),
            (0.34, (0.055, 0.28)),
            (0.52, (0.040, 0.53)),
            (0.8, (0.026, 0.93)),
            (0.93, (0.012, 1.012)),
            (1, (0, 1)),
        ],
        width=0.014,
    )

    def pose(p):
        turns, shift = {}, {}
        yaw, roll = -6.0 * swing(p, 0.02), 3.6 * swing(p, 0.17)
        shift["hip"] = (0.018 * swing(p, 0.30), -0.034 + 0.019 * swing(2 * p, 0.62), length * p)
        turns["hip"] = rig.mul(rig.qy(yaw), rig.qx(3.0), rig.qz(roll))
        figure.spine(turns, pitch=2.0 + swing(2 * p, 0.1), yaw=-yaw + 7.0 * swing(p, 0.04), roll=-1.35 * roll)
        figure.head(turns, pitch=-4.0, yaw=-6.0 * swing(p, 0.06), roll=0.35 * roll)
        for side, sign in (("left", 1), ("right", -1)):
            ahead, late = -sign * swing(p, 0.035), -sign * swing(p, 0.085)
            figure.arm(
                turns,
                side,
                lower=77,
                swing=4 + 27 * ahead,
                elbow=30 + 16 * late,
                twist=-6,
                hand_twist=-12,
                wrist=6,
                shrug=-3,
                reach=3 * ahead,
            )
        for side, sign, late in (("left", 1, 0.0), ("right", -1, 0.5)):
            place, pitch, _ = tread.at(p + late)
            place = place * [sign, 1, 1] + [0, 0, length * p]
            figure.leg(turns, shift, side, place, pitch, 0.0, yaw=4.0 * sign)
        return turns, shift

    poses = [pose(i / TICKS) for i in range(TICKS)]
    # The last frame repeats the first, one stride ahead.
    turns, shift = pose(0.0)
    return poses + [(turns, {"hip": np.asarray(shift["hip"]) + [0, 0, length]})]


def angles(m, order):
    """Euler angles in degrees of a rotation matrix, in the given `order`, outermost first."""
    i, j, k = ("XYZ".index(c) for c in order)
    sign = 1.0 if (i, j, k) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1.0
    second = np.arcsin(np.clip(sign * m[i, k], -1, 1))
    first = np.arctan2(-sign * m[j, k], m[k, k])
    third = np.arctan2(-sign * m[i, j], m[i, i])
    return np.degrees([first, second, third])


def main():
    s, orders, ends = skeleton()
    lines = ["HIERARCHY"]

    def write(j, depth):
        name, pad = s.names[j], "\t" * depth
        parent = s.parents[j]
        offset = (s.world[j] - (s.world[parent] if parent >= 0 else 0)) * 100
        if parent < 0:
            offset = offset * 0.0
        lines.append(f"{pad}{'ROOT' if parent < 0 else 'JOINT'} {name}")
        lines.append(pad + "{")
        lines.append(f"{pad}\tOFFSET {offset[0]:.3f} {offset[1]:.3f} {offset[2]:.3f}".replace("-0.000", "0.000"))
        turn = " ".join(f"{c}rotation" for c in orders[name])
        lines.append(f"{pad}\tCHANNELS " + (f"6 Xposition Yposition Zposition {turn}" if parent < 0 else f"3 {turn}"))
        for child in s.children(j):
            write(child, depth + 1)
        if name in ends:
            e = np.array(ends[name]) * 100
            lines.append(f"{pad}\tEnd Site")
            lines.append(pad + "\t{")
            lines.append(f"{pad}\t\tOFFSET {e[0]:.3f} {e[1]:.3f} {e[2]:.3f}".replace("-0.000", "0.000"))
            lines.append(pad + "\t}")
        lines.append(pad + "}")

    write(0, 0)
    poses = walk(figure_of(s))
    lines += ["MOTION", f"Frames: {len(poses)}", f"Frame Time: {TICK:.6f}"]
    for turns, shift in poses:
        row = list((s.world[0] + np.asarray(shift["hip"])) * 100)
        for name in s.names:
            row += list(angles(rig.matrix(turns.get(name, gait.NONE)), orders[name]))
        lines.append(
            " ".join(
                (
                    f"{v:.4f}".rstrip("0").rstrip(".").replace("-0", "0")
                    if abs(v) < 5e-5
                    else f"{v:.4f}".rstrip("0").rstrip(".")
                )
                for v in row
            )
        )
    with open(OUT, "w") as f:
        f.write("\n".join(lines) + "\n")
    print(len("\n".join(lines)) + 1, "bytes")


if __name__ == "__main__":
    main()
