"""Human clips: idle, walk, run, jump, wave, crouch-aim. Each function returns (poses, frames per second)."""

import numpy as np

from gait import AHEAD, Figure, NONE, Tread, curve, cycle, swing
from rig import conj, mul, qx, qy, qz, rotate, slerp, smooth_step

RATE = 30.0


def mixamo_figure(s, prefix="mixamorig:"):
    """Roles of a skeleton with Mixamo's names."""
    n = lambda x: prefix + x
    names = {"hips": n("Hips"), "spine": [n("Spine"), n("Spine1"), n("Spine2")], "neck": n("Neck"), "head": n("Head")}
    for side, word in (("left", "Left"), ("right", "Right")):
        roles = {
            "shoulder": "Shoulder",
            "arm": "Arm",
            "forearm": "ForeArm",
            "hand": "Hand",
            "thigh": "UpLeg",
            "shin": "Leg",
            "foot": "Foot",
            "toe": "ToeBase",
        }
        names.update({f"{side}.{r}": n(word + j) for r, j in roles.items()})
        if n(word + "HandIndex1") in s.names:
            names[f"{side}.fingers"] = [
                [n(f"{word}Hand{f}{i}") for i in (1, 2, 3)] for f in ("Thumb", "Index", "Middle", "Ring", "Pinky")
            ]
    return Figure(s, names)


def feet(figure):
    """Rest ankle, heel and toe joint (relative to the ankle) of the left foot."""
    ankle, toe = figure.place("left.foot"), figure.place("left.toe")
    return ankle, np.array([0.0, -ankle[1], -0.062]), toe - ankle


def set_feet(figure, turns, moves, tread, phase):
    """Both legs of a cycle; the right one half a stride later."""
    for side, sign, shift in (("left", 1, 0.0), ("right", -1, 0.5)):
        ankle, pitch, toe = tread.at(phase + shift)
        ankle = ankle * [sign, 1, 1]
        figure.leg(turns, moves, side, ankle, pitch, toe, yaw=sign * 3.0)


def walk(figure, speed=1.32, frames=32):
    ankle, heel, ball = feet(figure)
    length = speed * frames / RATE
    tread = Tread(
        ankle,
        heel,
        ball,
        flat=0.09,
        rise=0.34,
        off=0.61,
        length=length,
        start=0.245 * length - 0.024,
        pitch=[(0.0, 19), (0.09, 0), (0.34, 0), (0.46, -15), (0.61, -58), (0.69, -46), (0.80, -6), (0.93, 19)],
        air=[
            (0, (0, 0)),
            (0.07, (0.018, 0.022)),
            (0.16, (0.034, 0.080)),
            (0.34, (0.052, 0.28)),
            (0.52, (0.038, 0.53)),
            (0.8, (0.026, 0.93)),
            (0.93, (0.012, 1.012)),
            (1, (0, 1)),
        ],
        width=0.018,
        toe_air=[(0, 0), (0.4, 14), (1, 0)],
    )

    def pose(p):
        turns, moves = {}, {}
        hips = figure.names["hips"]
        yaw, roll = -5.0 * swing(p, 0.02), 3.2 * swing(p, 0.17)
        moves[hips] = (0.020 * swing(p, 0.30), -0.034 + 0.017 * swing(2 * p, 0.56), 0.006 * swing(2 * p, 0.2))
        turns[hips] = mul(qy(yaw), qx(2.5), qz(roll))
        figure.spine(turns, pitch=1.5 + 1.0 * swing(2 * p, 0.1), yaw=-yaw + 6.0 * swing(p, 0.04), roll=-1.35 * roll)
        figure.head(turns, pitch=-3.0 - 1.0 * swing(2 * p, 0.2), yaw=-5.0 * swing(p, 0.06), roll=0.35 * roll)
        for side, sign in (("left", 1), ("right", -1)):
            ahead = -sign * swing(p, 0.035)
            late = -sign * swing(p, 0.085)
            figure.arm(
                turns,
                side,
                lower=75 - 1.5 * ahead,
                swing=3 + 23 * ahead,
                elbow=24 + 13 * late,
                twist=-6,
                hand_twist=-14,
                wrist=6 + 4 * -late,
                shrug=-3,
                reach=3.0 * ahead,
            )
            figure.curl(turns, side, (20, 24, 27, 30), thumb=14)
        set_feet(figure, turns, moves, tread, p)
        return turns, moves

    return cycle(pose, frames), RATE, tread


def run(figure, speed=3.2, frames=20):
    ankle, heel, ball = feet(figure)
    length = speed * frames / RATE
    tread = Tread(
        ankle,
        heel,
        ball,
        flat=0.045,
        rise=0.10,
        off=0.33,
        length=length,
        start=0.215,
        pitch=[
            (0.0, 6),
            (0.045, 0),
            (0.10, 0),
            (0.22, -22),
            (0.33, -54),
            (0.46, -94),
            (0.62, -62),
            (0.80, 2),
            (0.93, 10),
        ],
        air=[
            (0, (0, 0)),
            (0.20, (0.20, 0.07)),
            (0.42, (0.30, 0.42)),
            (0.66, (0.20, 0.88)),
            (0.84, (0.105, 1.045)),
            (1, (0, 1)),
        ],
        width=0.055,
        toe_air=[(0, 0), (0.5, 6), (1, 0)],
        lift=0.0015,
    )

    def pose(p):
        turns, moves = {}, {}
        hips = figure.names["hips"]
        yaw, roll = -8.0 * swing(p, 0.04), 3.5 * swing(p, 0.13)
        # Lowest in mid-stance (0.16), highest in mid-flight.
        moves[hips] = (0.012 * swing(p, 0.17), -0.056 - 0.026 * swing(2 * p, 0.33), 0.008 * swing(2 * p, 0.2))
        turns[hips] = mul(qy(yaw), qx(8), qz(roll))
        figure.spine(turns, pitch=7 + 2.0 * swing(2 * p, 0.36), yaw=-yaw + 11.0 * swing(p, 0.05), roll=-1.3 * roll)
        figure.head(turns, pitch=-11 - 2.0 * swing(2 * p, 0.40), yaw=-10.0 * swing(p, 0.06), roll=0.3 * roll)
        for side, sign in (("left", 1), ("right", -1)):
            ahead = -sign * swing(p, 0.05)
            figure.arm(
                turns,
                side,
                lower=70 + 2 * ahead,
                swing=-4 + 41 * ahead,
                elbow=84 + 20 * ahead,
                twist=-16 - 12 * ahead,
                hand_twist=-18,
                wrist=4,
                shrug=-2,
                reach=7.0 * ahead,
            )
            figure.curl(turns, side, (58, 62, 64, 66), thumb=26)
        set_feet(figure, turns, moves, tread, p)
        return turns, moves

    return cycle(pose, frames), RATE, tread


def _stand(figure, turns, moves, spread=0.02, turn=9.0, lift=0.0):
    """Feet flat, slightly apart, toes out."""
    ankle, _, _ = feet(figure)
    for side, sign in (("left", 1), ("right", -1)):
        figure.leg(
            turns, moves, side, np.array([sign * (ankle[0] + spread), ankle[1] + lift, ankle[2]]), 0, 0, yaw=sign * turn
        )


def _easy_arms(figure, turns, breath=0.0, swing_=0.0, sides=("left", "right")):
    for side in sides:
        figure.arm(
            turns,
            side,
            lower=75 - 1.0 * breath,
            swing=2 + swing_,
            elbow=22 + 1.5 * breath,
            twist=-8,
            hand_twist=-16,
            wrist=6,
            shrug=-3 + 1.2 * breath,
        )
        figure.curl(turns, side, (20, 24, 27, 31), thumb=14)


def idle(figure, frames=120):
    """Four seconds: one slow shift of weight, two breaths, a look to each side."""

    def pose(p):
        turns, moves = {}, {}
        breath, sway = swing(2 * p, 0.5), swing(p, 0.25)
        look = float(
            curve(
                [(0.0, 0), (0.10, 0), (0.22, 17), (0.36, 17), (0.50, -2), (0.62, -15), (0.78, -15), (0.92, 0)], p, 1.0
            )
        )
        hips = figure.names["hips"]
        moves[hips] = (0.020 * sway, -0.008 - 0.004 * abs(sway) ** 2, 0.004 * breath)
        turns[hips] = mul(qy(2.5 * sway), qz(1.6 * sway))
        figure.spine(turns, pitch=1.0 - 1.6 * breath, yaw=-2 * sway + 0.15 * look, roll=-2.6 * sway)
        figure.head(turns, pitch=1.0 + 0.8 * breath, yaw=0.85 * look, roll=0.06 * look + 0.8 * sway)
        _easy_arms(figure, turns, breath)
        _stand(figure, turns, moves, spread=0.030)
        return turns, moves

    return cycle(pose, frames), RATE


def wave(figure, frames=72):
    """The right arm is raised; the forearm swings and twists, the body counters."""

    def pose(p):
        turns, moves = {}, {}
        beat, breath = swing(3 * p, 0.0), swing(p, 0.5)
        late = swing(3 * p, 0.12)
        hips = figure.names["hips"]
        moves[hips] = (0.022 + 0.004 * beat, -0.009, 0.0)
        turns[hips] = mul(qy(-4), qz(2.0 + 0.5 * beat))
        figure.spine(turns, pitch=-2.0 - breath, yaw=2, roll=0.5 - 1.6 * beat)
        figure.head(turns, pitch=1.0, yaw=-3 + 2 * late, roll=4.5 + 2.2 * late)
        _easy_arms(figure, turns, breath, sides=("left",))
        figure.arm(
            turns,
            "right",
            lower=-12 + 3 * beat,
            out=24,
            twist=-78,
            elbow=64 - 20 * beat,
            hand_twist=-6 + 34 * late,
            wrist=-14 * late,
            shrug=9,
        )
        figure.curl(turns, "right", (2, 2, 4, 6), thumb=2, spread=9)
        _stand(figure, turns, moves, spread=0.035)
        return turns, moves

    return cycle(pose, frames), RATE


def jump(figure, frames=54):
    """Crouches, jumps 0.36 m high, lands softly, stands up; the flight is a true parabola."""
    leave, land = 14, 30
    flight = (land - leave) / RATE
    ankle, heel, ball = feet(figure)
    tip = 52.0
    stretched = ball - rotate(qx(tip), ball)
    # Legs are never fully straight at take-off and landing: nearly straight knees move too fast for 30 keys per second.
    top, bottom = 0.012, -0.035
    spring = (bottom - top) / flight + 9.81 * flight / 2

    def height(f):
        if leave <= f <= land:
            t = (f - leave) / RATE
            return top + spring * t - 0.5 * 9.81 * t * t
        return None

    keys = [(0, -0.014), (4, -0.10), (8.5, -0.33), (11, -0.26), (leave, top)]
    after = [(land, bottom), (32, -0.17), (35.5, -0.30), (41, -0.16), (48, -0.03), (frames, -0.014)]

    def pose(p):
        f = p * frames
        turns, moves = {}, {}
        h = height(f)
        y = h if h is not None else float(curve(keys, f) if f < leave else curve(after, f))
        if 11 <= f < leave:
            # Takes off at the initial speed of the flight.
            s = (f - 11) / (leave - 11)
            v = spring * (leave - 11) / RATE
            y = (
                -0.26
                + (top + 0.26) * (s * s * (3 - 2 * s))
                + v * (s**3 - s**2)
                + 2.4 / RATE * (leave - 11) * (s**3 - 2 * s * s + s)
            )
        lean = float(
            curve([(0, 0), (8.5, 34), (leave, 4), (20, -2), (27, 8), (land, 10), (35.5, 36), (46, 8), (frames, 0)], f)
        )
        hips = figure.names["hips"]
        moves[hips] = (0, y, -0.0035 * lean + 0.010 * smooth_step((f - 8) / 6) * (1 - smooth_step((f - 30) / 6)))
        turns[hips] = qx(0.62 * lean)
        figure.spine(turns, pitch=0.55 * lean)
        figure.head(
            turns,
            pitch=-0.62 * lean + float(curve([(0, 0), (leave, -8), (22, -4), (land, 8), (40, 0), (frames, 0)], f)),
        )
        arms = float(
            curve(
                [
                    (0, 2),
                    (3, -4),
                    (7.5, -54),
                    (10.5, -22),
                    (leave, 84),
                    (18, 126),
                    (25, 74),
                    (land, 36),
                    (35.5, -16),
                    (43, 6),
                    (frames, 2),
                ],
                f,
            )
        )
        spread = float(
            curve([(0, 75), (8.5, 70), (leave, 66), (20, 44), (27, 40), (land, 48), (36, 66), (frames, 75)], f)
        )
        bend = float(curve([(0, 22), (8.5, 30), (leave, 22), (20, 28), (land, 34), (36, 48), (frames, 22)], f))
        for side in ("left", "right"):
            figure.arm(turns, side, lower=spread, swing=arms, elbow=bend, twist=-8, hand_twist=-16, wrist=6, shrug=-3)
            a = float(curve([(0, 24), (8.5, 46), (leave, 10), (24, 14), (36, 40), (frames, 24)], f))
            figure.curl(turns, side, (a - 4, a, a + 3, a + 7), thumb=14)
        for side, sign in (("left", 1), ("right", -1)):
            # Raised by 1.5 mm to compensate for the sag between keys.
            base = np.array([sign * (ankle[0] + 0.030), ankle[1] + 0.0015, ankle[2]])
            if f <= leave:
                pitch = -tip * float(smooth_step((f - 8.5) / (leave + 0.6 - 8.5)))
                pivot = rotate(qy(sign * 9), ball * [sign, 1, 1])
                place = base + pivot - rotate(mul(qy(sign * 9), qx(-pitch)), ball * [sign, 1, 1])
                figure.leg(turns, moves, side, place, pitch, -pitch, yaw=sign * 9)
            elif f < land:
                s = (f - leave) / (land - leave)
                # In the air the feet follow the hips: they trail, tuck slightly, then reach for the ground.
                rise = spring * (f - leave) / RATE - 0.5 * 9.81 * ((f - leave) / RATE) ** 2 - (bottom - top) * s
                tuck = float(curve([(0, 0), (0.3, 0.03), (0.6, 0.10), (1, 0.0)], s))
                pitch = float(curve([(0, -tip), (0.35, -46), (0.75, -14), (1, -12)], s))
                start = (
                    base
                    + rotate(qy(sign * 9), ball * [sign, 1, 1])
                    - rotate(mul(qy(sign * 9), qx(tip)), ball * [sign, 1, 1])
                )
                end = (
                    base
                    + rotate(qy(sign * 9), ball * [sign, 1, 1])
                    - rotate(mul(qy(sign * 9), qx(12)), ball * [sign, 1, 1])
                )
                place = start + (end - start) * smooth_step(s) + [0, rise + tuck, -0.3 * tuck]
                toe = float(curve([(0, tip), (0.3, 0), (0.8, 0), (1, 12)], s))
                figure.leg(turns, moves, side, place, pitch, toe, yaw=sign * 9)
            else:
                pitch = -12 * max(0.0, 1 - (f - land) / 3.0)
                pivot = rotate(qy(sign * 9), ball * [sign, 1, 1])
                place = base + pivot - rotate(mul(qy(sign * 9), qx(-pitch)), ball * [sign, 1, 1])
                figure.leg(turns, moves, side, place, pitch, -pitch, yaw=sign * 9)
        return turns, moves

    poses = [pose(i / frames) for i in range(frames)]
    return poses + [poses[0]], RATE


def crouch_aim(figure, frames=90):
    """Crouched on a bent front leg, rear heel up, both hands forward and tracking from side to side."""
    ankle, heel, ball = feet(figure)

    def pose(p):
        turns, moves = {}, {}
        breath, track = swing(2 * p, 0.3), swing(p, 0.25)
        hips = figure.names["hips"]
        moves[hips] = (0.012 * track, -0.375 + 0.006 * breath, -0.02)
        turns[hips] = mul(qy(-18 + 2 * track), qx(16))
        figure.spine(turns, pitch=12 - 1.5 * breath, yaw=16 + 6 * track, roll=0)
        front = np.array([ankle[0] + 0.020, ankle[1], 0.27])
        figure.leg(turns, moves, "left", front, 0, 0, yaw=4, knee=rotate(qy(9), AHEAD))
        rear_pitch, yaw = -48.0, -22.0
        flat = np.array([-(ankle[0] + 0.055), ankle[1], -0.36])
        b = ball * [-1, 1, 1]
        rear = flat + rotate(qy(yaw), b) - rotate(mul(qy(yaw), qx(-rear_pitch)), b)
        figure.leg(turns, moves, "right", rear, rear_pitch, -rear_pitch, yaw=yaw, knee=rotate(qy(-26), AHEAD))
        # Both hands at eye height, straight in front of the sternum, turning with the chest.
        chest, whole = figure.world(turns, moves, figure.names["spine"][-1])
        aim = qy(9 * track)
        eye = chest + np.array([0, 0.245, 0])
        for side, sign in (("left", 1), ("right", -1)):
            if figure.has(f"{side}.shoulder"):
                turns[figure.names[f"{side}.shoulder"]] = mul(qy(-sign * 14), qz(sign * 2))
            reach = np.array([sign * 0.022, -0.035 if side == "left" else 0.0, 0.47 if side == "right" else 0.42])
            place = eye + rotate(aim, reach)
            # Palms face each other, thumbs up, the left hand rotated slightly under the right.
            grip = mul(aim, qz(-sign * (84 if side == "right" else 60)), qy(-sign * 84))
            figure.limb(
                turns,
                moves,
                f"{side}.arm",
                f"{side}.forearm",
                f"{side}.hand",
                place,
                grip,
                rotate(aim, np.array([sign * 0.65, -0.75, 0])),
                AHEAD,
            )
            figure.curl(turns, side, (8, 60, 64, 66) if side == "right" else (52, 56, 58, 60), thumb=16)
        _, chest_turn = figure.world(turns, moves, figure.names["spine"][-1])
        want = mul(aim, qx(4))
        local = mul(conj(chest_turn), want)
        half = slerp(NONE, local, 0.45)
        turns[figure.names["neck"]] = half
        turns[figure.names["head"]] = mul(conj(half), local)
        return turns, moves

    return cycle(pose, frames), RATE


def all_clips(figure):
    """[(name, poses, rate)]"""
    return [
        ("idle", *idle(figure)),
        ("walk", *walk(figure)[:2]),
        ("run", *run(figure)[:2]),
        ("jump", *jump(figure)),
        ("wave", *wave(figure)),
        ("crouch-aim", *crouch_aim(figure)),
    ]
