"""Paint: unwraps a mesh into one atlas and bakes colour, roughness, metal, occlusion and fine relief into textures.

Colours are functions of the position on the body, so borders are sharp to a texel independent of the mesh. Relief is a height
in metres as a function of position; it is baked into the normal map along with the exact normals of the clay.
"""

import numpy as np

import clay


def unwrap(mesh, splits=None, margin=0.004):
    """The atlas: a list of corner UVs per face, v up.

    Every part is cut into charts by face direction: `splits[part]` is the vector that separates front from back, or None for the
    six sides of a box. Fewer charts mean fewer duplicated vertices.
    """
    import bpy

    charts = _charts(mesh, splits or {})
    thing = clay._blender_mesh("unwrap", mesh.vertices, mesh.faces)
    data = thing.data
    sides = {}
    for number, f in enumerate(mesh.faces):
        for a, b in zip(f, f[1:] + f[:1]):
            sides.setdefault((min(a, b), max(a, b)), []).append(number)
    for e in data.edges:
        near = sides[tuple(sorted(e.vertices))]
        e.use_seam = bool(len(near) == 2 and charts[near[0]] != charts[near[1]])
    data.uv_layers.new(name="UV")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.unwrap(method="ANGLE_BASED", fill_holes=False, margin=margin)
    bpy.ops.uv.select_all(action="SELECT")
    bpy.ops.uv.average_islands_scale()
    bpy.ops.uv.pack_islands(rotate=True, margin=margin)
    bpy.ops.object.mode_set(mode="OBJECT")
    layer = thing.data.uv_layers.active.data
    uv = [[tuple(layer[i].uv) for i in p.loop_indices] for p in thing.data.polygons]
    bpy.data.objects.remove(thing)
    flat = np.array([c for f in uv for c in f])
    low, span = flat.min(axis=0), (flat.max(axis=0) - flat.min(axis=0)).max()
    return [[tuple(((np.array(c) - low) / span) * 0.996 + 0.002) for c in f] for f in uv]


def _charts(mesh, splits):
    """A chart number per face, by the side it faces; small islands are merged into their neighbours."""
    v = mesh.vertices
    normal = np.array([np.cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]]) + (np.cross(v[f[2]] - v[f[0]], v[f[-1]] - v[f[0]]) if len(f) > 3 else 0) for f in mesh.faces])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    neighbours = [[] for _ in mesh.faces]
    sides = {}
    for number, f in enumerate(mesh.faces):
        for a, b in zip(f, f[1:] + f[:1]):
            sides.setdefault((min(a, b), max(a, b)), []).append(number)
    for near in sides.values():
        if len(near) == 2:
            neighbours[near[0]].append(near[1])
            neighbours[near[1]].append(near[0])
    # Normals are smoothed first, so that chart borders run straight instead of following every bump.
    for _ in range(6):
        mean = np.array([normal[n].sum(axis=0) if n else np.zeros(3) for n in neighbours])
        normal = normal + mean
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    side = np.zeros(len(mesh.faces), dtype=int)
    for part in np.unique(mesh.part):
        mine = mesh.part == part
        split = splits.get(part)
        if split is not None:
            side[mine] = (normal[mine] @ np.asarray(split, dtype=np.float64) > 0).astype(int)
        else:
            axis = np.abs(normal[mine]).argmax(axis=1)
            side[mine] = axis * 2 + (np.take_along_axis(normal[mine], axis[:, None], 1)[:, 0] > 0)
    for _ in range(4):
        chart = _islands(side, neighbours)
        sizes = np.bincount(chart)
        for face in np.nonzero(sizes[chart] < 14)[0]:
            other = [side[n] for n in neighbours[face] if chart[n] != chart[face]]
            if other:
                side[face] = max(set(other), key=other.count)
    return _islands(side, neighbours)


def _islands(side, neighbours):
    chart = np.full(len(side), -1)
    count = 0
    for start in range(len(side)):
        if chart[start] >= 0:
            continue
        todo = [start]
        chart[start] = count
        while todo:
            at = todo.pop()
            for n in neighbours[at]:
                if chart[n] < 0 and side[n] == side[at]:
                    chart[n] = count
                    todo.append(n)
        count += 1
    return chart


def corners_of(mesh, uv):
    """The mesh in file layout: (vertex of each corner, corner UVs, triangles over corners, face of each triangle).

    Corners with equal vertex and UV are merged.
    """
    number, vertex, coords = {}, [], []
    faces = []
    for f, c in zip(mesh.faces, uv):
        face = []
        for v, t in zip(f, c):
            key = (v, round(t[0] * 65535), round(t[1] * 65535))
            if key not in number:
                number[key] = len(vertex)
                vertex.append(v)
                coords.append(t)
            face.append(number[key])
        faces.append(face)
    flat = clay.Mesh(mesh.vertices[vertex], faces, mesh.part)
    tris, source = flat.triangles()
    return np.array(vertex), np.array(coords), tris, source


def _tangents(mesh, uv):
    """MikkTSpace tangents and signs per triangle corner, from Blender, for the triangles of `mesh`."""
    import bpy

    vertex, coords, tris, source = corners_of(mesh, uv)
    thing = clay._blender_mesh("tangents", mesh.vertices, vertex[tris])
    data = thing.data
    for p in data.polygons:
        p.use_smooth = True
    layer = data.uv_layers.new(name="UV")
    layer.data.foreach_set("uv", coords[tris].reshape(-1).astype(np.float32))
    data.normals_split_custom_set_from_vertices([tuple(n) for n in mesh.normals()])
    data.calc_tangents(uvmap="UV")
    tangent = np.array([l.tangent[:] for l in data.loops]).reshape(-1, 3, 3)
    sign = np.array([l.bitangent_sign for l in data.loops]).reshape(-1, 3)
    bpy.data.objects.remove(thing)
    return vertex, coords, tris, source, tangent, sign


class Surface:
    """A mesh in file layout: per corner `vertex` (its index in the full mesh), `place`, `normal`, `uv` (v down),
    `tangent` (with sign); `triangles` over the corners."""


def surface(left, uv, alone=()):
    """The full Surface of a left half and its UVs; both sides share the atlas, the right one mirrored."""
    whole = clay.mirror(left, alone=alone)
    vertex, coords, tris, source, tangent, sign = _tangents(left, uv)
    total = np.zeros((len(vertex), 3))
    hand = np.zeros(len(vertex))
    for corner in range(3):
        np.add.at(total, tris[:, corner], tangent[:, corner])
        hand[tris[:, corner]] = sign[:, corner]
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-9)
    normals = whole.normals()
    twin = ~np.isin(left.part[source], list(alone))
    used = np.unique(tris[twin])
    number = np.full(len(vertex), -1)
    number[used] = len(vertex) + np.arange(len(used))
    out = Surface()
    out.vertex = np.concatenate([vertex, whole.other[vertex[used]]])
    out.place, out.normal = whole.vertices[out.vertex], normals[out.vertex]
    out.uv = np.concatenate([coords, coords[used]])
    out.uv = np.column_stack([out.uv[:, 0], 1 - out.uv[:, 1]])
    tangents = np.concatenate([total, total[used] * [-1, 1, 1]])
    tangents -= out.normal * np.einsum("ij,ij->i", tangents, out.normal)[:, None]
    tangents /= np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-9)
    out.tangent = np.column_stack([tangents, np.concatenate([hand, -hand[used]])])
    out.triangles = np.concatenate([tris, number[tris[twin]][:, ::-1]])
    out.mesh = whole
    return out


class Texels:
    """The surface under each texel of the atlas: `at` rows, place, normal, tangent, bitangent, part."""


def _rasterise(mesh, uv, size):
    vertex, coords, tris, source, tangent, sign = _tangents(mesh, uv)
    normals = mesh.normals()
    owner = np.full((size, size), -1, dtype=int)
    bary = np.zeros((size, size, 3))
    xy = coords * [size, -size] + [-0.5, size - 0.5]
    for number, tri in enumerate(tris):
        a, b, c = xy[tri]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(area) < 1e-9:
            continue
        low = np.maximum(np.floor(np.min([a, b, c], axis=0)).astype(int) - 1, 0)
        high = np.minimum(np.ceil(np.max([a, b, c], axis=0)).astype(int) + 2, size)
        x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area
        v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area
        w = 1 - u - v
        # Includes half a texel beyond the edge, so that no chart is thinner in the texture than on the mesh.
        slack = -0.75 * max(np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(a - c)) / abs(area)
        inside = np.minimum(np.minimum(u, v), w)
        old = owner[low[1] : high[1], low[0] : high[0]]
        take = (inside >= -1e-9) | ((inside >= slack) & (old < 0))
        old[take] = number
        bary[low[1] : high[1], low[0] : high[0]][take] = np.stack([u, v, w], axis=-1)[take]
    rows, columns = np.nonzero(owner >= 0)
    t = owner[rows, columns]
    k = bary[rows, columns]
    out = Texels()
    out.at = (rows, columns)
    out.part = mesh.part[source[t]]
    mix = lambda per_corner: np.einsum("nc,ncd->nd", k, per_corner)
    unit = lambda v: v / np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-9)
    out.place = mix(mesh.vertices[vertex[tris[t]]])
    out.normal = unit(mix(normals[vertex[tris[t]]]))
    out.tangent = mix(tangent[t])
    out.tangent = unit(out.tangent - out.normal * np.einsum("ij,ij->i", out.tangent, out.normal)[:, None])
    out.bitangent = np.cross(out.normal, out.tangent) * sign[t, 0][:, None]
    return out


def _overlap(mesh, uv):
    """The fraction of chart area lost to overlapping charts."""
    size = 512
    area = 0.0
    for f in uv:
        c = np.array(f)
        x, y = c[:, 0], c[:, 1]
        area += 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    from PIL import Image, ImageDraw

    picture = Image.new("1", (size * 2, size * 2))
    draw = ImageDraw.Draw(picture)
    for f in uv:
        draw.polygon([(c[0] * size * 2, c[1] * size * 2) for c in f], fill=1)
    return max(0.0, 1.0 - np.asarray(picture).mean() / max(area, 1e-9))


def _spread(picture, filled, rounds=6):
    """Dilates the charts, so that filtering never picks up the background."""
    for _ in range(rounds):
        total = np.zeros_like(picture)
        count = np.zeros(filled.shape)
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                moved = np.roll(filled, (dy, dx), (0, 1))
                total += np.roll(picture, (dy, dx), (0, 1)) * moved[..., None]
                count += moved
        new = ~filled & (count > 0)
        picture[new] = total[new] / count[new][:, None]
        filled = filled | new
    picture[~filled] = picture[filled].mean(axis=0)
    return picture


def occlusion(scene, place, normal, reach=(0.008, 0.02, 0.045, 0.1)):
    """Ambient occlusion (1: fully open), from the scene's distances slightly above the surface."""
    total, weight = np.zeros(len(place)), 0.0
    for d in reach:
        free = scene(place + normal * d)
        total += np.clip(1.0 - free / d, 0.0, 1.0)
        weight += 1.0
    return np.clip(1.0 - 0.85 * total / weight, 0.0, 1.0)


def bake(mesh, uv, shapes, paint, height=None, size=1024, scene=None):
    """Textures (u8): base colour, normal (+Y up), occlusion-roughness-metal (half the size).

    `shapes[part]` is the clay of each part, or None to use the mesh's normals; `paint(part, place, normal,
    open)` -> (sRGB colours (N, 3) in 0..1, roughness (N,), metal (N,)); `height(part, place)` -> metres; `scene` is all
    clay, for occlusion.
    """
    fine = _rasterise(mesh, uv, size)
    print(f"atlas: {len(fine.place) / size**2:.0%} used, {_overlap(mesh, uv):.1%} of the charts overlap", flush=True)
    rough = _rasterise(mesh, uv, size // 2)
    half = size // 2

    # Clay normals and occlusion are slow, so they are computed at half the size.
    surface = rough.normal.copy()
    for part in np.unique(rough.part):
        if shapes[part] is not None:
            mine = rough.part == part
            surface[mine] = clay.gradient(shapes[part], rough.place[mine], 1.5e-3)
    # Where a coarse mesh cuts a corner of the clay, the exact normal would look wrong.
    turned = np.einsum("ij,ij->i", surface, rough.normal)
    surface[turned < 0.35] = rough.normal[turned < 0.35]
    opened = occlusion(scene, rough.place, surface) if scene else np.ones(len(rough.place))
    smooth = np.zeros((half, half, 4))
    tangent_space = np.stack(
        [np.einsum("ij,ij->i", surface, v) for v in (rough.tangent, rough.bitangent, rough.normal)], axis=-1
    )
    smooth[rough.at] = np.column_stack([tangent_space, opened])
    filled = np.zeros((half, half), dtype=bool)
    filled[rough.at] = True
    smooth = _spread(smooth, filled)
    from PIL import Image

    large = np.stack(
        [np.asarray(Image.fromarray(smooth[..., i].astype(np.float32)).resize((size, size), Image.BILINEAR)) for i in range(4)],
        axis=-1,
    )[fine.at]
    bent = large[:, 0:1] * fine.tangent + large[:, 1:2] * fine.bitangent + large[:, 2:3] * fine.normal
    bent /= np.maximum(np.linalg.norm(bent, axis=1, keepdims=True), 1e-9)
    open_fine = large[:, 3]

    color = np.zeros((len(fine.place), 3))
    coarse = np.zeros((len(fine.place), 2))
    for part in np.unique(fine.part):
        mine = fine.part == part
        place, n = fine.place[mine], bent[mine]
        color[mine], r, m = paint(part, place, n, open_fine[mine])
        coarse[mine, 0], coarse[mine, 1] = r, m
        if height:
            step = 6e-4
            slope = np.stack(
                [
                    height(part, place + step * axis) - height(part, place - step * axis)
                    for axis in np.eye(3)
                ],
                axis=-1,
            ) / (2 * step)
            slope -= n * np.einsum("ij,ij->i", slope, n)[:, None]
            steep = np.linalg.norm(slope, axis=1, keepdims=True)
            slope *= np.minimum(1.0, 1.2 / np.maximum(steep, 1e-9))
            n = n - slope
            bent[mine] = n / np.linalg.norm(n, axis=1, keepdims=True)
    normal = np.stack([np.einsum("ij,ij->i", bent, v) for v in (fine.tangent, fine.bitangent, fine.normal)], axis=-1)
    filled = np.zeros((size, size), dtype=bool)
    filled[fine.at] = True

    def picture(values):
        out = np.zeros((size, size, values.shape[1]))
        out[fine.at] = values
        return _spread(out, filled.copy())

    byte = lambda v: np.round(np.clip(v, 0, 1) * 255).astype(np.uint8)
    base = byte(picture(color))
    bump = byte(picture(normal * 0.5 + 0.5))
    orm = byte(picture(np.column_stack([open_fine, coarse])))
    orm = np.asarray(Image.fromarray(orm).resize((half, half), Image.BOX))
    return base, bump, orm


# ---------------------------------------------------------------- patterns


def srgb(text):
    return np.array([int(text[i : i + 2], 16) / 255 for i in (1, 3, 5)])


def edge(distance, softness=0.0012):
    """1 inside (distance < 0), 0 outside, soft over `softness` metres."""
    return np.clip(0.5 - distance / softness, 0.0, 1.0)


def groove(distance, width=0.003, depth=0.0012):
    """Relief of a line where `distance` is 0."""
    return -depth * np.exp(-((distance / (width * 0.5)) ** 2))


def noise(p, scale, seed=0):
    """Smooth value noise in -1..1; `scale` in metres."""
    q = p / scale + 17.3 * (seed + 1)
    i = np.floor(q).astype(np.int64)
    f = q - i
    f = f * f * (3 - 2 * f)
    total = np.zeros(len(p))
    for corner in range(8):
        o = np.array([corner & 1, corner >> 1 & 1, corner >> 2 & 1])
        c = (i + o) * np.array([374761393, 668265263, 2147483647 // 3]) + seed * 1013904223
        h = c[:, 0] ^ (c[:, 1] << 1) ^ (c[:, 2] << 2)
        h = (h ^ (h >> 13)) * 1274126177 & 0xFFFFFFFF
        value = ((h ^ (h >> 16)) & 0xFFFF) / 32767.5 - 1.0
        total += value * np.prod(np.where(o, f, 1 - f), axis=1)
    return total
