"""Rig: skeletons and skin weights.

A Skeleton has names, parents (parents first) and rest positions; the rest frames are identity rotations unless given.
Motion is written as *turns* (see gait.py): rotations in axes parallel to the model's, which `local_rotation` converts to a
file's rotations, so the same motion drives skeletons with different rest frames.

Weights are functions of the rest position, not of the mesh: weight flows from the root down the tree, and at every joint a
soft gate decides how much passes to the child. So layers of clothing deform alike, left and right match, and any mesh of the
character can be skinned with the same `Gates`.
"""

import numpy as np

# ---------------------------------------------------------------- quaternions (x, y, z, w), rows


def quat(axis, degrees):
    axis = np.asarray(axis, dtype=np.float64)
    half = np.radians(degrees) / 2
    return np.append(axis / np.linalg.norm(axis) * np.sin(half), np.cos(half))


def qx(d):
    return quat((1, 0, 0), d)


def qy(d):
    return quat((0, 1, 0), d)


def qz(d):
    return quat((0, 0, 1), d)


def mul(*qs):
    out = np.asarray(qs[0], dtype=np.float64)
    for b in qs[1:]:
        ax, ay, az, aw = out
        bx, by, bz, bw = b
        out = np.array([
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ])
    return out


def conj(q):
    return np.array([-q[0], -q[1], -q[2], q[3]])


def rotate(q, v):
    u, w = q[:3], q[3]
    t = 2.0 * np.cross(u, v)
    return v + w * t + np.cross(u, t)


def matrix(q):
    x, y, z, w = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def from_matrix(m):
    """The quaternion of a proper rotation matrix."""
    k = np.array([
        [m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
        [m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
        [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1], 0],
        [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]],
    ])
    values, vectors = np.linalg.eigh(k, UPLO="L")
    q = vectors[:, values.argmax()]
    return q if q[3] >= 0 else -q


def between(a, b):
    """The shortest rotation from direction a to direction b."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    q = np.append(np.cross(a, b), 1.0 + a @ b)
    return q / np.linalg.norm(q)


def frame(down, pole, rest_down, rest_pole):
    """The rotation from (rest_down, rest_pole) to (down, pole); poles are orthogonalized first."""

    def basis(d, p):
        d = d / np.linalg.norm(d)
        p = p - d * (p @ d)
        p = p / np.linalg.norm(p)
        return np.column_stack([d, p, np.cross(d, p)])

    return from_matrix(basis(down, pole) @ basis(rest_down, rest_pole).T)


def slerp(a, b, t):
    d = float(a @ b)
    if d < 0:
        b, d = -b, -d
    if d > 0.99995:
        q = a + (b - a) * t
    else:
        angle = np.arccos(min(d, 1.0))
        q = (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)
    return q / np.linalg.norm(q)


# ---------------------------------------------------------------- skeleton


class Skeleton:
    def __init__(self):
        self.names, self.parents, self.world = [], [], []
        self.rest_translation, self.rest_rotation, self.rest_scale, self.world_rest = [], [], [], []

    def add(self, name, parent, position, rotation=None, scale=1.0):
        """`position` in the model's rest pose, metres; `rotation`: the joint's frame in the model (identity if none)."""
        number = len(self.names)
        up = -1 if parent is None else self.names.index(parent)
        rotation = np.array([0, 0, 0, 1.0]) if rotation is None else np.asarray(rotation, dtype=np.float64)
        m = np.eye(4)
        size = scale * (1.0 if up < 0 else self.size(up))
        m[:3, :3] = matrix(rotation) * size
        m[:3, 3] = position
        local = m if up < 0 else np.linalg.inv(self.world_rest[up]) @ m
        self.names.append(name)
        self.parents.append(up)
        self.world.append(np.asarray(position, dtype=np.float64))
        self.world_rest.append(m)
        self.rest_translation.append(local[:3, 3].copy())
        turn = rotation if up < 0 else mul(conj(self.frame(up)), rotation)
        self.rest_rotation.append(turn)
        self.rest_scale.append(np.full(3, float(scale)))
        return number

    def __getitem__(self, name):
        return self.names.index(name)

    def size(self, j):
        return np.linalg.norm(self.world_rest[j][:3, 0])

    def frame(self, j):
        """The joint's rest frame in the model as a quaternion."""
        return from_matrix(self.world_rest[j][:3, :3] / self.size(j))

    def children(self, j):
        return [k for k, p in enumerate(self.parents) if p == j]

    def local_rotation(self, j, turn):
        """Converts a turn (a rotation in the model's axes, relative to the parent's turn) to a file's local rotation."""
        up = self.parents[j]
        after = mul(turn, self.frame(j))
        return after if up < 0 else mul(conj(self.frame(up)), after)

    def pose(self, turns, moves=None):
        """World positions and turns of all joints. `turns`: {name: turn}; `moves`: {name: offset in the parent's axes}."""
        places, whole = [None] * len(self.names), [None] * len(self.names)
        moves = moves or {}
        identity = np.array([0, 0, 0, 1.0])
        for j, name in enumerate(self.names):
            up = self.parents[j]
            turn = turns.get(name, identity)
            shift = np.asarray(moves.get(name, (0, 0, 0)), dtype=np.float64)
            if up < 0:
                whole[j] = turn
                places[j] = self.world[j] + shift
            else:
                whole[j] = mul(whole[up], turn)
                places[j] = places[up] + rotate(whole[up], self.world[j] - self.world[up] + shift)
        return places, whole


# ---------------------------------------------------------------- weights


def smooth_step(t):
    t = np.clip(t, 0.0, 1.0)
    return t * t * (3 - 2 * t)


class Gates:
    """The transitions of weight from a joint to its child: a soft plane through the child.

    `gate(child, toward, width, shift, near)`: `toward` the direction into the child (default: the mean of the bones on
    both sides), `width` of the transition in metres, `shift` metres along `toward`, `near` an optional function of
    points -> [0, 1] for children side by side (fingers, legs). Joints without a gate get no weight.
    """

    def __init__(self, skeleton):
        self.skeleton = skeleton
        self.gates = {}

    def gate(self, child, toward=None, width=0.08, shift=0.0, near=None):
        s = self.skeleton
        j = s[child]
        if toward is None:
            before = s.world[j] - s.world[s.parents[j]]
            kids = s.children(j)
            after = s.world[kids[0]] - s.world[j] if kids else before
            toward = before / max(np.linalg.norm(before), 1e-9) + after / max(np.linalg.norm(after), 1e-9)
        toward = np.asarray(toward, dtype=np.float64)
        self.gates[j] = (toward / np.linalg.norm(toward), width, shift, near)

    def weights(self, points, root):
        """(N, joints) weights that sum to 1; all weight starts at the joint `root`."""
        s = self.skeleton
        flow = {s[root]: np.ones(len(points))}
        out = np.zeros((len(points), len(s.names)))
        for j in range(len(s.names)):
            if j not in flow:
                continue
            opened = {}
            for child in s.children(j):
                if child not in self.gates:
                    continue
                toward, width, shift, near = self.gates[child]
                t = (points - s.world[child]) @ toward - shift
                g = smooth_step(t / width + 0.5)
                opened[child] = g * near(points) if near else g
            total = sum(opened.values()) if opened else np.zeros(len(points))
            # Siblings that claim more than available share it.
            over = np.maximum(total, 1.0)
            for child, g in opened.items():
                flow[child] = flow[j] * g / over
            out[:, j] = flow[j] * np.maximum(1.0 - total, 0.0)
        return out / out.sum(axis=1, keepdims=True)


def smoothed(weights, faces, rounds=2, amount=0.5):
    """Laplacian smoothing of weights (N, J) over a mesh's edges."""
    edges = set()
    for f in faces:
        for a, b in zip(f, f[1:] + f[:1]):
            edges.add((min(a, b), max(a, b)))
    edges = np.array(sorted(edges))
    degree = np.zeros(len(weights))
    np.add.at(degree, edges[:, 0], 1)
    np.add.at(degree, edges[:, 1], 1)
    for _ in range(rounds):
        total = np.zeros_like(weights)
        np.add.at(total, edges[:, 0], weights[edges[:, 1]])
        np.add.at(total, edges[:, 1], weights[edges[:, 0]])
        mean = total / np.maximum(degree, 1)[:, None]
        weights = np.where(degree[:, None] > 0, weights * (1 - amount) + mean * amount, weights)
    return weights


def lent(points, mesh_points, mesh_weights, count=4):
    """Weights for points (belts, straps) from the nearest vertices of the body, so that they move with it."""
    out = np.zeros((len(points), mesh_weights.shape[1]))
    for i, p in enumerate(points):
        d = np.linalg.norm(mesh_points - p, axis=1)
        near = np.argpartition(d, count)[:count]
        k = 1.0 / np.maximum(d[near], 1e-5) ** 2
        out[i] = (mesh_weights[near] * k[:, None]).sum(axis=0) / k.sum()
    return out


def strongest(weights, joints, count=4):
    """The `count` largest of each row: (weights (N, count), slots (N, count)) for the joint list `joints`."""
    columns = weights[:, joints]
    slots = np.argsort(-columns, axis=1, kind="stable")[:, :count]
    values = np.take_along_axis(columns, slots, axis=1)
    return values / values.sum(axis=1, keepdims=True), slots
