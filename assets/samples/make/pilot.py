"""Makes ../pilot.glb: a test pilot in a flight suit, 52 animated joints with Mixamo's names, six clips."""

import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
import humanoid
from paint import edge, groove, noise, srgb
from clay import box, capsule, common, cut, ellipsoid, forward, grown, halfspace, sideways, union, upright

OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "pilot.glb")

# ---------------------------------------------------------------- the body under everything (left half)


def torso():
    trunk = upright(
        [
            (0.845, 0, -0.006, 0.100, 0.070),
            (0.90, 0, -0.012, 0.158, 0.102),
            (0.96, 0, -0.010, 0.163, 0.106),
            (1.03, 0, -0.002, 0.146, 0.098),
            (1.09, 0, 0.003, 0.136, 0.094),
            (1.17, 0, 0.004, 0.145, 0.101),
            (1.26, 0, 0.002, 0.166, 0.114),
            (1.34, 0, -0.006, 0.176, 0.114),
            (1.40, 0, -0.014, 0.158, 0.094),
            (1.445, 0, -0.018, 0.105, 0.072),
            (1.475, 0, -0.018, 0.072, 0.064),
            (1.53, 0, -0.010, 0.062, 0.062),
        ],
        power=2.35,
        rounding=0.03,
    )
    seat = ellipsoid((0.075, 0.905, -0.055), (0.082, 0.085, 0.065))
    chest = ellipsoid((0.078, 1.315, 0.070), (0.088, 0.070, 0.046))
    return union(union(trunk, seat, k=0.05), chest, k=0.05)


def arm():
    limb = sideways(
        [
            (0.10, 1.408, -0.016, 0.052, 0.056),
            (0.19, 1.408, -0.017, 0.068, 0.067),
            (0.25, 1.410, -0.018, 0.062, 0.062),
            (0.34, 1.411, -0.020, 0.053, 0.054),
            (0.42, 1.411, -0.022, 0.047, 0.048),
            (0.46, 1.411, -0.023, 0.046, 0.047),
            (0.53, 1.411, -0.021, 0.049, 0.050),
            (0.60, 1.411, -0.018, 0.044, 0.046),
            (0.655, 1.411, -0.017, 0.034, 0.036),
        ],
        rounding=0.02,
    )
    slope = capsule((0.03, 1.455, -0.020), (0.175, 1.425, -0.020), 0.040, 0.052)
    return union(limb, slope, k=0.05)


def leg():
    return upright(
        [
            (0.93, 0.088, -0.006, 0.080, 0.096),
            (0.86, 0.097, -0.002, 0.088, 0.099),
            (0.78, 0.101, 0.004, 0.084, 0.092),
            (0.66, 0.103, 0.010, 0.071, 0.077),
            (0.57, 0.104, 0.012, 0.062, 0.066),
            (0.508, 0.105, 0.013, 0.058, 0.063),
            (0.44, 0.106, 0.004, 0.056, 0.062),
            (0.35, 0.107, -0.010, 0.058, 0.066),
            (0.25, 0.108, -0.018, 0.048, 0.053),
            (0.15, 0.108, -0.020, 0.040, 0.044),
            (0.09, 0.108, -0.020, 0.038, 0.044),
        ],
        rounding=0.02,
    )


TORSO, ARM, LEG = torso(), arm(), leg()
SUIT = clay.mirrored(union(union(TORSO, ARM, k=0.075), LEG, k=0.035))

# ---------------------------------------------------------------- clothing and equipment


def glove():
    palm = sideways(
        [
            (0.685, 1.411, -0.017, 0.030, 0.035),
            (0.72, 1.410, -0.017, 0.026, 0.038),
            (0.76, 1.409, -0.017, 0.0235, 0.045),
            (0.80, 1.409, -0.018, 0.0185, 0.047),
        ],
        rounding=0.014,
        power=2.4,
    )
    hand = union(palm, ellipsoid((0.742, 1.397, 0.012), (0.030, 0.018, 0.024)), k=0.015)
    s = humanoid.skeleton(prefix="")
    for name, (r0, r1) in {
        "Index": (0.0122, 0.0098),
        "Middle": (0.0125, 0.0100),
        "Ring": (0.0120, 0.0096),
        "Pinky": (0.0108, 0.0088),
    }.items():
        p = humanoid.finger_places(name)
        finger = union(
            capsule(p[0] - [0.022, 0, 0], p[1], r0 * 1.08, r0),
            capsule(p[1], p[2], r0, (r0 + r1) / 2),
            capsule(p[2], p[3] - [0.006, 0, 0], (r0 + r1) / 2, r1),
            k=0.002,
        )
        hand = union(hand, finger, k=0.0055)
    t = [s.world[s[f"LeftHandThumb{i}"]] for i in (1, 2, 3, 4)]
    thumb = union(
        capsule(t[0], t[1], 0.0175, 0.0145),
        capsule(t[1], t[2], 0.0145, 0.0128),
        capsule(t[2], t[3], 0.0128, 0.0105),
        k=0.003,
    )
    hand = union(hand, thumb, k=0.010)
    wrist = sideways([(0.645, 1.411, -0.017, 0.0385, 0.0405), (0.70, 1.411, -0.017, 0.0315, 0.0365)], rounding=0.006)
    return union(hand, wrist, k=0.012)


def cuff():
    """The gauntlet: a flared tube with a rolled rim, its inside continuing to the sleeve."""
    cone = sideways(
        [
            (0.56, 1.411, -0.018, 0.0585, 0.0605),
            (0.625, 1.411, -0.018, 0.0525, 0.0545),
            (0.66, 1.411, -0.017, 0.0440, 0.0470),
            (0.71, 1.411, -0.017, 0.0345, 0.0395),
        ],
        rounding=0.004,
    )
    profile = [
        (0.614, -0.014),
        (0.597, -0.007),
        (0.592, 0.000),
        (0.595, 0.0045),
        (0.604, 0.0050),
        (0.609, 0.0015),
        (0.630, 0.0),
        (0.650, 0.0),
        (0.668, 0.0),
        (0.684, 0.0008),
        (0.693, 0.0005),
        (0.697, -0.004),
    ]
    return clay.ring(cone, (0, 1.411, -0.0175), (1, 0, 0), (0, 1, 0), profile, 20)


def boot():
    shaft = upright(
        [
            (0.325, 0.107, -0.011, 0.0665, 0.0745),
            (0.28, 0.108, -0.016, 0.0610, 0.0680),
            (0.20, 0.108, -0.020, 0.0530, 0.0580),
            (0.13, 0.108, -0.022, 0.0490, 0.0560),
            (0.07, 0.109, -0.022, 0.0480, 0.0560),
        ],
        rounding=0.008,
    )
    foot = forward(
        [
            (-0.088, 0.109, 0.050, 0.034, 0.038),
            (-0.050, 0.109, 0.062, 0.046, 0.058),
            (0.000, 0.110, 0.064, 0.047, 0.062),
            (0.060, 0.112, 0.050, 0.048, 0.048),
            (0.110, 0.114, 0.044, 0.051, 0.040),
            (0.160, 0.115, 0.040, 0.048, 0.034),
            (0.200, 0.115, 0.036, 0.034, 0.026),
        ],
        rounding=0.022,
        power=2.3,
    )
    sole = upright(
        [
            (0.0, 0.1125, 0.056, 0.054, 0.152),
            (0.014, 0.1125, 0.056, 0.056, 0.154),
            (0.030, 0.1125, 0.056, 0.0545, 0.152),
        ],
        rounding=0.007,
        power=2.7,
    )
    waist = ellipsoid((0.06, 0.0, 0.028), (0.022, 0.024, 0.045))
    sole = cut(sole, waist, k=0.01)
    strap = common(
        grown(union(shaft, foot, k=0.03), 0.0055),
        box(
            (0.11, 0.125, 0.0),
            (0.2, 0.013, 0.2),
            0.004,
            rotation=np.array([[1, 0, 0], [0, 0.94, -0.34], [0, 0.34, 0.94]]),
        ),
        k=0.004,
    )
    return union(union(union(shaft, foot, k=0.03), strap, k=0.004), sole, k=0.006)


def boot_rim():
    shaft = upright(
        [
            (0.20, 0.108, -0.020, 0.0530, 0.0580),
            (0.28, 0.108, -0.016, 0.0610, 0.0680),
            (0.37, 0.107, -0.008, 0.0720, 0.0800),
        ]
    )
    profile = [
        (0.300, 0.000),
        (0.308, 0.0035),
        (0.322, 0.0050),
        (0.338, 0.0045),
        (0.345, 0.0015),
        (0.346, -0.005),
        (0.338, -0.012),
        (0.318, -0.018),
    ]
    return clay.ring(shaft, (0.1075, 0, -0.012), (0, 1, 0), (0, 0, 1), profile, 20)


def vest():
    body = grown(union(TORSO, ARM, k=0.075), 0.015)
    low = halfspace((0, 1.105, 0), (0, -1, 0))
    neck = ellipsoid((0, 1.49, 0.03), (0.088, 0.115, 0.12))
    hole = capsule((0.225, 1.385, -0.018), (0.40, 1.33, -0.018), 0.098, flatten=((0, 0, 1), 1.25))
    trim = cut(cut(common(body, low, k=0.012), hole, k=0.012), neck, k=0.010)
    trim = common(trim, halfspace((0.172, 1.42, 0), (1, 0.30, 0)), k=0.012)
    core = grown(union(TORSO, ARM, k=0.075), -0.012)
    trim = cut(trim, core, k=0.004)
    plate = common(grown(TORSO, 0.026), box((0.0, 1.265, 0.12), (0.118, 0.085, 0.09), 0.03), k=0.012)
    return union(trim, plate, k=0.008)


def hem():
    """The vest's lower border."""
    outside = grown(union(TORSO, ARM, k=0.075), 0.015)
    profile = [
        (-0.013, -0.020),
        (-0.013, -0.004),
        (-0.010, 0.0035),
        (0.0, 0.0052),
        (0.012, 0.0048),
        (0.020, 0.0035),
        (0.023, -0.006),
    ]
    return clay.ring(outside, (0, 1.110, 0.003), (0, 1, 0), (0, 0, 1), profile, 40, half=True)


BELT_Y = 1.022


def belt():
    profile = [
        (-0.024, -0.006),
        (-0.024, 0.006),
        (-0.020, 0.0105),
        (0.0, 0.0115),
        (0.020, 0.0105),
        (0.024, 0.006),
        (0.024, -0.006),
    ]
    return clay.ring(TORSO, (0, BELT_Y, -0.004), (0, 1, 0), (0, 0, 1), profile, 40, half=True)


def _turned(degrees):
    a = np.radians(degrees)
    return np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])


def buckle():
    return box((0, BELT_Y, 0.108), (0.034, 0.027, 0.013), 0.009)


def pouch():
    r = _turned(50)
    bag = box((0.113, BELT_Y - 0.020, 0.086), (0.036, 0.040, 0.026), 0.012, rotation=r)
    flap = box((0.115, BELT_Y + 0.004, 0.088), (0.039, 0.017, 0.029), 0.010, rotation=r)
    return union(bag, flap, k=0.003)


def side_pouch():
    bag = box((0.166, BELT_Y - 0.018, -0.022), (0.024, 0.048, 0.040), 0.013)
    flap = box((0.168, BELT_Y + 0.012, -0.022), (0.027, 0.018, 0.043), 0.011)
    return union(bag, flap, k=0.003)


HEAD = (0.0, 1.640, 0.004)


def helmet_outer():
    dome = ellipsoid((0, 1.655, -0.004), (0.131, 0.137, 0.150))
    jaw = forward(
        [
            (-0.07, 0, 1.585, 0.098, 0.072),
            (0.0, 0, 1.575, 0.108, 0.074),
            (0.07, 0, 1.567, 0.098, 0.066),
            (0.142, 0, 1.566, 0.058, 0.046),
        ],
        rounding=0.045,
        power=2.3,
    )
    return union(dome, jaw, k=0.05)


def window(p, grow=0.0):
    """The visor's outline on the helmet, wrapping around to the temples, negative inside."""
    around = np.arctan2(np.abs(p[:, 0]), np.maximum(p[:, 2] + 0.03, 1e-3)) * 0.145
    middle = 1.652 - 0.30 * np.maximum(around - 0.06, 0.0) ** 1.0 * 0.25
    across, tall = 0.172 + grow, 0.060 + grow - 0.06 * np.maximum(around - 0.05, 0)
    f = ((around / across) ** 4 + (np.abs(p[:, 1] - middle) / tall) ** 4 + 1e-12) ** 0.25
    return (f - 1.0) * tall + np.where(p[:, 2] < -0.03, 1.0, 0.0)


HELMET_OUTER = helmet_outer()


def helmet():
    outer = HELMET_OUTER
    frame = common(grown(outer, 0.0065), lambda p: window(p, 0.016), k=0.006)
    body = union(outer, frame, k=0.004)
    deep = common(grown(outer, 0.03), lambda p: window(p, 0.0), k=0.004)
    body = cut(body, cut(deep, grown(outer, -0.014), k=0.004), k=0.005)
    opening = capsule((0, 1.40, -0.012), (0, 1.545, -0.008), 0.086, 0.080)
    body = cut(body, opening, k=0.012)
    turn = np.array([[0, 0, 1.0], [0, 1, 0], [-1.0, 0, 0]])
    ear = sideways([(0.10, 1.632, -0.028, 0.046, 0.046), (0.150, 1.632, -0.028, 0.044, 0.044)], rounding=0.008)
    dial = sideways([(0.12, 1.632, -0.028, 0.030, 0.030), (0.158, 1.632, -0.028, 0.027, 0.027)], rounding=0.006)
    crest = common(grown(outer, 0.010), box((0, 1.75, -0.03), (0.022, 0.12, 0.14), 0.01), k=0.008)
    crest = common(crest, halfspace((0, 1.735, 0.06), (0, -0.55, 0.9)), k=0.01)
    respirator = forward([(0.10, 0, 1.562, 0.046, 0.032), (0.172, 0, 1.558, 0.040, 0.027)], rounding=0.012, power=3.0)
    return union(union(body, ear, respirator, crest, k=0.006), dial, k=0.004)


def visor():
    """A sheet of glass just under the helmet's outer surface; its border is hidden inside the wall."""
    glass = grown(HELMET_OUTER, -0.0035)
    around, heights = np.linspace(0.0, 1.29, 11), np.linspace(1.578, 1.728, 10)
    a, y = [c.reshape(-1) for c in np.meshgrid(around, heights)]
    out = np.column_stack([np.sin(a), 0 * a, np.cos(a)])
    center = np.column_stack([0 * a, y, 0 * a - 0.03])
    n = len(around)
    faces = [
        [r * n + c, r * n + c + 1, (r + 1) * n + c + 1, (r + 1) * n + c]
        for r in range(len(heights) - 1)
        for c in range(n - 1)
    ]
    mesh = clay.Mesh(clay.cast(glass, center + out * 0.25, -out * 0.25, 1.0), faces)
    mesh.plane = a == 0.0
    mesh.vertices[mesh.plane, 0] = 0.0
    mesh.whole = False
    return mesh


def collar():
    """The neck ring under the helmet."""
    neck = upright([(1.42, 0, -0.016, 0.092, 0.082), (1.46, 0, -0.015, 0.092, 0.083), (1.54, 0, -0.010, 0.086, 0.080)])
    profile = [
        (1.440, -0.006),
        (1.446, 0.010),
        (1.458, 0.016),
        (1.476, 0.017),
        (1.490, 0.012),
        (1.497, 0.002),
        (1.496, -0.012),
    ]
    return clay.ring(neck, (0, 0, -0.014), (0, 1, 0), (0, 0, 1), profile, 28, half=True)


def pack():
    body = box((0.0, 1.285, -0.178), (0.128, 0.150, 0.056), 0.034)
    low = box((0.0, 1.175, -0.170), (0.105, 0.05, 0.056), 0.026)
    ridge = box((0.0, 1.30, -0.232), (0.052, 0.105, 0.016), 0.012)
    tank = capsule((0.092, 1.19, -0.205), (0.092, 1.375, -0.205), 0.040)
    cap = sideways([(0.0, 1.425, -0.175, 0.020, 0.024), (0.085, 1.425, -0.175, 0.020, 0.024)], rounding=0.01)
    return union(union(body, low, k=0.02), union(ridge, cap, k=0.006), tank, k=0.010)


LIMB = union(TORSO, ARM, k=0.075)


def shoulder_pad():
    profile = [(0, 0.027), (0.45, 0.026), (0.72, 0.0235), (0.86, 0.019), (0.94, 0.010), (1, -0.004)]
    return clay.patch(
        LIMB, (0.212, 1.47, -0.018), (0.30, 1, 0), (0, 0, 1), (0.052, 0.060), profile, 10, power=2.6, reach=0.3
    )


def knee_pad():
    profile = [(0, 0.026), (0.32, 0.025), (0.42, 0.018), (0.75, 0.0165), (0.88, 0.012), (1, -0.004)]
    return clay.patch(
        LEG, (0.105, 0.518, 0.08), (0.06, 0.02, 1), (0, 1, 0), (0.050, 0.076), profile, 10, power=2.6, reach=0.2
    )


class Part:
    """A piece: its clay, or a ready mesh of the left half, and the joint that carries it whole (None: by the gates)."""

    def __init__(self, name, shape, carrier=None, box=None, quads=0, step=0.004, mesh=None, solid=True, half=True):
        self.name, self.shape, self.carrier = name, shape, carrier
        self.box, self.quads, self.step, self.mesh, self.half = box, quads, step, mesh, half
        # Whether its clay hides what is inside it.
        self.solid = solid and shape is not None


PARTS = [
    Part("suit", SUIT, None, [(0, 0.06, -0.2), (0.74, 1.56, 0.2)], 2600, 0.008),
    Part("glove", glove(), None, [(0.60, 1.33, -0.13), (0.93, 1.49, 0.12)], 1040, 0.0024),
    Part("cuff", None, mesh=cuff),
    Part("boot", boot(), None, [(0.02, -0.03, -0.14), (0.22, 0.39, 0.25)], 760),
    Part("boot rim", None, mesh=boot_rim),
    Part("vest", clay.mirrored(vest()), None, [(0, 1.05, -0.2), (0.30, 1.57, 0.2)], 1150),
    Part("hem", None, mesh=hem),
    Part("belt", None, mesh=belt),
    Part("buckle", buckle(), "Hips", [(-0.05, 0.98, 0.08), (0.05, 1.07, 0.14)], 90, 0.003, half=False),
    Part("pouch", pouch(), "Hips", [(0.05, 0.93, 0.03), (0.18, 1.08, 0.15)], 220, 0.003, solid=False),
    Part("side pouch", side_pouch(), "Hips", [(0.11, 0.93, -0.09), (0.22, 1.08, 0.04)], 220, 0.003, solid=False),
    Part("helmet", clay.mirrored(helmet()), "Head", [(0, 1.45, -0.2), (0.2, 1.83, 0.22)], 1100),
    Part("visor", None, "Head", mesh=visor),
    Part("collar", None, mesh=collar),
    Part("pack", clay.mirrored(pack()), "Spine2", [(0, 1.08, -0.28), (0.2, 1.48, -0.08)], 500, 0.005),
    Part("shoulder", None, mesh=shoulder_pad),
    Part("knee", None, mesh=knee_pad),
]


def sculpt():
    """The left halves of all parts (or complete ones), without faces hidden by the parts over them."""
    meshes = []
    for part in PARTS:
        start = time.time()
        if part.mesh:
            mesh = part.mesh()
        else:
            mesh = clay.mesh_of(part.shape, *part.box, part.quads, part.step, part.half)
        full = len(mesh.faces)
        if part.shape is not None:
            covers = [(p.shape, 0.022 if p.carrier == "Head" else 0.0105) for p in PARTS if p.solid and p is not part]
            mesh = clay.without_hidden(mesh, covers)
        print(f"{part.name}: {len(mesh.faces)} quads of {full}, {time.time() - start:.1f} s", flush=True)
        meshes.append(mesh)
    return meshes


# ---------------------------------------------------------------- colours and relief

# Splits of the atlas charts: front and back, top and bottom, inside and outside.
SPLITS = {
    "suit": (0, 0, 1),
    "glove": (0, 1, 0),
    "boot": (1, 0, 0),
    "vest": (0, 0, 1),
    "shoulder": (0, 1, 0),
    "knee": (0, 0, 1),
    "visor": (0, 0, 1),
}
NAMES = [p.name for p in PARTS]
ORANGE, DEEP, CHARCOAL, INK = srgb("#d9581c"), srgb("#b8430f"), srgb("#3a3f47"), srgb("#23262b")
BONE, TEAL, SILVER, TAN = srgb("#e9e3d6"), srgb("#1f9a98"), srgb("#c9ccd0"), srgb("#6b5a48")


def mixed(base, color, amount):
    return base + (color - base) * np.asarray(amount)[:, None]


def band(x, a, b):
    """Distance to the strip a..b, negative inside."""
    return np.maximum(a - x, x - b)


def suit_regions(p):
    """Signed distances (metres, negative inside) of the suit's panels and lines."""
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    trunk = y > 0.86
    on_arm = x > 0.215
    around_arm = np.arctan2(z + 0.020, -(y - 1.411))  # 0: underside
    around_leg = np.arctan2(x - 0.104, z - 0.005)  # 0: front, + outside
    sleeve = np.where(on_arm, np.abs(around_arm) * 0.048 - 0.030, 1.0)
    flank = np.where(
        (~on_arm) & trunk & (y < 1.42),
        np.abs(np.arctan2(x / 0.155, z / 0.10 + 0.12) - 1.62) * 0.125 - 0.034 - 0.10 * np.clip(y - 1.2, 0, 0.1),
        1.0,
    )
    inner = np.where(y < 0.93, np.abs(np.abs(around_leg) - np.pi * 0.5) * 0.07, 1.0)
    inner = np.where((y < 0.93) & (around_leg < 0), inner - 0.034, 1.0)
    pocket = np.maximum(band(y, 0.665, 0.790), band(around_leg * 0.085, 0.028, 0.118))
    flap = np.maximum(band(y, 0.762, 0.794), band(around_leg * 0.085, 0.025, 0.121))
    pocket, flap = np.where(y < 0.88, pocket, 1.0), np.where(y < 0.88, flap, 1.0)
    bands = np.minimum(
        np.where(on_arm, np.minimum(band(x, 0.352, 0.378), band(x, 0.386, 0.391)), 1.0),
        np.where(y < 0.86, np.minimum(band(y, 0.600, 0.628), band(y, 0.589, 0.593)), 1.0),
    )
    return sleeve, flank, inner, pocket, flap, bands


def folds(p):
    """Creases where the cloth bends, metres."""
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    q = np.column_stack([x, y, z])
    warp = noise(q, 0.07, 1) * 0.016 + noise(q, 0.03, 2) * 0.004
    near = lambda d, w: np.exp(-((d / w) ** 2))
    arm = np.where(
        x > 0.22,
        near(x - 0.455, 0.055) * (0.5 + 0.5 * np.tanh((z + 0.03) / 0.03))
        + 0.6 * near(x - 0.57, 0.03)
        + 0.35 * near(x - 0.27, 0.05),
        0,
    )
    leg = np.where(
        y < 0.92,
        0.9 * near(y - 0.50, 0.05) * (0.35 + 0.65 * (z < 0.01))
        + 1.0 * near(y - 0.385, 0.035)
        + 0.7 * near(y - 0.86, 0.05),
        0,
    )
    waist = np.where(x < 0.2, 0.8 * near(y - 1.075, 0.035) + 0.4 * near(y - 0.965, 0.04), 0)
    wave_x = np.sin((x + warp) * 2 * np.pi / 0.030 + 9 * z)
    wave_y = np.sin((y + warp) * 2 * np.pi / 0.031 + 7 * x)
    round_ = lambda w: 0.5 * w + 0.5 * np.abs(w) * w
    return (
        0.0018 * (arm * round_(wave_x) + (leg + waist) * round_(wave_y))
        + 0.0012 * noise(q, 0.09, 5)
        + 0.0005 * noise(q, 0.035, 7)
    )


def height(part, p):
    name = NAMES[part]
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    q = np.column_stack([x, y, z])
    if name == "suit":
        sleeve, flank, inner, pocket, flap, bands = suit_regions(p)
        h = folds(p)
        for d in (sleeve, flank, inner):
            h = h + groove(d, 0.004, 0.0012) - groove(d - 0.006, 0.004, 0.0006)
        h = h + 0.0022 * edge(pocket, 0.004) + 0.0016 * edge(flap, 0.003) + 0.0008 * edge(bands, 0.002)
        h = h + groove(pocket + 0.007, 0.0022, 0.0006) + groove(flap + 0.006, 0.0022, 0.0006)
        return h + groove(np.where((y > 0.87) & (z > 0) & (x < 0.05), x, 1.0), 0.005, 0.0016)
    if name == "vest":
        plate = np.maximum(band(y, 1.185, 1.345), x - 0.112)
        ribs = np.where((z < -0.02) | (plate > 0.004), np.cos(y * 2 * np.pi / 0.034), 0.0)
        h = 0.0012 * np.clip(ribs * 2.5, -1, 1) * edge(0.012 - plate, 0.01) * (y > 1.125) * (y < 1.38)
        for d in (np.abs(x - 0.040), np.abs(y - 1.265) + np.where(x > 0.108, 1.0, 0)):
            h = h + np.where(plate < -0.004, groove(d, 0.004, 0.0016), 0)
        return h + 0.0003 * noise(q, 0.006, 3)
    if name == "glove":
        knuckles = np.where(x > 0.79, groove(x - 0.832, 0.004, 0.0008) + groove(x - 0.860, 0.004, 0.0007), 0)
        pad = np.maximum(np.maximum(band(x, 0.728, 0.788), np.abs(z + 0.018) - 0.036), 1.405 - y)
        return knuckles + 0.0018 * edge(pad, 0.004) + 0.0002 * noise(q, 0.004, 4)
    if name == "cuff":
        return 0.0010 * np.cos(x * 2 * np.pi / 0.0125) * edge(x - 0.676, 0.008) * edge(0.616 - x, 0.008)
    if name == "boot":
        sole = band(y, 0.006, 0.026)
        tread = np.where(sole < 0.003, 0.0012 * np.clip(3 * np.cos(np.arctan2(x - 0.112, z - 0.05) * 26), -1, 1), 0)
        front = np.where((z > -0.02) & (y > 0.14), np.abs(x - 0.108), 1.0)
        return (
            tread
            + groove(y - 0.0315, 0.004, 0.0015)
            + groove(front - 0.020, 0.004, 0.0012)
            + np.where(front < 0.02, 0.0012 * np.cos(y * 2 * np.pi / 0.022), 0)
            + np.where(y < 0.10, groove(z - 0.125 + 0.4 * (x - 0.113) ** 2 / 0.05, 0.004, 0.0012), 0)
            + 0.0002 * noise(q, 0.005, 4)
        )
    if name == "helmet":
        seam = groove(np.where(window(p, 0.016) > 0.006, z + 0.052 - 0.35 * (y - 1.6), 1.0), 0.0035, 0.0016)
        jaw = groove(np.where(z > -0.045, y - 1.588 + 0.05 * z, 1.0), 0.003, 0.0013) * (x > 0.055)
        vents = np.where((x < 0.034) & (z > 0.13), 0.0022 * np.clip(2 * np.cos(x * 2 * np.pi / 0.0135), -1, 1), 0)
        frame = groove(window(p, 0.016) - 0.001, 0.003, 0.0012)
        return seam + jaw + vents * edge(np.abs(y - 1.56) - 0.018, 0.003) + frame
    if name == "pack":
        lines = groove(np.where(z < -0.21, y - 1.235, 1.0), 0.004, 0.0018) + groove(
            np.where(x < 0.056, y - 1.36, 1.0), 0.004, 0.0015
        )
        grille = np.where(
            (x < 0.036) & (z < -0.236),
            0.002 * np.clip(2 * np.cos(y * 2 * np.pi / 0.016), -1, 1) * edge(band(y, 1.255, 1.345), 0.004),
            0,
        )
        return lines + grille + groove(z + 0.158, 0.004, 0.0015)
    if name in ("shoulder", "knee"):
        return 0.0002 * noise(q, 0.01, 2)
    if name == "buckle":
        return groove(np.maximum(x - 0.024, np.abs(y - BELT_Y) - 0.016), 0.004, 0.0016)
    if name in ("belt", "pouch", "side pouch"):
        return 0.0002 * noise(q, 0.004, 3)
    return np.zeros(len(p))


def paint(part, p, n, opened):
    name = NAMES[part]
    x, y, z = np.abs(p[:, 0]), p[:, 1], p[:, 2]
    q = np.column_stack([x, y, z])
    ones = np.ones(len(p))
    grime = np.clip(0.5 + 0.5 * noise(q, 0.06, 11) + 0.35 * noise(q, 0.02, 12), 0, 1)
    metal = 0.0 * ones
    if name == "suit":
        sleeve, flank, inner, pocket, flap, bands = suit_regions(p)
        c = np.tile(ORANGE, (len(p), 1))
        dark = np.maximum.reduce([edge(sleeve), edge(flank), edge(inner)])
        c = mixed(c, DEEP, 0.55 * np.maximum(edge(pocket), edge(flap)))
        c = mixed(c, CHARCOAL, dark)
        c = mixed(c, SILVER, edge(bands))
        for d in (pocket + 0.007, flap + 0.006):
            stitch = edge(np.abs(d) - 0.0008, 0.001) * (np.cos((x + y + z) * 2 * np.pi / 0.007) > -0.2)
            c = mixed(c, BONE, 0.35 * stitch)
        c = c * (0.94 + 0.10 * grime)[:, None]
        c = c * (1.0 + 26.0 * np.clip(folds(p), -0.003, 0.003))[:, None]
        c = mixed(c, INK, 0.35 * np.clip((0.50 - y) / 0.2, 0, 1) * grime)
        rough = 0.82 - 0.30 * edge(bands)
        c = mixed(c, ORANGE * 0.45, 0.5 * (1 - opened))
        return c, rough, metal
    if name == "vest":
        plate = np.maximum(band(y, 1.185, 1.345), x - 0.112)
        c = np.tile(INK * 1.25, (len(p), 1))
        c = mixed(c, CHARCOAL * 1.2, edge(plate))
        lamp = np.hypot(x - 0.076, y - 1.305) - 0.012
        c = mixed(c, TEAL * 1.15, edge(lamp) * (z > 0))
        tab = np.maximum(np.abs(x - 0.076) - 0.020, np.abs(y - 1.225) - 0.007)
        c = mixed(c, ORANGE, edge(tab) * (z > 0))
        return c * (0.9 + 0.2 * grime)[:, None], 0.62 + 0.15 * grime - 0.3 * edge(lamp), metal
    if name in ("glove", "cuff"):
        c = np.tile(INK * 1.15, (len(p), 1))
        pad = np.maximum(np.maximum(band(x, 0.728, 0.788), np.abs(z + 0.018) - 0.036), 1.405 - y)
        c = mixed(c, CHARCOAL * 1.3, edge(pad))
        c = mixed(c, ORANGE, edge(band(x, 0.588, 0.6115)))
        c = mixed(c, TEAL, edge(band(x, 0.684, 0.692)))
        c = mixed(c, CHARCOAL, 0.6 * edge(0.868 - x, 0.01))
        return c * (0.88 + 0.22 * grime)[:, None], 0.68 + 0.1 * grime, metal
    if name == "boot":
        c = np.tile(CHARCOAL * 0.95, (len(p), 1))
        c = mixed(c, INK * 0.8, edge(y - 0.031))
        c = mixed(c, INK, edge(np.where((z > -0.02) & (y > 0.14), np.abs(x - 0.108), 1.0) - 0.020))
        c = mixed(c, INK, edge(0.128 - z, 0.002) * (y < 0.1) * (y > 0.031))
        dust = np.clip((0.09 - y) / 0.09, 0, 1) * grime
        c = mixed(c, TAN * 1.3, 0.32 * dust)
        return c, 0.55 + 0.3 * dust, metal
    if name == "boot rim":
        c = np.tile(ORANGE, (len(p), 1))
        c = mixed(c, INK, edge(y - 0.306))
        return c * (0.85 + 0.2 * grime)[:, None], 0.65 * ones, metal
    if name == "helmet":
        c = np.tile(BONE, (len(p), 1))
        frame = edge(window(p, 0.0155))
        stripe = edge(x - 0.021) * (y > 1.70)
        c = mixed(c, ORANGE, stripe)
        c = mixed(c, ORANGE, edge(band(z, -0.082, -0.060)) * (y < 1.70) * (y > 1.575) * (x > 0.05) * 0.0)
        swoosh = band(y - 1.60 + 0.12 * (z + 0.02), -0.012, 0.010)
        c = mixed(c, TEAL, edge(np.where(z < -0.055, swoosh, 1.0)))
        c = mixed(c, INK, edge(np.hypot(y - 1.632, z + 0.028) - 0.0285) * (x > 0.12))
        c = mixed(c, ORANGE, edge(np.abs(np.hypot(y - 1.632, z + 0.028) - 0.036) - 0.003) * (x > 0.12))
        c = mixed(c, INK * 1.1, frame)
        c = mixed(c, CHARCOAL, edge(np.maximum(x - 0.044, np.abs(y - 1.56) - 0.03)) * (z > 0.125))
        c = mixed(c, INK, edge(y - 1.508, 0.003))
        chips = np.clip((noise(q, 0.012, 21) + 0.6 * noise(q, 0.005, 22) - 0.95) * 6, 0, 1) * (y < 1.62)
        c = mixed(c, CHARCOAL * 1.6, 0.6 * chips)
        c = c * (0.96 + 0.06 * grime)[:, None]
        return mixed(c, BONE * 0.5, 0.35 * (1 - opened)), 0.36 + 0.16 * grime + 0.2 * frame, metal
    if name == "visor":
        c = srgb("#0f1c26") + (srgb("#2b4a55") - srgb("#0f1c26")) * np.clip((y - 1.60) / 0.10, 0, 1)[:, None]
        return c, 0.07 * ones, 0.75 * ones
    if name in ("belt", "pouch", "side pouch"):
        c = np.tile(TAN, (len(p), 1))
        if name == "belt":
            stitch = edge(np.abs(np.abs(y - BELT_Y) - 0.017) - 0.0008, 0.001) * (
                np.cos((x + z) * 2 * np.pi / 0.007) > -0.2
            )
            c = mixed(c, BONE, 0.4 * stitch)
        else:
            stud = edge(np.hypot((x + z) - (0.215 if name == "pouch" else 5.0), y - BELT_Y + 0.002) - 0.006)
            c = mixed(c, SILVER * 0.7, stud)
        c = c * (0.80 + 0.25 * grime)[:, None]
        return mixed(c, TAN * 0.4, 0.5 * (1 - opened)), 0.72 * ones, metal
    if name == "buckle":
        inner = np.maximum(x - 0.024, np.abs(y - BELT_Y) - 0.016)
        c = np.tile(SILVER * 0.85, (len(p), 1))
        c = mixed(c, INK, edge(np.abs(inner) - 0.0012))
        return c, 0.35 + 0.2 * grime, 0.9 * ones
    if name == "pack":
        c = np.tile(CHARCOAL * 1.35, (len(p), 1))
        tank = edge(np.where(z < -0.19, np.abs(x - 0.092) - 0.0415, 1.0)) * (y < 1.42) * (y > 1.14)
        c = mixed(c, BONE, tank)
        c = mixed(c, ORANGE, tank * edge(band(y, 1.345, 1.366)))
        c = mixed(c, INK, edge(x - 0.050) * (z < -0.225))
        c = mixed(c, TEAL, edge(np.maximum(x - 0.03, np.abs(y - 1.378) - 0.006)) * (z < -0.235))
        return c * (0.9 + 0.15 * grime)[:, None], 0.45 + 0.2 * grime, metal
    if name in ("shoulder", "knee"):
        c = np.tile(BONE, (len(p), 1))
        if name == "shoulder":
            c = mixed(c, ORANGE, edge(band(x, 0.252, 0.266)))
        else:
            c = mixed(c, CHARCOAL, edge(np.hypot((x - 0.105) / 0.030, (y - 0.52) / 0.058) * 0.03 - 0.030) * 0.85)
        chips = np.clip((noise(q, 0.014, 31) + 0.6 * noise(q, 0.005, 32) - 0.8) * 6, 0, 1)
        c = mixed(c, CHARCOAL * 1.5, 0.55 * chips)
        return c * (0.93 + 0.1 * grime)[:, None], 0.42 + 0.2 * grime, metal
    c = np.tile(TEAL * 0.9 if name == "hem" else CHARCOAL, (len(p), 1))
    return c * (0.9 + 0.15 * grime)[:, None], 0.6 * ones, metal


# ---------------------------------------------------------------- the file


def main():
    import gait
    import glb
    import moves
    import paint as paint_
    import rig

    s = humanoid.skeleton()
    g = humanoid.gates(s)
    meshes = sculpt()
    out = glb.Glb()
    nodes = out.nodes_of(s)
    joints = [j for j, n in enumerate(s.names) if not (n.endswith("_End") or n.endswith("4"))]
    left = clay.joined(meshes)
    alone = [i for i, m in enumerate(meshes) if m.whole]
    left_uv = paint_.unwrap(left, {NAMES.index(n): v for n, v in SPLITS.items()})
    scene = lambda p: np.minimum.reduce([clay.mirrored(part.shape)(p) for part in PARTS if part.shape])
    base, bump, orm = paint_.bake(left, left_uv, [p.shape for p in PARTS], paint, height, 896, scene)
    shown = paint_.surface(left, left_uv, alone)
    body = shown.mesh
    w = g.weights(body.vertices, "mixamorig:Hips")
    for i, part in enumerate(PARTS):
        if part.carrier:
            mine = np.unique([v for f, p in zip(body.faces, body.part) if p == i for v in f])
            w[mine] = 0
            w[mine, s["mixamorig:" + part.carrier]] = 1
    values, slots = rig.strongest(w, joints)
    material = out.add(
        "materials",
        {
            "name": "pilot",
            "pbrMetallicRoughness": {
                "baseColorTexture": {"index": out.image(base, quality=69, name="pilot colour")},
                "metallicRoughnessTexture": {"index": (relief := out.image(orm, quality=62, name="pilot surface"))},
            },
            "normalTexture": {"index": out.image(bump, quality=69, name="pilot relief")},
            "occlusionTexture": {"index": relief},
        },
    )
    primitive = out.primitive(
        shown.place,
        shown.normal,
        shown.triangles,
        material,
        shown.uv,
        joints=slots[shown.vertex],
        weights=values[shown.vertex],
        tangent=shown.tangent,
    )
    print(len(shown.place), "vertices,", len(shown.triangles), "triangles")
    mesh = out.add("meshes", {"name": "pilot", "primitives": [primitive]})
    skin = out.skin(s, nodes, joints, "pilot")
    node = out.add("nodes", {"name": "pilot", "mesh": mesh, "skin": skin})
    figure = moves.mixamo_figure(s)
    legs = [n for n in s.names if any(w in n for w in ("Hips", "Leg", "Foot", "Toe"))]
    for name, poses, rate in moves.all_clips(figure):
        out.clip(name, nodes, gait.channels(s, poses, rate, tight=legs))
    print(out.write(OUT, [nodes[0], node]), "bytes")


if __name__ == "__main__":
    main()
