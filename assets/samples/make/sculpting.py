"""Sculpting tools on top of clay.py, shared by dwarf, fox and goblin: chains of capsules, remeshing on other grids where
QuadriFlow fails, and sharp tips."""

import numpy as np

import clay
from clay import capsule, union


def chain(points, radii, k=0.01, flatten=None):
    """A blended chain of capsules: locks of hair, horns, fingers, legs."""
    return union(*[capsule(a, b, ra, rb, flatten) for a, b, ra, rb in zip(points, points[1:], radii, radii[1:])], k=k)


def bent(points, radii, k=0.01, count=6, flatten=None):
    """A chain along a smooth curve through `points`."""
    at = clay._smooth_table(np.linspace(0, 1, len(points)), np.column_stack([points, radii]))
    rows = at(np.linspace(0, 1, count))
    return chain(list(rows[:, :3]), list(rows[:, 3]), k, flatten)


def folded(mesh, shape):
    """Number of faces whose normal disagrees with the clay, or that bridge a hollow: tears and dents."""
    tris, _ = mesh.triangles()
    v = mesh.vertices
    face = np.cross(v[tris[:, 1]] - v[tris[:, 0]], v[tris[:, 2]] - v[tris[:, 0]])
    size = np.linalg.norm(face, axis=1)
    center = v[tris].mean(axis=1)
    agree = np.einsum("ij,ij->i", face, clay.gradient(shape, center)) / np.maximum(size, 1e-12)
    return int(np.sum((agree < 0.55) & (size > 1e-9)))


def meshed(part, keep=(), tries=4, good=4):
    """The quads of a part (`shape`, `box`, `quads`, `step`, `half`, `relax`): the best of several grids, because the remesher may
    fail, tear a crevice or lose a limb (a vertex must be near each point of `keep`)."""
    best, fewest = None, None
    for factor in (1.0, 0.93, 1.06, 0.87, 1.12, 0.82)[:tries]:
        try:
            mesh = clay.mesh_of(part.shape, *part.box, part.quads, part.step * factor, part.half, part.relax)
        except RuntimeError:
            continue
        if any(np.linalg.norm(mesh.vertices - place, axis=1).min() > 0.035 for place in keep):
            continue
        bad = folded(mesh, part.shape)
        if fewest is None or bad < fewest:
            best, fewest = mesh, bad
        if bad <= good:
            break
    if best is None:
        raise RuntimeError(f"no grid suits {part.name}")
    print(f"{part.name}: {fewest} faces folded", flush=True)
    return best


def pointed(mesh, places):
    """Even quads round off pointed tips; moves the nearest vertex to each of `places`."""
    for place in places:
        d = np.linalg.norm(mesh.vertices - place, axis=1)
        if place[0] == 0:
            d = d + ~mesh.plane
        mesh.vertices[d.argmin()] = place
    return mesh


def mixed(base, color, amount):
    """Blends colours (N, 3) towards one colour by amounts (N,)."""
    return base + (color - base) * np.asarray(amount)[:, None]


def unit_normals(shown):
    """Normals cancel where the mirror plane folds a face onto its twin; replaces them with arbitrary unit vectors."""
    lost = np.linalg.norm(shown.normal, axis=1) < 0.5
    shown.normal[lost], shown.tangent[lost, :3] = (0, 0, 1), (1, 0, 0)
