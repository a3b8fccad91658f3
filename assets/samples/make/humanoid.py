"""Shared by the humanoid samples: a 1.75 m skeleton in T-pose with Mixamo's names, and its weight gates."""

import numpy as np

import rig

# Center and left side, metres. T-pose at rest with palms down, facing +Z.
PLACES = [
    ("Hips", None, (0, 0.965, 0.0)),
    ("Spine", "Hips", (0, 1.065, 0.0)),
    ("Spine1", "Spine", (0, 1.17, -0.006)),
    ("Spine2", "Spine1", (0, 1.285, -0.014)),
    ("Neck", "Spine2", (0, 1.46, -0.018)),
    ("Head", "Neck", (0, 1.535, -0.004)),
    ("HeadTop_End", "Head", (0, 1.79, 0.0)),
    ("LeftShoulder", "Spine2", (0.055, 1.42, -0.014)),
    ("LeftArm", "LeftShoulder", (0.187, 1.41, -0.018)),
    ("LeftForeArm", "LeftArm", (0.457, 1.41, -0.022)),
    ("LeftHand", "LeftForeArm", (0.705, 1.41, -0.018)),
    ("LeftHandThumb1", "LeftHand", (0.73, 1.398, 0.016)),
    ("LeftHandThumb2", "LeftHandThumb1", (0.758, 1.386, 0.046)),
    ("LeftHandThumb3", "LeftHandThumb2", (0.785, 1.381, 0.063)),
    ("LeftHandThumb4", "LeftHandThumb3", (0.812, 1.378, 0.074)),
    ("LeftUpLeg", "Hips", (0.095, 0.915, 0.0)),
    ("LeftLeg", "LeftUpLeg", (0.104, 0.508, 0.010)),
    ("LeftFoot", "LeftLeg", (0.108, 0.100, -0.022)),
    ("LeftToeBase", "LeftFoot", (0.113, 0.026, 0.105)),
    ("LeftToe_End", "LeftToeBase", (0.116, 0.022, 0.190)),
]
# Knuckle z, tip z, length of each finger; the phalanges share the length 45 : 30 : 25.
FINGERS = {
    "Index": (0.018, 0.030, 0.084),
    "Middle": (-0.007, -0.005, 0.094),
    "Ring": (-0.031, -0.038, 0.087),
    "Pinky": (-0.054, -0.070, 0.068),
}
KNUCKLE_X = 0.795


def finger_places(name):
    root, tip, length = FINGERS[name]
    back = {"Index": 0.0, "Middle": 0.004, "Ring": 0.0, "Pinky": -0.008}[name]
    start = np.array([KNUCKLE_X + back, 1.409, root])
    end = np.array([KNUCKLE_X + back + length, 1.404, tip])
    return [start + (end - start) * t for t in (0.0, 0.45, 0.75, 1.0)]


def skeleton(prefix="mixamorig:", fingers=True, ends=True):
    """The human skeleton with identity rest frames."""
    places = list(PLACES)
    if fingers:
        at = [p[0] for p in places].index("LeftUpLeg")
        rows = []
        for name in FINGERS:
            up = "LeftHand"
            for i, place in enumerate(finger_places(name)):
                rows.append((f"LeftHand{name}{i + 1}", up, tuple(place)))
                up = rows[-1][0]
        places[at:at] = rows
    else:
        places = [p for p in places if "Thumb" not in p[0]]
    if not ends:
        places = [p for p in places if not (p[0].endswith("_End") or p[0].endswith("4"))]
    full = []
    # The right side follows the left limb by limb, in the order of this rig's exporters.
    for limb in ("", "Shoulder Arm ForeArm Hand", "UpLeg Leg Foot Toe"):
        words = tuple(limb.split())
        if not words:
            full += [p for p in places if not p[0].startswith("Left")]
            continue
        mine = [p for p in places if p[0].startswith("Left") and p[0][4:].startswith(words)]
        full += mine
        full += [
            (n.replace("Left", "Right"), up.replace("Left", "Right"), (-x, y, z)) for n, up, (x, y, z) in mine
        ]
    out = rig.Skeleton()
    for name, up, place in full:
        out.add(prefix + name, None if up is None else prefix + up, place)
    return out


def _capsule_distance(p, a, b):
    along = b - a
    t = np.clip((p - a) @ along / (along @ along), 0, 1)
    return np.linalg.norm(p - a - t[:, None] * along, axis=1)


def gates(s, prefix="mixamorig:", fingers=True):
    """The weight gates of this body; see rig.Gates."""
    g = rig.Gates(s)
    n = lambda name: prefix + name
    up = (0, 1, 0)
    g.gate(n("Spine"), up, 0.10)
    g.gate(n("Spine1"), up, 0.11)
    g.gate(n("Spine2"), up, 0.12)
    middle = lambda p: 1.0 - rig.smooth_step((np.abs(p[:, 0]) - 0.09) / 0.06)
    g.gate(n("Neck"), up, 0.07, shift=0.01, near=middle)
    g.gate(n("Head"), up, 0.05)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        # Below the armpit the trunk keeps its weight; farther out everything belongs to the arm.
        high = lambda p, sign=sign: np.maximum(
            rig.smooth_step((p[:, 1] - 1.285) / 0.10), rig.smooth_step((sign * p[:, 0] - 0.155) / 0.075)
        )
        g.gate(n(side + "Shoulder"), (sign, 0.1, 0), 0.12, shift=0.055, near=high)
        g.gate(n(side + "Arm"), (sign, 0.30, 0), 0.105, shift=0.004)
        g.gate(n(side + "ForeArm"), (sign, 0, 0), 0.10)
        g.gate(n(side + "Hand"), (sign, 0, 0), 0.06)
        beside = lambda p, sign=sign: rig.smooth_step((sign * p[:, 0] + 0.022) / 0.044)
        g.gate(n(side + "UpLeg"), (0.42 * sign, -1, 0), 0.13, shift=-0.006, near=beside)
        g.gate(n(side + "Leg"), (0, -1, 0), 0.11)
        g.gate(n(side + "Foot"), (0, -1, 0.15), 0.07, shift=-0.005)
        g.gate(n(side + "ToeBase"), (0, -0.1, 1), 0.05, shift=-0.004)
        if not fingers:
            continue
        chains = ["Thumb", *FINGERS]

        def share(p, which, side=side):
            distances = np.stack(
                [
                    np.min(
                        [
                            _capsule_distance(p, s.world[s[n(f"{side}Hand{c}{i}")]], s.world[s[n(f"{side}Hand{c}{i + 1}")]])
                            for i in (1, 2, 3)
                        ],
                        axis=0,
                    )
                    for c in chains
                ]
            )
            k = np.exp(-(distances - distances.min(axis=0)) / 0.0022)
            return k[chains.index(which)] / k.sum(axis=0)

        for c in chains:
            first = s.world[s[n(f"{side}Hand{c}2")]] - s.world[s[n(f"{side}Hand{c}1")]]
            width = 0.03 if c == "Thumb" else 0.024
            g.gate(n(f"{side}Hand{c}1"), first, width, near=lambda p, c=c, share=share: share(p, c))
            g.gate(n(f"{side}Hand{c}2"), None, 0.016)
            g.gate(n(f"{side}Hand{c}3"), None, 0.014)
    return g
