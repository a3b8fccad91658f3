"""Makes ../morphs.glb: the bust of a young goblin with twelve facial morph targets, and a clip that animates them.

The face is one mesh in clean loops: rings of quads around the eyes and the mouth, set into a grid of longitudes and latitudes
and projected onto clay. The lids lie on a sphere a tenth larger than the eyeball, because a morph target moves vertices along
straight lines: halfway through a blink a lid is closer to the eye's center than at either end, and must still clear the
eyeball. The lips continue into a mouth with teeth and a tongue, so that there is no hole when the jaw drops.
"""

import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
from clay import capsule, common, cut, ellipsoid, halfspace, sphere, union, upright
from paint import edge, noise, srgb
from rig import mul, qx, qy, qz, smooth_step
from sculpting import bent, meshed, mixed, pointed

OUT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "morphs.glb")

# Everything is modelled around the head's center and moved onto the ground at the end.
LIFT = 0.345
EYE, BALL = np.array([0.0505, 0.020, 0.0820]), 0.0355
LID = 1.10 * BALL


# ---------------------------------------------------------------- clay


def mouth_line(x):
    """The height of the closed mouth: a slight smile."""
    return -0.0735 + 3.2 * x**2


def skull():
    shape = union(ellipsoid((0, 0.010, -0.010), (0.126, 0.128, 0.124)), ellipsoid((0, -0.062, 0.028), (0.092, 0.062, 0.078)), k=0.06)
    shape = union(shape, ellipsoid((0.070, -0.040, 0.062), (0.046, 0.040, 0.040)), k=0.04)
    shape = union(shape, ellipsoid((0, -0.112, 0.070), (0.040, 0.026, 0.034)), k=0.04)
    shape = union(shape, ellipsoid((0.044, 0.062, 0.084), (0.040, 0.016, 0.026)), k=0.05)
    shape = union(shape, sphere(EYE, LID), k=0.024)
    shape = union(shape, capsule((0, 0.030, 0.100), (0, -0.012, 0.122), 0.016, 0.021), k=0.02)
    nose = union(ellipsoid((0, -0.022, 0.136), (0.0250, 0.0215, 0.0260)), ellipsoid((0.021, -0.029, 0.124), (0.0150, 0.0130, 0.0150)), k=0.012)
    shape = union(shape, nose, k=0.014)
    # Lips: two soft rolls along the mouth's line.
    upper = bent([(0, -0.0665, 0.1085), (0.022, -0.0655, 0.1010), (0.047, -0.0640, 0.083)], [0.0095, 0.0085, 0.004], k=0.006)
    lower = bent([(0, -0.0835, 0.1075), (0.020, -0.0815, 0.1010), (0.045, -0.0685, 0.083)], [0.0115, 0.0100, 0.004], k=0.006)
    return union(shape, union(upper, lower, k=0.003), k=0.012)


SKULL = clay.mirrored(skull())


def ear():
    leaf = bent([(0.110, -0.010, -0.012), (0.160, 0.012, -0.028), (0.215, 0.044, -0.048), (0.262, 0.082, -0.066)], [0.032, 0.044, 0.030, 0.003], k=0.01, count=9, flatten=((0.35, 0, 1.0), 0.42))
    bowl = bent([(0.138, -0.002, -0.006), (0.172, 0.016, -0.014), (0.222, 0.048, -0.034)], [0.012, 0.024, 0.010], k=0.01, flatten=((0.35, 0, 1.0), 0.62))
    return cut(leaf, bowl, k=0.010)


# Locks of the crest, from the forehead backwards; tips sharp.
LOCKS = (
    ([(0.000, 0.110, 0.070), (0.004, 0.168, 0.078), (0.006, 0.222, 0.052)], [0.036, 0.034, 0.003]),
    ([(0.000, 0.126, 0.020), (0.004, 0.190, 0.008), (0.006, 0.246, -0.040)], [0.044, 0.038, 0.003]),
    ([(0.000, 0.124, -0.040), (0.004, 0.176, -0.078), (0.004, 0.208, -0.140)], [0.046, 0.038, 0.003]),
    ([(0.000, 0.082, -0.090), (0.004, 0.112, -0.142), (0.004, 0.112, -0.205)], [0.046, 0.036, 0.003]),
    ([(0.000, 0.024, -0.112), (0.003, 0.016, -0.150), (0.003, -0.022, -0.188)], [0.040, 0.030, 0.003]),
    ([(0.038, 0.108, 0.044), (0.060, 0.136, 0.036), (0.084, 0.160, 0.004)], [0.028, 0.023, 0.002]),
    ([(0.038, 0.112, -0.020), (0.060, 0.138, -0.044), (0.076, 0.150, -0.098)], [0.032, 0.026, 0.002]),
    ([(0.034, 0.078, -0.080), (0.054, 0.092, -0.116), (0.060, 0.084, -0.170)], [0.032, 0.025, 0.002]),
)


HAIR = clay.mirrored(union(*[bent(points, radii) for points, radii in LOCKS], k=0.01))


def hair():
    """Each lock is a separate tube with a sharp tip; those on the mirror plane are halves."""
    meshes = []
    for points, radii in LOCKS:
        middle = points[-1][0] < 0.01
        # The root is well inside the head.
        points = [np.array(points[0]) * 0.80, *points[1:]]
        at = clay._smooth_table(np.linspace(0, 1, 3), np.column_stack([points, radii]))
        t = np.linspace(0, 1, 6) ** 0.85
        rows = at(t)
        if middle:
            rows[:, 0] = 0.0
        # Swells above the root, then narrows evenly to the tip.
        thick = radii[0] * (1.0 + 0.22 * np.sin(np.pi * np.minimum(t / 0.55, 1.0))) * (1.0 - t**2.2) + 0.0004
        along = np.gradient(rows[:, :3], axis=0)
        places, faces = [], []
        angles = np.linspace(-np.pi / 2, np.pi / 2, 6) if middle else np.arange(7) * 2 * np.pi / 7
        n = len(angles)
        for center, direction, r in zip(rows[:, :3], along, thick):
            direction = direction / np.linalg.norm(direction)
            across = np.array([1.0, 0, 0]) - direction * direction[0]
            across /= np.linalg.norm(across)
            other = np.cross(direction, across)
            places += [center + r * (np.cos(a) * across + 1.15 * np.sin(a) * other) for a in angles]
        for i in range(len(rows) - 1):
            for k in range(n - 1 if middle else n):
                l = (k + 1) % n
                faces.append([i * n + k, i * n + l, (i + 1) * n + l, (i + 1) * n + k])
        mesh = clay.Mesh(places, faces)
        mesh.plane = np.zeros(len(places), dtype=bool)
        if middle:
            mesh.plane[0::n] = mesh.plane[n - 1 :: n] = True
            mesh.vertices[mesh.plane, 0] = 0.0
        meshes.append(mesh)
    mesh = clay.joined(meshes)
    mesh.part[:] = 0
    mesh.whole = False
    return mesh


def brow():
    return bent([(0.017, 0.064, 0.1185), (0.042, 0.0755, 0.1160), (0.070, 0.0745, 0.0985), (0.090, 0.0640, 0.0770)], [0.0072, 0.0092, 0.0082, 0.0030], k=0.004, count=9)


def shirt():
    """Shoulders in a hooded coat, cut off as a bust, on a round foot."""
    trunk = upright(
        [(-0.300, 0, -0.020, 0.100, 0.070), (-0.270, 0, -0.020, 0.135, 0.092), (-0.225, 0, -0.022, 0.165, 0.104), (-0.185, 0, -0.024, 0.140, 0.094), (-0.150, 0, -0.022, 0.080, 0.076), (-0.115, 0, -0.020, 0.060, 0.060)],
        rounding=0.02, power=2.2,
    )
    shoulder = ellipsoid((0.145, -0.225, -0.022), (0.062, 0.058, 0.062))
    trunk = union(trunk, shoulder, k=0.05)
    return common(trunk, halfspace((0, -0.292, 0), (0, -1, 0)), k=0.012)


def collar():
    """The hood's rolled edge round the neck, in clean loops; it thins out to a notch in front."""
    around, section = 17, 8
    places, faces = [], []
    for i in range(around):
        a = np.pi * i / (around - 1)
        front = np.exp(-((a / 0.55) ** 2))
        thick = (0.029 + 0.006 * (1 - np.cos(a))) * (0.45 + 0.55 * smooth_step((a + 0.03) / 0.36))
        r = 0.094 + 0.012 * front
        for k in range(section):
            b = 2 * np.pi * k / section
            out = r + thick * np.cos(b)
            places.append((1.06 * np.sin(a) * out, -0.146 - 0.034 * front + 0.010 * np.cos(a - np.pi) + 1.12 * thick * np.sin(b), np.cos(a) * out - 0.020))
    for i in range(around - 1):
        for k in range(section):
            l = (k + 1) % section
            faces.append([i * section + k, (i + 1) * section + k, (i + 1) * section + l, i * section + l])
    mesh = clay.Mesh(places, faces)
    mesh.plane = np.abs(mesh.vertices[:, 0]) < 1e-9
    mesh.vertices[mesh.plane, 0] = 0.0
    mesh.whole = False
    return mesh


def foot():
    """Turned wood: a lathe's profile, half round."""
    profile = [(0.002, -0.345), (0.092, -0.345), (0.098, -0.340), (0.098, -0.330), (0.090, -0.323), (0.062, -0.318), (0.050, -0.308), (0.048, -0.298), (0.056, -0.286), (0.060, -0.275)]
    n = 12
    angles = np.linspace(0, np.pi, n)
    places = [(r * np.sin(a), y, r * np.cos(a) - 0.018) for r, y in profile for a in angles]
    faces = [[i * n + k, i * n + k + 1, (i + 1) * n + k + 1, (i + 1) * n + k] for i in range(len(profile) - 1) for k in range(n - 1)]
    mesh = clay.Mesh(places, faces)
    mesh.plane = np.abs(mesh.vertices[:, 0]) < 1e-9
    mesh.vertices[mesh.plane, 0] = 0.0
    mesh.whole = False
    return mesh


# ---------------------------------------------------------------- the face in loops (left half)

LON = [0, 3, 6, 9, 14, 19, 24, 29, 34, 39, 47, 57, 70, 86, 108, 142, 180]
LAT = [-76, -63, -52, -46, -40, -34, -28, -22, -17, -12, -7, -2, 3, 8, 13, 18, 23, 28, 35, 45, 60, 77]
EYE_BLOCK = (LON.index(9), LON.index(39), LAT.index(-7), LAT.index(28))
MOUTH_BLOCK = (0, LON.index(29), LAT.index(-52), LAT.index(-22))
# Position of each ring between the block's border (0) and the opening's rim (1).
EYE_RINGS = (0.34, 0.64, 0.87, 1.0)
MOUTH_RINGS = (0.32, 0.60, 0.83, 1.0)


def outward(lon, lat):
    lon, lat = np.radians(lon), np.radians(lat)
    return np.column_stack([np.sin(lon) * np.cos(lat), np.sin(lat), np.cos(lon) * np.cos(lat)])


def on_skull(direction):
    d = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    return clay.cast(SKULL, d * 0.30, -d, 0.28, 100)


def angles_of(p):
    """Longitude and latitude of places, degrees."""
    return np.degrees(np.arctan2(p[:, 0], p[:, 2])), np.degrees(np.arctan2(p[:, 1], np.hypot(p[:, 0], p[:, 2])))


class Face:
    """Vertices with the data the targets need: `eye` and `mouth` = (ring 0..1 or beyond, angle), NaN elsewhere."""

    def __init__(self):
        self.places, self.faces, self.kind, self.eye, self.mouth, self.skin = [], [], [], [], [], []

    def add(self, places, skin=True, eye=None, mouth=None):
        first = len(self.places)
        nothing = [(np.nan, np.nan)] * len(places)
        self.places += list(places)
        self.eye += nothing if eye is None else eye
        self.mouth += nothing if mouth is None else mouth
        self.skin += [skin] * len(places)
        return list(range(first, len(self.places)))

    def strip(self, a, b, closed):
        n = len(a)
        for i in range(n if closed else n - 1):
            j = (i + 1) % n
            self.faces.append([a[i], a[j], b[j], b[i]])


def rim_of_eye(theta):
    """The lids' opening, seen from the eye's center: (azimuth, elevation) in degrees, an almond that slants up outwards."""
    x = np.cos(theta)
    up = np.where(np.sin(theta) > 0, 29.0, -25.0)
    return 16.0 + 36.0 * x, up * np.abs(np.sin(theta)) ** 0.92 + 3.0 * x


def lid_place(azimuth, elevation, radius):
    a, e = np.radians(azimuth), np.radians(elevation)
    return EYE + radius * np.column_stack([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])


def block_border(block, closed):
    """Grid points round a block: counter-clockwise seen from outside, from the bottom's middle plane or corner."""
    c0, c1, r0, r1 = block
    ring = [(c, r0) for c in range(c0, c1 + 1)] + [(c1, r) for r in range(r0 + 1, r1 + 1)] + [(c, r1) for c in range(c1 - 1, c0 - 1, -1)]
    if closed:
        ring += [(c0, r) for r in range(r1 - 1, r0, -1)]
    return ring


def build_face():
    f = Face()
    inside = lambda c, r, b: b[0] < c < b[1] and b[2] < r < b[3]
    half_inside = lambda c, r, b: c < b[1] and b[2] < r < b[3]
    grid = {}
    wanted = [(c, r) for r in range(len(LAT)) for c in range(len(LON)) if not inside(c, r, EYE_BLOCK) and not half_inside(c, r, MOUTH_BLOCK)]
    for key, n in zip(wanted, f.add(on_skull(outward([LON[c] for c, _ in wanted], [LAT[r] for _, r in wanted])))):
        grid[key] = n
    for r in range(len(LAT) - 1):
        for c in range(len(LON) - 1):
            hole = any(b[0] <= c < b[1] and b[2] <= r < b[3] for b in (EYE_BLOCK, MOUTH_BLOCK))
            if not hole:
                f.faces.append([grid[c, r], grid[c + 1, r], grid[c + 1, r + 1], grid[c, r + 1]])
    for r, up in ((0, False), (len(LAT) - 1, True)):
        pole = f.add(on_skull(np.array([[0.0, 1.0 if up else -1.0, 0.0]])))[0]
        for c in range(len(LON) - 1):
            f.faces.append([grid[c, r], grid[c + 1, r], pole] if up else [grid[c + 1, r], grid[c, r], pole])

    # Eye: rings from the block's border to the rim, then over the rim to the inside.
    border = [grid[k] for k in block_border(EYE_BLOCK, True)]
    start = np.array([f.places[i] for i in border])
    lon, lat = angles_of(start)
    center = ((LON[EYE_BLOCK[0]] + LON[EYE_BLOCK[1]]) / 2, (LAT[EYE_BLOCK[2]] + LAT[EYE_BLOCK[3]]) / 2)
    theta = np.arctan2((lat - center[1]) / 17.5, (lon - center[0]) / 15.0)
    end = lid_place(*rim_of_eye(theta), LID)
    last = border
    for i in border:
        f.eye[i] = (0.0, np.nan)
    for t in EYE_RINGS:
        row = start + (end - start) * t
        if t < 1.0:
            row = on_skull(row)
        ring = f.add(row, eye=[(t, a) for a in theta])
        f.strip(last, ring, True)
        last = ring
    ring = f.add(lid_place(*rim_of_eye(theta), BALL * 1.005), eye=[(1.05, a) for a in theta])
    f.strip(last, ring, True)
    last = ring
    ring = f.add(lid_place(*rim_of_eye(theta), BALL * 0.93), eye=[(1.05, a) for a in theta])
    f.strip(last, ring, True)

    # Mouth: rings to the slit, then inwards to a bag behind the teeth.
    border = [grid[k] for k in block_border(MOUTH_BLOCK, False)]
    start = np.array([f.places[i] for i in border])
    n = len(border)
    lon, lat = angles_of(start)
    theta = np.arctan2((lat + 36.5) / 15.0, lon / 29.0)
    theta[0], theta[-1] = -np.pi / 2, np.pi / 2
    width = 0.050
    x = width * np.cos(theta)
    slit = np.column_stack([x, mouth_line(x) - 0.0005 * np.sin(theta), np.zeros(n)])
    front = clay.cast(SKULL, slit * [1, 1, 0] + [0, 0, 0.25], np.tile([0, 0, -1.0], (n, 1)), 0.25, 120)
    last = border
    for t in MOUTH_RINGS:
        row = start + (front - start) * t
        if t < 1.0:
            row = on_skull(row)
        else:
            row = front - [0, 0, 0.0030]
        ring = f.add(row, mouth=[(t, a) for a in theta])
        f.strip(last, ring, False)
        last = ring
    for deep, tall, narrow, level in ((0.009, 0.0002, 0.97, 1.1), (0.018, 0.010, 0.90, 1.2), (0.048, 0.022, 0.70, 1.4)):
        row = np.column_stack([x * narrow, mouth_line(x * narrow) + tall * np.sin(theta), front[:, 2] - deep])
        ring = f.add(row, skin=False, mouth=[(level, a) for a in theta])
        f.strip(last, ring, False)
        last = ring
    back = f.add(np.array([[0, mouth_line(0.0), front[0, 2] - 0.068]]), skin=False, mouth=[(1.4, 0.0)])[0]
    for a, b in zip(last, last[1:]):
        f.faces.append([a, b, back])
    return f


def band_of_teeth(upper):
    """A curved strip with a rounded edge; the teeth are painted and scalloped."""
    places, faces = [], []
    count = 13
    for i in range(count):
        x = 0.036 * i / (count - 1)
        depth = 0.0925 - 13.5 * x**2
        tooth = 0.5 - 0.5 * np.cos(2 * np.pi * (x / 0.0115))
        y0 = mouth_line(x) + (0.009 if upper else -0.009)
        tall = (0.0105 if upper else 0.0095) * (0.80 + 0.20 * tooth)
        # One cheerful fang on each side below.
        if not upper:
            tall += 0.0065 * np.exp(-(((x - 0.0265) / 0.0042) ** 2))
        tip = y0 + (-tall if upper else tall)
        side = 1.0 if upper else -1.0
        for k, (y, z) in enumerate(((y0, 0.0), (tip + 0.0035 * side, 0.0008), (tip, -0.0016), (tip + 0.004 * side, -0.0052))):
            places.append((x, y, depth + z))
    for i in range(count - 1):
        for k in range(3):
            quad = [i * 4 + k, (i + 1) * 4 + k, (i + 1) * 4 + k + 1, i * 4 + k + 1]
            faces.append(quad[::-1] if upper else quad)
    mesh = clay.Mesh(places, faces)
    mesh.plane = np.abs(mesh.vertices[:, 0]) < 1e-9
    mesh.whole = False
    return mesh


TONGUE = union(ellipsoid((0, -0.0925, 0.072), (0.024, 0.0075, 0.026)), ellipsoid((0, -0.095, 0.050), (0.026, 0.010, 0.024)), k=0.01)


class Part:
    def __init__(self, name, shape, group, box=None, quads=0, step=0.004, half=True, relax=3):
        self.name, self.shape, self.group, self.box, self.quads, self.step = name, shape, group, box, quads, step
        self.half, self.relax = half, relax


# Groups: "face" has the targets, "head" moves with the head, "bust" is static.
PARTS = [
    Part("face", None, "face"),
    Part("upper teeth", None, "face"),
    Part("lower teeth", None, "face"),
    Part("tongue", clay.mirrored(TONGUE), "face", [(0, -0.11, 0.02), (0.04, -0.07, 0.11)], 80, 0.0022),
    Part("brow", brow(), "face", [(0.006, 0.04, 0.06), (0.11, 0.09, 0.14)], 110, 0.0022),
    Part("ear", ear(), "head", [(0.07, -0.08, -0.12), (0.29, 0.11, 0.04)], 340, 0.0034),
    Part("hair", None, "head"),
    Part("shirt", clay.mirrored(shirt()), "bust", half=False),
    Part("collar", None, "bust"),
    Part("foot", None, "bust"),
]
NAMES = [p.name for p in PARTS]
SPLITS = {"face": (0.0, 0, 1), "upper teeth": (0, 0, 1), "lower teeth": (0, 0, 1), "tongue": (0, 1, 0), "brow": (0, 0, 1), "ear": (0, 0, 1), "hair": (1, 0.0, 0),
          "shirt": (0, 0, 1), "collar": (0, 0, 1), "foot": (0, 1, 0)}


# Pointed tips: even quads round them off, so the nearest vertex is moved there.
POINTS = {
    "ear": [(0.2645, 0.0845, -0.0672)],
}


READY = {"collar": collar, "hair": hair, "foot": foot}


def sculpt():
    face = build_face()
    meshes = []
    for part in PARTS:
        if part.name == "face":
            mesh = clay.Mesh(np.array(face.places), face.faces)
            mesh.plane = np.abs(mesh.vertices[:, 0]) < 1e-6
            mesh.vertices[mesh.plane, 0] = 0.0
            mesh.whole = False
        elif part.name == "shirt":
            # Star-shaped around its center.
            mesh = clay.globe(part.shape, (0, -0.222, -0.022), (0.20, 0.075, 0.10), (10, 5, 5))
            mesh.whole = True
        elif part.name in READY:
            mesh = READY[part.name]()
        elif "teeth" in part.name:
            mesh = band_of_teeth(part.name.startswith("upper"))
        else:
            mesh = pointed(meshed(part), POINTS.get(part.name, ()))
            if part.group != "face":
                mesh = clay.without_hidden(mesh, [(SKULL, 0.012)] + [(p.shape, 0.010) for p in PARTS if p.shape and p.group == "bust" and part.group == "bust" and p is not part])
        print(f"{part.name}: {len(mesh.faces)} quads", flush=True)
        meshes.append(mesh)
    return face, meshes


# ---------------------------------------------------------------- targets


def near(p, center, radius):
    """A soft bump: 1 at `center`, 0 beyond about two `radius`."""
    g = np.exp(-np.sum(((p - np.asarray(center)) / radius) ** 2, axis=1))
    return np.maximum(g - 0.03, 0.0) / 0.97


class Rig:
    """All vertices of the face mesh (both sides) with their target data."""

    def __init__(self, p, part, eye, mouth):
        self.p, self.part, self.eye, self.mouth = p, part, eye, mouth
        self.side = np.sign(p[:, 0])
        self.q = p * np.column_stack([np.where(p[:, 0] < 0, -1.0, 1.0), np.ones(len(p)), np.ones(len(p))])

    def on(self, name):
        return self.part == NAMES.index(name)

    # Masks -------------------------------------------------------

    def lower(self):
        """1 for what moves with the jaw, 0 for the rest: split exactly at the lips."""
        p, q = self.p, self.q
        ring, angle = self.mouth[:, 0], self.mouth[:, 1]
        # Skin: below the mouth's line and in front of the jaw's joint.
        below = smooth_step((mouth_line(q[:, 0]) + 0.018 - p[:, 1]) / 0.045) * smooth_step((p[:, 2] + 0.015) / 0.07)
        out = below * smooth_step((0.112 - q[:, 0]) / 0.06)
        known = ~np.isnan(ring)
        split = (0.5 - 0.5 * np.sin(np.nan_to_num(angle))) ** 1.35
        share = np.where(known, smooth_step(np.nan_to_num(ring) / 0.75), 0.0)
        out = out * (1 - share) + split * share
        out[self.on("lower teeth") | self.on("tongue")] = 1.0
        out[self.on("upper teeth") | self.on("brow")] = 0.0
        return out

    def lids(self, up_amount, low_amount, sides):
        """The lids' motion: elevation about the eye's center moves to the closed line by these shares."""
        out = np.zeros_like(self.p)
        ring, angle = self.eye[:, 0], self.eye[:, 1]
        mine = ~np.isnan(angle) & np.isin(self.side, sides)
        q = self.q[mine] - EYE
        t, a = ring[mine], angle[mine]
        _, elevation = rim_of_eye(a)
        # Where the lids meet: low, and through both corners; the upper one slightly overlaps the lower.
        closed = 3.0 * np.cos(a) - 15.0 * np.abs(np.sin(a)) ** 0.92
        share = smooth_step((np.minimum(t, 1.0) - 0.18) / 0.82)
        upper = np.sin(a) > 0
        closed = closed + np.where(upper, -1.5, 1.0) * np.abs(np.sin(a))
        part = share * np.where(upper, up_amount, low_amount)
        # Each vertex stays on its sphere around the eye's center and on its meridian.
        radius = np.linalg.norm(q, axis=1) * (1.0 + 0.022 * upper * np.maximum(part, 0.0))
        rise = np.arctan2(q[:, 1], np.hypot(q[:, 0], q[:, 2])) + np.radians((closed - elevation) * part)
        around = np.arctan2(q[:, 0], q[:, 2])
        moved = radius[:, None] * np.column_stack([np.sin(around) * np.cos(rise), np.sin(rise), np.cos(around) * np.cos(rise)])
        out[mine] = (moved - q) * np.column_stack([self.side[mine], np.ones(mine.sum()), np.ones(mine.sum())])
        return out

    def mirrored_field(self, field):
        """`field(q)` gives displacements on the left side; the right one is its mirror."""
        d = field(self.q)
        return d * np.column_stack([np.where(self.p[:, 0] < 0, -1.0, 1.0), np.ones(len(d)), np.ones(len(d))])

    def skin_only(self, d, also=()):
        stays = self.on("upper teeth") | self.on("lower teeth") | self.on("tongue")
        if "brow" not in also:
            stays |= self.on("brow")
        # The inside of the mouth follows the lips less with depth.
        deep = np.clip((np.nan_to_num(self.mouth[:, 0]) - 1.0) / 0.4, 0, 1)
        return d * np.where(stays, 0.0, 1.0 - deep)[:, None]


def half(side, p):
    """1 on the left (or right) half, with a soft transition in the middle."""
    return smooth_step(side * p[:, 0] / 0.030 + 0.5)[:, None]


def targets(rig):
    """[(name, displacements)]"""
    p = rig.p
    left, right = half(1, p), half(-1, p)
    corner = (0.048, mouth_line(0.048), 0.085)

    def smile(q):
        d = near(q, corner, (0.030, 0.026, 0.04))[:, None] * [0.0105, 0.0170, -0.0100]
        d = d + near(q, (0.0, -0.076, 0.11), (0.022, 0.020, 0.05))[:, None] * [0, -0.0030, -0.0030]
        d = d + near(q, (0.078, -0.026, 0.088), (0.030, 0.022, 0.04))[:, None] * [0.0040, 0.0105, 0.0070]
        return d + near(q, (0.021, -0.029, 0.124), (0.016, 0.016, 0.03))[:, None] * [0.0020, 0.0016, 0]

    def frown(q):
        d = near(q, corner, (0.028, 0.028, 0.04))[:, None] * [-0.0030, -0.0165, -0.0040]
        d = d + near(q, (0.0, -0.078, 0.11), (0.024, 0.020, 0.05))[:, None] * [0, 0.0055, 0.0040]
        return d + near(q, (0.0, -0.112, 0.10), (0.034, 0.024, 0.05))[:, None] * [0, 0.0060, 0.0045]

    def brow_up(q):
        d = near(q, (0.050, 0.072, 0.105), (0.048, 0.030, 0.05))[:, None] * [0.0, 0.0165, -0.0020]
        return d

    def brows_down(q):
        d = near(q, (0.026, 0.066, 0.115), (0.030, 0.026, 0.05))[:, None] * [-0.0055, -0.0145, 0.0030]
        return d + near(q, (0.086, 0.070, 0.08), (0.030, 0.026, 0.05))[:, None] * [0, 0.0050, 0]

    def pucker(q):
        area = near(q, (0.0, -0.074, 0.105), (0.050, 0.026, 0.05))
        d = area[:, None] * [0, 0, 0.0150]
        d[:, 0] -= 0.56 * q[:, 0] * near(q, (0.020, -0.072, 0.10), (0.042, 0.026, 0.05)) * np.clip(q[:, 0] / 0.01, 0, 1)
        d[:, 1] += (-0.074 - q[:, 1]) * -0.30 * area
        return d

    def puff(q):
        d = near(q, (0.070, -0.066, 0.075), (0.036, 0.034, 0.042))[:, None] * [0.0200, -0.0010, 0.0130]
        d = d + near(q, (0.0, -0.074, 0.105), (0.040, 0.022, 0.05))[:, None] * [0, 0, 0.0030]
        d[:, 0] -= 0.10 * q[:, 0] * near(q, (0.030, -0.072, 0.10), (0.030, 0.022, 0.05))
        return d

    lower = rig.lower()
    hinge = np.array([0, -0.035, -0.010])
    a = np.radians(15.0)
    turned = (p - hinge) @ np.array([[1, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]]) + hinge
    jaw = (turned - p + [0, -0.004, 0.0]) * lower[:, None]
    # The corners are drawn in, and the upper lip follows slightly.
    jaw += rig.skin_only(rig.mirrored_field(lambda q: near(q, corner, (0.026, 0.022, 0.04))[:, None] * [-0.0070, 0, 0.0020]))
    jaw += rig.skin_only(near(p, (0, -0.062, 0.11), (0.030, 0.012, 0.04))[:, None] * [0, 0.0028, 0.0]) * (1 - lower)[:, None]
    tongue = np.zeros_like(p)
    on = rig.on("tongue")
    ahead = smooth_step((p[:, 2] - 0.045) / 0.045) * on
    # Up over the lower lip, then down in front of it.
    rise = 0.0160 * smooth_step((p[:, 2] - 0.034) / 0.022) - 0.0125 * smooth_step((p[:, 2] - 0.076) / 0.022)
    tongue += ahead[:, None] * [0, 0, 0.044] + (rise * on)[:, None] * [0, 1, 0]

    skin = lambda field: rig.skin_only(rig.mirrored_field(field))
    brows = lambda field: rig.skin_only(rig.mirrored_field(field), also=("brow",))
    smiles = skin(smile) + rig.lids(0.0, 0.45, (1, -1))
    lift = rig.lids(-0.16, 0.0, (1, -1))
    return [
        ("smileLeft", smiles * left),
        ("smileRight", smiles * right),
        ("frown", skin(frown)),
        ("blinkLeft", rig.lids(1.0, 1.0, (1,))),
        ("blinkRight", rig.lids(1.0, 1.0, (-1,))),
        ("browUpLeft", (brows(brow_up) + lift) * left),
        ("browUpRight", (brows(brow_up) + lift) * right),
        ("browsDown", brows(brows_down) + rig.lids(0.22, 0.25, (1, -1))),
        ("jawOpen", jaw),
        ("pucker", skin(pucker)),
        ("puff", skin(puff)),
        ("tongueOut", tongue),
    ]


# ---------------------------------------------------------------- colours

SKIN, BLUSH, LIP, SHADE = srgb("#8fbf5f"), srgb("#d58a5a"), srgb("#b5654f"), srgb("#4f7a3a")
PLUM, VIOLET, OCHRE, WOOD, CREAM = srgb("#3d2b52"), srgb("#6a4a86"), srgb("#d79a32"), srgb("#6b4630"), srgb("#f4ead2")
MAROON, INK = srgb("#5a1420"), srgb("#15100f")


def paint(part, p, n, opened):
    name = NAMES[part]
    q = np.column_stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]])
    x, y, z = q.T
    ones = np.ones(len(p))
    soft = np.clip(0.5 + 0.5 * noise(q, 0.03, 3) + 0.3 * noise(q, 0.009, 4), 0, 1)
    shade = lambda c, dark, k=0.6: mixed(c, dark, k * (1 - opened))
    if name in ("face", "ear"):
        c = np.tile(SKIN, (len(p), 1)) * (0.95 + 0.08 * soft)[:, None]
        c = mixed(c, srgb("#b7d673"), 0.55 * near(q, (0, -0.03, 0.13), (0.05, 0.09, 0.05)) + 0.35 * near(q, (0.045, 0.085, 0.10), (0.06, 0.03, 0.05)))
        if name == "face":
            c = mixed(c, BLUSH, 0.62 * near(q, (0.082, -0.034, 0.085), (0.026, 0.020, 0.05)) + 0.60 * near(q, (0, -0.024, 0.160), (0.022, 0.018, 0.03)))
            # Freckles.
            spots = (noise(q, 0.0075, 51) > 0.60) * near(q, (0.066, -0.022, 0.10), (0.030, 0.013, 0.05))
            c = mixed(c, SHADE, 0.75 * np.clip(spots * 1.4, 0, 1))
            to_rim = np.linalg.norm(q - EYE, axis=1)
            c = mixed(c, SHADE, 0.40 * np.exp(-(((to_rim - LID) / 0.006) ** 2)))
            line = mouth_line(x)
            lips = np.maximum(np.abs(y - line) - 0.0125 * np.sqrt(np.clip(1 - (x / 0.052) ** 2, 0, 1)), x - 0.052)
            c = mixed(c, LIP, 0.70 * edge(lips, 0.005) * (z > 0.06))
            c = mixed(c, MAROON, edge(np.abs(y - line) - 0.0012, 0.0015) * (x < 0.051) * (z > 0.05))
            inside = SKULL(p) < -0.0042
            deep = np.clip((0.105 - z) / 0.05, 0, 1)
            mouth = (x < 0.052) & (np.abs(y - line) < 0.030) & (z > 0.0) & inside
            c = np.where(mouth[:, None], mixed(np.tile(srgb("#8a2f36"), (len(p), 1)), MAROON * 0.5, deep), c)
            c = np.where(((to_rim < LID * 0.985) & (z > 0.07))[:, None], srgb("#a5624f"), c)
        else:
            inner = np.clip((n[:, 2] - 0.25) / 0.4, 0, 1) * near(q, (0.178, 0.022, -0.02), (0.055, 0.030, 0.05))
            c = mixed(c, BLUSH, 0.75 * inner)
            c = mixed(c, SHADE, 0.5 * np.clip((x - 0.215) / 0.05, 0, 1))
        return shade(c, SHADE * 0.55, 0.75), 0.55 * ones, 0 * ones
    if "teeth" in name:
        gap = np.abs(((x / 0.0115) + 0.5) % 1.0 - 0.5) * 0.0115
        c = mixed(np.tile(CREAM, (len(p), 1)), srgb("#b99a6a"), 0.8 * edge(0.0 + gap - 0.0007, 0.0012))
        root = np.abs(y - mouth_line(x)) - 0.0062
        c = mixed(c, srgb("#a8484c"), np.clip(root / 0.0022, 0, 1))
        return c, 0.3 * ones, 0 * ones
    if name == "tongue":
        c = mixed(np.tile(srgb("#c9555c"), (len(p), 1)), MAROON, 0.5 * edge(x - 0.0012, 0.003) * (n[:, 1] > 0.3))
        return c, 0.4 * ones, 0 * ones
    if name in ("hair", "brow"):
        streak = np.cos((y + 0.7 * z + 0.4 * x) * 2 * np.pi / 0.008 + 3 * noise(q, 0.025, 7)) if name == "brow" else noise(q * [1, 0.25, 0.25], 0.006, 8)
        c = np.tile(PLUM, (len(p), 1)) * (1.0 + 0.25 * streak)[:, None]
        if name == "hair":
            c = mixed(c, VIOLET, 0.8 * np.clip((np.hypot(y, z) - 0.175) / 0.06, 0, 1))
        return shade(np.clip(c, 0, 1), PLUM * 0.3), 0.6 * ones, 0 * ones
    if name in ("shirt", "collar"):
        weave = noise(q * [1, 1, 1], 0.004, 9)
        c = np.tile(OCHRE if name == "collar" else OCHRE * 0.88, (len(p), 1)) * (0.94 + 0.07 * weave + 0.06 * soft)[:, None]
        if name == "shirt":
            seam = np.abs(x - 0.004) - 0.0012
            c = mixed(c, OCHRE * 0.5, 0.8 * edge(seam, 0.002) * (z > 0))
            trim = np.abs(np.hypot(x, z + 0.02) - 0.128) - 0.006
            c = mixed(c, srgb("#8c3b2a"), edge(trim, 0.002) * (y > -0.26))
            c = mixed(c, OCHRE * 0.45, edge(y + 0.284, 0.004))
        return shade(c, OCHRE * 0.3), 0.9 * ones, 0 * ones
    rings = np.sin((np.hypot(x, z + 0.018) + 0.004 * noise(q, 0.03, 5)) * 2 * np.pi / 0.012)
    c = np.tile(WOOD, (len(p), 1)) * (0.92 + 0.10 * rings)[:, None]
    return shade(c, WOOD * 0.3), 0.45 * ones, 0 * ones


def eyeball():
    """A sphere with its pole in front, coloured by rings: no texture, no seam. (positions, normals, triangles, colours)"""
    rings = [0, 12.5, 15, 22, 29, 34, 36.5, 40, 55, 72, 92, 120, 150, 180]
    colors = {0: INK, 12.5: INK, 15: srgb("#a8741a"), 22: srgb("#e0a829"), 29: srgb("#d9971f"), 34: srgb("#8a5410"), 36.5: srgb("#4d2f10"), 40: srgb("#f2eee2")}
    linear = lambda c: np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    around = 16
    places, shades, tris = [], [], []
    for r in rings:
        a = np.arange(around) * 2 * np.pi / around
        e = np.radians(r)
        places += list(np.column_stack([np.sin(e) * np.cos(a), np.sin(e) * np.sin(a), np.full(around, np.cos(e))]))
        shades += [linear(colors.get(r, srgb("#f2eee2")))] * around
    for i in range(len(rings) - 1):
        for k in range(around):
            a, b = i * around + k, i * around + (k + 1) % around
            c, d = a + around, b + around
            if i > 0:
                tris.append((a, c, b))
            if i < len(rings) - 2:
                tris.append((b, c, d))
    # The first and last ring are points; their unused corners keep the indexing simple.
    n = np.array(places)
    return n * BALL, n, np.array(tris), np.array(shades)


# ---------------------------------------------------------------- the clip

RATE = 24.0
LENGTH = 12.0


def expressions(names):
    """Times, weights (T, targets) and turns of eyes and head: a conversation without words."""
    from gait import curve

    at = lambda keys, t: float(curve(keys, t, LENGTH)) if keys else 0.0
    keys = {
        "smileLeft": [(0, 0.10), (0.5, 0.10), (1.1, 0.75), (2.2, 0.80), (2.8, 0.15), (5.0, 0.0), (6.2, 0.0), (6.6, 0.55), (7.6, 0.55), (8.2, 0.2), (8.9, 0.95), (10.6, 1.0), (11.4, 0.2)],
        "smileRight": [(0, 0.10), (0.55, 0.10), (1.2, 0.75), (2.2, 0.80), (2.9, 0.15), (5.0, 0.0), (6.2, 0.0), (6.7, 0.05), (7.6, 0.05), (8.2, 0.2), (8.9, 0.95), (10.6, 1.0), (11.4, 0.2)],
        "frown": [(0, 0), (2.8, 0), (4.4, 0.0), (4.8, 0.75), (5.7, 0.80), (6.2, 0), (11, 0)],
        "browUpLeft": [(0, 0), (0.7, 0), (1.1, 0.35), (2.2, 0.25), (2.9, 0.3), (3.15, 1.0), (4.0, 0.9), (4.4, 0), (6.2, 0), (6.6, 1.0), (7.6, 0.95), (8.0, 0), (8.9, 0.45), (10.4, 0.4), (11.2, 0)],
        "browUpRight": [(0, 0), (0.7, 0), (1.15, 0.35), (2.2, 0.25), (2.9, 0.3), (3.15, 1.0), (4.0, 0.9), (4.4, 0), (6.2, 0), (6.7, 0.0), (7.6, 0.0), (8.0, 0), (8.9, 0.45), (10.4, 0.4), (11.2, 0)],
        "browsDown": [(0, 0), (4.3, 0), (4.75, 0.95), (5.8, 0.95), (6.25, 0), (6.7, 0.12), (7.6, 0.12), (8, 0), (11, 0)],
        "jawOpen": [(0, 0), (0.8, 0), (1.25, 0.26), (2.1, 0.22), (2.6, 0), (2.95, 0.05), (3.2, 0.85), (3.9, 0.75), (4.3, 0.0), (8.35, 0.0), (8.8, 0.55), (9.05, 0.30), (9.3, 0.55), (9.55, 0.45), (10.5, 0.50), (11.0, 0)],
        "pucker": [(0, 0), (4.3, 0), (4.8, 0.12), (5.7, 0.1), (6.0, 0), (7.75, 0), (8.05, 0.85), (8.3, 0.0), (11, 0)],
        "puff": [(0, 0), (5.0, 0), (5.35, 0.95), (5.75, 0.9), (5.95, 0), (11, 0)],
        "tongueOut": [(0, 0), (9.5, 0), (9.8, 1.0), (10.4, 1.0), (10.7, 0), (11.5, 0)],
    }
    blinks = [0.30, 2.55, 4.20, 4.48, 6.10, 8.15, 10.85]
    look = [(0, 0), (1.5, 4), (2.5, 4), (2.62, -14), (2.9, -14), (3.0, 0), (4.2, 0), (4.3, 16), (5.7, 16), (6.05, 14), (6.2, -10), (7.6, -10), (7.8, 0), (11.5, 0)]
    rise = [(0, 0), (2.6, -3), (3.0, 4), (3.9, 5), (4.3, -5), (5.8, -5), (6.2, 3), (7.6, 3), (8.0, 0), (11.5, 0)]
    yaw = [(0, 0), (1.3, 4), (2.4, 3), (3.1, 0), (4.1, 0), (4.7, 11), (5.8, 11), (6.4, -6), (7.7, -5), (8.4, 0), (9.4, 3), (10.4, -2), (11.5, 0)]
    nod = [(0, 0), (1.2, 3), (2.3, 2), (2.9, 2), (3.2, -7), (4.0, -6), (4.6, 6), (5.8, 5), (6.5, -1), (7.6, -1), (8.3, 3), (8.8, -6), (9.1, -3), (9.4, -6), (10.4, -3), (11.2, 2)]
    tilt = [(0, 0), (1.3, -4), (2.3, -3), (3.2, 0), (4.6, 3), (5.8, 4), (6.5, -8), (7.6, -8), (8.3, 0), (9.2, 5), (10.3, 4), (11.4, 0)]
    times = np.arange(int(LENGTH * RATE) + 1) / RATE
    weights, eyes, heads = [], [], []
    for t in times:
        shut = 0.0
        for b in blinks:
            # A lid falls in about 80 ms and rises in about 170.
            s = t - b
            shut = max(shut, float(smooth_step((s + 0.09) / 0.09)) if s <= 0 else float(1 - smooth_step((s - 0.03) / 0.19)))
        row = {name: at(k, t) for name, k in keys.items()}
        # Laughing narrows the eyes; only the left eye winks.
        squint = 0.30 * float(smooth_step((row["smileLeft"] - 0.6) / 0.4))
        wink = float(curve([(0, 0), (7.00, 0), (7.12, 1), (7.30, 1), (7.52, 0), (12, 0)], t))
        # Lids follow the gaze.
        low = 0.012 * max(-at(rise, t), 0)
        row["blinkLeft"] = min(max(shut, squint + low, 0.0), 1.0)
        row["blinkRight"] = min(max(shut, wink, squint + low), 1.0)
        weights.append([row.get(n, 0.0) for n in names])
        eyes.append(mul(qy(at(look, t)), qx(-at(rise, t))))
        heads.append(mul(qy(at(yaw, t)), qx(at(nod, t)), qz(at(tilt, t))))
    return times, np.array(weights), np.array(eyes), np.array(heads)


# ---------------------------------------------------------------- the file


def main(size=int(os.environ.get("ATLAS", "512"))):
    import gait
    import glb
    import paint as paint_
    from rig import slerp

    face, meshes = sculpt()
    left = clay.joined(meshes)
    alone = [i for i, m in enumerate(meshes) if m.whole]
    uv = paint_.unwrap(left, {NAMES.index(n): v for n, v in SPLITS.items()})
    shapes = [p.shape for p in PARTS]
    cover = [SKULL, HAIR] + [clay.mirrored(p.shape) for p in PARTS if p.shape and p.name != "tongue"]
    scene = lambda p: np.minimum.reduce([s(p) for s in cover])
    base, _, orm = paint_.bake(left, uv, shapes, paint, None, size, scene)
    shown = paint_.surface(left, uv, alone)
    whole = shown.mesh
    part = np.zeros(len(whole.vertices), dtype=int)
    for f, number in zip(whole.faces, whole.part):
        part[f] = number

    # The target data of the left half also applies to its mirror image.
    count = len(left.vertices)
    twin = np.arange(len(whole.vertices))
    moved = np.nonzero(whole.other != np.arange(count))[0] if len(whole.other) == count else np.array([], dtype=int)
    twin[whole.other[moved]] = moved
    eye = np.full((count, 2), np.nan)
    mouth = eye.copy()
    eye[: len(face.eye)], mouth[: len(face.mouth)] = face.eye, face.mouth
    rig = Rig(whole.vertices, part, eye[twin], mouth[twin])
    wanted = targets(rig)
    names = [name for name, _ in wanted]

    out = glb.Glb()
    material = out.add("materials", {
        "name": "goblin",
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": out.image(base, quality=65, name="goblin colour")},
            "metallicRoughnessTexture": {"index": (open_ := out.image(orm, quality=60, name="goblin surface"))},
        },
        "occlusionTexture": {"index": open_},
        "doubleSided": False,
    })
    wet = out.add("materials", {"name": "eye", "pbrMetallicRoughness": {"roughnessFactor": 0.08, "metallicFactor": 0.0}})

    rest = whole.normals()
    lift = np.array([0, LIFT, 0.0])

    def piece(group, morphs):
        mine = np.isin(part[shown.vertex], [i for i, p in enumerate(PARTS) if p.group == group])
        number = np.cumsum(mine) - 1
        tris = number[shown.triangles[mine[shown.triangles].all(axis=1)]]
        v = shown.vertex[mine]
        pivot = lift + PIVOT if group != "bust" else np.zeros(3)
        deltas = []
        for _, d in morphs:
            bent_ = clay.Mesh(whole.vertices + d, whole.faces, whole.part).normals()
            change = bent_ - rest
            # Deltas below 0.2 mm or five degrees are dropped.
            d = np.where(np.abs(d).max(axis=1, keepdims=True) > 2e-4, d, 0.0)
            change = np.where(np.abs(change).max(axis=1, keepdims=True) > 0.09, change, 0.0)
            deltas.append((d[v], change[v]))
        primitive = out.primitive(shown.place[mine] + lift - pivot, shown.normal[mine], tris, material, shown.uv[mine], targets=deltas, small=True)
        print(group, len(v), "vertices,", len(tris), "triangles")
        mesh = {"name": group, "primitives": [primitive]}
        if morphs:
            mesh["weights"] = [0.0] * len(morphs)
            mesh["extras"] = {"targetNames": names}
        return out.add("meshes", mesh)

    face_mesh, head_mesh, bust_mesh = piece("face", wanted), piece("head", []), piece("bust", [])
    places, normals, tris, colors = eyeball()
    used = np.unique(tris)
    number = np.full(len(places), -1)
    number[used] = np.arange(len(used))
    eye_mesh = out.add("meshes", {"name": "eye", "primitives": [out.primitive(places[used], normals[used], number[tris], wet, color=colors[used], small=True)]})

    node = lambda **more: out.add("nodes", more)
    eyes = [node(name=f"eye {side}", mesh=eye_mesh, translation=glb.tidy(EYE * [sign, 1, 1] - PIVOT)) for side, sign in (("left", 1), ("right", -1))]
    face_node = node(name="face", mesh=face_mesh)
    head = node(name="head", mesh=head_mesh, translation=glb.tidy(lift + PIVOT), children=[face_node, *eyes])
    bust = node(name="goblin", mesh=bust_mesh, children=[head])

    times, weights, gaze, heads = expressions(names)
    # Drops keys on a straight line, for all weights together.
    keep = gait._thin(list(weights), lambda a, b, t: a + (b - a) * t, lambda a, b: np.abs(a - b).max(), 0.02)
    angle = lambda a, b: 2 * np.arccos(min(1.0, abs(a @ b)))
    few = lambda track: gait._thin(list(track), slerp, angle, np.radians(0.25))
    g, h = few(gaze), few(heads)
    out.clip("expressions", list(range(len(out.json["nodes"]))), [
        (face_node, "weights", times[keep], weights[keep]),
        (eyes[0], "rotation", times[g], gaze[g]),
        (eyes[1], "rotation", times[g], gaze[g]),
        (head, "rotation", times[h], heads[h]),
    ])
    print(out.write(OUT, [bust]), "bytes")


# The head rotates about the top of the neck.
PIVOT = np.array([0.0, -0.105, -0.020])

if __name__ == "__main__":
    main()
