"""Clay: bodies modelled as signed distance fields and converted to even quads.

A shape is a function of points (N, 3) -> distances (N,), negative inside, in metres, close enough to true distances for
blending. Shapes are joined with `union(..., k=...)`, k being the blend width in metres.
`mesh_of(shape, …)` samples a shape, meshes it (surface nets), remeshes it to even quads with Blender's QuadriFlow and projects
every vertex back onto the shape. Characters face +Z, stand on y = 0, and their left is +X; `half=True` models only the left
half (x >= 0) and mirrors it, so that both sides have identical loops.

Leaves to others: joints and weights (rig.py), colours (paint.py), files (glb.py).
"""

import numpy as np

# ---------------------------------------------------------------- shapes


def _vec(v):
    return np.asarray(v, dtype=np.float64)


def length(v):
    return np.sqrt(np.einsum("ij,ij->i", v, v))


def sphere(center, radius):
    center = _vec(center)
    return lambda p: length(p - center) - radius


def ellipsoid(center, radii, rotation=None):
    """`rotation` (3x3) maps the ellipsoid's axes to the model's."""
    center, radii = _vec(center), _vec(radii)

    def distance(p):
        q = p - center
        if rotation is not None:
            q = q @ rotation
        a = length(q / radii)
        b = length(q / radii**2)
        return np.where(b > 1e-9, a * (a - 1.0) / np.maximum(b, 1e-9), -radii.min())

    return distance


def capsule(a, b, radius_a, radius_b=None, flatten=None):
    """A tapered capsule. `flatten` = (axis vector, factor): the cross-section is `factor` as thick along that axis."""
    a, b = _vec(a), _vec(b)
    radius_b = radius_a if radius_b is None else radius_b
    along = b - a
    squared = max(float(along @ along), 1e-12)

    def distance(p):
        q = p - a
        t = np.clip(q @ along / squared, 0.0, 1.0)
        off = q - t[:, None] * along
        scale = 1.0
        if flatten is not None:
            axis = _vec(flatten[0]) / np.linalg.norm(flatten[0])
            off = off + ((off @ axis) * (1.0 / flatten[1] - 1.0))[:, None] * axis
            scale = min(1.0, flatten[1])
        return (length(off) - (radius_a + (radius_b - radius_a) * t)) * scale

    return distance


def box(center, half, rounding=0.01, rotation=None):
    """`half` are the outer half sizes, including the rounding."""
    center, inner = _vec(center), _vec(half) - rounding

    def distance(p):
        q = p - center
        if rotation is not None:
            q = q @ rotation
        q = np.abs(q) - inner
        return length(np.maximum(q, 0.0)) + np.minimum(q.max(axis=1), 0.0) - rounding

    return distance


def _smooth_table(t, values):
    """A monotone-friendly cubic through (t, values): Catmull-Rom slopes, clamped against overshoot."""
    slopes = np.gradient(values, t, axis=0)
    delta = np.diff(values, axis=0) / np.diff(t)[:, None]
    for i in range(1, len(t) - 1):
        flat = delta[i - 1] * delta[i] <= 0.0
        limit = 3.0 * np.minimum(np.abs(delta[i - 1]), np.abs(delta[i]))
        slopes[i] = np.where(flat, 0.0, np.sign(slopes[i]) * np.minimum(np.abs(slopes[i]), limit))

    def at(x):
        x = np.clip(x, t[0], t[-1])
        i = np.clip(np.searchsorted(t, x, side="right") - 1, 0, len(t) - 2)
        h = t[i + 1] - t[i]
        s = ((x - t[i]) / h)[:, None]
        h = h[:, None]
        return (
            values[i] * (1 + 2 * s) * (1 - s) ** 2
            + slopes[i] * h * s * (1 - s) ** 2
            + values[i + 1] * s * s * (3 - 2 * s)
            + slopes[i + 1] * h * s * s * (s - 1)
        )

    return at


def loft(origin, along, side, stations, rounding=0.02, power=2.0):
    """Cross-sections lofted along an axis, for torsos and limbs.

    `along` is the axis, `side` a vector across it; the third direction is along x side. A station is
    (t, center_side, center_other, radius_side, radius_other[, power]): t metres from `origin`, section a superellipse
    of exponent `power` (2: ellipse, 4: box-like). Ends are closed with `rounding`.
    """
    origin, along, side = _vec(origin), _vec(along), _vec(side)
    along = along / np.linalg.norm(along)
    side = side - along * (side @ along)
    side = side / np.linalg.norm(side)
    other = np.cross(along, side)
    rows = np.array([list(s[:5]) + [s[5] if len(s) > 5 else power] for s in stations], dtype=np.float64)
    at = _smooth_table(rows[:, 0], rows[:, 1:])
    start, end = rows[0, 0], rows[-1, 0]

    def distance(p):
        q = p - origin
        t = q @ along
        s = at(t)
        x = np.abs(q @ side - s[:, 0])
        y = np.abs(q @ other - s[:, 1])
        n = s[:, 4]
        a = ((x / s[:, 2]) ** n + (y / s[:, 3]) ** n + 1e-12) ** (1.0 / n)
        # Divided by the gradient of the radial term, so that flat sections keep nearly true distances.
        gx = (x / s[:, 2]) ** (n - 1) / s[:, 2]
        gy = (y / s[:, 3]) ** (n - 1) / s[:, 3]
        slope = np.sqrt(gx**2 + gy**2) * np.maximum(a, 1e-6) ** (1.0 - n)
        radial = (a - 1.0) / np.maximum(slope, 1.0 / np.maximum(s[:, 2], s[:, 3]))
        cap = np.maximum(start - t, t - end)
        qx, qy = np.maximum(radial + rounding, 0.0), np.maximum(cap + rounding, 0.0)
        return np.minimum(np.maximum(radial, cap) + rounding, 0.0) + np.hypot(qx, qy) - rounding

    return distance


def upright(stations, **more):
    """A loft along +Y. Stations (y, center_x, center_z, radius_x, radius_z[, power])."""
    rows = [(s[0], s[1], -s[2], *s[3:]) for s in sorted(stations)]
    return loft((0, 0, 0), (0, 1, 0), (1, 0, 0), rows, **more)


def sideways(stations, **more):
    """A loft along +X. Stations (x, center_y, center_z, radius_y, radius_z[, power])."""
    return loft((0, 0, 0), (1, 0, 0), (0, 1, 0), sorted(stations), **more)


def forward(stations, **more):
    """A loft along +Z. Stations (z, center_x, center_y, radius_x, radius_y[, power])."""
    return loft((0, 0, 0), (0, 0, 1), (1, 0, 0), sorted(stations), **more)


def smooth_min(a, b, k):
    if k <= 0.0:
        return np.minimum(a, b)
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - h * h * k * 0.25


def union(*shapes, k=0.02):
    def distance(p):
        d = shapes[0](p)
        for shape in shapes[1:]:
            d = smooth_min(d, shape(p), k)
        return d

    return distance


def cut(shape, tool, k=0.01):
    """`shape` minus `tool`, the edge rounded over `k`."""
    return lambda p: -smooth_min(-shape(p), tool(p), k)


def common(a, b, k=0.01):
    """The intersection."""
    return lambda p: -smooth_min(-a(p), -b(p), k)


def grown(shape, by):
    return lambda p: shape(p) - by


def shell(shape, thickness):
    return lambda p: np.abs(shape(p)) - thickness * 0.5


def halfspace(point, outward):
    """The half space behind the plane through `point` with normal `outward`."""
    point, outward = _vec(point), _vec(outward) / np.linalg.norm(outward)
    return lambda p: (p - point) @ outward


def mirrored(shape):
    """Mirrors a shape modelled at x >= 0."""
    return lambda p: shape(np.column_stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]]))


def gradient(shape, p, step=1e-3):
    """Unit normals of the shape at points (N, 3)."""
    g = np.empty_like(p)
    for axis in range(3):
        offset = np.zeros(3)
        offset[axis] = step
        g[:, axis] = shape(p + offset) - shape(p - offset)
    return g / np.maximum(np.linalg.norm(g, axis=1, keepdims=True), 1e-12)


def project(shape, p, rounds=6, keep_plane=None):
    """Moves points onto the surface; those of the mask `keep_plane` keep x = 0."""
    p = p.copy()
    for _ in range(rounds):
        d = shape(p)
        step = 1e-3
        g = np.empty_like(p)
        for axis in range(3):
            offset = np.zeros(3)
            offset[axis] = step
            g[:, axis] = (shape(p + offset) - shape(p - offset)) / (2 * step)
        if keep_plane is not None:
            g[keep_plane, 0] = 0.0
        squared = np.maximum(np.einsum("ij,ij->i", g, g), 0.05)
        p -= np.clip(d / squared, -0.01, 0.01)[:, None] * g
    return p


# ---------------------------------------------------------------- sampling and surface nets


def _sample(shape, low, high, step):
    """Distances on a grid; only blocks near the surface are evaluated at full resolution."""
    block = 4
    count = (np.ceil((high - low) / (step * block)).astype(int) + 1) * block
    axes = [low[i] + step * np.arange(count[i] + 1) for i in range(3)]
    coarse_axes = [a[:: block] for a in axes]
    centers = [0.5 * (a[1:] + a[:-1]) for a in coarse_axes]
    grid = np.stack(np.meshgrid(*centers, indexing="ij"), axis=-1).reshape(-1, 3)
    d = shape(grid).reshape([len(c) for c in centers])
    near = np.abs(d) < step * block * 1.6
    field = np.repeat(np.repeat(np.repeat(d, block, 0), block, 1), block, 2)
    field = np.pad(field, ((0, 1), (0, 1), (0, 1)), mode="edge")
    i, j, k = np.nonzero(near)
    offsets = np.stack(np.meshgrid(*[np.arange(block + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    for start in range(0, len(i), 4000):
        index = np.stack([i, j, k], axis=-1)[start : start + 4000, None, :] * block + offsets[None]
        index = index.reshape(-1, 3)
        field[index[:, 0], index[:, 1], index[:, 2]] = shape(low + step * index)
    return field


def surface_nets(shape, low, high, step):
    """Vertices (N, 3) and quads (M, 4) of the shape's surface, counter-clockwise seen from outside."""
    low, high = _vec(low), _vec(high)
    field = _sample(shape, low, high, step)
    inside = field < 0.0
    cells = tuple(n - 1 for n in field.shape)
    sums = np.zeros(cells + (3,))
    hits = np.zeros(cells)
    corner = lambda a, o: a[o[0] : o[0] + cells[0], o[1] : o[1] + cells[1], o[2] : o[2] + cells[2]]
    for axis in range(3):
        for u in (0, 1):
            for v in (0, 1):
                o = [0, 0, 0]
                o[(axis + 1) % 3], o[(axis + 2) % 3] = u, v
                e = list(o)
                e[axis] = 1
                a, b = corner(field, o), corner(field, e)
                crossing = corner(inside, o) != corner(inside, e)
                t = np.where(crossing, a / np.where(a == b, 1.0, a - b), 0.0)
                point = np.zeros(cells + (3,))
                point[...] = o
                point[..., axis] += t
                sums += point * crossing[..., None]
                hits += crossing
    used = hits > 0
    number = np.full(cells, -1)
    number[used] = np.arange(used.sum())
    base = np.stack(np.nonzero(used), axis=-1)
    vertices = low + step * (base + sums[used] / hits[used][:, None])
    quads = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        lower = [slice(None)] * 3
        upper = [slice(None)] * 3
        lower[axis], upper[axis] = slice(0, -1), slice(1, None)
        crossing = inside[tuple(lower)] != inside[tuple(upper)]
        index = np.stack(np.nonzero(crossing), axis=-1)
        index = index[(index[:, u] > 0) & (index[:, v] > 0) & (index[:, u] < cells[u]) & (index[:, v] < cells[v])]
        outward = inside[tuple(lower)][tuple(index.T)]
        ring = []
        for du, dv in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
            c = index.copy()
            c[:, u] += du
            c[:, v] += dv
            ring.append(number[tuple(c.T)])
        ring = np.stack(ring, axis=-1)
        ring[~outward] = ring[~outward][:, ::-1]
        quads.append(ring)
    return vertices, np.concatenate(quads)


def marching_tetrahedra(shape, low, high, step):
    """Vertices and triangles; more and less regular than surface nets, but always a manifold."""
    low, high = _vec(low), _vec(high)
    field = _sample(shape, low, high, step)
    field = np.where(np.abs(field) < 1e-9, 1e-9, field)
    size = np.array(field.shape)
    inside = field < 0.0
    corners = np.stack(np.meshgrid((0, 1), (0, 1), (0, 1), indexing="ij"), axis=-1).reshape(-1, 3)
    cells = size - 1
    count = np.zeros(cells, dtype=int)
    for c in corners:
        count += inside[c[0] : c[0] + cells[0], c[1] : c[1] + cells[1], c[2] : c[2] + cells[2]]
    base = np.stack(np.nonzero((count > 0) & (count < 8)), axis=-1)
    flat = field.reshape(-1)
    grid = (base[:, None, :] + corners[None]) @ np.array([size[1] * size[2], size[2], 1])
    pairs, outward = [], []
    # Six tetrahedra around the cell's diagonal 0-7; corner index = 4x + 2y + z.
    for tet in ((0, 4, 6, 7), (0, 6, 2, 7), (0, 2, 3, 7), (0, 3, 1, 7), (0, 1, 5, 7), (0, 5, 4, 7)):
        index = grid[:, tet]
        sign = flat[index] < 0.0
        for case in range(1, 15):
            rows = index[(sign * [1, 2, 4, 8]).sum(axis=1) == case]
            ins = [k for k in range(4) if case >> k & 1]
            outs = [k for k in range(4) if not case >> k & 1]
            if len(ins) == 2:
                (a, b), (c, d) = ins, outs
                ring = [(a, c), (a, d), (b, d), (b, c)]
                triples = [(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])]
            else:
                one, rest = (ins[0], outs) if len(ins) == 1 else (outs[0], ins)
                triples = [tuple((one, r) for r in rest)]
            for triple in triples:
                pairs.append(np.stack([np.stack([rows[:, e[0]], rows[:, e[1]]], axis=-1) for e in triple], axis=1))
                out = corners[[tet[k] for k in outs]].mean(axis=0) - corners[[tet[k] for k in ins]].mean(axis=0)
                outward.append(np.broadcast_to(out, (len(rows), 3)))
    pairs = np.sort(np.concatenate(pairs), axis=-1)
    keys = pairs[..., 0] * flat.size + pairs[..., 1]
    unique, number = np.unique(keys.reshape(-1), return_inverse=True)
    i, j = unique // flat.size, unique % flat.size
    a = np.stack(np.unravel_index(i, field.shape), axis=-1)
    b = np.stack(np.unravel_index(j, field.shape), axis=-1)
    # Crossings are kept away from the corners, so that no triangle degenerates.
    t = np.clip(flat[i] / (flat[i] - flat[j]), 0.12, 0.88)[:, None]
    vertices = low + step * (a + (b - a) * t)
    tris = number.reshape(-1, 3)
    face = np.cross(vertices[tris[:, 1]] - vertices[tris[:, 0]], vertices[tris[:, 2]] - vertices[tris[:, 0]])
    flip = np.einsum("ij,ij->i", face, np.concatenate(outward)) < 0
    tris[flip] = tris[flip][:, ::-1]
    return vertices, tris


def _is_manifold(faces):
    """Whether the mesh is manifold: each directed edge at most once, and no vertex where two sheets touch."""
    faces = np.asarray(faces)
    n = faces.shape[1]
    a = faces.reshape(-1)
    b = np.roll(faces, -1, axis=1).reshape(-1)
    keys = a.astype(np.int64) * (faces.max() + 1) + b
    if len(np.unique(keys)) != len(keys):
        return False
    # Around a vertex the faces must form one fan: link edges (next, previous) make a single chain.
    following, leading = b.reshape(-1, n), np.roll(faces, 1, axis=1)
    links = {}
    for v, x, y in zip(faces.reshape(-1), following.reshape(-1), leading.reshape(-1)):
        links.setdefault(v, {})[x] = y
    for chain in links.values():
        starts = set(chain) - set(chain.values())
        if len(starts) > 1:
            return False
        at = starts.pop() if starts else next(iter(chain))
        first, steps = at, 0
        while at in chain:
            at = chain[at]
            steps += 1
            if at == first:
                break
        if steps != len(chain):
            return False
    return True


# ---------------------------------------------------------------- even quads


class Mesh:
    """Vertices (N, 3), faces (lists of 3 or 4 indices), and the part number of each face."""

    def __init__(self, vertices, faces, part=None):
        self.vertices = np.asarray(vertices, dtype=np.float64)
        self.faces = [list(map(int, f)) for f in faces]
        self.part = np.zeros(len(self.faces), dtype=int) if part is None else np.asarray(part)

    def triangles(self):
        """Triangles (M, 3) and the face each comes from; quads are split along the shorter diagonal."""
        tris, source = [], []
        v = self.vertices
        for number, f in enumerate(self.faces):
            if len(f) == 4 and np.sum((v[f[0]] - v[f[2]]) ** 2) > np.sum((v[f[1]] - v[f[3]]) ** 2):
                split = [[f[0], f[1], f[3]], [f[1], f[2], f[3]]]
            else:
                split = [[f[0], f[i], f[i + 1]] for i in range(1, len(f) - 1)]
            tris += split
            source += [number] * len(split)
        return np.array(tris), np.array(source)

    def normals(self):
        """Smooth vertex normals, weighted by angle and area."""
        tris, _ = self.triangles()
        v = self.vertices
        n = np.zeros_like(v)
        face = np.cross(v[tris[:, 1]] - v[tris[:, 0]], v[tris[:, 2]] - v[tris[:, 0]])
        for corner in range(3):
            np.add.at(n, tris[:, corner], face)
        return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-12)


def _blender_mesh(name, vertices, faces):
    import bpy

    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(v) for v in vertices], [], [list(map(int, f)) for f in faces])
    mesh.update()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    for other in bpy.context.selected_objects:
        other.select_set(False)
    thing.select_set(True)
    return thing


def _relax(vertices, faces, shape, plane, rounds):
    """Relaxes the quads: each vertex moves halfway to its neighbours' mean, then back onto the shape."""
    edges = set()
    for f in faces:
        for a, b in zip(f, f[1:] + f[:1]):
            edges.add((min(a, b), max(a, b)))
    edges = np.array(sorted(edges))
    for _ in range(rounds):
        total = np.zeros_like(vertices)
        count = np.zeros(len(vertices))
        # On the mirror plane only neighbours on the plane count, which keeps the seam even.
        both = plane[edges[:, 0]] & plane[edges[:, 1]]
        for a, b in ((0, 1), (1, 0)):
            use = both | ~plane[edges[:, a]]
            np.add.at(total, edges[use, a], vertices[edges[use, b]])
            np.add.at(count, edges[use, a], 1)
        moved = np.where(count[:, None] > 1, 0.5 * vertices + 0.5 * total / np.maximum(count, 1)[:, None], vertices)
        vertices = project(shape, moved, 3, plane)
        vertices[plane, 0] = 0.0
    return vertices


def mesh_of(shape, low, high, quads, step=0.008, half=True, relax=3, seed=0):
    """Even quads for a shape inside the box `low`..`high`; about `quads` of them in the full (mirrored) mesh."""
    import bpy  # must come first: it makes bmesh importable
    import bmesh

    low, high = _vec(low).copy(), _vec(high).copy()
    touches = bool(half and low[0] <= 0.0)
    if touches:
        low[0] = -6.0 * step
    vertices, faces = surface_nets(shape, low, high, step)
    if not _is_manifold(faces):
        vertices, faces = marching_tetrahedra(shape, low, high, step)
    # QuadriFlow treats edges below half a millimetre as degenerate, so the body is scaled by 100.
    thing = _blender_mesh("clay", vertices * 100.0, faces)
    if touches:
        edit = bmesh.new()
        edit.from_mesh(thing.data)
        geometry = edit.verts[:] + edit.edges[:] + edit.faces[:]
        bmesh.ops.bisect_plane(edit, geom=geometry, plane_co=(0, 0, 0), plane_no=(1, 0, 0), clear_inner=True)
        bmesh.ops.remove_doubles(edit, verts=edit.verts[:], dist=step)
        edit.to_mesh(thing.data)
        edit.free()
    target = quads // 2 if half else quads
    bpy.ops.object.quadriflow_remesh(
        target_faces=target, use_mesh_symmetry=False, use_preserve_sharp=False, use_preserve_boundary=touches,
        smooth_normals=False, mode="FACES", seed=seed,
    )
    data = bpy.context.view_layer.objects.active.data
    if len(data.polygons) > 3 * target + 100:
        raise RuntimeError("QuadriFlow refused the surface: it is not a manifold; try another grid step")
    vertices = np.array([v.co[:] for v in data.vertices], dtype=np.float64) / 100.0
    faces = [list(f.vertices) for f in data.polygons]
    bpy.data.objects.remove(bpy.context.view_layer.objects.active)
    plane = np.zeros(len(vertices), dtype=bool)
    if touches:
        # The open border is the mirror plane.
        seen = {}
        for f in faces:
            for a, b in zip(f, f[1:] + f[:1]):
                key = (min(a, b), max(a, b))
                seen[key] = seen.get(key, 0) + 1
        for (a, b), n in seen.items():
            if n == 1:
                plane[a] = plane[b] = True
        vertices[plane, 0] = 0.0
        if not plane.any():
            # QuadriFlow closes small openings, so small parts are meshed whole instead of mirrored.
            low[0] = -high[0]
            return mesh_of(shape, low, high, quads, step, False, relax, seed)
    vertices = project(shape, vertices, 6, plane)
    vertices = _relax(vertices, faces, shape, plane, relax)
    if touches:
        plane |= vertices[:, 0] < 2e-4
        vertices[plane, 0] = 0.0
    mesh = Mesh(vertices, faces)
    mesh.plane = plane
    mesh.whole = not half
    # A face in the mirror plane would coincide with its own image.
    return _outward(_only(mesh, np.array([not all(plane[i] for i in f) for f in faces])), shape)


def _outward(mesh, shape):
    tris, _ = mesh.triangles()
    v = mesh.vertices
    face = np.cross(v[tris[:, 1]] - v[tris[:, 0]], v[tris[:, 2]] - v[tris[:, 0]])
    center = v[tris].mean(axis=1)
    if np.sum(np.einsum("ij,ij->i", face, gradient(shape, center))) < 0:
        mesh.faces = [f[::-1] for f in mesh.faces]
    return mesh


def cast(shape, start, direction, reach, steps=64):
    """First hits of rays (N, 3 origins; N, 3 directions) with the shape within `reach` directions; rays that miss end there."""
    start, direction = np.asarray(start, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    low = np.zeros(len(start))
    high = np.full(len(start), float(reach))
    open_ = np.ones(len(start), dtype=bool)
    for t in np.linspace(0.0, reach, steps)[1:]:
        hit = open_ & (shape(start + direction * t) < 0.0)
        high[hit] = t
        open_ &= ~hit
        low[open_] = t
    low = np.minimum(low, high)
    for _ in range(18):
        middle = 0.5 * (low + high)
        hit = shape(start + direction * middle[:, None]) < 0.0
        high = np.where(hit, middle, high)
        low = np.where(hit, low, middle)
    return start + direction * high[:, None]


def ring(shape, origin, axis, side, profile, segments, half=False, closed=False, reach=0.3):
    """A band around a limb in clean loops: cuffs, belts, collars, boot rims.

    `axis` the limb's direction, `side` the direction where the loop begins; `profile` a list of (along, offset): metres
    along the axis from `origin`, and metres out from the shape's surface there, from one edge to the other. `half`: only
    the half turn from `side` over axis x side, both ends on the mirror plane (then `side` must lie in it).
    `closed`: the profile is a loop.
    """
    origin, axis, side = _vec(origin), _vec(axis), _vec(side)
    axis = axis / np.linalg.norm(axis)
    side = side - axis * (side @ axis)
    side = side / np.linalg.norm(side)
    other = np.cross(axis, side)
    around = np.linspace(0, np.pi, segments // 2 + 1) if half else np.arange(segments) * 2 * np.pi / segments
    out = np.cos(around)[:, None] * side + np.sin(around)[:, None] * other
    rows = []
    for along, offset in profile:
        center = origin + axis * along
        hit = cast(shape, center + out * reach, -out, reach)
        rows.append(hit + out * offset)
    vertices = np.concatenate(rows)
    n = len(around)
    faces = []
    columns = n - 1 if half else n
    for r in range(len(profile) - (0 if closed else 1)):
        for c in range(columns):
            a, b = r * n + c, r * n + (c + 1) % n
            d, e = (r + 1) % len(profile) * n + c, (r + 1) % len(profile) * n + (c + 1) % n
            faces.append([a, b, e, d])
    mesh = Mesh(vertices, faces)
    mesh.plane = np.zeros(len(vertices), dtype=bool)
    if half:
        mesh.plane[0::n] = mesh.plane[n - 1 :: n] = True
        mesh.vertices[mesh.plane, 0] = 0.0
    mesh.whole = False
    return _away(mesh, origin, axis)


def _away(mesh, origin, axis):
    """Flips all faces if they face the axis."""
    tris, _ = mesh.triangles()
    v = mesh.vertices
    face = np.cross(v[tris[:, 1]] - v[tris[:, 0]], v[tris[:, 2]] - v[tris[:, 0]])
    out = v[tris].mean(axis=1) - origin
    out -= (out @ axis)[:, None] * axis
    if np.sum(np.einsum("ij,ij->i", face, out)) < 0:
        mesh.faces = [f[::-1] for f in mesh.faces]
    return mesh


def patch(shape, center, facing, up, radii, profile, size=8, power=2.5, reach=0.15):
    """A plate on a body in clean loops: pads, pockets, pouches, badges.

    It is seen from `facing` (a direction), `up` across it; `radii` (across, up) of its outline, a superellipse of
    exponent `power`; `profile`: (0..1 from middle to border, metres above the surface) keys, the last normally below 0.
    `size` x `size` quads.
    """
    center, facing, up = _vec(center), _vec(facing), _vec(up)
    facing = facing / np.linalg.norm(facing)
    up = up - facing * (up @ facing)
    up = up / np.linalg.norm(up)
    across = np.cross(up, facing)
    grid = np.linspace(-1, 1, size + 1)
    u, v = [c.reshape(-1) for c in np.meshgrid(grid, grid)]
    s = np.maximum(np.abs(u), np.abs(v))
    # Morphs square loops into the outline's shape.
    angle = np.arctan2(v, u)
    norm = (np.abs(np.cos(angle)) ** power + np.abs(np.sin(angle)) ** power) ** (1.0 / power)
    x, y = s * np.cos(angle) / norm, s * np.sin(angle) / norm
    start = center + facing * (reach * 0.5) + np.outer(x * radii[0], across) + np.outer(y * radii[1], up)
    hit = cast(shape, start, np.broadcast_to(-facing, start.shape), reach)
    keys = np.array(profile, dtype=np.float64)
    offset = np.interp(s, keys[:, 0], keys[:, 1])
    vertices = hit + gradient(shape, hit, 4e-3) * offset[:, None]
    n = size + 1
    faces = [[j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i] for j in range(size) for i in range(size)]
    mesh = Mesh(vertices, faces)
    mesh.plane = np.zeros(len(vertices), dtype=bool)
    mesh.whole = False
    tris, _ = mesh.triangles()
    w = mesh.vertices
    face = np.cross(w[tris[:, 1]] - w[tris[:, 0]], w[tris[:, 2]] - w[tris[:, 0]])
    if np.sum(face @ facing) < 0:
        mesh.faces = [f[::-1] for f in mesh.faces]
    return mesh


def globe(shape, center, radii, counts, rotation=None):
    """A closed part in clean loops: a box of `counts` quads along its three axes, projected onto a shape that is star-shaped
    around `center`. `radii` approximate the shape's along the same axes; `rotation` (3x3) rotates them."""
    center, radii = _vec(center), _vec(radii)
    turn = np.eye(3) if rotation is None else np.asarray(rotation)
    index, vertices, faces = {}, [], []
    ease = lambda i, n: np.tan((2.0 * i / n - 1.0) * np.pi / 4)

    def corner(i, j, k):
        if (i, j, k) not in index:
            index[i, j, k] = len(vertices)
            vertices.append([ease(i, counts[0]), ease(j, counts[1]), ease(k, counts[2])])
        return index[i, j, k]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, counts[axis]):
            for a in range(counts[u]):
                for b in range(counts[v]):
                    face = []
                    for da, db in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        at = [0, 0, 0]
                        at[axis], at[u], at[v] = end, a + da, b + db
                        face.append(corner(*at))
                    faces.append(face if end else face[::-1])
    out = np.array(vertices)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    out = (out * radii * 1.7) @ turn.T
    mesh = Mesh(cast(shape, center + out, -out, 1.0, 80), faces)
    mesh.plane = np.zeros(len(mesh.vertices), dtype=bool)
    mesh.whole = False
    return _outward(mesh, shape)


def without_hidden(mesh, covers):
    """The mesh without the faces that lie entirely inside one of `covers` [(shape, depth in metres)]."""
    hidden = np.zeros(len(mesh.faces), dtype=bool)
    for shape, depth in covers:
        inside = shape(mesh.vertices) < -depth
        hidden |= np.array([all(inside[i] for i in f) for f in mesh.faces])
    return _only(mesh, ~hidden)


def _only(mesh, keep):
    """The mesh of the faces in the mask `keep`, without unused vertices."""
    faces = [f for f, k in zip(mesh.faces, keep) if k]
    used = np.unique([i for f in faces for i in f])
    number = np.full(len(mesh.vertices), -1)
    number[used] = np.arange(len(used))
    out = Mesh(mesh.vertices[used], [[int(number[i]) for i in f] for f in faces], mesh.part[keep])
    out.plane, out.whole = mesh.plane[used], mesh.whole
    return out


def joined(meshes):
    """Joins meshes; `part` stores the origin of each face."""
    vertices, faces, part, plane, base = [], [], [], [], 0
    for number, m in enumerate(meshes):
        vertices.append(m.vertices)
        faces += [[i + base for i in f] for f in m.faces]
        part += [number] * len(m.faces)
        plane.append(m.plane)
        base += len(m.vertices)
    mesh = Mesh(np.concatenate(vertices), faces, part)
    mesh.plane = np.concatenate(plane)
    return mesh


def mirror(mesh, uv=None, alone=()):
    """Mirrors a left half. Vertices on the mirror plane are shared; both sides use the same UVs (per face corner).

    Faces of the parts in `alone` are complete already and are not mirrored. `other` of the result is the mirror image of each
    of the first vertices.
    """
    count = len(mesh.vertices)
    doubled = [i for i, part in enumerate(mesh.part) if part not in alone]
    used = np.zeros(count, dtype=bool)
    for i in doubled:
        used[mesh.faces[i]] = True
    used &= ~mesh.plane
    other = np.arange(count)
    other[used] = count + np.arange(used.sum())
    faces = mesh.faces + [[int(other[i]) for i in mesh.faces[f]][::-1] for f in doubled]
    flipped = mesh.vertices[used] * [-1, 1, 1]
    whole = Mesh(np.concatenate([mesh.vertices, flipped]), faces, np.concatenate([mesh.part, mesh.part[doubled]]))
    whole.plane = np.concatenate([mesh.plane, np.zeros(len(flipped), dtype=bool)])
    whole.other = other
    return whole if uv is None else (whole, uv + [uv[f][::-1] for f in doubled])
