"""Makes ../pilot.glb: a test pilot in a flight suit, 52 moving joints under Mixamo's names, six clips."""

import os
import sys
import time

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
import humanoid
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
        power=2.35, rounding=0.03,
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
            (0.61, 1.411, -0.018, 0.043, 0.045),
            (0.69, 1.411, -0.017, 0.034, 0.038),
            (0.73, 1.411, -0.017, 0.030, 0.036),
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

# ---------------------------------------------------------------- what is worn


def glove():
    palm = sideways(
        [
            (0.685, 1.411, -0.017, 0.030, 0.035),
            (0.72, 1.410, -0.017, 0.026, 0.038),
            (0.76, 1.409, -0.017, 0.0235, 0.045),
            (0.80, 1.409, -0.018, 0.0185, 0.047),
        ],
        rounding=0.014, power=2.4,
    )
    hand = union(palm, ellipsoid((0.742, 1.397, 0.012), (0.030, 0.018, 0.024)), k=0.015)
    s = humanoid.skeleton(prefix="")
    for name, (r0, r1) in {
        "Index": (0.0122, 0.0098), "Middle": (0.0125, 0.0100), "Ring": (0.0120, 0.0096), "Pinky": (0.0108, 0.0088)
    }.items():
        p = humanoid.finger_places(name)
        finger = union(
            capsule(p[0] - [0.022, 0, 0], p[1], r0 * 1.08, r0), capsule(p[1], p[2], r0, (r0 + r1) / 2),
            capsule(p[2], p[3] - [0.006, 0, 0], (r0 + r1) / 2, r1), k=0.002,
        )
        hand = union(hand, finger, k=0.0055)
    t = [s.world[s[f"LeftHandThumb{i}"]] for i in (1, 2, 3, 4)]
    thumb = union(
        capsule(t[0], t[1], 0.0175, 0.0145), capsule(t[1], t[2], 0.0145, 0.0128), capsule(t[2], t[3], 0.0128, 0.0105), k=0.003
    )
    hand = union(hand, thumb, k=0.010)
    cuff = sideways(
        [
            (0.598, 1.411, -0.018, 0.0555, 0.0575),
            (0.625, 1.411, -0.018, 0.0530, 0.0550),
            (0.665, 1.411, -0.017, 0.0445, 0.0475),
            (0.70, 1.411, -0.017, 0.0355, 0.0405),
        ],
        rounding=0.006,
    )
    rim = sideways(
        [(0.592, 1.411, -0.018, 0.0595, 0.0615), (0.607, 1.411, -0.018, 0.0590, 0.0610)], rounding=0.006
    )
    return union(union(hand, cuff, k=0.012), rim, k=0.004)


def boot():
    shaft = upright(
        [
            (0.345, 0.107, -0.010, 0.0685, 0.0765),
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
        rounding=0.022, power=2.3,
    )
    sole = upright(
        [(0.0, 0.1125, 0.056, 0.054, 0.152), (0.014, 0.1125, 0.056, 0.056, 0.154), (0.030, 0.1125, 0.056, 0.0545, 0.152)],
        rounding=0.007, power=2.7,
    )
    waist = ellipsoid((0.06, 0.0, 0.028), (0.022, 0.024, 0.045))
    sole = cut(sole, waist, k=0.01)
    rim = upright([(0.332, 0.107, -0.010, 0.0725, 0.0805), (0.352, 0.107, -0.009, 0.0735, 0.0815)], rounding=0.008)
    strap = common(grown(union(shaft, foot, k=0.03), 0.0055), box((0.11, 0.125, 0.0), (0.2, 0.013, 0.2), 0.004,
                   rotation=np.array([[1, 0, 0], [0, 0.94, -0.34], [0, 0.34, 0.94]])), k=0.004)
    return union(union(union(shaft, foot, k=0.03), rim, strap, k=0.004), sole, k=0.006)


def vest():
    body = grown(union(TORSO, ARM, k=0.075), 0.015)
    low = halfspace((0, 1.105, 0), (0, -1, 0))
    neck = ellipsoid((0, 1.49, 0.03), (0.088, 0.115, 0.12))
    hole = capsule((0.225, 1.385, -0.018), (0.40, 1.33, -0.018), 0.098, flatten=((0, 0, 1), 1.25))
    trim = cut(cut(common(body, low, k=0.012), hole, k=0.012), neck, k=0.010)
    core = grown(union(TORSO, ARM, k=0.075), -0.012)
    trim = cut(trim, core, k=0.004)
    plate = common(grown(TORSO, 0.026), box((0.0, 1.265, 0.12), (0.118, 0.085, 0.09), 0.03), k=0.012)
    return union(trim, plate, k=0.008)


def belt():
    band = common(grown(TORSO, 0.016), box((0, 1.03, 0), (0.3, 0.024, 0.3), 0.006), k=0.006)
    band = cut(band, grown(TORSO, -0.012), k=0.004)
    buckle = box((0, 1.03, 0.115), (0.034, 0.026, 0.014), 0.008)
    turn = 0.72
    r = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    pouch = box((0.118, 1.012, 0.086), (0.036, 0.042, 0.024), 0.011, rotation=r)
    flap = box((0.1195, 1.036, 0.0875), (0.039, 0.017, 0.027), 0.009, rotation=r)
    side = box((0.168, 1.008, -0.02), (0.022, 0.046, 0.042), 0.012)
    return union(band, buckle, pouch, flap, side, k=0.004)


HEAD = (0.0, 1.640, 0.004)


def helmet_outer():
    dome = ellipsoid((0, 1.655, -0.004), (0.131, 0.137, 0.150))
    jaw = forward(
        [(-0.07, 0, 1.585, 0.098, 0.072), (0.0, 0, 1.575, 0.108, 0.074), (0.07, 0, 1.567, 0.098, 0.066), (0.142, 0, 1.566, 0.058, 0.046)],
        rounding=0.045, power=2.3,
    )
    return union(dome, jaw, k=0.05)


def window(p, grow=0.0):
    """The visor's outline on the helmet: wraps round to the temples, negative inside."""
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
    glass = common(grown(HELMET_OUTER, 0.001), lambda p: window(p, -0.0015), k=0.008)
    return cut(glass, grown(HELMET_OUTER, -0.022), k=0.004)


def collar():
    ring = upright(
        [(1.452, 0, -0.016, 0.100, 0.090), (1.475, 0, -0.014, 0.104, 0.094), (1.505, 0, -0.010, 0.096, 0.088)], rounding=0.012
    )
    hole = capsule((0, 1.55, -0.008), (0, 1.62, -0.008), 0.066)
    return cut(ring, hole, k=0.01)


def pack():
    body = box((0.0, 1.285, -0.178), (0.128, 0.150, 0.056), 0.034)
    low = box((0.0, 1.175, -0.170), (0.105, 0.05, 0.056), 0.026)
    ridge = box((0.0, 1.30, -0.232), (0.052, 0.105, 0.016), 0.012)
    tank = capsule((0.092, 1.19, -0.205), (0.092, 1.375, -0.205), 0.040)
    cap = sideways([(0.0, 1.425, -0.175, 0.020, 0.024), (0.085, 1.425, -0.175, 0.020, 0.024)], rounding=0.01)
    return union(union(body, low, k=0.02), union(ridge, cap, k=0.006), tank, k=0.010)


LIMB = union(TORSO, ARM, k=0.075)


def shoulder_pad():
    cap = common(grown(LIMB, 0.027), ellipsoid((0.218, 1.475, -0.018), (0.074, 0.082, 0.088)), k=0.010)
    return cut(cap, grown(LIMB, -0.008), k=0.006)


def knee_pad():
    cap = common(grown(LEG, 0.017), ellipsoid((0.105, 0.520, 0.085), (0.056, 0.084, 0.062)), k=0.010)
    ridge = common(grown(LEG, 0.025), ellipsoid((0.105, 0.520, 0.085), (0.030, 0.060, 0.040)), k=0.008)
    return cut(union(cap, ridge, k=0.006), grown(LEG, -0.010), k=0.006)


# name, clay (left half), box, quads (whole), grid step, the joint that carries it whole (None: by the gates)
PARTS = [
    ("suit", SUIT, (0, 0.06, -0.2), (0.74, 1.56, 0.2), 3000, 0.008, None),
    ("glove", glove(), (0.57, 1.33, -0.13), (0.93, 1.49, 0.12), 1700, 0.0024, None),
    ("boot", boot(), (0.02, -0.03, -0.14), (0.22, 0.39, 0.25), 900, 0.004, None),
    ("vest", clay.mirrored(vest()), (0, 1.05, -0.2), (0.36, 1.57, 0.2), 1000, 0.004, None),
    ("belt", belt(), (0, 0.93, -0.18), (0.24, 1.1, 0.2), 760, 0.003, None),
    ("helmet", clay.mirrored(helmet()), (0, 1.45, -0.2), (0.2, 1.83, 0.22), 1300, 0.004, "Head"),
    ("visor", clay.mirrored(visor()), (0, 1.5, -0.1), (0.2, 1.78, 0.22), 240, 0.003, "Head"),
    ("collar", clay.mirrored(collar()), (0, 1.42, -0.14), (0.16, 1.55, 0.14), 220, 0.004, None),
    ("pack", clay.mirrored(pack()), (0, 1.08, -0.28), (0.2, 1.48, -0.08), 560, 0.005, "Spine2"),
    ("shoulder", shoulder_pad(), (0.08, 1.3, -0.14), (0.34, 1.54, 0.1), 260, 0.004, None),
    ("knee", knee_pad(), (0.02, 0.4, 0.0), (0.2, 0.62, 0.14), 220, 0.004, None),
]


def sculpt():
    meshes = []
    for name, shape, low, high, quads, step, _ in PARTS:
        start = time.time()
        mesh = clay.mesh_of(shape, low, high, quads, step)
        print(f"{name}: {len(mesh.faces)} quads on the left, {time.time() - start:.1f} s", flush=True)
        meshes.append(mesh)
    return meshes


# ---------------------------------------------------------------- the file


def main():
    import gait
    import glb
    import moves
    import rig

    s = humanoid.skeleton()
    g = humanoid.gates(s)
    meshes = sculpt()
    out = glb.Glb()
    nodes = out.nodes_of(s)
    joints = [j for j, n in enumerate(s.names) if not (n.endswith("_End") or n.endswith("4"))]
    left = clay.joined(meshes)
    alone = [i for i, m in enumerate(meshes) if m.whole]
    body = clay.mirror(left, alone=alone)
    w = g.weights(body.vertices, "mixamorig:Hips")
    w = rig.smoothed(w, body.faces, 2)
    for i, (name, *_, carrier) in enumerate(PARTS):
        if carrier:
            mine = np.unique([v for f, p in zip(body.faces, body.part) if p == i for v in f])
            w[mine] = 0
            w[mine, s["mixamorig:" + carrier]] = 1
    values, slots = rig.strongest(w, joints)
    colors = [(.85,.33,.12),(.17,.18,.2),(.2,.2,.22),(.25,.27,.3),(.3,.28,.25),(.9,.87,.8),(.05,.1,.15),(.3,.3,.3),(.4,.42,.45),(.85,.82,.78),(.85,.82,.78)]
    color = np.zeros((len(body.vertices), 3))
    for f, p in zip(body.faces, body.part):
        color[f] = np.array(colors[p]) ** 2.2
    tris, _ = body.triangles()
    material = out.add("materials", {"name": "pilot", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.7}})
    primitive = out.primitive(body.vertices, body.normals(), tris, material, color=color, joints=slots, weights=values)
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
