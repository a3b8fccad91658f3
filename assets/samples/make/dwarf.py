"""Makes ../dwarf.glb: a heavy dwarf of 1.4 m with unusual joint names and one clip, "crouch and look" (55 frames).

His arms hang at rest, so that a retargeted walk without arm motion still looks like a swagger. All rest frames are parallel
to the model's axes, as in files of old exporters: motion can be copied channel by channel.
"""

import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
import rig
from clay import box, capsule, common, cut, ellipsoid, forward, grown, halfspace, loft, union, upright
from paint import edge, groove, noise, srgb
from sculpting import bent, chain, meshed, mixed, unit_normals

OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "dwarf.glb")

# ---------------------------------------------------------------- joints

# Center and left side, metres; he faces +Z.
PLACES = [
    ("base", None, (0, 0, 0)),
    ("middle", "base", (0, 0.53, 0.0)),
    ("lhip", "middle", (0.125, 0.49, 0.0)),
    ("lknee", "lhip", (0.142, 0.298, 0.012)),
    ("lankle", "lknee", (0.150, 0.112, -0.015)),
    ("ltoe", "lankle", (0.165, 0.045, 0.115)),
    ("lskirt", "middle", (0.11, 0.535, 0.195)),
    ("spine2", "middle", (0, 0.63, -0.01)),
    ("spine1", "spine2", (0, 0.86, -0.025)),
    ("head", "spine1", (0, 1.00, 0.0)),
    ("beard1", "head", (0, 1.00, 0.125)),
    ("beard2", "beard1", (0, 0.86, 0.19)),
    ("lcollar", "spine1", (0.07, 0.925, -0.02)),
    ("lsholda", "lcollar", (0.238, 0.912, -0.02)),
    ("lelbo", "lsholda", (0.372, 0.752, -0.035)),
    ("lwrist", "lelbo", (0.470, 0.590, 0.020)),
    ("lthumb", "lwrist", (0.480, 0.560, 0.062)),
    ("lfist", "lwrist", (0.506, 0.508, 0.045)),
]
AT = {name: np.array(place) for name, _, place in PLACES}


def skeleton():
    s = rig.Skeleton()
    for name, up, place in PLACES:
        s.add(name, up, place)
    for name, up, (x, y, z) in PLACES:
        if name[0] == "l":
            s.add("r" + name[1:], "r" + up[1:] if up[0] == "l" else up, (-x, y, z))
    return s


def gates(s):
    """The weight gates of trunk and legs; see rig.Gates."""
    g = rig.Gates(s)
    up = (0, 1, 0)
    g.gate("spine2", up, 0.16)
    g.gate("spine1", up, 0.18)
    g.gate("head", up, 0.06, near=lambda p: 1.0 - rig.smooth_step((np.abs(p[:, 0]) - 0.10) / 0.05))
    for side, sign in (("l", 1.0), ("r", -1.0)):
        beside = lambda p, sign=sign: rig.smooth_step((sign * p[:, 0] + 0.035) / 0.07)
        g.gate(side + "hip", (0.35 * sign, -1, 0), 0.15, shift=-0.004, near=beside)
        g.gate(side + "knee", (0, -1, 0), 0.12)
        g.gate(side + "ankle", (0, -1, 0.15), 0.08, shift=-0.005)
        g.gate(side + "toe", (0, -0.1, 1), 0.07, shift=-0.004)
    return g


def place_weights(s, points):
    """Weights as a function of position. The arms hang beside the trunk, so they bypass its gates: whatever is outside the flank
    belongs to the arm, at any height."""
    w = gates(s).weights(points, "middle")
    arm = rig.Gates(s)
    for side, sign in (("l", 1.0), ("r", -1.0)):
        arm.gate(side + "elbo", None, 0.11)
        arm.gate(side + "wrist", None, 0.06)
        x, y = sign * points[:, 0], points[:, 1]
        flank = 0.248 + 0.25 * np.maximum(0.78 - y, 0.0)
        out = np.maximum(rig.smooth_step((y - 0.80) / 0.12), rig.smooth_step((x - flank) / 0.05))
        collar = out * rig.smooth_step((x - AT["lcollar"][0] + 0.1 * (y - 0.925) - 0.07) / 0.15 + 0.5)
        beyond = rig.smooth_step((x - AT["lsholda"][0] + 0.1 * (y - 0.912) - 0.028) / 0.12 + 0.5)
        w *= (1.0 - collar)[:, None]
        w[:, s[side + "collar"]] += collar * (1.0 - beyond)
        w += (collar * beyond)[:, None] * arm.weights(points, side + "sholda")
    return w


# ---------------------------------------------------------------- the body under everything (left half)


def placed(shape, rotation, origin):
    """A shape modelled in a local frame, whose axes are the columns of `rotation`."""
    rotation, origin = np.asarray(rotation), np.asarray(origin)
    return lambda p: shape((p - origin) @ rotation)


def axes(along, side):
    along = np.asarray(along, dtype=np.float64) / np.linalg.norm(along)
    side = np.asarray(side, dtype=np.float64)
    side = side - along * (side @ along)
    side /= np.linalg.norm(side)
    return np.column_stack([along, np.cross(side, along), side])


TORSO = upright(
    [
        (0.44, 0, 0.000, 0.165, 0.130),
        (0.50, 0, 0.004, 0.212, 0.172),
        (0.57, 0, 0.016, 0.236, 0.202),
        (0.66, 0, 0.022, 0.246, 0.218),
        (0.75, 0, 0.012, 0.248, 0.208),
        (0.84, 0, -0.004, 0.236, 0.182),
        (0.91, 0, -0.016, 0.200, 0.146),
        (0.96, 0, -0.018, 0.140, 0.115),
        (1.02, 0, -0.010, 0.095, 0.095),
    ],
    power=2.25, rounding=0.04,
)
SHOULDER, ELBOW, WRIST = AT["lsholda"], AT["lelbo"], AT["lwrist"]
UPPER = loft(
    SHOULDER, ELBOW - SHOULDER, (0, 0, 1),
    [(-0.07, 0, 0, 0.080, 0.070), (0.0, 0, 0, 0.094, 0.088), (0.08, 0.004, 0, 0.090, 0.086), (0.16, 0, 0, 0.078, 0.074), (0.235, 0, 0, 0.070, 0.066)],
    rounding=0.04,
)
LOWER = loft(
    ELBOW, WRIST - ELBOW, (0, 0, 1),
    [(-0.05, 0, 0, 0.062, 0.060), (0.0, 0, 0, 0.071, 0.068), (0.06, 0, 0, 0.074, 0.072), (0.13, 0, 0, 0.062, 0.060), (0.21, 0, 0, 0.047, 0.043)],
    rounding=0.03,
)
ARM = union(UPPER, LOWER, k=0.04)
LEG = upright(
    [
        (0.53, 0.115, 0.000, 0.105, 0.120),
        (0.45, 0.130, 0.004, 0.112, 0.122),
        (0.37, 0.138, 0.008, 0.102, 0.110),
        (0.298, 0.143, 0.012, 0.089, 0.096),
        (0.22, 0.147, 0.000, 0.082, 0.088),
        (0.12, 0.150, -0.012, 0.070, 0.076),
    ],
    rounding=0.03,
)
CLOTH = clay.mirrored(union(union(TORSO, ARM, k=0.07), LEG, k=0.05))

# ---------------------------------------------------------------- clothes


def skirt():
    """The tunic below the belt: a wide hem with an inside, open at the legs."""
    cone = upright(
        [(0.30, 0, 0.012, 0.290, 0.236), (0.38, 0, 0.012, 0.276, 0.226), (0.46, 0, 0.012, 0.256, 0.212), (0.56, 0, 0.015, 0.238, 0.204), (0.62, 0, 0.02, 0.24, 0.21)],
        power=2.4,
    )
    profile = [(0.585, -0.012), (0.575, 0.006), (0.53, 0.008), (0.48, 0.008), (0.43, 0.009), (0.39, 0.010), (0.362, 0.011),
               (0.352, 0.005), (0.356, -0.006), (0.40, -0.014), (0.45, -0.020)]
    return clay.ring(cone, (0, 0, 0.012), (0, 1, 0), (0, 0, 1), profile, 36, half=True, reach=0.45)


BELT_Y = 0.575


def belt():
    profile = [(-0.034, -0.004), (-0.034, 0.012), (-0.028, 0.018), (0.0, 0.019), (0.028, 0.018), (0.034, 0.012), (0.034, -0.004)]
    return clay.ring(TORSO, (0, BELT_Y, 0.012), (0, 1, 0), (0, 0, 1), profile, 36, half=True, reach=0.45)


def buckle():
    plate = box((0, BELT_Y, 0.243), (0.056, 0.050, 0.020), 0.014)
    return cut(plate, box((0, BELT_Y, 0.262), (0.034, 0.028, 0.012), 0.008), k=0.004)


def bracer():
    frame = axes(WRIST - ELBOW, (0, 0, 1))
    profile = [(0.040, -0.004), (0.036, 0.008), (0.041, 0.014), (0.050, 0.0135), (0.055, 0.0095), (0.085, 0.009), (0.115, 0.009), (0.142, 0.0095),
               (0.147, 0.0135), (0.158, 0.014), (0.163, 0.008), (0.160, -0.004)]
    return clay.ring(LOWER, ELBOW, frame[:, 0], frame[:, 2], profile, 16, reach=0.14)


def hand():
    palm = clay.sideways(
        [(-0.035, 0, 0, 0.034, 0.037), (0.0, 0.000, 0.0, 0.036, 0.042), (0.035, 0.002, 0.0, 0.038, 0.054), (0.075, 0.002, -0.001, 0.032, 0.057), (0.100, 0, 0, 0.024, 0.052)],
        rounding=0.02, power=2.4,
    )
    shape = palm
    for z, length, r in ((0.042, 0.064, 0.0185), (0.014, 0.072, 0.0195), (-0.015, 0.068, 0.019), (-0.042, 0.056, 0.0170)):
        a = np.array([0.080, 0.004, z])
        b = a + [0.50 * length, -0.006, 0.02 * z]
        c = b + [0.42 * length, -0.026, -0.06 * z]
        shape = union(shape, chain([a, b, c], [r, r, r * 0.88], k=0.004), k=0.006)
    thumb = bent([(0.022, -0.006, 0.040), (0.052, -0.014, 0.070), (0.088, -0.024, 0.078)], [0.027, 0.0225, 0.018], k=0.006)
    shape = union(shape, thumb, k=0.012)
    along = AT["lfist"] - WRIST
    # Palms face the thighs, a little backwards.
    frame = axes(along, (-0.32, 0.0, 1.0))
    frame = np.column_stack([frame[:, 0], frame[:, 1], frame[:, 2]])
    return placed(shape, frame, WRIST)


def boot():
    shaft = upright(
        [(0.255, 0.146, 0.004, 0.100, 0.106), (0.19, 0.148, -0.006, 0.094, 0.100), (0.12, 0.150, -0.014, 0.086, 0.096), (0.06, 0.151, -0.016, 0.086, 0.098)],
        rounding=0.012,
    )
    foot = forward(
        [
            (-0.125, 0.152, 0.070, 0.058, 0.055), (-0.07, 0.152, 0.085, 0.082, 0.082), (0.0, 0.154, 0.090, 0.087, 0.090), (0.07, 0.158, 0.078, 0.092, 0.076),
            (0.14, 0.164, 0.072, 0.096, 0.068), (0.20, 0.168, 0.066, 0.088, 0.058), (0.245, 0.168, 0.058, 0.060, 0.040),
        ],
        rounding=0.035, power=2.35,
    )
    sole = upright(
        [(0.0, 0.158, 0.058, 0.094, 0.196), (0.018, 0.158, 0.058, 0.100, 0.202), (0.040, 0.158, 0.058, 0.097, 0.198)], rounding=0.010, power=2.7
    )
    cap = common(grown(foot, 0.007), halfspace((0.16, 0.07, 0.150), (0, 0.10, -1)), k=0.006)
    cap = common(cap, halfspace((0, 0.03, 0), (0, -1, 0)), k=0.004)
    return union(union(union(shaft, foot, k=0.05), cap, k=0.004), sole, k=0.006)


def cuff():
    """Fur at the boot's top."""

    def distance(p):
        q = p - [0.1465, 0.248, 0.002]
        around = np.arctan2(q[:, 0], q[:, 2])
        r = np.hypot(q[:, 0], q[:, 2] * 0.95)
        tufts = 0.005 * np.cos(around * 11) * np.cos(q[:, 1] * 55) + 0.003 * np.cos(around * 19 + q[:, 1] * 70)
        return np.hypot(r - 0.090, q[:, 1] * 0.85) - 0.029 - tufts

    return distance


PAULDRON_AT = np.array([0.268, 0.905, -0.022])
PAULDRON_OUT = np.array([0.70, 0.714, 0.0])


def pauldron():
    """A steel dome with a brass rim over each shoulder: lathed, in loops around its axis."""
    # (radius, height along the axis), from the inside over the rim to the boss.
    profile = [
        (0.098, 0.046), (0.104, 0.018), (0.112, 0.008), (0.122, 0.011), (0.126, 0.024), (0.121, 0.038), (0.1095, 0.043), (0.100, 0.060),
        (0.083, 0.081), (0.058, 0.099), (0.029, 0.109), (0.026, 0.116), (0.022, 0.126), (0.012, 0.132), (0.0008, 0.134),
    ]
    across = np.array([PAULDRON_OUT[1], -PAULDRON_OUT[0], 0.0])
    angles = np.arange(17) * 2 * np.pi / 17
    places = [
        PAULDRON_AT + PAULDRON_OUT * t + 1.05 * r * (np.cos(a) * across + 1.07 * np.sin(a) * np.array([0, 0, 1.0])) for r, t in profile for a in angles
    ]
    n = len(angles)
    faces = [[i * n + k, (i + 1) * n + k, (i + 1) * n + (k + 1) % n, i * n + (k + 1) % n] for i in range(len(profile) - 1) for k in range(n)]
    mesh = clay.Mesh(places, faces)
    mesh.plane = np.zeros(len(places), dtype=bool)
    mesh.whole = False
    return clay._away(mesh, PAULDRON_AT, np.array([0, 0, 1.0]))


# ---------------------------------------------------------------- the head

EYE = np.array([0.054, 1.134, 0.108])


def face():
    skull = ellipsoid((0, 1.13, 0.0), (0.128, 0.150, 0.132))
    jaw = ellipsoid((0, 1.05, 0.035), (0.105, 0.085, 0.095))
    shape = union(skull, jaw, k=0.05)
    shape = union(shape, ellipsoid((0.066, 1.082, 0.098), (0.042, 0.036, 0.036)), k=0.03)
    shape = cut(shape, ellipsoid((0.056, 1.136, 0.150), (0.036, 0.024, 0.032)), k=0.025)
    nose = union(ellipsoid((0, 1.082, 0.158), (0.037, 0.032, 0.040)), capsule((0, 1.150, 0.118), (0, 1.09, 0.150), 0.020, 0.026), k=0.02)
    nose = union(nose, ellipsoid((0.030, 1.076, 0.142), (0.020, 0.018, 0.022)), k=0.012)
    shape = union(shape, nose, k=0.016)
    ear = ellipsoid((0.134, 1.095, -0.012), (0.020, 0.042, 0.030))
    ear = cut(ear, ellipsoid((0.152, 1.097, 0.0), (0.012, 0.026, 0.017)), k=0.006)
    shape = union(shape, ear, k=0.012)
    return union(shape, capsule((0, 0.97, -0.01), (0, 1.06, -0.005), 0.085), k=0.04)


def eyeball():
    return clay.sphere(EYE, 0.0265)


def lids():
    """Heavy upper lids, half a shell over each eye."""
    whole = clay.shell(clay.sphere(EYE, 0.0285), 0.005)
    upper = common(whole, halfspace(EYE + [0, 0.004, 0], (0, -0.92, 0.40)), k=0.003)
    lower = common(whole, halfspace(EYE + [0, -0.011, 0], (0, 1.0, 0.15)), k=0.003)
    return union(upper, lower, k=0.002)


def beard():
    mass = union(
        ellipsoid((0, 0.985, 0.085), (0.128, 0.105, 0.082)),
        capsule((0.118, 1.125, 0.020), (0.100, 1.005, 0.060), 0.030, 0.060), k=0.04,
    )
    locks = [
        ([(0.020, 1.00, 0.135), (0.028, 0.86, 0.200), (0.022, 0.74, 0.245), (0.006, 0.635, 0.262)], [0.050, 0.052, 0.040, 0.010]),
        ([(0.060, 1.00, 0.120), (0.082, 0.88, 0.185), (0.085, 0.78, 0.222), (0.070, 0.690, 0.246)], [0.048, 0.046, 0.035, 0.008]),
        ([(0.095, 1.01, 0.090), (0.132, 0.92, 0.140), (0.142, 0.83, 0.180), (0.130, 0.750, 0.208)], [0.044, 0.040, 0.030, 0.007]),
        ([(0.108, 1.06, 0.060), (0.156, 0.98, 0.090), (0.178, 0.90, 0.112), (0.178, 0.825, 0.135)], [0.036, 0.034, 0.025, 0.006]),
    ]
    shape = mass
    for points, radii in locks:
        shape = union(shape, bent(points, radii, k=0.012, count=7), k=0.016)
    return shape


def moustache():
    big = bent([(0.004, 1.058, 0.168), (0.055, 1.046, 0.172), (0.110, 1.000, 0.160), (0.150, 0.945, 0.150), (0.186, 0.925, 0.150)], [0.022, 0.030, 0.026, 0.017, 0.006], k=0.008, count=9)
    small = bent([(0.012, 1.044, 0.168), (0.05, 1.020, 0.172), (0.092, 0.965, 0.172), (0.118, 0.920, 0.172)], [0.018, 0.024, 0.019, 0.006], k=0.008, count=7)
    return union(big, small, k=0.010)


def brow():
    return union(
        bent([(0.018, 1.152, 0.140), (0.052, 1.174, 0.140), (0.090, 1.180, 0.112), (0.124, 1.166, 0.076)], [0.012, 0.0175, 0.016, 0.005], k=0.006, count=7),
        bent([(0.045, 1.174, 0.140), (0.082, 1.192, 0.124), (0.122, 1.196, 0.096)], [0.013, 0.013, 0.004], k=0.006, count=5), k=0.008,
    )


def hair():
    shape = None
    for points, radii in (
        ([(0.010, 1.12, -0.105), (0.015, 1.00, -0.150), (0.014, 0.88, -0.178), (0.006, 0.79, -0.190)], [0.05, 0.054, 0.042, 0.01]),
        ([(0.065, 1.12, -0.090), (0.082, 1.01, -0.130), (0.090, 0.90, -0.156), (0.080, 0.83, -0.168)], [0.05, 0.048, 0.036, 0.008]),
        ([(0.110, 1.11, -0.050), (0.138, 1.02, -0.075), (0.152, 0.95, -0.085), (0.158, 0.885, -0.085)], [0.036, 0.038, 0.028, 0.007]),
    ):
        lock = bent(points, radii, k=0.012, count=7)
        shape = lock if shape is None else union(shape, lock, k=0.016)
    return shape


RIM = np.array([0.0, 0.93, -0.36])  # the way "up" from the helmet's rim: it lies low at the neck
RIM /= np.linalg.norm(RIM)
RIM_AT = np.array([0.0, 1.160, 0.0])
DOME = ellipsoid((0, 1.175, -0.004), (0.155, 0.190, 0.166))


def helmet():
    above = halfspace(RIM_AT, -RIM)
    dome = common(DOME, above, k=0.010)
    dome = cut(dome, common(grown(DOME, -0.020), halfspace(RIM_AT + RIM * 0.06, RIM), k=0.01), k=0.004)
    band = common(grown(DOME, 0.013), lambda p: np.abs((p - RIM_AT) @ RIM - 0.026) - 0.026, k=0.008)
    band = cut(band, grown(DOME, -0.020), k=0.003)
    ridge = common(grown(DOME, 0.015), lambda p: np.maximum(np.abs(p[:, 0]) - 0.022, 1.17 - p[:, 1]), k=0.008)
    guard = box((0, 1.150, 0.183), (0.017, 0.050, 0.010), 0.007)
    socket = placed(clay.sideways([(0.0, 0, 0, 0.046, 0.046), (0.06, 0, 0, 0.043, 0.043)], rounding=0.008), axes((0.86, 0.50, 0), (0, 0, 1)), (0.105, 1.245, -0.01))
    knob = ellipsoid((0, 1.372, -0.004), (0.026, 0.024, 0.028))
    return union(union(dome, ridge, k=0.004), band, guard, socket, knob, k=0.006)


def horn():
    return bent(
        [(0.135, 1.262, -0.01), (0.215, 1.300, -0.006), (0.268, 1.375, 0.012), (0.262, 1.470, 0.040)], [0.036, 0.034, 0.025, 0.004], k=0.004, count=10
    )


class Part:
    """A piece: its clay, or a ready mesh of the left half; `carrier`: the joint that carries it whole (or "beard", or
    None: by the gates)."""

    def __init__(self, name, shape, carrier=None, box=None, quads=0, step=0.004, mesh=None, solid=True, half=True, relax=3):
        self.name, self.shape, self.carrier = name, shape, carrier
        self.box, self.quads, self.step, self.mesh, self.half, self.relax = box, quads, step, mesh, half, relax
        # Whether its clay hides what is inside it.
        self.solid = solid and shape is not None


PARTS = [
    Part("cloth", CLOTH, None, [(0, 0.09, -0.25), (0.53, 1.06, 0.28)], 1040, 0.010),
    Part("skirt", None, "skirt", mesh=skirt),
    Part("belt", None, "middle", mesh=belt),
    Part("buckle", buckle(), "middle", [(-0.08, 0.50, 0.21), (0.08, 0.65, 0.28)], 90, 0.004, solid=False, half=False),
    Part("bracer", None, mesh=bracer),
    Part("hand", hand(), "hand", [(0.40, 0.38, -0.08), (0.64, 0.66, 0.16)], 440, 0.004),
    Part("boot", boot(), None, [(0.03, -0.03, -0.18), (0.29, 0.28, 0.29)], 440, 0.006),
    Part("cuff", cuff(), None, [(0.01, 0.19, -0.14), (0.28, 0.31, 0.15)], 250, 0.006, solid=False),
    Part("pauldron", None, "pauldron", mesh=pauldron),
    Part("face", clay.mirrored(face()), "head", [(0, 0.88, -0.16), (0.18, 1.30, 0.22)], 600, 0.005),
    Part("eye", eyeball(), "head", [(0.02, 1.09, 0.07), (0.09, 1.17, 0.15)], 110, 0.0025, solid=False),
    Part("lids", lids(), "head", [(0.02, 1.09, 0.07), (0.09, 1.17, 0.15)], 170, 0.0016, solid=False),
    Part("beard", clay.mirrored(beard()), "beard", [(0, 0.60, -0.06), (0.24, 1.18, 0.30)], 680, 0.006),
    Part("moustache", clay.mirrored(moustache()), "head", [(0, 0.89, 0.10), (0.22, 1.10, 0.22)], 330, 0.004),
    Part("brow", brow(), "head", [(0.003, 1.11, 0.05), (0.15, 1.24, 0.18)], 150, 0.0024, solid=False),
    Part("hair", clay.mirrored(hair()), "hair", [(0, 0.76, -0.26), (0.22, 1.18, 0.02)], 330, 0.006, solid=False),
    Part("helmet", clay.mirrored(helmet()), "head", [(0, 1.03, -0.20), (0.20, 1.42, 0.21)], 720, 0.005),
    Part("horn", horn(), "head", [(0.08, 1.20, -0.06), (0.32, 1.50, 0.08)], 180, 0.005, solid=False),
]
NAMES = [p.name for p in PARTS]
# Splits of the atlas charts: front and back, top and bottom, inside and outside.
SPLITS = {
    "cloth": (0, 0, 1), "skirt": (0, 0, 1), "hand": (1, 0.3, -0.3), "boot": (1, 0, 0), "cuff": (0, 1, 0), "pauldron": (1, 1, 0),
    "eye": (0, 0, 1), "lids": (0, 0, 1), "beard": (0, 0, 1), "moustache": (0, 0, 1), "brow": (0, 0, 1), "hair": (0, 0, 1), "horn": (0, 0, 1),
    "face": (0, 0, 1),
}


def sculpt():
    """The left halves of all parts (or complete ones), without faces hidden by the parts over them."""
    meshes = []
    for part in PARTS:
        start = time.time()
        if part.mesh:
            mesh = part.mesh()
        else:
            mesh = meshed(part, good=40)
        full = len(mesh.faces)
        if part.shape is not None:
            # A part must not hide what it moves against.
            depth = 0.035 if part.carrier in ("beard", "hair") else 0.006
            covers = [(p.shape, depth) for p in PARTS if p.solid and p is not part and p.carrier in (part.carrier, None)]
            if part.name == "face":
                covers += [(p.shape, 0.030) for p in PARTS if p.name == "beard"]
            mesh = clay.without_hidden(mesh, covers)
        print(f"{part.name}: {len(mesh.faces)} quads of {full}, {time.time() - start:.1f} s", flush=True)
        meshes.append(mesh)
    return meshes


# ---------------------------------------------------------------- colours and relief

BLUE, NAVY, SAND, SKIN = srgb("#2f5f83"), srgb("#213f59"), srgb("#c9a46a"), srgb("#d59a72")
LEATHER, DARK, FUR, RUST = srgb("#6d4428"), srgb("#3a281c"), srgb("#b59a78"), srgb("#a8481c")
STEEL, BRASS, IVORY, INK = srgb("#a9b0b8"), srgb("#d9a441"), srgb("#e6dabd"), srgb("#1d1a19")


def band(x, a, b):
    """Distance to the strip a..b, negative inside."""
    return np.maximum(a - x, x - b)


def strands(p, scale=0.011, seed=0):
    """Strands that run down and fan out from the chin, -1..1."""
    across = np.arctan2(p[:, 0], 0.35 + np.abs(p[:, 2])) * 0.35 + 0.006 * noise(p, 0.06, seed)
    fine = np.cos(across * 2 * np.pi / scale + 2.0 * noise(p * [1, 0.3, 1], 0.03, seed + 1))
    return 0.7 * fine + 0.5 * noise(p * [1, 0.12, 1], 0.006, seed + 2)


def along_arm(p):
    q = np.column_stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]]) - ELBOW
    d = (WRIST - ELBOW) / np.linalg.norm(WRIST - ELBOW)
    return q @ d


def cloth_parts(p):
    """Signed distances of trousers, sleeve hem and lower sleeve."""
    x, y = np.abs(p[:, 0]), p[:, 1]
    trousers = np.where(x < 0.30, y - 0.47, 1.0)
    t = along_arm(p)
    lower = np.where(x > 0.27, 0.0 - t, 1.0)
    return trousers, lower, t


def folds(p):
    q = np.column_stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]])
    x, y, z = q.T
    warp = 0.016 * noise(q, 0.07, 1) + 0.008 * noise(q, 0.028, 2)
    near = lambda v, width: np.exp(-((v / width) ** 2))
    t = along_arm(p)
    arm = np.where(x > 0.25, near(t, 0.045) + 0.7 * near(t + 0.10, 0.05), 0)
    leg = np.where(y < 0.46, 1.0 * near(y - 0.31, 0.05) + 0.6 * near(y - 0.40, 0.04), 0)
    waist = np.where((x < 0.26) & (y > 0.5), 0.9 * near(y - 0.64, 0.05), 0)
    wave = np.sin((np.where(x > 0.25, t, y) + warp) * 2 * np.pi / 0.042 + 6 * z)
    return 0.0026 * (arm + leg + waist) * wave + 0.0016 * noise(q, 0.11, 5)


def height(part, p):
    name = NAMES[part]
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    q = np.column_stack([x, y, z])
    if name == "cloth":
        trousers, lower, t = cloth_parts(p)
        seam = groove(np.where(x > 0.27, lower, 1.0), 0.006, 0.002)
        weave = 0.0003 * np.cos(x * 900) * np.cos(y * 900)
        quilt = np.minimum(np.abs(np.sin((x + y) * np.pi / 0.062)), np.abs(np.sin((x - y) * np.pi / 0.062))) * 0.062 / np.pi
        chest = (y > 0.60) & (t < -0.02) & (x < 0.30)
        return folds(p) + seam + np.where(chest, groove(quilt, 0.010, 0.0020), weave)
    if name == "skirt":
        around = np.arctan2(p[:, 0], p[:, 2])
        hem = 0.0012 * edge(y - 0.392, 0.003)
        return 0.0030 * np.cos(np.abs(around) * 13 + 3 * noise(q, 0.1, 4)) * np.clip((0.55 - y) / 0.12, 0, 1) * (y > 0.39) + hem + groove(y - 0.392, 0.004, 0.001)
    if name == "cuff":
        return 0.0028 * noise(q * [1, 0.55, 1], 0.012, 7) + 0.0016 * noise(q * [1, 0.5, 1], 0.005, 8)
    if name == "beard" or name == "hair":
        return 0.0024 * strands(p)
    if name == "moustache":
        return 0.0018 * np.cos((y + 0.45 * x) * 2 * np.pi / 0.010 + 2 * noise(q, 0.03, 3)) + 0.0008 * noise(q, 0.005, 4)
    if name == "brow":
        return 0.0014 * np.cos((y - 0.2 * x) * 2 * np.pi / 0.007 + 2 * noise(q, 0.02, 3))
    if name == "helmet":
        rim = (p - RIM_AT) @ RIM
        around = np.arctan2(x, z)
        rivet = lambda a, b: 0.0030 * np.clip(1.0 - (np.hypot(a, b) / 0.0075) ** 2, 0, 1)
        step = np.pi / 9
        to = (around - step / 2) - np.round((around - step / 2) / step) * step
        h = np.where(rim < 0.06, rivet(to * 0.165, rim - 0.026), 0.0)
        ridge = (np.arctan2(y - 1.175, np.abs(z)) % 0.36 - 0.18) * 0.18
        h = h + np.where((x < 0.022) & (y > 1.21), rivet(x, ridge), 0.0)
        dents = 0.0007 * noise(q, 0.035, 4)
        return h + dents + groove(rim - 0.054, 0.004, 0.0012)
    if name == "horn":
        t = np.hypot(x - 0.13, y - 1.26)
        return 0.0011 * np.cos(t * 2 * np.pi / 0.017) * np.clip(1.5 - t / 0.13, 0, 1) + 0.0004 * noise(q, 0.004, 2)
    if name == "boot":
        tread = np.where(y < 0.034, 0.0014 * np.clip(3 * np.cos(np.arctan2(x - 0.158, z - 0.05) * 24), -1, 1), 0)
        strap = 0.003 * edge(np.abs(y - 0.16 - 0.2 * z) - 0.017, 0.004)
        return tread + groove(y - 0.042, 0.005, 0.002) + strap + 0.0004 * noise(q, 0.007, 3) + groove(np.where(y > 0.05, z - 0.150, 1.0), 0.005, 0.001)
    if name in ("belt", "bracer"):
        if name == "bracer":
            t = along_arm(p)
            return 0.0009 * np.cos(t * 2 * np.pi / 0.022) * edge(band(t, 0.058, 0.140), 0.003) + 0.0003 * noise(q, 0.005, 2)
        return groove(np.abs(y - BELT_Y) - 0.024, 0.003, 0.0009) + 0.0004 * noise(q, 0.005, 3)
    if name == "pauldron":
        t = (q - PAULDRON_AT) @ PAULDRON_OUT
        a = q - PAULDRON_AT - np.outer(t, PAULDRON_OUT)
        around = np.arctan2(a[:, 2], a @ [0.714, -0.70, 0.0])
        to = (around / (np.pi / 7) % 1.0 - 0.5) * (np.pi / 7) * 0.115
        rivet = 0.0028 * np.clip(1.0 - (np.hypot(to, t - 0.026) / 0.0065) ** 2, 0, 1)
        return 0.0006 * noise(q, 0.03, 3) + rivet * (t < 0.045) + groove(t - 0.043, 0.004, 0.0012)
    if name == "hand":
        return 0.0004 * noise(q, 0.008, 3)
    if name == "face":
        frown = groove(np.where((z > 0.10) & (x < 0.02), x - 0.010, 1.0), 0.005, 0.0012) * (y > 1.14)
        crow = np.where((x > 0.085) & (z > 0.05), groove(np.abs(y - 1.125 + 0.4 * (x - 0.09)) - 0.008, 0.004, 0.0008), 0.0)
        return 0.0004 * noise(q, 0.006, 3) + frown + crow
    return np.zeros(len(p))


def paint(part, p, n, opened):
    name = NAMES[part]
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    q = np.column_stack([x, y, z])
    ones = np.ones(len(p))
    grime = np.clip(0.5 + 0.5 * noise(q, 0.07, 11) + 0.35 * noise(q, 0.02, 12), 0, 1)
    metal = 0.0 * ones
    shade = lambda c, dark, k=0.6: mixed(c, dark, k * (1 - opened))
    if name == "cloth":
        trousers, lower, t = cloth_parts(p)
        c = np.tile(BLUE, (len(p), 1))
        c = mixed(c, SAND * 0.92, edge(lower))
        c = mixed(c, srgb("#5a4a3c"), edge(trousers))
        c = mixed(c, BRASS * 0.9, edge(np.where(x > 0.27, band(t, -0.020, 0.002), 1.0)))
        c = c * (0.90 + 0.16 * grime)[:, None] * (1.0 + 22.0 * np.clip(folds(p), -0.004, 0.004))[:, None]
        return shade(c, c * 0.4), 0.85 * ones, metal
    if name == "skirt":
        c = np.tile(BLUE * 0.92, (len(p), 1))
        c = mixed(c, BRASS * 0.92, edge(y - 0.392))
        key = np.abs((np.arctan2(p[:, 0], p[:, 2]) * 24 / np.pi) % 2 - 1) - 0.5
        c = mixed(c, NAVY, edge(band(y, 0.366, 0.382)) * edge(key * 0.03, 0.002))
        c = c * (0.88 + 0.16 * grime)[:, None]
        return shade(c, c * 0.35), 0.85 * ones, metal
    if name == "cuff":
        tuft = np.clip(0.5 + 0.5 * noise(q * [1, 0.55, 1], 0.012, 7) + 0.3 * noise(q * [1, 0.5, 1], 0.005, 8), 0, 1)
        c = FUR * 0.62 + (FUR * 1.18 - FUR * 0.62) * tuft[:, None]
        return shade(c, FUR * 0.3), 0.95 * ones, metal
    if name in ("beard", "hair", "moustache", "brow"):
        s = strands(p) if name in ("beard", "hair") else np.cos((y + 0.45 * x) * 2 * np.pi / 0.010 + 2 * noise(q, 0.03, 3))
        c = np.tile(RUST * (1.08 if name in ("moustache", "brow") else 1.0), (len(p), 1))
        c = c * (0.92 + 0.16 * s)[:, None]
        # Sun-bleached towards the tips.
        c = mixed(c, srgb("#d07a36"), 0.55 * np.clip((0.82 - y) / 0.16, 0, 1) if name == "beard" else 0.0 * ones)
        return shade(np.clip(c, 0, 1), RUST * 0.28, 0.8), 0.62 * ones, metal
    if name == "helmet":
        rim = (p - RIM_AT) @ RIM
        brass = np.maximum(edge(rim - 0.055), edge(np.where(y > 1.19, x - 0.0225, 1.0)))
        socket = np.column_stack([x, y, z]) - [0.105, 1.245, -0.01]
        s = socket @ axes((0.86, 0.50, 0), (0, 0, 1))
        brass = np.maximum(brass, edge(np.maximum(np.hypot(s[:, 1], s[:, 2]) - 0.050, 0.035 - s[:, 0])))
        c = mixed(np.tile(STEEL, (len(p), 1)), BRASS, brass)
        worn = np.clip(noise(q, 0.05, 21) + 0.5 * noise(q, 0.012, 22), -1, 1)
        c = c * (0.94 + 0.08 * worn)[:, None]
        return shade(c, c * 0.3, 0.8), 0.36 + 0.14 * grime, 0.85 * ones
    if name == "pauldron":
        t = (q - PAULDRON_AT) @ PAULDRON_OUT
        c = mixed(np.tile(STEEL, (len(p), 1)), BRASS, np.maximum(edge(t - 0.0405), edge(0.103 - t)))
        c = c * (0.9 + 0.1 * grime)[:, None]
        return shade(c, c * 0.3, 0.8), 0.38 + 0.14 * grime, 0.85 * ones
    if name == "horn":
        t = np.clip(np.hypot(x - 0.13, y - 1.26) / 0.24, 0, 1)
        c = mixed(np.tile(IVORY, (len(p), 1)), DARK * 1.2, np.clip((t - 0.55) / 0.45, 0, 1))
        c = c * (0.86 + 0.10 * np.cos(np.hypot(x - 0.13, y - 1.26) * 2 * np.pi / 0.017) * (1 - t) + 0.1 * grime)[:, None]
        return shade(c, c * 0.4), 0.5 * ones, metal
    if name == "boot":
        c = np.tile(LEATHER * 0.85, (len(p), 1))
        c = mixed(c, DARK, edge(np.abs(y - 0.16 - 0.2 * z) - 0.017))
        cap = edge(np.where(y > 0.046, 0.150 - z, 1.0))
        c = mixed(c, STEEL * 0.9, cap)
        c = mixed(c, INK * 1.3, edge(y - 0.042))
        c = mixed(c, SAND * 0.7, 0.30 * np.clip((0.12 - y) / 0.12, 0, 1) * grime * (1 - cap))
        return shade(c * (0.85 + 0.25 * grime)[:, None], DARK * 0.5), 0.66 - 0.26 * cap, 0.8 * cap
    if name in ("belt", "bracer"):
        c = np.tile(LEATHER, (len(p), 1))
        brass = 0.0 * ones
        if name == "bracer":
            t = along_arm(p)
            brass = np.maximum(edge(t - 0.0555), edge(0.1425 - t))
            c = mixed(c, BRASS, brass)
        c = c * (0.78 + 0.3 * grime)[:, None]
        return shade(c, DARK * 0.5), 0.7 - 0.3 * brass, 0.85 * brass
    if name == "buckle":
        c = np.tile(BRASS, (len(p), 1)) * (0.86 + 0.18 * grime)[:, None]
        inner = edge(np.maximum(x - 0.034, np.abs(y - BELT_Y) - 0.028)) * (z > 0.24)
        c = mixed(c, INK * 1.4, inner * 0.85)
        return c, 0.34 * ones, 0.9 * ones
    if name == "eye":
        d = np.hypot(x - EYE[0] + 0.003, y - EYE[1] + 0.001)
        c = np.tile(srgb("#efe9df"), (len(p), 1))
        c = mixed(c, srgb("#4d7a3a"), edge(d - 0.0125))
        c = mixed(c, srgb("#2c4a22"), edge(np.abs(d - 0.0122) - 0.0012, 0.001))
        c = mixed(c, INK * 0.5, edge(d - 0.0062))
        glint = np.hypot(x - EYE[0] - 0.001, y - EYE[1] - 0.006) - 0.0030
        c = mixed(c, np.ones(3), edge(glint))
        front = (z > EYE[2])[:, None]
        return np.where(front, c, srgb("#efe9df")), 0.15 * ones, metal
    # Skin: face, lids, hands.
    c = np.tile(SKIN, (len(p), 1))
    if name in ("face", "lids"):
        red = lambda center, r: np.exp(-np.sum((q - np.array(center)) ** 2, axis=1) / r**2)
        c = mixed(c, srgb("#c4623f"), 0.75 * red((0.0, 1.078, 0.175), 0.036) + 0.55 * red((0.072, 1.082, 0.115), 0.036) + 0.5 * red((0.145, 1.09, -0.01), 0.03))
        if name == "lids":
            c = mixed(c, srgb("#b5714f"), 0.45 * ones)
    else:
        knuckle = noise(q, 0.03, 5)
        c = mixed(c, srgb("#c06f4c"), np.clip(0.25 + 0.25 * knuckle + 0.4 * np.clip((0.49 - y) / 0.06, 0, 1), 0, 1))
    c = c * (0.94 + 0.08 * grime)[:, None]
    return shade(c, srgb("#7d3f28"), 0.7), 0.6 * ones, metal


# ---------------------------------------------------------------- weights


def weights_of(s, body):
    w = rig.smoothed(place_weights(s, body.vertices), body.faces, 2)
    v = body.vertices
    for i, part in enumerate(PARTS):
        if part.carrier is None:
            continue
        mine = np.unique([k for f, p in zip(body.faces, body.part) if p == i for k in f])
        p = v[mine]
        if part.carrier == "hand":
            for side, sign in (("l", 1.0), ("r", -1.0)):
                own = mine[sign * p[:, 0] > 0]
                q = v[own] * [sign, 1, 1]
                frame = axes(AT["lfist"] - WRIST, (-0.32, 0.0, 1.0))
                t = (q - WRIST) @ frame
                fist = rig.smooth_step((t[:, 0] - 0.092) / 0.036 + 0.5) * (1 - rig.smooth_step((t[:, 2] - 0.058) / 0.006 + 0.5))
                # The thumb starts on the side of its root that faces away from the index finger.
                thumb = rig.smooth_step((t[:, 2] - 0.052 + 0.25 * np.maximum(t[:, 0] - 0.075, 0)) / 0.022 + 0.5) * (1 - fist)
                low = rig.smooth_step(0.5 - (t[:, 0] + 0.004) / 0.05)
                w[own] = 0
                w[own, s[side + "fist"]] = fist
                w[own, s[side + "thumb"]] = thumb
                rest = np.clip(1 - fist - thumb, 0, 1)
                w[own, s[side + "elbo"]] = rest * low
                w[own, s[side + "wrist"]] = rest * (1 - low)
            continue
        w[mine] = 0
        if part.carrier == "beard":
            first = rig.smooth_step((1.02 - p[:, 1]) / 0.12)
            second = rig.smooth_step((0.90 - p[:, 1]) / 0.14)
            w[mine, s["head"]] = 1 - first
            w[mine, s["beard1"]] = first * (1 - second)
            w[mine, s["beard2"]] = first * second
        elif part.carrier == "skirt":
            # The wide hem clears the thighs in a walk; its front has separate joints for deeper bends.
            low = rig.smooth_step((0.56 - p[:, 1]) / 0.12)
            front = low * rig.smooth_step((p[:, 2] + 0.13) / 0.22)
            left = rig.smooth_step(p[:, 0] / 0.22 + 0.5)
            legs = 0.16 * low * (1 - front)
            w[mine, s["lskirt"]], w[mine, s["rskirt"]] = front * left, front * (1 - left)
            w[mine, s["lhip"]], w[mine, s["rhip"]] = legs * left, legs * (1 - left)
            w[mine, s["middle"]] = 1 - front - legs
        elif part.carrier == "pauldron":
            for side, own in (("l", mine[p[:, 0] > 0]), ("r", mine[p[:, 0] < 0])):
                w[own, s[side + "collar"]], w[own, s[side + "sholda"]] = 0.6, 0.4
        elif part.carrier == "hair":
            # Below the mantle the hair rests on the back.
            low = rig.smooth_step((1.04 - p[:, 1]) / 0.14)
            w[mine, s["head"]] = 1 - low
            w[mine, s["spine1"]] = low
        else:
            w[mine, s[part.carrier]] = 1
    return w


# ---------------------------------------------------------------- the clip

TICKS, RATE = 55, 25.0


def crouch_and_look(s):
    """Hears something, crouches, shades his eyes, looks left, then right, and stands up again."""
    from gait import Figure, curve
    from rig import frame, mul, qx, qy, qz, rotate, slerp

    names = {"hips": "middle", "spine": ["spine2", "spine1"], "head": "head"}
    for side in ("left", "right"):
        roles = {"shoulder": "collar", "arm": "sholda", "forearm": "elbo", "hand": "wrist", "thigh": "hip", "shin": "knee", "foot": "ankle", "toe": "toe"}
        names.update({f"{side}.{r}": side[0] + j for r, j in roles.items()})
    figure = Figure(s, names)
    down = [(0, 0), (4, -0.06), (12, 1.0), (16, 0.94), (42, 0.97), (45, 1.03), (53, -0.03), (55, 0)]
    look = [(0, 0), (3, -4), (12, 30), (20, 36), (24, 30), (33, -40), (40, -38), (46, -8), (55, 0)]
    shade = [(0, 0), (5, 0), (14, 1), (43, 1), (52, 0), (55, 0)]

    def pose(f):
        turns, moves = {}, {}
        d, y, hand = (float(curve(k, f)) for k in (down, look, shade))
        late = float(curve(look, max(f - 2.2, 0) if f < 53 else f))
        drop = float(curve(down, max(f - 2, 0) if f < 52 else f))
        moves["middle"] = (0.012 * y / 36, -0.088 * d, -0.045 * d)
        turns["middle"] = mul(qy(0.12 * y), qx(15 * d))
        figure.spine(turns, pitch=13 * d, yaw=0.38 * y, roll=-2 * d)
        figure.head(turns, pitch=-20 * d + 2.0 * np.sin(f * 0.9) * hand * 0.6, yaw=0.62 * y, roll=0.10 * y)
        # The beard hangs down and follows the head with a delay.
        turns["beard1"] = mul(qy(0.45 * (late - y)), qx(3 * d - 14 * (drop - d)))
        turns["beard2"] = mul(qy(0.35 * (late - y)), qx(4 * d - 10 * (drop - d)))
        for side, sign in (("left", 1), ("right", -1)):
            ankle = figure.place(f"{side}.foot").copy()
            figure.leg(turns, moves, side, ankle, 0, 0, knee=np.array([sign * 0.24, 0, 1.0]))
        turns["rcollar"] = qz(-20 * hand)
        # The left hand rests on the knee, the right one shades the eyes.
        for side, sign in (("left", 1), ("right", -1)):
            hang, chest = figure.world(turns, moves, "spine1")
            rest_hand = figure.place(f"{side}.hand")
            free = hang + rotate(chest, rest_hand - figure.skeleton.world[s["spine1"]])
            free = free + np.array([0, -0.012 * d, 0.03 * d])
            if side == "left":
                knee, _ = figure.world(turns, moves, "lknee")
                goal, amount = knee + np.array([0.075, 0.135, 0.030]), d
                want = mul(chest, qx(-38), qz(-4))
                pole = np.array([0.9, 0.15, -0.75])
            else:
                head, head_turn = figure.world(turns, moves, "head")
                goal, amount = head + rotate(head_turn, np.array([-0.185, 0.150, 0.150])), hand
                # Fingers to the left, the palm down, the thumb to the helmet's rim.
                along = (AT["lfist"] - WRIST) * [-1, 1, 1]
                want = mul(head_turn, frame(np.array([0.90, 0.16, 0.34]), np.array([0.3, 0.35, -1.0]), along, np.array([0.32, 0.0, 1.0])))
                pole = np.array([-0.75, -0.85, 0.20])
            amount = float(np.clip(amount, 0, 1))
            place = free + (goal - free) * amount
            # Swings out around the belly and the beard.
            place = place + np.array([sign * 0.06, 0, 0.05]) * np.sin(np.pi * amount)
            turn = slerp(chest, want, amount)
            rest_pole = np.array([sign * 0.35, 0, -1.0])
            figure.limb(turns, moves, f"{side}.arm", f"{side}.forearm", f"{side}.hand", place, turn,
                        rotate(chest, rest_pole * (1 - amount)) + pole * amount, np.array([sign * 0.35, 0.0, -1.0]))
            # The hem gives way to the thigh.
            turns[side[0] + "skirt"] = mul(qx(-34 * d), qz(sign * 17 * d))
        turns["lfist"] = qz(-18 * d)
        turns["rfist"] = qz(-10 * hand)
        return turns, moves

    return [pose(f) for f in range(TICKS)] + [pose(0)]


# ---------------------------------------------------------------- the file


def main(size=int(os.environ.get("ATLAS", "640"))):
    import gait
    import glb
    import paint as paint_

    s = skeleton()
    meshes = sculpt()
    out = glb.Glb()
    nodes = out.nodes_of(s)
    joints = list(range(1, len(s.names)))
    left = clay.joined(meshes)
    alone = [i for i, m in enumerate(meshes) if m.whole]
    left_uv = paint_.unwrap(left, {NAMES.index(n): v for n, v in SPLITS.items()})
    scene = lambda p: np.minimum.reduce([clay.mirrored(part.shape)(p) for part in PARTS if part.shape]) + 0.002
    base, bump, orm = paint_.bake(left, left_uv, [p.shape for p in PARTS], paint, height, size, scene)
    shown = paint_.surface(left, left_uv, alone)
    unit_normals(shown)
    values, slots = rig.strongest(weights_of(s, shown.mesh), joints)
    material = out.add("materials", {
        "name": "dwarf",
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": out.image(base, quality=74, name="dwarf colour")},
            "metallicRoughnessTexture": {"index": (relief := out.image(orm, quality=72, name="dwarf surface"))},
        },
        "normalTexture": {"index": out.image(bump, quality=74, name="dwarf relief")},
        "occlusionTexture": {"index": relief},
    })
    primitive = out.primitive(
        shown.place, shown.normal, shown.triangles, material, shown.uv, joints=slots[shown.vertex],
        weights=values[shown.vertex], tangent=shown.tangent,
    )
    print(len(shown.place), "vertices,", len(shown.triangles), "triangles")
    mesh = out.add("meshes", {"name": "dwarf", "primitives": [primitive]})
    skin = out.skin(s, nodes, joints, "dwarf")
    node = out.add("nodes", {"name": "dwarf", "mesh": mesh, "skin": skin})
    out.clip("crouch and look", nodes, gait.channels(s, crouch_and_look(s), RATE, tight=[n for n in s.names if n[1:] in ("hip", "knee", "ankle") or n == "middle"], tolerance=0.04, move_tolerance=0.0001))
    print(out.write(OUT, [nodes[0], node]), "bytes")


if __name__ == "__main__":
    main()
