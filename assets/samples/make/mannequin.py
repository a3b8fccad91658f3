"""Makes ../mannequin.glb (an artist's wooden mannequin without clips) and ../mannequin_run.glb (its skeleton with a run that
travels). Both have the armature node of FBX conversions: scaled by 100, rotated by -90 degrees about X, with joint
positions in centimetres, z up, and each frame's y axis along its bone."""

import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import clay
import gait
import glb
import humanoid
import moves
import paint
import rig
from clay import capsule, cut, ellipsoid, forward, halfspace, sideways, sphere, union, upright
from paint import noise, srgb

HERE = os.path.dirname(os.path.abspath(__file__))
PREFIX = "mixamorig:"
SPEED = 3.2


def skeleton():
    """The human skeleton under an armature node."""
    plain = humanoid.skeleton(PREFIX, fingers=False)
    s = rig.Skeleton()
    s.add("Armature", None, (0, 0, 0), rig.qx(-90), 100.0)
    for j, name in enumerate(plain.names):
        kids = plain.children(j)
        along = None
        if kids:
            # The bone points at the joint that continues the limb.
            heir = next((k for k in kids if any(w in plain.names[k] for w in ("Spine", "Neck"))), kids[0])
            along = plain.world[heir] - plain.world[j]
        elif plain.parents[j] >= 0:
            along = plain.world[j] - plain.world[plain.parents[j]]
        trunk = any(w in name for w in ("Hips", "Spine", "Neck", "Head"))
        turn = np.array([0, 0, 0, 1.0]) if trunk else rig.between(np.array([0.0, 1.0, 1e-6]), along)
        s.add(name, "Armature" if plain.parents[j] < 0 else plain.names[plain.parents[j]], plain.world[j], turn)
    return s


def rotation_to(direction):
    """A rotation (3x3) whose y axis points in a direction."""
    return rig.matrix(rig.between(np.array([0.0, 1.0, 1e-6]), np.asarray(direction, dtype=np.float64)))


class Piece:
    """One turned piece of wood: its clay, its middle, about its radii (y along `along`), quads, joint, tone."""

    def __init__(self, shape, center, radii, counts, joint, along=(0, 1, 0), dark=False, both=True):
        self.shape, self.center, self.radii, self.counts = shape, np.asarray(center, dtype=float), radii, counts
        self.joint, self.along, self.dark, self.both = joint, np.asarray(along, dtype=float), dark, both
        self.along /= np.linalg.norm(self.along)


def ball(center, radius, joint, both=True, counts=(4, 4, 4)):
    return Piece(sphere(center, radius), center, (radius,) * 3, counts, joint, dark=True, both=both)


def pieces():
    """Center and left side."""
    s = humanoid.skeleton("", fingers=False)
    at = lambda n: s.world[s[n]]
    out = []

    # The trunk: pelvis, waist ball, chest; a neck ball and a short neck; the head an egg, its face slightly flattened.
    pelvis = upright(
        [
            (0.855, 0, 0.0, 0.055, 0.055),
            (0.89, 0, -0.004, 0.115, 0.082),
            (0.945, 0, -0.006, 0.148, 0.098),
            (1.0, 0, -0.002, 0.132, 0.088),
            (1.035, 0, 0.0, 0.085, 0.060),
        ],
        rounding=0.03,
        power=2.3,
    )
    out.append(Piece(pelvis, (0, 0.945, -0.004), (0.145, 0.085, 0.095), (7, 5, 6), "Hips", both=False))
    out.append(
        Piece(
            ellipsoid((0, 1.072, 0.0), (0.088, 0.066, 0.070)),
            (0, 1.072, 0),
            (0.088, 0.066, 0.070),
            (5, 4, 4),
            "Spine",
            dark=True,
            both=False,
        )
    )
    chest = upright(
        [
            (1.095, 0, 0.002, 0.070, 0.055),
            (1.13, 0, 0.002, 0.108, 0.082),
            (1.20, 0, 0.002, 0.138, 0.102),
            (1.29, 0, -0.002, 0.158, 0.112),
            (1.37, 0, -0.010, 0.150, 0.104),
            (1.42, 0, -0.015, 0.110, 0.078),
            (1.447, 0, -0.018, 0.060, 0.050),
        ],
        rounding=0.03,
        power=2.3,
    )
    pecs = ellipsoid((0.068, 1.315, 0.062), (0.082, 0.066, 0.048))
    chest = union(chest, clay.mirrored(pecs), k=0.06)
    out.append(Piece(chest, (0, 1.28, 0.0), (0.155, 0.175, 0.108), (7, 8, 6), "Spine2", both=False))
    out.append(ball((0, 1.463, -0.016), 0.042, "Neck", both=False))
    out.append(
        Piece(
            capsule((0, 1.475, -0.015), (0, 1.535, -0.006), 0.039, 0.037),
            (0, 1.505, -0.010),
            (0.039, 0.07, 0.039),
            (4, 3, 4),
            "Neck",
            both=False,
        )
    )
    skull = union(
        ellipsoid((0, 1.672, -0.006), (0.078, 0.102, 0.096)),
        upright(
            [
                (1.545, 0, 0.022, 0.030, 0.034),
                (1.575, 0, 0.018, 0.050, 0.058),
                (1.63, 0, 0.010, 0.066, 0.080),
                (1.68, 0, 0.004, 0.070, 0.086),
            ],
            rounding=0.022,
            power=2.2,
        ),
        k=0.05,
    )
    skull = cut(skull, halfspace((0, 1.64, 0.088), (0, -0.10, -1)), k=0.030)
    out.append(Piece(skull, (0, 1.655, 0.004), (0.078, 0.118, 0.094), (6, 7, 7), "Head", both=False))

    # The arm, along +X.
    shoulder, elbow, wrist = at("LeftArm"), at("LeftForeArm"), at("LeftHand")
    x = (1, 0, 0)
    collar = ellipsoid((0.128, 1.412, -0.016), (0.058, 0.042, 0.046))
    out.append(Piece(collar, (0.128, 1.412, -0.016), (0.042, 0.058, 0.046), (4, 4, 4), "LeftShoulder", along=x))
    out.append(ball(shoulder + [0.006, 0, 0], 0.054, "LeftArm", counts=(5, 5, 5)))
    upper = sideways(
        [
            (0.222, 1.410, -0.018, 0.030, 0.030),
            (0.245, 1.411, -0.018, 0.046, 0.046),
            (0.29, 1.412, -0.018, 0.0515, 0.0505),
            (0.36, 1.411, -0.019, 0.045, 0.044),
            (0.41, 1.410, -0.020, 0.037, 0.037),
            (0.434, 1.410, -0.021, 0.026, 0.026),
        ],
        rounding=0.02,
    )
    out.append(Piece(upper, (0.328, 1.411, -0.019), (0.048, 0.108, 0.048), (4, 7, 4), "LeftArm", along=x))
    out.append(ball(elbow, 0.0375, "LeftForeArm"))
    fore = sideways(
        [
            (0.478, 1.410, -0.022, 0.027, 0.027),
            (0.500, 1.411, -0.022, 0.038, 0.039),
            (0.545, 1.411, -0.021, 0.043, 0.043),
            (0.61, 1.411, -0.019, 0.036, 0.037),
            (0.66, 1.410, -0.018, 0.0285, 0.030),
            (0.682, 1.410, -0.018, 0.020, 0.021),
        ],
        rounding=0.015,
    )
    out.append(Piece(fore, (0.58, 1.411, -0.020), (0.040, 0.104, 0.040), (4, 7, 4), "LeftForeArm", along=x))
    out.append(ball(wrist + [-0.002, 0, 0], 0.0265, "LeftHand", counts=(3, 3, 3)))
    palm = sideways(
        [
            (0.722, 1.409, -0.018, 0.015, 0.018),
            (0.738, 1.409, -0.018, 0.0205, 0.031),
            (0.775, 1.409, -0.018, 0.0205, 0.042),
            (0.806, 1.408, -0.018, 0.0165, 0.043),
            (0.822, 1.407, -0.018, 0.010, 0.036),
        ],
        rounding=0.010,
        power=2.5,
    )
    out.append(Piece(palm, (0.772, 1.409, -0.018), (0.020, 0.052, 0.042), (3, 5, 5), "LeftHand", along=x))
    mitt = sideways(
        [
            (0.824, 1.406, -0.018, 0.009, 0.034),
            (0.836, 1.406, -0.018, 0.0145, 0.040),
            (0.865, 1.405, -0.018, 0.0135, 0.038),
            (0.895, 1.402, -0.018, 0.0110, 0.031),
            (0.912, 1.400, -0.018, 0.007, 0.022),
        ],
        rounding=0.007,
        power=2.5,
    )
    out.append(Piece(mitt, (0.866, 1.404, -0.018), (0.0135, 0.047, 0.038), (3, 4, 5), "LeftHand", along=x))
    thumb = capsule((0.752, 1.402, 0.024), (0.795, 1.394, 0.046), 0.0150, 0.0110)
    out.append(
        Piece(thumb, (0.7735, 1.398, 0.035), (0.014, 0.037, 0.014), (3, 5, 3), "LeftHand", along=(0.85, -0.15, 0.45))
    )

    # The leg.
    hip, knee, ankle, toe = at("LeftUpLeg"), at("LeftLeg"), at("LeftFoot"), at("LeftToeBase")
    out.append(ball(hip + [0.004, -0.006, 0], 0.069, "LeftUpLeg", counts=(5, 5, 5)))
    thigh = upright(
        [
            (0.895, 0.098, 0.0, 0.040, 0.045),
            (0.865, 0.099, 0.000, 0.068, 0.076),
            (0.80, 0.101, 0.002, 0.078, 0.087),
            (0.70, 0.102, 0.006, 0.068, 0.076),
            (0.60, 0.103, 0.009, 0.053, 0.058),
            (0.550, 0.104, 0.010, 0.043, 0.047),
            (0.527, 0.104, 0.010, 0.030, 0.033),
        ],
        rounding=0.03,
    )
    out.append(Piece(thigh, (0.101, 0.712, 0.004), (0.073, 0.185, 0.080), (5, 9, 5), "LeftUpLeg"))
    out.append(ball(knee, 0.049, "LeftLeg"))
    shin = upright(
        [
            (0.487, 0.105, 0.008, 0.032, 0.034),
            (0.465, 0.105, 0.006, 0.044, 0.047),
            (0.41, 0.106, -0.002, 0.051, 0.056),
            (0.34, 0.107, -0.010, 0.052, 0.058),
            (0.25, 0.107, -0.016, 0.041, 0.045),
            (0.17, 0.108, -0.020, 0.031, 0.034),
            (0.137, 0.108, -0.022, 0.022, 0.024),
        ],
        rounding=0.025,
    )
    out.append(Piece(shin, (0.1065, 0.312, -0.008), (0.050, 0.178, 0.054), (5, 8, 5), "LeftLeg"))
    out.append(ball(ankle + [0, 0.004, 0], 0.036, "LeftFoot"))
    foot = forward(
        [
            (-0.082, 0.109, 0.036, 0.024, 0.026),
            (-0.055, 0.109, 0.042, 0.036, 0.040),
            (-0.005, 0.110, 0.047, 0.039, 0.046),
            (0.045, 0.111, 0.036, 0.041, 0.035),
            (0.080, 0.112, 0.028, 0.043, 0.028),
            (0.094, 0.113, 0.026, 0.036, 0.022),
        ],
        rounding=0.018,
        power=2.4,
    )
    flat = halfspace((0, 0.001, 0), (0, -1, 0))
    foot = clay.common(foot, flat, k=0.008)
    z = (0, 0, 1)
    out.append(Piece(foot, (0.110, 0.036, 0.008), (0.040, 0.086, 0.036), (5, 7, 4), "LeftFoot", along=z))
    toes = forward(
        [
            (0.098, 0.114, 0.024, 0.036, 0.020),
            (0.110, 0.114, 0.025, 0.044, 0.024),
            (0.145, 0.115, 0.023, 0.043, 0.022),
            (0.180, 0.115, 0.020, 0.033, 0.018),
            (0.196, 0.115, 0.018, 0.020, 0.012),
        ],
        rounding=0.012,
        power=2.5,
    )
    toes = clay.common(toes, flat, k=0.006)
    out.append(Piece(toes, (0.115, 0.022, 0.146), (0.043, 0.049, 0.022), (5, 4, 3), "LeftToeBase", along=z))
    return out


MAPLE, HONEY, WALNUT, RIM = srgb("#d9b27c"), srgb("#b9854c"), srgb("#6d4326"), srgb("#4b2c18")


def wood(piece, seed, p, opened):
    """Growth rings around an axis beside the piece, fibres along it; darker where pieces meet."""
    along = piece.along
    side = np.cross(along, [0.3, 0.2, 0.93])
    side /= np.linalg.norm(side)
    other = np.cross(along, side)
    q = p - piece.center
    t, u, v = q @ along, q @ side, q @ other
    random = np.random.default_rng(seed)
    cu, cv = random.uniform(0.05, 0.11, 2) * random.choice([-1, 1], 2)
    wobble = noise(np.column_stack([u, v, t * 0.25]), 0.035, seed) * 0.006
    r = np.hypot(u - cu + 0.06 * t * random.uniform(-1, 1), v - cv) + wobble
    ring = (r / 0.0105) % 1.0
    late = np.clip(ring, 0, 1) ** 3 * (1 - np.clip((ring - 0.93) / 0.07, 0, 1))
    fibre = 0.5 + 0.5 * noise(np.column_stack([u, v, t * 0.04]), 0.0016, seed + 5)
    broad = 0.5 + 0.5 * noise(np.column_stack([u, v, t * 0.3]), 0.05, seed + 9)
    light, deep = (WALNUT, RIM) if piece.dark else (MAPLE, HONEY)
    amount = np.clip(0.62 * late + 0.22 * fibre + 0.20 * broad - 0.08, 0, 1)
    c = light + (deep - light) * amount[:, None]
    c = c * (0.55 + 0.45 * opened)[:, None]
    return c, 0.40 + 0.12 * fibre + 0.1 * late + 0.2 * (1 - opened), np.zeros(len(p))


def main():
    s = skeleton()
    out = glb.Glb()
    nodes = out.nodes_of(s)
    parts = pieces()
    meshes = []
    for piece in parts:
        m = clay.globe(piece.shape, piece.center, piece.radii, piece.counts, rotation_to(piece.along))
        m.whole = not piece.both
        meshes.append(m)
    left = clay.joined(meshes)
    alone = [i for i, piece in enumerate(parts) if not piece.both]
    uv = paint.unwrap(left, {i: (0, 0, 1) if abs(p.along[2]) < 0.9 else (1, 0, 0) for i, p in enumerate(parts)})
    scene = lambda p: np.minimum.reduce([clay.mirrored(piece.shape)(p) for piece in parts])
    color = lambda part, p, n, opened: wood(parts[part], 40 + part, p, opened)
    base, _, orm = paint.bake(left, uv, [p.shape for p in parts], color, None, 768, scene)
    shown = paint.surface(left, uv, alone)
    joints = list(range(1, len(s.names)))
    joints = [j for j in joints if not s.names[j].endswith("_End")]
    # Wood does not bend: each piece is rigid.
    slots = np.zeros((len(shown.place), 4), dtype=int)
    weights = np.tile([1.0, 0, 0, 0], (len(shown.place), 1))
    whole = shown.mesh
    owner = np.zeros(len(whole.vertices), dtype=int)
    for f, p in zip(whole.faces, whole.part):
        owner[f] = p
    for i, v in enumerate(shown.vertex):
        name = parts[owner[v]].joint
        if whole.vertices[v][0] < 0 and parts[owner[v]].both:
            name = name.replace("Left", "Right")
        slots[i, 0] = joints.index(s[PREFIX + name])
    material = out.add(
        "materials",
        {
            "name": "wood",
            "pbrMetallicRoughness": {
                "baseColorTexture": {"index": out.image(base, quality=74, name="wood colour")},
                "metallicRoughnessTexture": {"index": (relief := out.image(orm, quality=70, name="wood surface"))},
            },
            "occlusionTexture": {"index": relief},
        },
    )
    primitive = out.primitive(
        shown.place, shown.normal, shown.triangles, material, shown.uv, joints=slots, weights=weights
    )
    print(len(shown.place), "vertices,", len(shown.triangles), "triangles")
    mesh = out.add("meshes", {"name": "mannequin", "primitives": [primitive]})
    node = out.add("nodes", {"name": "mannequin", "mesh": mesh, "skin": out.skin(s, nodes, joints, "mannequin")})
    print(out.write(os.path.join(HERE, "..", "mannequin.glb"), [nodes[0], node]), "bytes")

    figure = moves.mixamo_figure(s)
    poses, rate, _ = moves.run(figure, SPEED)
    hips = PREFIX + "Hips"
    travelling = []
    for i, (turns, shift) in enumerate(poses):
        travelling.append((turns, {**shift, hips: np.asarray(shift[hips]) + [0, 0, SPEED * i / rate]}))
    legs = [n for n in s.names if any(w in n for w in ("Hips", "Leg", "Foot", "Toe"))]
    out = glb.Glb()
    nodes = out.nodes_of(s)
    out.clip("run", nodes, gait.channels(s, travelling, rate, tight=legs))
    print(out.write(os.path.join(HERE, "..", "mannequin_run.glb"), [nodes[0]]), "bytes")


if __name__ == "__main__":
    main()
