"""Makes ../creature.glb: a fox with a scarf, 0.85 m high to the tips of its ears, with the clips idle, walk and run.

Gaits. Walk: lateral sequence - left hind, left fore, right hind, right fore, a quarter of a stride apart - each paw on the
ground for 0.63 of the stride, the body highest when a fore leg passes under it. Run: rotary gallop - left hind, right hind,
right fore, left fore, as dogs and foxes do - each paw down for less than a quarter, with a stretched flight after the hind
legs' push and a gathered one after the fore legs'; the back bends and stretches with it. Sources: Hildebrand, "The
quadrupedal gaits of vertebrates" (BioScience 1989); Alexander, "Principles of Animal Locomotion" (2003), ch. 7; Bertram and
Gutmann, "Motions of the running horse and cheetah revisited" (2009) for the rotary order; Muybridge, "Animals in Motion".

Legs are solved from the toes up: the toe tip is fixed on the moving ground, metatarsus and pastern follow a key curve, and
two-bone inverse kinematics solves the rest. All clips are in place.
"""

import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
import rig
from clay import capsule, common, cut, ellipsoid, forward, halfspace, union
from paint import edge, groove, noise, srgb
from rig import conj, mul, qx, qy, qz, rotate, slerp, smooth_step
from sculpting import bent, meshed, mixed, pointed, unit_normals

OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "creature.glb")

# ---------------------------------------------------------------- joints

# Center and left side, metres; the fox faces +Z. The last number is the thickness of the body around the bone that starts
# there, which determines the weights.
PLACES = [
    ("root", None, (0, 0, 0)),
    ("hips", "root", (0, 0.400, -0.200)),
    ("spine1", "hips", (0, 0.412, -0.090)),
    ("spine2", "spine1", (0, 0.410, 0.015)),
    ("chest", "spine2", (0, 0.405, 0.120)),
    ("neck", "chest", (0, 0.445, 0.225)),
    ("head", "neck", (0, 0.575, 0.305)),
    ("ear.L", "head", (0.048, 0.690, 0.315)),
    ("eartip.L", "ear.L", (0.078, 0.765, 0.312)),
    ("scapula.L", "chest", (0.050, 0.445, 0.150)),
    ("upperarm.L", "scapula.L", (0.066, 0.335, 0.205)),
    ("forearm.L", "upperarm.L", (0.070, 0.240, 0.145)),
    ("pastern.L", "forearm.L", (0.069, 0.110, 0.165)),
    ("forepaw.L", "pastern.L", (0.069, 0.032, 0.183)),
    ("thigh.L", "hips", (0.060, 0.385, -0.195)),
    ("shank.L", "thigh.L", (0.076, 0.262, -0.130)),
    ("metatarsus.L", "shank.L", (0.071, 0.140, -0.240)),
    ("hindpaw.L", "metatarsus.L", (0.071, 0.032, -0.203)),
    ("tail1", "hips", (0, 0.410, -0.285)),
    ("tail2", "tail1", (0, 0.395, -0.370)),
    ("tail3", "tail2", (0, 0.375, -0.460)),
    ("tail4", "tail3", (0, 0.385, -0.560)),
]
AT = {name: np.array(place) for name, _, place in PLACES}


def skeleton():
    s = rig.Skeleton()
    for name, up, place in PLACES:
        s.add(name, up, place)
        if name.endswith(".L"):
            right = up.replace(".L", ".R") if up else None
            s.add(name.replace(".L", ".R"), right, (-place[0], place[1], place[2]))
    return s


# Bones for the weights: joint, from, to, radius, softness. From and to are joints or positions.
BONES = [
    ("hips", (0, 0.400, -0.270), "spine1", 0.070, 0.014),
    ("spine1", "spine1", "spine2", 0.075, 0.014),
    ("spine2", "spine2", "chest", 0.078, 0.014),
    ("chest", "chest", (0, 0.425, 0.215), 0.080, 0.014),
    ("neck", "neck", "head", 0.060, 0.014),
    ("scapula.L", "scapula.L", "upperarm.L", 0.028, 0.012),
    ("upperarm.L", "upperarm.L", "forearm.L", 0.036, 0.009),
    ("forearm.L", "forearm.L", "pastern.L", 0.026, 0.007),
    ("pastern.L", "pastern.L", "forepaw.L", 0.022, 0.006),
    ("forepaw.L", "forepaw.L", (0.069, 0.022, 0.235), 0.024, 0.006),
    ("thigh.L", "thigh.L", "shank.L", 0.046, 0.012),
    ("shank.L", "shank.L", "metatarsus.L", 0.026, 0.008),
    ("metatarsus.L", "metatarsus.L", "hindpaw.L", 0.020, 0.006),
    ("hindpaw.L", "hindpaw.L", (0.071, 0.022, -0.150), 0.024, 0.006),
    ("tail1", "tail1", "tail2", 0.036, 0.012),
    ("tail2", "tail2", "tail3", 0.055, 0.014),
    ("tail3", "tail3", "tail4", 0.065, 0.014),
    ("tail4", "tail4", (0, 0.430, -0.680), 0.050, 0.014),
]


def place_weights(s, p):
    """Weights by distance to bones, relative to their thickness; points equally close to two bones follow both."""
    rows, joints = [], []
    for name, a, b, radius, soft in BONES:
        a, b = (AT[v] if isinstance(v, str) else np.array(v) for v in (a, b))
        for side, sign in ((".L", 1.0), (".R", -1.0)) if name.endswith(".L") else (("", 1.0),):
            mirror = np.array([sign, 1, 1])
            start, along = a * mirror, (b - a) * mirror
            t = np.clip((p - start) @ along / (along @ along), 0, 1)
            d = np.linalg.norm(p - start - t[:, None] * along, axis=1)
            rows.append((d - radius) / soft)
            joints.append(s[name.replace(".L", side)])
    rows = np.array(rows)
    k = np.exp(-(rows - rows.min(axis=0)))
    w = np.zeros((len(p), len(s.names)))
    w[:, joints] = (k / k.sum(axis=0)).T
    return w


# ---------------------------------------------------------------- clay (left half)


TRUNK = forward(
    [
        (-0.310, 0, 0.405, 0.030, 0.036),
        (-0.270, 0, 0.398, 0.068, 0.076),
        (-0.205, 0, 0.390, 0.086, 0.098),
        (-0.110, 0, 0.400, 0.078, 0.086),
        (-0.010, 0, 0.393, 0.080, 0.092),
        (0.090, 0, 0.378, 0.090, 0.114),
        (0.170, 0, 0.382, 0.090, 0.120),
        (0.240, 0, 0.415, 0.070, 0.096),
        (0.285, 0, 0.440, 0.040, 0.055),
    ],
    rounding=0.02, power=2.15,
)
NECK = bent([(0, 0.415, 0.170), (0, 0.480, 0.245), (0, 0.545, 0.288), (0, 0.605, 0.315)], [0.092, 0.078, 0.066, 0.060], k=0.03)
BIB = union(
    bent([(0, 0.500, 0.300), (0, 0.420, 0.312), (0, 0.345, 0.285)], [0.046, 0.052, 0.012], k=0.015),
    bent([(0.030, 0.490, 0.290), (0.040, 0.425, 0.292), (0.038, 0.365, 0.272)], [0.040, 0.042, 0.010], k=0.015), k=0.012,
)


def paw(at):
    x, z = at
    pad = ellipsoid((x, 0.026, z + 0.012), (0.029, 0.027, 0.040))
    shape = pad
    for dx, dz, r in ((-0.0175, 0.035, 0.0135), (0.0, 0.044, 0.0145), (0.0175, 0.036, 0.0135)):
        shape = union(shape, ellipsoid((x + dx, 0.0175, z + dz), (r, 0.0175, 0.022)), k=0.005)
    return common(shape, halfspace((0, 0.0, 0), (0, -1, 0)), k=0.006)


def fore_leg():
    upper = bent([(0.056, 0.420, 0.165), (0.066, 0.335, 0.198), (0.071, 0.243, 0.152)], [0.052, 0.056, 0.036], k=0.02)
    lower = bent([(0.071, 0.243, 0.150), (0.070, 0.180, 0.157), (0.069, 0.112, 0.166), (0.069, 0.040, 0.184)], [0.038, 0.0285, 0.0225, 0.0235], k=0.012, count=8)
    return union(union(upper, lower, k=0.02), paw((0.069, 0.188)), k=0.014)


def hind_leg():
    thigh = bent([(0.054, 0.390, -0.205), (0.070, 0.330, -0.168), (0.077, 0.262, -0.138)], [0.074, 0.066, 0.044], k=0.02)
    ham = bent([(0.050, 0.360, -0.250), (0.068, 0.280, -0.205), (0.072, 0.200, -0.205)], [0.050, 0.042, 0.018], k=0.02)
    shank = bent([(0.077, 0.258, -0.140), (0.074, 0.200, -0.192), (0.071, 0.140, -0.236)], [0.042, 0.031, 0.0225], k=0.012)
    lower = bent([(0.071, 0.142, -0.240), (0.071, 0.090, -0.224), (0.071, 0.038, -0.200)], [0.0235, 0.0195, 0.0225], k=0.012)
    leg = union(union(thigh, ham, k=0.03), union(shank, lower, k=0.012), k=0.02)
    return union(leg, paw((0.071, -0.198)), k=0.014)


def tail():
    core = bent(
        [(0, 0.405, -0.270), (0, 0.402, -0.345), (0, 0.385, -0.440), (0, 0.385, -0.540), (0, 0.415, -0.640), (0, 0.480, -0.760)],
        [0.032, 0.046, 0.070, 0.074, 0.052, 0.005], k=0.03, count=12,
    )
    tufts = union(
        bent([(0.030, 0.375, -0.500), (0.050, 0.372, -0.580), (0.044, 0.390, -0.650)], [0.044, 0.034, 0.006], k=0.01),
        bent([(0.0, 0.350, -0.490), (0.0, 0.352, -0.570), (0.0, 0.385, -0.640)], [0.044, 0.034, 0.008], k=0.01),
        bent([(0.018, 0.425, -0.540), (0.026, 0.450, -0.620), (0.016, 0.486, -0.680)], [0.040, 0.028, 0.006], k=0.01), k=0.012,
    )
    return union(core, tufts, k=0.016)


BODY = clay.mirrored(
    union(union(union(union(TRUNK, NECK, k=0.05), BIB, k=0.016), fore_leg(), hind_leg(), k=0.030), tail(), k=0.030)
)

# ---------------------------------------------------------------- the head

EYE = np.array([0.0475, 0.634, 0.379])


def head():
    skull = ellipsoid((0, 0.628, 0.330), (0.082, 0.073, 0.080))
    brow = ellipsoid((0.034, 0.652, 0.370), (0.040, 0.026, 0.034))
    muzzle = forward(
        [(0.35, 0, 0.607, 0.056, 0.044), (0.39, 0, 0.603, 0.042, 0.036), (0.43, 0, 0.600, 0.027, 0.026), (0.468, 0, 0.598, 0.020, 0.020), (0.490, 0, 0.598, 0.014, 0.014)],
        rounding=0.014,
    )
    cheeks = union(
        bent([(0.040, 0.600, 0.345), (0.088, 0.588, 0.330), (0.148, 0.560, 0.308)], [0.042, 0.034, 0.004], k=0.01),
        bent([(0.040, 0.585, 0.335), (0.075, 0.560, 0.325), (0.110, 0.520, 0.310)], [0.040, 0.028, 0.004], k=0.01),
        bent([(0.045, 0.615, 0.335), (0.092, 0.615, 0.318), (0.146, 0.608, 0.292)], [0.036, 0.028, 0.004], k=0.01), k=0.012,
    )
    shape = union(union(skull, muzzle, k=0.05), brow, k=0.02)
    shape = union(shape, cheeks, k=0.020)
    shape = cut(shape, ellipsoid(EYE + [0.006, 0.001, 0.018], (0.024, 0.019, 0.019)), k=0.014)
    mouth = union(capsule((0, 0.583, 0.485), (0.024, 0.584, 0.425), 0.0032, 0.0028), capsule((0.024, 0.584, 0.425), (0.041, 0.594, 0.392), 0.0028, 0.002), k=0.002)
    shape = cut(shape, mouth, k=0.006)
    ear = bent([(0.048, 0.660, 0.318), (0.066, 0.722, 0.314), (0.090, 0.795, 0.309), (0.104, 0.842, 0.305)], [0.050, 0.043, 0.0195, 0.0045], k=0.008, flatten=((0.25, 0, 1.0), 0.5))
    hollow = bent([(0.052, 0.694, 0.338), (0.068, 0.732, 0.334), (0.090, 0.796, 0.322)], [0.033, 0.029, 0.006], k=0.008, flatten=((0.25, 0, 1.0), 0.62))
    return union(shape, cut(ear, hollow, k=0.006), k=0.014)


def lids():
    """Upper lids with a slight slant for a friendly expression."""
    whole = clay.shell(clay.sphere(EYE, 0.0222), 0.0042)
    upper = common(whole, halfspace(EYE + [0, -0.0020, 0], (0.16, -0.95, 0.26)), k=0.002)
    lower = common(whole, halfspace(EYE + [0, -0.0130, 0], (0.0, 1.0, 0.0)), k=0.002)
    return union(upper, lower, k=0.001)


def nose():
    return union(ellipsoid((0, 0.607, 0.492), (0.0165, 0.0125, 0.0125)), ellipsoid((0, 0.600, 0.489), (0.009, 0.012, 0.010)), k=0.006)


def scarf():
    """A scarf around the neck with a knot under the left cheek and two ends."""
    a, b = np.array([0.0, 0.495, 0.256]), np.array([0.0, 0.86, 0.51])
    b = b / np.linalg.norm(b)
    side = np.cross([1.0, 0, 0], b)

    def band(p):
        q = p - a
        t = q @ b
        # Wider in front, over the fur of the chest.
        x, z = q[:, 0], np.where(q @ side > 0, (q @ side) / 1.42, q @ side)
        around = np.arctan2(x, z)
        r = np.hypot(x / 0.97, z)
        wave = 0.006 * np.cos(3 * around + 0.8) + 0.003 * np.cos(7 * around)
        return (np.hypot((r - 0.083) / 0.80, (t - wave) / 1.15) - 0.027) * 0.85

    knot = ellipsoid((0.054, 0.448, 0.352), (0.027, 0.030, 0.024))
    ends = union(
        bent([(0.054, 0.445, 0.354), (0.066, 0.400, 0.350), (0.080, 0.335, 0.328)], [0.020, 0.030, 0.036], k=0.006, flatten=((0.5, 0, 1.0), 0.34)),
        bent([(0.058, 0.448, 0.348), (0.100, 0.412, 0.325), (0.128, 0.362, 0.290)], [0.018, 0.026, 0.032], k=0.006, flatten=((0.75, 0.1, 0.75), 0.34)), k=0.004,
    )
    return union(union(band, knot, k=0.008), ends, k=0.006)


class Part:
    """A piece: its clay and the joint that carries it whole, or None: by nearness to bones."""

    def __init__(self, name, shape, carrier, box, quads, step, half=True, relax=3):
        self.name, self.shape, self.carrier, self.box, self.quads, self.step = name, shape, carrier, box, quads, step
        self.half, self.relax = half, relax


PARTS = [
    Part("body", BODY, None, [(0, -0.02, -0.80), (0.18, 0.68, 0.38)], 3456, 0.0045, relax=16),
    Part("head", clay.mirrored(head()), "head", [(0, 0.50, 0.22), (0.17, 0.87, 0.52)], 1750, 0.00296),
    Part("eye", clay.sphere(EYE, 0.0205), "head", [(0.02, 0.60, 0.34), (0.09, 0.67, 0.42)], 160, 0.0022),
    Part("lids", lids(), "head", [(0.02, 0.60, 0.34), (0.09, 0.67, 0.42)], 200, 0.0014),
    Part("nose", nose(), "head", [(-0.03, 0.57, 0.46), (0.03, 0.64, 0.52)], 110, 0.0018, half=False),
    Part("scarf", scarf(), "neck", [(-0.13, 0.28, 0.12), (0.20, 0.60, 0.42)], 760, 0.004, half=False),
]
NAMES = [p.name for p in PARTS]
SPLITS = {"body": (1, 0.0, 0.0), "head": (0, 0.35, 1), "eye": (0, 0, 1), "lids": (0, 0, 1), "nose": (0, 0, 1), "scarf": (0, 0, 1)}


# Pointed tips: even quads round them off, so the nearest vertex is moved there.
POINTS = {
    "body": [(0, 0.484, -0.770)],
    "head": [(0.1055, 0.848, 0.3045), (0.151, 0.559, 0.307), (0.112, 0.516, 0.3095), (0.149, 0.608, 0.291)],
}


# Required points, because remeshing sometimes loses a thin limb.
KEEP = {"body": [(0.069, 0.012, 0.24), (0.071, 0.012, -0.145), (0, 0.470, -0.74)], "head": [(0.100, 0.83, 0.306)]}


def sculpt():
    meshes = []
    for part in PARTS:
        start = time.time()
        mesh = pointed(meshed(part, KEEP.get(part.name, ()), good=10), POINTS.get(part.name, ()))
        full = len(mesh.faces)
        hiders = {"body": ["head", "scarf"], "head": ["body"], "eye": ["head"], "lids": ["head"], "nose": ["head"], "scarf": ["body"]}[part.name]
        depth = {"eye": 0.004, "nose": 0.003, "lids": 0.004}.get(part.name, 0.014)
        mesh = clay.without_hidden(mesh, [(p.shape, depth) for p in PARTS if p.name in hiders])
        print(f"{part.name}: {len(mesh.faces)} quads of {full}, {time.time() - start:.1f} s", flush=True)
        meshes.append(mesh)
    return meshes


# ---------------------------------------------------------------- colours and relief

ORANGE, DEEP, CREAM, SOCK = srgb("#dd6f22"), srgb("#a8430f"), srgb("#f6ead6"), srgb("#3b241b")
TEAL, AQUA, INK, AMBER = srgb("#127c80"), srgb("#2ba79f"), srgb("#17110f"), srgb("#d98e1f")


def fur(p, seed=0):
    """Streaks that run backwards on the body and down the legs, -1..1."""
    y, z = p[:, 1], p[:, 2]
    leg = np.clip((0.30 - y) / 0.08, 0, 1)
    along = noise(p * [1, 1, 0.22], 0.0075, seed) * (1 - leg) + noise(p * [1, 0.22, 1], 0.0065, seed + 1) * leg
    clump = noise(p * [1, 1, 0.4], 0.026, seed + 2) * (1 - leg) + noise(p * [1, 0.4, 1], 0.02, seed + 3) * leg
    return 0.6 * along + 0.5 * clump


def height(part, p):
    name = NAMES[part]
    q = np.column_stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]])
    if name in ("body", "head"):
        return (0.0013 if name == "body" else 0.0008) * fur(q)
    if name == "scarf":
        knit = np.cos((p[:, 1] + 0.6 * p[:, 2]) * 2 * np.pi / 0.011) * np.cos(np.arctan2(p[:, 0], p[:, 2] - 0.255) * 44)
        return 0.0009 * knit + 0.0012 * noise(p, 0.02, 3)
    if name == "nose":
        return 0.0003 * noise(p, 0.003, 2) + groove(np.where(p[:, 1] < 0.605, p[:, 0], 1.0), 0.003, 0.0012)
    return np.zeros(len(p))


def coat(q):
    """Signed distances with ragged, fur-like edges: socks, cream parts of the body, tail's tip."""
    x, y, z = q.T
    rag = 0.010 * noise(q * [1, 0.4, 1], 0.012, 31) + 0.006 * noise(q, 0.03, 32)
    sock = np.maximum(y - np.where(z > 0, 0.172, 0.165) - rag, -z - 0.32)
    belly = np.where((z > -0.30) & (z < 0.33), np.maximum(y - (0.330 + 0.02 * np.sin(z * 14)) - rag, x - 0.062 - rag), 1.0)
    belly = np.where(y < 0.235, 1.0, belly)
    bib = np.maximum(np.maximum(0.228 - z + 0.10 * (y - 0.40) - rag, x - 0.062 - 0.10 * (y - 0.40) - rag), 0.30 - y)
    tip = z + 0.575 + 0.25 * (y - 0.39) + 1.6 * rag
    return sock, np.minimum(belly, bib), tip


def paint(part, p, n, opened):
    name = NAMES[part]
    q = np.column_stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]])
    x, y, z = q.T
    ones = np.ones(len(p))
    metal = 0.0 * ones
    shade = lambda c, k=0.55: mixed(c, c * 0.35, k * (1 - opened))
    if name in ("body", "head"):
        f = fur(q)
        c = np.tile(ORANGE, (len(p), 1))
        if name == "body":
            top = np.clip((n[:, 1] - 0.35) / 0.6, 0, 1) * (y > 0.33)
            c = mixed(c, DEEP, 0.60 * top)
            sock, pale, tip = coat(q)
            c = mixed(c, CREAM, edge(pale, 0.016))
            c = mixed(c, CREAM, edge(tip, 0.014))
            c = mixed(c, DEEP, 0.6 * edge(np.abs(tip - 0.018) - 0.014, 0.02) * (tip > 0))
            c = mixed(c, SOCK, edge(sock, 0.014))
            c = mixed(c, INK, 0.55 * edge(y - 0.006, 0.008))
        else:
            rag = 0.005 * noise(q * [1, 0.5, 1], 0.010, 41) + 0.003 * noise(q, 0.02, 42)
            c = mixed(c, DEEP, 0.45 * np.clip((y - 0.655) / 0.03, 0, 1) * edge(x - 0.035, 0.02) * (z < 0.40))
            # White cheeks and chin; the bridge of the nose stays orange.
            line = np.where(z > 0.385, 0.603 + 0.10 * (z - 0.385), 0.603 - 0.30 * np.maximum(x - 0.06, 0) + 0.35 * np.clip(x - 0.05, 0, 0.03))
            c = mixed(c, CREAM, edge(y - line - rag, 0.007) * (y < 0.66))
            spot = np.linalg.norm((q - [0.030, 0.662, 0.392]) * [0.8, 1.2, 1], axis=1) - 0.011
            c = mixed(c, CREAM, 0.9 * edge(spot - rag * 0.5, 0.008))
            ear = np.maximum(0.700 - y, -1.0)
            c = mixed(c, SOCK, edge(0.775 - y + 1.2 * rag, 0.02) * np.where(n[:, 2] > 0.3, 0.75, 1.0))
            hollow = edge(ear, 0.012) * np.clip((n[:, 2] - 0.1) / 0.3, 0, 1) * edge(np.abs(x - 0.052 - 0.38 * (y - 0.694)) - 0.027 + 0.14 * np.maximum(y - 0.72, 0), 0.008)
            c = mixed(c, srgb("#e8b99a"), hollow * (y < 0.81))
            rim = np.linalg.norm(q - EYE - [0.006, 0, 0.008], axis=1) - 0.0235
            c = mixed(c, SOCK, edge(rim, 0.004))
            tear = np.linalg.norm((q - [0.036, 0.620, 0.396]) * [1.2, 0.8, 0.8], axis=1) - 0.009
            c = mixed(c, SOCK, 0.8 * edge(tear, 0.006))
            c = mixed(c, INK, edge(np.maximum(np.abs(y - 0.583 - 0.32 * np.maximum(0.426 - z, 0.0)) - 0.0022, 0.391 - z), 0.002) * (z < 0.487))
        c = c * (1.0 + 0.16 * f)[:, None]
        return shade(np.clip(c, 0, 1)), 0.88 * ones, metal
    if name == "eye":
        look = np.array([0.42, 0.06, 0.905])
        away = np.degrees(np.arccos(np.clip((np.column_stack([np.abs(p[:, 0]), y, z]) - EYE) @ look / 0.0205, -1, 1)))
        c = np.tile(srgb("#f3ede2"), (len(p), 1))
        c = mixed(c, AMBER, edge(away - 62, 4))
        c = mixed(c, srgb("#7a430c"), edge(np.abs(away - 60) - 4, 4))
        c = mixed(c, INK * 0.4, edge(away - 36, 3))
        glint = np.linalg.norm(q - EYE - np.array([0.0040, 0.0080, 0.0180]), axis=1) - 0.0050
        c = mixed(c, np.ones(3), edge(glint, 0.001))
        return c, 0.12 * ones, metal
    if name == "lids":
        c = mixed(np.tile(ORANGE * 0.92, (len(p), 1)), SOCK, edge(np.abs(y - EYE[1] + 0.003) - 0.0125, 0.003))
        return shade(c), 0.8 * ones, metal
    if name == "nose":
        return np.tile(INK, (len(p), 1)), 0.32 * ones, metal
    # The scarf: broad stripes.
    hang = np.clip((0.455 - p[:, 1]) / 0.01, 0, 1) * (p[:, 0] > 0.03) * (p[:, 2] > 0.23)
    stripe = np.cos((p[:, 1] - 0.35) * 2 * np.pi / 0.05)
    around = np.cos(np.arctan2(p[:, 0], p[:, 2] - 0.255) * 9)
    c = mixed(np.tile(TEAL, (len(p), 1)), AQUA, 0.9 * edge(-(stripe * hang + around * (1 - hang)) * 0.01 + 0.003, 0.004))
    c = mixed(c, CREAM, hang * edge(np.abs(p[:, 1] - 0.335 - 0.4 * (p[:, 0] - 0.09)) - 0.006, 0.003))
    c = c * (0.92 + 0.12 * noise(p, 0.01, 6))[:, None]
    return shade(c), 0.92 * ones, metal


def weights_of(s, body):
    v = body.vertices
    w = rig.smoothed(place_weights(s, v), body.faces, 4)
    for i, part in enumerate(PARTS):
        mine = np.unique([k for f, p in zip(body.faces, body.part) if p == i for k in f])
        p = v[mine]
        if part.name == "body":
            # A paw's sole is rigid, so that it does not creep while planted.
            for side, sign in ((".L", 1), (".R", -1)):
                for joint, fore in (("forepaw", 1), ("hindpaw", -1)):
                    sole = smooth_step((0.042 - p[:, 1]) / 0.018) * (sign * p[:, 0] > 0) * (fore * p[:, 2] > 0)
                    w[mine] *= (1 - sole)[:, None]
                    w[mine, s[joint + side]] += sole
            # Neck and head blend under the scarf.
            t = (p - AT["head"]) @ np.array([0, 0.86, 0.51])
            up = smooth_step(t / 0.10 + 0.45) * (p[:, 2] > 0.2)
            w[mine] *= (1 - up)[:, None]
            w[mine, s["head"]] += up
        elif part.name == "head":
            w[mine] = 0
            ear = smooth_step((p[:, 1] - 0.680) / 0.030) * (np.abs(p[:, 0]) > 0.012)
            tip = smooth_step((p[:, 1] - 0.735) / 0.060)
            w[mine, s["head"]] = 1 - ear
            for side, sign in ((".L", 1), (".R", -1)):
                own = ear * (sign * p[:, 0] > 0)
                w[mine, s["ear" + side]] = own * (1 - tip)
                w[mine, s["eartip" + side]] = own * tip
        elif part.name == "scarf":
            # The ends rest on the chest.
            low = smooth_step((0.455 - p[:, 1]) / 0.09) * smooth_step((p[:, 0] - 0.02) / 0.03)
            w[mine] = 0
            w[mine, s["neck"]] = 1 - 0.6 * low
            w[mine, s["chest"]] = 0.6 * low
        else:
            w[mine] = 0
            w[mine, s["head"]] = 1
    return w


# ---------------------------------------------------------------- motion

RATE = 60.0
TIP = np.array([0.0, -0.026, 0.052])  # from a paw's joint to the tip of its toes
LEGS = {
    "hind": ("thigh", "shank", "metatarsus", "hindpaw"),
    "fore": ("upperarm", "forearm", "pastern", "forepaw"),
}


def figure_of(s):
    from gait import Figure

    names = {"hips": "hips", "spine": ["spine1", "spine2", "chest"], "neck": "neck", "head": "head"}
    for pair, joints in LEGS.items():
        for side in "LR":
            for role, joint in zip(("upper", "lower", "end", "paw"), joints):
                names[f"{pair}.{side}.{role}"] = f"{joint}.{side}"
    return Figure(s, names)


def within_reach(figure, turns, moves, role, foot, shaft, lean):
    """The lean closest to `lean` at which the two bones above can reach, or `lean` if there is none."""
    s = figure.skeleton
    upper, lower, end = (figure.names[f"{role}.{r}"] for r in ("upper", "lower", "end"))
    above = s.names[s.parents[s[upper]]]
    base, turn = figure.world(turns, moves, above)
    root = base + rotate(turn, s.world[s[upper]] - s.world[s[above]])
    bones = np.linalg.norm(s.world[s[lower]] - s.world[s[upper]]) + np.linalg.norm(s.world[s[end]] - s.world[s[lower]])
    lack = lambda a: np.linalg.norm(foot + rotate(qx(a), shaft) - root) - 0.990 * bones
    if lack(lean) <= 0:
        return lean
    for change in np.arange(0.25, 60.0, 0.25):
        for a in (lean + change, lean - change):
            if lack(a) <= 0:
                return a
    return lean


def set_leg(figure, turns, moves, pair, side, tip, lean, paw):
    """Places a paw: `tip` is the position of the toe tip, `paw` degrees the toes point down, `lean` degrees the bone above the paw
    leans forward from its rest."""
    sign = 1 if side == "L" else -1
    role = f"{pair}.{side}"
    foot = tip - rotate(qx(paw), TIP)
    shaft = figure.place(f"{role}.end") - figure.place(f"{role}.paw")
    lean = within_reach(figure, turns, moves, role, foot, shaft, lean)
    end = foot + rotate(qx(lean), shaft)
    bend = np.array([0.12 * sign, 0, 1.0]) if pair == "hind" else np.array([0.10 * sign, 0, -1.0])
    rest = np.array([0, 0, 1.0]) if pair == "hind" else np.array([0, 0, -1.0])
    got = figure.limb(turns, moves, f"{role}.upper", f"{role}.lower", f"{role}.end", end, qx(lean), bend, rest)
    turns[figure.names[f"{role}.paw"]] = qx(paw - lean)
    return np.linalg.norm(got - end)


class Step:
    """The path of a paw through a stride of `length` metres; on the ground from phase 0 to `duty`.

    `start`: where the toe tip lands (z); `lean` keys over (0..1 of the stance, 1..2 of the swing) in degrees.
    """

    def __init__(self, x, start, length, duty, lift, lean, curl, roll=12.0):
        self.x, self.start, self.length, self.duty, self.lift = x, start, length, duty, lift
        self.lean, self.curl, self.roll = lean, curl, roll

    def at(self, phase):
        """(tip, lean, paw) at a phase of this paw's stride."""
        from gait import curve

        p = phase % 1.0
        d = self.duty
        stance = p < d
        u = p / d if stance else 1.0 + (p - d) / (1.0 - d)
        lean = float(curve([*self.lean, (2.0, self.lean[0][1])], u))
        if stance:
            paw = self.roll * float(smooth_step((u - 0.72) / 0.28)) * 0.5
            return np.array([self.x, 0.006, self.start - self.length * p]), lean, paw
        s = u - 1.0
        # Lifts off and lands at the speed of the ground, so that no paw jerks.
        slope = -(1.0 - d) / d
        way = (s**3 - 2 * s**2 + s) * slope + (3 * s**2 - 2 * s**3) + (s**3 - s**2) * slope
        z = self.start - self.length * d * (1.0 - way)
        up = self.lift * np.sin(np.pi * s**0.85) ** 1.5
        paw = float(curve([(0, self.roll * 0.5), *self.curl, (1, 0)], s))
        return np.array([self.x, 0.006 + up, z]), lean, paw


def settle_head(figure, turns, moves, want, share=0.45):
    """Turns neck and head so that the head's world turn is `want`."""
    _, chest = figure.world(turns, moves, "chest")
    local = mul(conj(chest), want)
    half = slerp(np.array([0, 0, 0, 1.0]), local, share)
    turns["neck"] = half
    turns["head"] = mul(conj(half), local)


def swing(p, at=0.0):
    return np.cos(2 * np.pi * (p - at))


def wag(turns, p, base, side, lift, lag=0.09):
    """The tail follows joint by joint with increasing delay. `base`: degrees each joint droops."""
    for i in range(4):
        turns[f"tail{i + 1}"] = mul(qy(side[i] * swing(p, 0.10 + lag * i)), qx(base[i] + lift[i] * swing(2 * p, 0.15 + lag * i)))


def ears(turns, back=0.0, out=0.0, flick=0.0):
    for side, sign in ((".L", 1), (".R", -1)):
        turns["ear" + side] = mul(qz(-sign * out), qx(-back))
        turns["eartip" + side] = qx(-0.5 * back - flick)


def walk(figure, speed=0.80, frames=42):
    length = speed * frames / RATE
    duty = 0.63
    hind = dict(lean=[(0, -14), (0.35, -4), (0.7, 12), (1.0, 40), (1.30, 46), (1.62, 12), (1.85, -16)], curl=[(0.22, 34), (0.5, 26), (0.82, -4)])
    fore = dict(lean=[(0, -12), (0.4, -2), (0.75, 14), (1.0, 42), (1.28, 82), (1.55, 62), (1.82, -4)], curl=[(0.25, 72), (0.5, 66), (0.84, -2)])
    reach = length * duty
    steps = {
        "hind": Step(0.058, -0.195 + TIP[2] + 0.50 * reach, length, duty, 0.045, **hind),
        "fore": Step(0.055, 0.190 + TIP[2] + 0.43 * reach, length, duty, 0.055, **fore),
    }
    # Lateral sequence: left hind, left fore, right hind, right fore.
    begin = {("hind", "L"): 0.0, ("fore", "L"): 0.25, ("hind", "R"): 0.5, ("fore", "R"): 0.75}

    def pose(p):
        turns, moves = {}, {}
        yaw = 4.0 * swing(p, 0.0)
        moves["hips"] = (0.008 * swing(p, 0.32), -0.010 + 0.006 * swing(2 * p, 0.30), 0.004 * swing(2 * p, 0.1))
        turns["hips"] = mul(qy(-yaw), qx(-0.8 * swing(2 * p, 0.05)), qz(2.6 * swing(p, 0.30)))
        for i, k in enumerate((0.30, 0.35, 0.35)):
            turns[figure.names["spine"][i]] = mul(qy(1.9 * k * yaw), qx(1.2 * k * swing(2 * p, 0.10)), qz(-4.2 * k * swing(p, 0.30)))
        settle_head(figure, turns, moves, mul(qy(1.5 * swing(p, 0.45)), qx(4.0 + 2.2 * swing(2 * p, 0.42)), qz(0.8 * swing(p, 0.3))))
        for (pair, side), at in begin.items():
            tip, lean, paw = steps[pair].at(p - at)
            tip = tip * [1 if side == "L" else -1, 1, 1]
            if pair == "fore":
                turns[f"scapula.{side}"] = qx(-14 * swing(p - at, 0.02))
            set_leg(figure, turns, moves, pair, side, tip, lean, paw)
        wag(turns, p, (-14, -3, 5, 9), (7, 7, 8, 8), (1.5, 2, 2, 2))
        ears(turns, back=3 + 3 * swing(2 * p, 0.5), flick=3 * swing(2 * p, 0.6))
        return turns, moves

    return pose, frames, speed


def run(figure, speed=3.6, frames=26):
    length = speed * frames / RATE
    duty = 0.215
    hind = dict(lean=[(0, -4), (0.4, 6), (0.75, 26), (1.0, 52), (1.16, 58), (1.40, 22), (1.72, -14)], curl=[(0.18, 50), (0.45, 32), (0.80, -6)])
    fore = dict(lean=[(0, -14), (0.4, 0), (0.75, 22), (1.0, 50), (1.22, 100), (1.50, 92), (1.80, 4)], curl=[(0.20, 88), (0.5, 92), (0.84, 0)])
    reach = length * duty
    steps = {
        "hind": Step(0.052, -0.195 + TIP[2] + 0.60 * reach, length, duty, 0.066, roll=20, **hind),
        "fore": Step(0.046, 0.200 + TIP[2] + 0.46 * reach, length, duty, 0.105, roll=20, **fore),
    }
    # Rotary gallop: left hind, right hind, right fore, left fore.
    begin = {("hind", "L"): 0.0, ("hind", "R"): 0.10, ("fore", "R"): 0.47, ("fore", "L"): 0.57}

    def pose(p):
        turns, moves = {}, {}
        gather = swing(p, 0.93)
        flex = 4.0 + 12.0 * gather
        pitch = 4.5 * swing(p, 0.80)
        moves["hips"] = (0, -0.030 + 0.018 * swing(p, 0.70) + 0.010 * swing(2 * p, 0.42), 0.030 * swing(p, 0.93) + 0.01)
        turns["hips"] = mul(qx(pitch - 1.15 * flex), qz(1.5 * swing(p, 0.0)))
        for i, k in enumerate((0.42, 0.34, 0.24)):
            turns[figure.names["spine"][i]] = mul(qx(2.0 * k * flex), qy(2.0 * k * swing(p, 0.3)))
        settle_head(figure, turns, moves, mul(qx(15 + 4.0 * swing(p, 0.86)), qz(0.0)), share=0.62)
        for (pair, side), at in begin.items():
            tip, lean, paw = steps[pair].at(p - at)
            tip = tip * [1 if side == "L" else -1, 1, 1]
            if pair == "fore":
                turns[f"scapula.{side}"] = qx(-27 * swing(p - at, 0.02))
            set_leg(figure, turns, moves, pair, side, tip, lean, paw)
        for i in range(4):
            late = 0.08 + 0.10 * i
            turns[f"tail{i + 1}"] = mul(qx((8, 0, -3, -4)[i] + (12, 11, 10, 9)[i] * swing(p, 0.80 + late)), qy(4 * swing(p, 0.3 + late)))
        ears(turns, back=24 + 5 * swing(p, 0.5), out=4, flick=6 * swing(p, 0.65))
        return turns, moves

    return pose, frames, speed


def idle(figure, frames=300):
    """Five seconds: breathing, a shift of weight, a look to the left with a tilt of the head, ears that listen."""
    from gait import curve

    def pose(p):
        turns, moves = {}, {}
        breath, sway = swing(3 * p, 0.5), swing(p, 0.25)
        look = float(curve([(0.0, 0), (0.12, 0), (0.20, 26), (0.40, 26), (0.50, 4), (0.60, -20), (0.76, -20), (0.90, 0)], p, 1.0))
        tilt = float(curve([(0.0, 0), (0.24, 0), (0.31, 15), (0.38, 15), (0.48, 0), (0.95, 0)], p, 1.0))
        nod = float(curve([(0.0, 0), (0.56, 0), (0.64, 7), (0.72, 5), (0.86, 0), (0.97, 0)], p, 1.0))
        moves["hips"] = (0.007 * sway, -0.006 - 0.002 * breath, 0.002 * breath)
        turns["hips"] = mul(qy(0.8 * sway), qz(1.2 * sway))
        for name, k in zip(figure.names["spine"], (0.2, 0.4, 0.4)):
            turns[name] = mul(qy(0.10 * k * look - 0.8 * k * sway), qx(-0.9 * k * breath), qz(-1.2 * k * sway))
        settle_head(figure, turns, moves, mul(qy(look), qx(2 + nod - 1.2 * breath), qz(tilt)), share=0.40)
        for pair, joints in LEGS.items():
            for side, sign in (("L", 1), ("R", -1)):
                tip = AT[f"{joints[3]}.L"] * [sign, 1, 1] + TIP
                # One hind paw slightly ahead, for a natural stance.
                tip[2] += {"hind": 0.022, "fore": -0.010}[pair] * sign
                tip[1] = 0.006
                set_leg(figure, turns, moves, pair, side, tip, {"hind": 2.0, "fore": -2.0}[pair] * -sign, 0)
        for i in range(4):
            turns[f"tail{i + 1}"] = mul(qy((8, 9, 10, 12)[i] * swing(2 * p, 0.1 + 0.06 * i)), qx((-16, -5, 3, 8)[i] + 2 * swing(p, 0.3 + 0.1 * i)))
        twitch = float(curve([(0, 0), (0.155, 0), (0.17, 1), (0.185, 0.1), (0.20, 0.9), (0.22, 0), (0.66, 0), (0.675, 1), (0.70, 0), (0.98, 0)], p, 1.0))
        ears(turns, back=2 + 2 * breath, flick=0)
        turns["ear.L"] = mul(turns["ear.L"], qz(-10 * twitch), qy(14 * max(look, 0) / 26))
        turns["ear.R"] = mul(turns["ear.R"], qy(12 * min(look, 0) / 20), qz(4 * tilt / 15))
        return turns, moves

    return pose, frames, 0.0


def main(size=int(os.environ.get("ATLAS", "640"))):
    import gait
    import glb
    import paint as paint_

    s = skeleton()
    meshes = sculpt()
    out = glb.Glb()
    nodes = out.nodes_of(s)
    joints = [j for j, n in enumerate(s.names) if n != "root"]
    left = clay.joined(meshes)
    alone = [i for i, m in enumerate(meshes) if m.whole]
    left_uv = paint_.unwrap(left, {NAMES.index(n): v for n, v in SPLITS.items()})
    scene = lambda p: np.minimum.reduce([clay.mirrored(part.shape)(p) if part.half else part.shape(p) for part in PARTS]) + 0.002
    base, bump, orm = paint_.bake(left, left_uv, [p.shape for p in PARTS], paint, height, size, scene)
    shown = paint_.surface(left, left_uv, alone)
    unit_normals(shown)
    values, slots = rig.strongest(weights_of(s, shown.mesh), joints)
    material = out.add("materials", {
        "name": "fox",
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": out.image(base, quality=78, name="fox colour")},
            "metallicRoughnessTexture": {"index": (relief := out.image(orm, quality=72, name="fox surface"))},
        },
        "normalTexture": {"index": out.image(bump, quality=74, name="fox relief")},
        "occlusionTexture": {"index": relief},
    })
    primitive = out.primitive(
        shown.place, shown.normal, shown.triangles, material, shown.uv, joints=slots[shown.vertex],
        weights=values[shown.vertex], tangent=shown.tangent,
    )
    print(len(shown.place), "vertices,", len(shown.triangles), "triangles")
    mesh = out.add("meshes", {"name": "fox", "primitives": [primitive]})
    node = out.add("nodes", {"name": "fox", "mesh": mesh, "skin": out.skin(s, nodes, joints, "fox")})
    figure = figure_of(s)
    legs = [n for n in s.names if n.split(".")[0] in ("hips", "scapula", *LEGS["hind"], *LEGS["fore"]) or n in figure.names["spine"]]
    for name, make in (("idle", idle), ("walk", walk), ("run", run)):
        pose, frames, _ = make(figure)
        # Keys are interpolated linearly, so fast paws need them close together.
        fine = {"idle": 1, "walk": 2, "run": 4}[name]
        poses = gait.cycle(pose, frames * fine)
        out.clip(name, nodes, gait.channels(s, poses, RATE * fine, tight=legs, tolerance=0.010, loose=0.25, move_tolerance=0.0001))
    print(out.write(OUT, [nodes[0], node]), "bytes")


if __name__ == "__main__":
    main()
