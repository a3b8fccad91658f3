"""Makes ../ssd.obj, ../ssd.skel and ../ssd.attach: an imp of plain clay with 18 joints, for teaching skeletal subspace
deformation: every vertex has many influences.

`.skel`: a line per joint, `x y z parent`, with the offset from the parent (the root's parent is -1). `.attach`: a row per
vertex, with a weight for every joint but the root, which would get the remainder to 1; here all rows sum to 1."""

import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
import rig
from clay import capsule, common, cut, ellipsoid, forward, grown, halfspace, sideways, sphere, union, upright

HERE = os.path.dirname(os.path.abspath(__file__))

# The root has no column, so the belly belongs to `pelvis`, just above it.
JOINTS = [
    ("root", None, (0, 0.60, 0.0)),
    ("pelvis", "root", (0, 0.655, 0.0)),
    ("chest", "pelvis", (0, 0.86, -0.005)),
    ("head", "chest", (0, 1.155, 0.0)),
    ("lshoulder", "chest", (0.185, 1.035, -0.01)),
    ("lelbow", "lshoulder", (0.415, 1.035, -0.015)),
    ("lwrist", "lelbow", (0.620, 1.035, -0.010)),
    ("lfingers", "lwrist", (0.725, 1.030, -0.010)),
    ("rshoulder", "chest", (-0.185, 1.035, -0.01)),
    ("relbow", "rshoulder", (-0.415, 1.035, -0.015)),
    ("rwrist", "relbow", (-0.620, 1.035, -0.010)),
    ("rfingers", "rwrist", (-0.725, 1.030, -0.010)),
    ("lhip", "pelvis", (0.112, 0.545, 0.0)),
    ("lknee", "lhip", (0.124, 0.325, 0.012)),
    ("lankle", "lknee", (0.130, 0.100, -0.020)),
    ("rhip", "pelvis", (-0.112, 0.545, 0.0)),
    ("rknee", "rhip", (-0.124, 0.325, 0.012)),
    ("rankle", "rknee", (-0.130, 0.100, -0.020)),
]


def skull():
    s = union(
        ellipsoid((0, 1.385, -0.012), (0.205, 0.190, 0.185)),
        ellipsoid((0, 1.285, 0.030), (0.160, 0.110, 0.140)),
        k=0.08,
    )
    return union(s, ellipsoid((0.088, 1.300, 0.092), (0.062, 0.055, 0.060)), k=0.06)


def head():
    bare = clay.mirrored(skull())
    shape = skull()
    # Ears: long leaves, hollow in front.
    ear = capsule((0.165, 1.370, -0.020), (0.385, 1.485, -0.082), 0.068, 0.024, flatten=((-0.25, 0.0, 1.0), 0.50))
    hollow = capsule((0.215, 1.398, 0.016), (0.325, 1.454, -0.024), 0.034, 0.012, flatten=((-0.25, 0.0, 1.0), 0.55))
    shape = union(shape, cut(ear, hollow, k=0.018), k=0.035)
    # Large eyes in their sockets under heavy lids; raised brows.
    eye = np.array([0.080, 1.386, 0.122])
    shape = cut(shape, ellipsoid(eye + [0.002, 0.002, 0.050], (0.072, 0.066, 0.046)), k=0.030)
    globe = sphere(eye, 0.060)
    shape = union(shape, globe, k=0.003)
    upper = common(sphere(eye, 0.0690), halfspace(eye + [0, 0.016, 0.030], (0.05, -1.0, 0.55)), k=0.008)
    shape = union(shape, upper, k=0.010)
    brow = union(
        capsule((0.034, 1.480, 0.158), (0.082, 1.494, 0.140), 0.018, 0.023),
        capsule((0.082, 1.494, 0.140), (0.148, 1.466, 0.096), 0.023, 0.014),
        k=0.01,
    )
    shape = union(shape, brow, k=0.018)
    shape = union(shape, ellipsoid((0, 1.330, 0.196), (0.043, 0.040, 0.056)), k=0.022)
    shape = union(shape, ellipsoid((0.033, 1.321, 0.178), (0.023, 0.021, 0.026)), k=0.014)
    # The mouth is a groove in the surface with upturned corners, and a lower lip.
    line = [(0.0, 1.236), (0.040, 1.240), (0.080, 1.256), (0.110, 1.280), (0.124, 1.300)]
    starts = np.array([(x, y, 0.4) for x, y in line])
    points = clay.cast(bare, starts, np.broadcast_to([0, 0, -0.4], starts.shape), 1.0)
    for a, b in zip(points, points[1:]):
        shape = cut(shape, capsule(a, b, 0.0165), k=0.010)
    lip = points[0] + [0, -0.024, -0.006]
    shape = union(shape, capsule(lip * [0, 1, 1], lip + [0.030, 0.003, -0.004], 0.014, 0.009), k=0.018)
    # A tuft.
    tuft = union(
        capsule((0, 1.545, -0.02), (0.0, 1.650, -0.045), 0.055, 0.034),
        capsule((0.0, 1.650, -0.045), (0.0, 1.715, -0.115), 0.034, 0.016),
        k=0.03,
    )
    tuft = union(tuft, capsule((0.045, 1.545, -0.05), (0.085, 1.625, -0.10), 0.042, 0.018), k=0.03)
    return union(shape, tuft, k=0.03)


def leg():
    limb = upright(
        [
            (0.64, 0.095, -0.005, 0.085, 0.105),
            (0.56, 0.108, -0.002, 0.100, 0.108),
            (0.46, 0.117, 0.004, 0.090, 0.096),
            (0.325, 0.124, 0.012, 0.071, 0.076),
            (0.22, 0.128, -0.012, 0.072, 0.082),
            (0.12, 0.130, -0.020, 0.056, 0.060),
            (0.05, 0.130, -0.015, 0.054, 0.062),
        ],
        rounding=0.03,
    )
    foot = forward(
        [
            (-0.105, 0.130, 0.052, 0.040, 0.044),
            (-0.06, 0.131, 0.060, 0.058, 0.060),
            (0.02, 0.135, 0.062, 0.066, 0.062),
            (0.10, 0.142, 0.046, 0.078, 0.046),
            (0.16, 0.146, 0.038, 0.080, 0.038),
        ],
        rounding=0.025,
        power=2.3,
    )
    for x, z, r in ((0.088, 0.175, 0.041), (0.146, 0.190, 0.038), (0.200, 0.168, 0.034)):
        foot = union(foot, ellipsoid((x, r * 0.98, z), (r, r, r * 1.15)), k=0.018)
    foot = common(foot, halfspace((0, 0.0, 0), (0, -1, 0)), k=0.012)
    return union(limb, foot, k=0.03)


LEG = leg()


def body():
    trunk = union(
        ellipsoid((0, 0.735, 0.022), (0.185, 0.185, 0.170)),
        ellipsoid((0, 0.965, -0.012), (0.172, 0.140, 0.118)),
        k=0.14,
    )
    trunk = union(trunk, ellipsoid((0, 0.600, -0.008), (0.178, 0.105, 0.140)), k=0.10)
    trunk = union(trunk, capsule((0, 1.02, -0.012), (0, 1.20, -0.005), 0.082, 0.075), k=0.06)
    arm = sideways(
        [
            (0.10, 1.030, -0.012, 0.070, 0.070),
            (0.19, 1.035, -0.012, 0.078, 0.078),
            (0.29, 1.036, -0.013, 0.062, 0.064),
            (0.415, 1.035, -0.015, 0.052, 0.053),
            (0.50, 1.035, -0.014, 0.058, 0.060),
            (0.58, 1.035, -0.012, 0.048, 0.052),
            (0.65, 1.033, -0.010, 0.036, 0.046),
        ],
        rounding=0.03,
    )
    hand = ellipsoid((0.690, 1.032, -0.010), (0.068, 0.032, 0.062))
    for z0, z1, length, r in (
        (0.036, 0.058, 0.105, 0.0255),
        (-0.010, -0.012, 0.120, 0.0265),
        (-0.054, -0.078, 0.100, 0.0245),
    ):
        hand = union(hand, capsule((0.705, 1.031, z0), (0.725 + length, 1.024, z1), r, r * 0.88), k=0.016)
    hand = union(hand, capsule((0.660, 1.026, 0.034), (0.728, 1.014, 0.098), 0.027, 0.0235), k=0.022)
    arm = union(arm, hand, k=0.03)
    leg = LEG
    # Short trousers: a thicker skin that ends under the belt and the hems.
    skin = union(union(trunk, leg, k=0.045), arm, k=0.08)
    cloth = grown(union(trunk, leg, k=0.045), 0.010)
    cloth = common(cloth, halfspace((0, 0.655, 0.0), (0, 1, 0)), k=0.02)
    cloth = common(cloth, halfspace((0.12, 0.425, 0), (0.10, -1, 0.0)), k=0.02)
    return union(skin, cloth, k=0.015)


def bands():
    """Belt, hems and bracelets: separate loops around the body."""

    def roll(half, thick):
        across = [
            (-half, -0.008),
            (-half, 0.4 * thick),
            (-0.72 * half, 0.9 * thick),
            (0.0, thick),
            (0.72 * half, 0.9 * thick),
            (half, 0.4 * thick),
            (half, -0.008),
        ]
        return across

    out = [clay.ring(IMP, (0, 0.652, 0.0), (0, 1, 0.10), (0, 0, 1), roll(0.022, 0.017), 40)]
    for sign in (1, -1):
        trouser = lambda p, sign=sign: LEG(p * [sign, 1, 1]) - 0.010
        out.append(
            clay.ring(trouser, (sign * 0.121, 0.425, 0.007), (sign * -0.10, 1, 0), (0, 0, 1), roll(0.019, 0.012), 26)
        )
        out.append(clay.ring(IMP, (sign * 0.592, 1.034, -0.011), (1, 0, 0), (0, 0, 1), roll(0.014, 0.012), 18))
    return out


IMP = clay.mirrored(union(body(), head(), k=0.012))
NECK, WRIST, FINER_HEAD, FINER_HAND = 1.185, 0.625, 2.3, 1.6


def shrunk(p):
    """Maps positions on a body whose head and hands are FINER_… times as large to the imp.

    That body is remeshed, so face and fingers get more quads.
    """
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    f = 1 - (1 - 1 / FINER_HEAD) * rig.smooth_step((y - NECK) / 0.32)
    u = x - WRIST
    g = 1 - (1 - 1 / FINER_HAND) * rig.smooth_step(u / 0.10) * (1 - rig.smooth_step((y - NECK) / 0.04))
    out = np.column_stack([x * f, np.where(y > NECK, NECK + (y - NECK) * f, y), z * f])
    hand = (u > 0) & (y < NECK + 0.04)
    out[hand, 0] = WRIST + u[hand] * g[hand]
    out[hand, 1] = 1.03 + (y[hand] - 1.03) * g[hand]
    out[hand, 2] = -0.01 + (z[hand] + 0.01) * g[hand]
    out[:, 0] *= np.where(p[:, 0] < 0, -1, 1)
    return out


def gates(s):
    g = rig.Gates(s)
    up = (0, 1, 0)
    g.gate("pelvis", up, 0.001, shift=-5.0)
    g.gate("chest", up, 0.22)
    g.gate(
        "head",
        up,
        0.09,
        shift=0.01,
        near=lambda p: 1 - rig.smooth_step((np.abs(p[:, 0]) - 0.10) / 0.08) * (p[:, 1] < 1.15),
    )
    for side, sign in (("l", 1.0), ("r", -1.0)):
        high = lambda p, sign=sign: np.maximum(
            rig.smooth_step((p[:, 1] - 0.88) / 0.12), rig.smooth_step((sign * p[:, 0] - 0.17) / 0.08)
        ) * (1 - rig.smooth_step((p[:, 1] - 1.13) / 0.05))
        g.gate(side + "shoulder", (sign, 0.25, 0), 0.15, shift=0.0, near=high)
        g.gate(side + "elbow", (sign, 0, 0), 0.12)
        g.gate(side + "wrist", (sign, 0, 0), 0.09)
        g.gate(side + "fingers", (sign, 0, 0), 0.06, shift=0.01)
        beside = lambda p, sign=sign: rig.smooth_step((sign * p[:, 0] + 0.03) / 0.06)
        g.gate(side + "hip", (0.35 * sign, -1, 0), 0.15, near=beside)
        g.gate(side + "knee", (0, -1, 0), 0.12)
        g.gate(side + "ankle", (0, -1, 0.25), 0.09)
    return g


def number(v, digits):
    text = f"{v:.{digits}f}".rstrip("0").rstrip(".")
    text = "0" if text in ("-0", "") else text
    return (
        text.replace("0.", ".", 1)
        if text.startswith("0.")
        else text.replace("-0.", "-.", 1) if text.startswith("-0.") else text
    )


def main():
    s = rig.Skeleton()
    for joint in JOINTS:
        s.add(*joint)
    # Meshed whole: the seam of mirrored halves would be visible on this body.
    mesh = clay.mesh_of(
        lambda p: IMP(shrunk(p)), (-1.06, -0.03, -0.50), (1.06, 2.48, 0.62), 5900, 0.012, half=False, relax=5
    )
    mesh.vertices = clay.project(IMP, shrunk(mesh.vertices), 3)
    w = gates(s).weights(mesh.vertices, "root")
    # Diffused over the surface, partly over a long distance, which makes the weights dense.
    near = rig.smoothed(w, mesh.faces, 40)
    w = 0.86 * near + 0.14 * rig.smoothed(near, mesh.faces, 500)
    rolls = clay.joined(bands())
    w = np.concatenate([w, rig.lent(rolls.vertices, mesh.vertices, w, 8)])
    mesh = clay.joined([mesh, rolls])
    w[:, 0] = 0.0
    # Keeps the twelve strongest, rounded to thousandths that sum to exactly 1.
    order = np.argsort(-w, axis=1)
    np.put_along_axis(w, order[:, 12:], 0.0, axis=1)
    w /= w.sum(axis=1, keepdims=True)
    w = np.round(w, 3)
    rows = np.arange(len(w))
    w[rows, w.argmax(axis=1)] += 1.0 - w.sum(axis=1)
    used = (w > 0).sum(axis=1)
    print(
        f"{len(mesh.vertices)} vertices, {len(mesh.faces)} quads, influences: mean {used.mean():.1f}, most {used.max()}"
    )
    with open(os.path.join(HERE, "..", "ssd.obj"), "w") as f:
        f.write("# An imp in clay, made for Gaitway; CC0 1.0\n")
        for v in mesh.vertices:
            f.write("v " + " ".join(number(c, 4) for c in v) + "\n")
        for face in mesh.faces:
            f.write("f " + " ".join(str(i + 1) for i in face) + "\n")
    with open(os.path.join(HERE, "..", "ssd.skel"), "w") as f:
        for j, parent in enumerate(s.parents):
            offset = s.world[j] - (s.world[parent] if parent >= 0 else 0)
            f.write(" ".join(f"{c:.4f}" for c in offset) + f" {parent}\n")
    with open(os.path.join(HERE, "..", "ssd.attach"), "w") as f:
        for row in w[:, 1:]:
            f.write(" ".join(number(c, 3) for c in row) + "\n")


if __name__ == "__main__":
    main()
