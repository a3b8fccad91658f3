"""Sculpting: what the dwarf, the fox and the goblin share on top of clay.py - strings of capsules, pieces that are meshed
with another grid where the remesher stumbles, and sharp tips."""

import numpy as np

import clay
from clay import capsule, union


def chain(points, radii, k=0.01, flatten=None):
    """A soft string of capsules: locks of hair, horns, fingers, legs."""
    return union(*[capsule(a, b, ra, rb, flatten) for a, b, ra, rb in zip(points, points[1:], radii, radii[1:])], k=k)


def bent(points, radii, k=0.01, count=6, flatten=None):
    """A chain along a smooth curve through `points`."""
    at = clay._smooth_table(np.linspace(0, 1, len(points)), np.column_stack([points, radii]))
    rows = at(np.linspace(0, 1, count))
    return chain(list(rows[:, :3]), list(rows[:, 3]), k, flatten)


def meshed(part, keep=()):
    """The quads of a part (`shape`, `box`, `quads`, `step`, `half`). Another grid is tried where the remesher refuses one or
    loses a limb: some vertex must be near each place of `keep`."""
    for factor in (1.0, 0.93, 1.06, 0.87, 1.12, 0.82):
        try:
            mesh = clay.mesh_of(part.shape, *part.box, part.quads, part.step * factor, part.half)
        except RuntimeError:
            continue
        if all(np.linalg.norm(mesh.vertices - place, axis=1).min() < 0.035 for place in keep):
            return mesh
    raise RuntimeError(f"no grid suits {part.name}")


def pointed(mesh, places):
    """Even quads round off where a silhouette ends in a point; the vertex nearest to each of `places` is put there."""
    for place in places:
        d = np.linalg.norm(mesh.vertices - place, axis=1)
        if place[0] == 0:
            d = d + ~mesh.plane
        mesh.vertices[d.argmin()] = place
    return mesh


def mixed(base, color, amount):
    """Colours (N, 3) painted over with one colour by amounts (N,)."""
    return base + (color - base) * np.asarray(amount)[:, None]


def unit_normals(shown):
    """Where the mirror plane folds a face onto its twin, the two normals cancel; any unit vector does there."""
    lost = np.linalg.norm(shown.normal, axis=1) < 0.5
    shown.normal[lost], shown.tangent[lost, :3] = (0, 0, 1), (1, 0, 0)
