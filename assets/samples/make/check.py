"""Measures finished files as played back: ground penetration of the soles, sliding of planted feet, and loop seams.
`python check.py FILE.glb [CLIP=SPEED …]`: SPEED of the treadmill in metres per second (default 0; walks face +Z). A foot is
planted while part of its sole is within 4 mm of the ground and neither rises nor falls.
"""

import json
import struct
import sys

import numpy as np

from rig import matrix, slerp

SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TYPES = {5126: "<f4", 5121: "u1", 5123: "<u2", 5125: "<u4", 5122: "<i2"}


class File:
    def __init__(self, path):
        data = open(path, "rb").read()
        n = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + n])
        self.bin = data[28 + n :]

    def array(self, index):
        a = self.json["accessors"][index]
        v = self.json["bufferViews"][a["bufferView"]]
        dtype, width = np.dtype(TYPES[a["componentType"]]), SIZES[a["type"]]
        start = v.get("byteOffset", 0) + a.get("byteOffset", 0)
        stride = v.get("byteStride", dtype.itemsize * width)
        out = np.ndarray((a["count"], width), dtype, self.bin, start, (stride, dtype.itemsize)).astype(np.float64)
        if a.get("normalized"):
            out = np.maximum(out / np.iinfo(dtype).max, -1)
        return out

    def world(self, clip, time):
        """World matrices of all nodes."""
        nodes = self.json["nodes"]
        local = [
            {
                "translation": n.get("translation", [0, 0, 0]),
                "rotation": n.get("rotation", [0, 0, 0, 1]),
                "scale": n.get("scale", [1, 1, 1]),
            }
            for n in nodes
        ]
        for c in clip["channels"] if clip else []:
            s = clip["samplers"][c["sampler"]]
            times, values = self.array(s["input"])[:, 0], self.array(s["output"])
            i = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 1))
            k = min(i + 1, len(times) - 1)
            t = 0.0 if k == i else np.clip((time - times[i]) / (times[k] - times[i]), 0, 1)
            a, b = values[i], values[k]
            local[c["target"]["node"]][c["target"]["path"]] = (
                slerp(a, b, t) if c["target"]["path"] == "rotation" else a + (b - a) * t
            )
        out = [None] * len(nodes)

        def visit(i, parent):
            m = np.eye(4)
            m[:3, :3] = matrix(np.asarray(local[i]["rotation"], dtype=float)) * np.asarray(local[i]["scale"])
            m[:3, 3] = local[i]["translation"]
            out[i] = parent @ m
            for child in nodes[i].get("children", []):
                visit(child, out[i])

        for root in self.json["scenes"][0]["nodes"]:
            visit(root, np.eye(4))
        return out


def soles(file, clip, times):
    """Positions (T, V, 3) of the vertices that are soles in the rest pose, and the foot each belongs to."""
    prim = file.json["meshes"][0]["primitives"][0]["attributes"]
    skin = file.json["skins"][0]
    place = file.array(prim["POSITION"])
    low = place[:, 1] < place[:, 1].min() + 0.012
    place = np.column_stack([place[low], np.ones(low.sum())])
    joints, weights = file.array(prim["JOINTS_0"])[low].astype(int), file.array(prim["WEIGHTS_0"])[low]
    inverse = file.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    out = []
    for t in times:
        world = file.world(clip, t)
        palette = np.array([world[n] @ inverse[k] for k, n in enumerate(skin["joints"])])
        out.append(np.einsum("nk,nkij,nj->ni", weights, palette[joints], place)[:, :3])
    return np.array(out), place[:, 0] > 0


def main():
    file = File(sys.argv[1])
    speeds = dict(a.split("=") for a in sys.argv[2:])
    for clip in file.json.get("animations", []):
        end = max(file.array(s["input"])[-1, 0] for s in clip["samplers"])
        rate = 120
        times = np.arange(int(round(end * rate)) + 1) / rate
        gap = max(np.abs(np.array(file.world(clip, 0.0)) - np.array(file.world(clip, end))).max(axis=(1, 2)))
        line = f"{clip['name']}: {end:.3f} s, loop gap {gap * 1000:.2f} mm"
        if "meshes" in file.json:
            p, left = soles(file, clip, times)
            p[:, :, 2] += float(speeds.get(clip["name"], 0)) * times[:, None]
            worst, mean = 0.0, []
            for foot in (left, ~left):
                q = p[:, foot]
                for a, b in zip(q, q[1:]):
                    bears = (a[:, 1] < 0.004) & (b[:, 1] < 0.004) & (np.abs(b[:, 1] - a[:, 1]) * rate < 0.1)
                    if bears.any():
                        # The steadiest quarter of the sole: an edge that is landing or lifting is not planted.
                        v = np.sort(np.linalg.norm((b - a)[bears][:, [0, 2]], axis=1) * rate)
                        v = v[: max(1, len(v) // 4)].mean()
                        mean.append(v)
                        worst = max(worst, v)
            line += f", lowest sole {p[:, :, 1].min() * 1000:.1f} mm, slide mean {np.mean(mean or [0]):.3f} worst {worst:.3f} m/s"
        print(line)


if __name__ == "__main__":
    main()
