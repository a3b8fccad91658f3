"""Gait: poses and cycles of bipeds, keyed from measurements of human motion, as turns on any skeleton.

A turn is a joint's rotation from the T-pose in axes parallel to the model's (x left, y up, z forward), relative to its
parent's turn; rig.Skeleton.local_rotation converts it to a file's rotation. A cycle is a function of the phase 0..1 (0: the
left heel strikes) that returns (turns, moves). Feet are placed first - heel, flat foot or toe joint rests on a fixed point
on the ground - and the legs follow by two-bone inverse kinematics, so feet neither slide nor sink. Clips
in place are on a treadmill: the ground moves back at the given speed.

Sources of the numbers: Whittle, "Gait Analysis" (stance 62 % of a walking stride; heel strike, foot flat at 8 %, heel
rise at 35 %, toe off at 62 %; the trunk highest in mid-stance, the pelvis turning about 4 degrees each way and dropping
about 4 degrees on the swinging side, the shoulders turning against it); Novacheck, "The biomechanics of running" (stance
under 40 %, two phases of flight, trunk lowest in mid-stance); Williams, "The Animator's Survival Kit" (contact, down,
passing, up).
"""

import numpy as np

from rig import conj, frame, mul, qx, qy, qz, quat, rotate, slerp, smooth_step

UP = np.array([0.0, 1.0, 0.0])
AHEAD = np.array([0.0, 0.0, 1.0])
NONE = np.array([0.0, 0.0, 0.0, 1.0])


def curve(keys, t, period=None):
    """A smooth curve through (time, value) keys; values may be vectors. With `period` it is periodic."""
    times = [k[0] for k in keys]
    values = [np.asarray(k[1], dtype=np.float64) for k in keys]
    if period is not None:
        t = (t - times[0]) % period + times[0]
        times = [times[-1] - period, *times, times[0] + period, times[1] + period]
        values = [values[-1], *values, values[0], values[1]]
    t = min(max(t, times[0]), times[-1])
    i = min(max(int(np.searchsorted(times, t, side="right")) - 1, 0), len(times) - 2)

    def slope(k):
        if k == 0 or k == len(times) - 1:
            return np.zeros_like(values[0])
        before = (values[k] - values[k - 1]) / (times[k] - times[k - 1])
        after = (values[k + 1] - values[k]) / (times[k + 1] - times[k])
        # No overshoot: extrema are flat, and no slope exceeds three times a neighbour.
        limit = 3.0 * np.minimum(np.abs(before), np.abs(after))
        mean = (values[k + 1] - values[k - 1]) / (times[k + 1] - times[k - 1])
        return np.where(before * after <= 0, 0.0, np.clip(mean, -limit, limit))

    h = times[i + 1] - times[i]
    s = (t - times[i]) / h
    return (
        values[i] * (1 + 2 * s) * (1 - s) ** 2 + slope(i) * h * s * (1 - s) ** 2
        + values[i + 1] * s * s * (3 - 2 * s) + slope(i + 1) * h * s * s * (s - 1)
    )


def swing(phase, at=0.0):
    """One cosine cycle, 1 at phase `at`."""
    return np.cos(2 * np.pi * (phase - at))


class Figure:
    """A skeleton with the roles that motion needs. `names`: role -> joint name; missing roles are skipped.

    Roles: hips, spine (list), neck, head, and per side "left"/"right": shoulder, arm, forearm, hand, thigh, shin, foot,
    toe, and "fingers": lists of joint chains (the thumb's first).
    """

    def __init__(self, skeleton, names):
        self.skeleton = skeleton
        self.names = names
        # The farthest requested reach of any limb, relative to its length; above 1 it is out of reach.
        self.worst_reach = 0.0

    def place(self, role):
        return self.skeleton.world[self.skeleton[self.names[role]]]

    def has(self, role):
        return role in self.names

    def world(self, turns, moves, name):
        """World position and turn of a joint in a pose."""
        s = self.skeleton
        chain = []
        j = s[name]
        while j >= 0:
            chain.append(j)
            j = s.parents[j]
        place, whole = None, NONE
        for j in reversed(chain):
            shift = np.asarray(moves.get(s.names[j], (0, 0, 0)))
            if place is None:
                place = s.world[j] + shift
            else:
                place = place + rotate(whole, s.world[j] - s.world[s.parents[j]] + shift)
            whole = mul(whole, turns.get(s.names[j], NONE))
        return place, whole

    def limb(self, turns, moves, upper, lower, end, target, end_turn, pole, hinge):
        """Two-bone inverse kinematics: sets the turns of `upper`, `lower`, `end` so that `end` is at `target`.

        `end_turn` is the end's world turn (None: follows the lower bone); the middle joint points towards `pole` (a direction);
        `hinge` is the direction in which it bends in the rest pose.
        """
        s = self.skeleton
        a, b, c = self.place(upper), self.place(lower), self.place(end)
        up_name = s.names[s.parents[s[self.names[upper]]]]
        base, base_turn = self.world(turns, moves, up_name)
        root = base + rotate(base_turn, a - s.world[s[up_name]])
        l1, l2 = np.linalg.norm(b - a), np.linalg.norm(c - b)
        reach = target - root
        far = np.linalg.norm(reach)
        far_ok = np.clip(far, abs(l1 - l2) * 1.02, (l1 + l2) * 0.9995)
        self.worst_reach = max(self.worst_reach, far / (l1 + l2))
        along = reach / far
        target = root + along * far_ok
        axis = np.cross(pole, along)
        axis /= np.linalg.norm(axis)
        side = np.cross(along, axis)
        x = (l1 * l1 - l2 * l2 + far_ok * far_ok) / (2 * far_ok)
        middle = root + along * x + side * np.sqrt(max(l1 * l1 - x * x, 0.0))
        first = frame(middle - root, np.cross(middle - root, axis), b - a, hinge)
        second = frame(target - middle, np.cross(target - middle, axis), c - b, hinge)
        turns[self.names[upper]] = mul(conj(base_turn), first)
        turns[self.names[lower]] = mul(conj(first), second)
        if end_turn is not None:
            turns[self.names[end]] = mul(conj(second), end_turn)
        return target

    def leg(self, turns, moves, side, ankle, pitch, toe=0.0, yaw=0.0, roll=0.0, knee=None):
        """Places a foot: `ankle` is its joint's position, `pitch` degrees toes up, `toe` degrees the toes bend up against it."""
        foot = mul(qy(yaw), qx(-pitch), qz(roll))
        pole = rotate(qy(yaw), AHEAD) if knee is None else np.asarray(knee, dtype=np.float64)
        self.limb(turns, moves, f"{side}.thigh", f"{side}.shin", f"{side}.foot", ankle, foot, pole, AHEAD)
        if self.has(f"{side}.toe"):
            turns[self.names[f"{side}.toe"]] = qx(-toe)

    def spine(self, turns, pitch=0.0, yaw=0.0, roll=0.0):
        """Distributes a bend of the spine over its joints; pitch forward, yaw to the left, roll to the right."""
        joints = self.names["spine"]
        for name in joints:
            k = 1.0 / len(joints)
            turns[name] = mul(qy(yaw * k), qx(pitch * k), qz(roll * k))

    def head(self, turns, pitch=0.0, yaw=0.0, roll=0.0):
        parts = [self.names[r] for r in ("neck", "head") if self.has(r)]
        for name, k in zip(parts, (0.4, 0.6) if len(parts) == 2 else (1.0,)):
            turns[name] = mul(qy(yaw * k), qx(pitch * k), qz(roll * k))

    def arm(self, turns, side, lower=76.0, swing=0.0, elbow=15.0, twist=0.0, wrist=0.0, hand_twist=0.0, out=0.0, shrug=0.0,
            reach=0.0):
        """An arm by angles: `lower` degrees down from the T-pose, `swing` forward, `twist` of the upper arm (elbow
        outwards), `elbow` flexion, `hand_twist` (thumb up to the back of the hand), `wrist` flexion towards the palm."""
        s = 1.0 if side == "left" else -1.0
        names = self.names
        if self.has(f"{side}.shoulder"):
            turns[names[f"{side}.shoulder"]] = mul(qy(-s * reach), qz(s * shrug))
        turns[names[f"{side}.arm"]] = mul(qx(-swing), qy(-s * out), qz(-s * lower), qx(twist))
        turns[names[f"{side}.forearm"]] = qy(-s * elbow)
        turns[names[f"{side}.hand"]] = mul(qx(hand_twist), qz(-s * wrist))

    def curl(self, turns, side, amount=25.0, thumb=None, spread=0.0):
        """Bends the fingers: `amount` degrees per joint, or one per finger."""
        if not self.has(f"{side}.fingers"):
            return
        s = 1.0 if side == "left" else -1.0
        chains = self.names[f"{side}.fingers"]
        amounts = np.broadcast_to(amount, len(chains) - 1)
        for k, (chain, a) in enumerate(zip(chains[1:], amounts)):
            for i, name in enumerate(chain[:3]):
                turns[name] = qz(-s * a * (0.8, 1.1, 0.8)[i])
            if spread:
                turns[chain[0]] = mul(qy(-s * spread * (1.5 - k) / 1.5), turns[chain[0]])
        t = 15.0 if thumb is None else thumb
        for i, name in enumerate(chains[0][:3]):
            turns[name] = quat((s * 0.25, s * 0.9, 0.35), t * (0.5, 0.8, 1.0)[i])


# ---------------------------------------------------------------- feet on the ground


class Tread:
    """The path of a foot through a stride.

    `heel`, `ball`: where heel and toe joint are, relative to the ankle of the flat foot; `pitch`, `toe`: periodic keys
    (phase, degrees); `flat`, `rise`, `off`: phases when the foot is flat, the heel leaves, the toes leave; `length`: how
    far the ground passes in a stride; `start`: the ankle's z when it would stand flat at phase 0; `air`: keys (part of
    the swing 0..1, (rise, advance)) that shape the way through the air; `toe_air`: the same for the toes' bend; `lift`:
    metres that everything is raised, against the sag between keys; `ease_out`, `ease_in`: the parts of the swing in which
    the speed of the ground is lost and found again.
    """

    def __init__(self, rest_ankle, heel, ball, pitch, flat, rise, off, length, start, air, width=0.0, toe_air=(), lift=0.0,
                 ease_out=0.35, ease_in=0.25):
        self.ankle, self.heel, self.ball = rest_ankle, np.asarray(heel), np.asarray(ball)
        self.pitch_keys, self.flat, self.rise, self.off = pitch, flat, rise, off
        self.length, self.start, self.air, self.width = length, start, air, width
        self.toe_air, self.lift = toe_air, lift
        self.ease_out, self.ease_in = ease_out, ease_in

    def pitch(self, p):
        return float(curve(self.pitch_keys, p % 1.0, 1.0))

    def _grounded(self, p):
        pitch = self.pitch(p)
        base = np.array([self.ankle[0] - self.width, self.ankle[1] + self.lift, self.start - self.length * p])
        pivot = self.heel if p < self.flat else self.ball
        if self.flat <= p <= self.rise:
            return base, 0.0, 0.0
        place = base + pivot - rotate(qx(-pitch), pivot)
        toe = -pitch if p > self.rise else 0.0
        return place, pitch, toe

    def at(self, p):
        """(ankle, pitch, toe bend) at a phase of this foot's stride."""
        p = p % 1.0
        if p <= self.off:
            return self._grounded(p)
        leave, _, toe0 = self._grounded(self.off)
        land, _, _ = self._grounded(0.0)
        span = 1.0 - self.off
        s = (p - self.off) / span

        def way(s):
            lift, advance = curve(self.air, s)
            place = leave + (land - leave) * advance
            place[1] = leave[1] + (land[1] - leave[1]) * smooth_step(s) + lift
            return place

        # Lifts off and lands at the speed of the ground, so that no joint jerks.
        h = 1e-3
        before = (leave - self._grounded(self.off - h)[0]) / h * span - (way(h) - way(0.0)) / h
        after = (self._grounded(h)[0] - land) / h * span - (way(1.0) - way(1.0 - h)) / h
        place = way(s)
        if s < self.ease_out:
            place = place + before * s * (1.0 - s / self.ease_out) ** 2
        if s > 1.0 - self.ease_in:
            place = place + after * (s - 1.0) * (1.0 - (1.0 - s) / self.ease_in) ** 2
        toe = toe0 * float(1.0 - smooth_step(s / 0.35)) + float(curve(self.toe_air, s)) if self.toe_air else toe0 * float(
            1.0 - smooth_step(s / 0.35)
        )
        return place, self.pitch(p), toe


# ---------------------------------------------------------------- clips


def channels(skeleton, poses, rate, tolerance=0.06, loose=0.3, tight=(), move_tolerance=0.0003, scale_moves=None):
    """File channels of poses [(turns, moves)] at `rate` per second, with as few LINEAR keys as possible within a
    tolerance (degrees; `tight` joints within `tolerance`, others within `loose`)."""
    times = np.arange(len(poses)) / rate
    out = []
    for j, name in enumerate(skeleton.names):
        if any(name in turns for turns, _ in poses):
            track = [skeleton.local_rotation(j, turns.get(name, NONE)) for turns, _ in poses]
            for i in range(1, len(track)):
                if track[i] @ track[i - 1] < 0:
                    track[i] = -track[i]
            limit = np.radians(tolerance if name in tight else loose)
            keep = _thin(track, lambda a, b, t: slerp(a, b, t), lambda a, b: 2 * np.arccos(min(1.0, abs(a @ b))), limit)
            at_rest = all(2 * np.arccos(min(1.0, abs(q @ skeleton.rest_rotation[j]))) < 1e-5 for q in track)
            if not (len(keep) <= 2 and at_rest):
                out.append((j, "rotation", times[keep], np.array(track)[keep]))
        if any(name in moves for _, moves in poses):
            up = skeleton.parents[j]
            turn = NONE if up < 0 else conj(skeleton.frame(up))
            size = 1.0 if up < 0 else skeleton.size(up)
            track = [
                skeleton.rest_translation[j] + rotate(turn, np.asarray(moves.get(name, (0, 0, 0)), dtype=np.float64)) / size
                for _, moves in poses
            ]
            keep = _thin(track, lambda a, b, t: a + (b - a) * t, lambda a, b: np.linalg.norm(a - b), move_tolerance / size)
            out.append((j, "translation", times[keep], np.array(track)[keep]))
    return out


def _thin(track, mix, distance, limit):
    """Indices of the keys to keep (Douglas-Peucker)."""
    keep = {0, len(track) - 1}
    todo = [(0, len(track) - 1)]
    while todo:
        a, b = todo.pop()
        worst, where = limit, None
        for i in range(a + 1, b):
            d = distance(mix(track[a], track[b], (i - a) / (b - a)), track[i])
            if d > worst:
                worst, where = d, i
        if where is not None:
            keep.add(where)
            todo += [(a, where), (where, b)]
    kept = sorted(keep)
    # A constant channel needs one key.
    return kept[:1] if len(kept) == 2 and distance(track[kept[0]], track[kept[1]]) < 1e-6 else kept


def cycle(pose, frames):
    """Samples a closed cycle at `frames` steps; the last pose is the first."""
    poses = [pose(i / frames) for i in range(frames)]
    return poses + [poses[0]]
