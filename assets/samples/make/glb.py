"""Writes a skeleton, skinned meshes with textures or vertex colours, morph targets and clips into a .glb (glTF 2.0).

Vertices are compact without extensions: u8 joints, u8 weights that sum to exactly 255, u16 UVs, u8 colours. Rotation keys
are 16-bit.
"""

import io
import json
import struct

import numpy as np

FLOAT, U8, U16, U32, I16, I8 = 5126, 5121, 5123, 5125, 5122, 5120


def tidy(values, digits=6):
    """Plain JSON numbers: rounded, no negative zero."""
    return [round(float(v), digits) + 0.0 for v in values]


def short(values):
    """JSON numbers with the fewest digits that read back as the same values (32-bit floats or integers)."""
    return [float(str(v)) for v in values]


class Glb:
    def __init__(self, generator="Gaitway sample scripts", copyright="CC0 1.0, the Gaitway authors"):
        self.json = {"asset": {"version": "2.0", "generator": generator, "copyright": copyright}, "scene": 0}
        self.bin = bytearray()
        self.known = {}

    def add(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def view(self, data, target=None):
        while len(self.bin) % 4:
            self.bin.append(0)
        view = {"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.bin += data
        return self.add("bufferViews", view)

    def accessor(self, array, kind, component, target=None, normalized=False, bounds=False, pad_to=None):
        """An array (N,) or (N, width). Rows are padded to `pad_to` components where alignment requires it."""
        dtype = {FLOAT: "<f4", U8: "u1", U16: "<u2", U32: "<u4", I16: "<i2", I8: "i1"}[component]
        array = np.ascontiguousarray(array, dtype=dtype)
        stored = array
        if pad_to:
            stored = np.zeros((len(array), pad_to), dtype=dtype)
            stored[:, : array.shape[1]] = array
        view = self.view(stored.tobytes(), target)
        if pad_to:
            self.json["bufferViews"][view]["byteStride"] = stored.strides[0]
        accessor = {"bufferView": view, "componentType": component, "count": len(array), "type": kind}
        if normalized:
            accessor["normalized"] = True
        if bounds:
            rows = array.reshape(len(array), -1)
            accessor["min"], accessor["max"] = short(rows.min(axis=0)), short(rows.max(axis=0))
        return self.add("accessors", accessor)

    def sparse(self, array, tolerance=2e-6, bounds=False):
        """A sparse float VEC3 accessor: only non-zero rows are stored."""
        array = np.asarray(array, dtype="<f4")
        rows = np.nonzero(np.abs(array).max(axis=1) > tolerance)[0]
        accessor = {"componentType": FLOAT, "count": len(array), "type": "VEC3"}
        if len(rows):
            small = len(array) <= 65535
            accessor["sparse"] = {
                "count": len(rows),
                "indices": {"bufferView": self.view(rows.astype("<u2" if small else "<u4").tobytes()), "componentType": U16 if small else U32},
                "values": {"bufferView": self.view(array[rows].tobytes())},
            }
        if bounds:
            kept = np.zeros_like(array)
            kept[rows] = array[rows]
            accessor["min"], accessor["max"] = short(kept.min(axis=0)), short(kept.max(axis=0))
        return self.add("accessors", accessor)

    def _shared(self, array, kind, component, **more):
        """Returns an accessor shared by equal data, such as constant joints and clips of equal length."""
        key = (kind, component, np.ascontiguousarray(array, dtype="<i2" if component == I16 else "<f4").tobytes())
        if key not in self.known:
            self.known[key] = self.accessor(array, kind, component, **more)
        return self.known[key]

    def image(self, pixels, kind="jpeg", quality=85, name=None):
        """`pixels` (H, W, 3 or 4) u8. Returns the texture's index."""
        from PIL import Image

        out = io.BytesIO()
        picture = Image.fromarray(pixels)
        if kind == "jpeg":
            picture.save(out, "JPEG", quality=quality, optimize=True, subsampling=0 if quality > 85 else 2)
        else:
            picture.save(out, "PNG", optimize=True)
        if "samplers" not in self.json:
            self.add("samplers", {"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071})
        entry = {"bufferView": self.view(out.getvalue()), "mimeType": f"image/{kind}"}
        if name:
            entry["name"] = name
        return self.add("textures", {"source": self.add("images", entry), "sampler": 0})

    def primitive(self, positions, normals, indices, material, uv=None, color=None, joints=None, weights=None, targets=(),
                  tangent=None, small=False):
        """`weights` (N, 4) floats; `targets`: [(position deltas, normal deltas or None)].

        With `tangent` (N, 4), normals and tangents are quantized (KHR_mesh_quantization); `small` alone quantizes normals to bytes.
        """
        attributes = {"POSITION": self.accessor(positions, "VEC3", FLOAT, 34962, bounds=True)}
        if tangent is None and not small:
            attributes["NORMAL"] = self.accessor(normals, "VEC3", FLOAT, 34962)
        else:
            for key in ("extensionsUsed", "extensionsRequired"):
                if "KHR_mesh_quantization" not in self.json.get(key, []):
                    self.add(key, "KHR_mesh_quantization")
            if tangent is None:
                attributes["NORMAL"] = self.accessor(np.round(normals * 127), "VEC3", I8, 34962, normalized=True, pad_to=4)
            else:
                attributes["NORMAL"] = self.accessor(np.round(normals * 32767), "VEC3", I16, 34962, normalized=True, pad_to=4)
                attributes["TANGENT"] = self.accessor(np.round(tangent * 127), "VEC4", I8, 34962, normalized=True)
        if uv is not None:
            attributes["TEXCOORD_0"] = self.accessor(
                np.round(np.clip(uv, 0, 1) * 65535), "VEC2", U16, 34962, normalized=True
            )
        if color is not None:
            attributes["COLOR_0"] = self.accessor(
                np.round(np.clip(color, 0, 1) * 255), "VEC3", U8, 34962, normalized=True, pad_to=4
            )
        if joints is not None:
            bytes_, joints = weights_as_bytes(weights, joints)
            attributes["JOINTS_0"] = self.accessor(joints, "VEC4", U8, 34962)
            attributes["WEIGHTS_0"] = self.accessor(bytes_, "VEC4", U8, 34962, normalized=True)
        flat = np.asarray(indices).reshape(-1)
        small = len(positions) < 65535
        primitive = {
            "attributes": attributes,
            "indices": self.accessor(flat, "SCALAR", U16 if small else U32, 34963),
            "material": material,
        }
        for moved, turned in targets:
            target = {"POSITION": self.sparse(moved, bounds=True)}
            if turned is not None:
                target["NORMAL"] = self.sparse(turned, tolerance=2e-3)
            primitive.setdefault("targets", []).append(target)
        return primitive

    def nodes_of(self, skeleton, base_children=None):
        """Adds one node per joint of a rig.Skeleton; returns their indices."""
        first = len(self.json.get("nodes", []))
        for j, name in enumerate(skeleton.names):
            node = {"name": name}
            if np.abs(skeleton.rest_translation[j]).max() > 1e-9:
                node["translation"] = tidy(skeleton.rest_translation[j])
            if abs(skeleton.rest_rotation[j][3]) < 1 - 1e-9:
                node["rotation"] = tidy(skeleton.rest_rotation[j], 7)
            if np.abs(skeleton.rest_scale[j] - 1).max() > 1e-9:
                node["scale"] = tidy(skeleton.rest_scale[j])
            children = [first + k for k, p in enumerate(skeleton.parents) if p == j]
            if children:
                node["children"] = children
            self.add("nodes", node)
        return list(range(first, first + len(skeleton.names)))

    def skin(self, skeleton, nodes, joints, name=None):
        """`joints`: joint indices of the skeleton, in skin order. The mesh is bound at the rest pose."""
        matrices = np.array([np.linalg.inv(skeleton.world_rest[j]) for j in joints])
        skin = {
            "joints": [nodes[j] for j in joints],
            "inverseBindMatrices": self.accessor(
                matrices.transpose(0, 2, 1).reshape(-1, 16), "MAT4", FLOAT
            ),
            "skeleton": nodes[joints[0]],
        }
        if name:
            skin["name"] = name
        return self.add("skins", skin)

    def clip(self, name, nodes, channels):
        """`channels`: [(joint, "rotation" | "translation" | "scale" | "weights", times, values)], all LINEAR."""
        samplers, entries = [], []
        for joint, path, times, values in channels:
            clock = self._shared(np.asarray(times), "SCALAR", FLOAT, bounds=True)
            kind = {"rotation": "VEC4", "weights": "SCALAR"}.get(path, "VEC3")
            values = np.asarray(values, dtype=np.float64)
            if path == "rotation":
                # 16 bits are accurate to 0.004 degrees at half the size.
                output = self._shared(np.round(values * 32767), kind, I16, normalized=True)
            else:
                output = self._shared(values.reshape(-1) if path == "weights" else values, kind, FLOAT)
            samplers.append({"input": clock, "output": output})
            entries.append({"sampler": len(samplers) - 1, "target": {"node": nodes[joint], "path": path}})
        return self.add("animations", {"name": name, "samplers": samplers, "channels": entries})

    def write(self, path, roots):
        self.add("scenes", {"nodes": roots})
        self._share_keys()
        while len(self.bin) % 4:
            self.bin.append(0)
        if self.bin:
            self.json["buffers"] = [{"byteLength": len(self.bin)}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + (8 + len(self.bin) if self.bin else 0)
        with open(path, "wb") as f:
            f.write(struct.pack("<III", 0x46546C67, 2, total))
            f.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
            if self.bin:
                f.write(struct.pack("<II", len(self.bin), 0x004E4942) + self.bin)
        return total

    def _share_keys(self):
        """Merges accessors without a view target (keys, matrices) of equal element size into shared views.

        Otherwise every key track would need its own bufferView in the JSON.
        """
        views, accessors = self.json.get("bufferViews", []), self.json.get("accessors", [])
        images = {i["bufferView"] for i in self.json.get("images", [])}
        sparse = [a["sparse"][k] for a in accessors if "sparse" in a for k in ("indices", "values")]
        images |= {part["bufferView"] for part in sparse}
        plain = [i for i, v in enumerate(views) if "target" not in v and i not in images]
        if not plain:
            return
        old = self.bin
        self.bin = bytearray()
        keep = [i for i in range(len(views)) if i not in plain]
        number = {}
        new = []
        for i in keep:
            v = dict(views[i])
            while len(self.bin) % 4:
                self.bin.append(0)
            data = old[v["byteOffset"] : v["byteOffset"] + v["byteLength"]]
            v["byteOffset"] = len(self.bin)
            self.bin += data
            number[i] = len(new)
            new.append(v)
        groups = {}
        for i in plain:
            users = [a for a in accessors if a.get("bufferView") == i]
            kind = (users[0]["type"], users[0]["componentType"]) if users else ()
            groups.setdefault(kind, []).append(i)
        where = {}
        for members in groups.values():
            while len(self.bin) % 4:
                self.bin.append(0)
            start = len(self.bin)
            for i in members:
                v = views[i]
                where[i] = (len(new), len(self.bin) - start)
                self.bin += old[v["byteOffset"] : v["byteOffset"] + v["byteLength"]]
            new.append({"buffer": 0, "byteOffset": start, "byteLength": len(self.bin) - start})
        for part in sparse:
            part["bufferView"] = number[part["bufferView"]]
        for a in accessors:
            if "bufferView" not in a:
                continue
            i = a["bufferView"]
            if i in where:
                a["bufferView"], offset = where[i]
                if offset:
                    a["byteOffset"] = offset
            else:
                a["bufferView"] = number[i]
        for image in self.json.get("images", []):
            image["bufferView"] = number[image["bufferView"]]
        self.json["bufferViews"] = new


def weights_as_bytes(weights, joints):
    """(N, 4) floats -> u8 that sum to exactly 255 (the largest takes the rounding); joints of zero weights become 0."""
    weights = weights / weights.sum(axis=1, keepdims=True)
    bytes_ = np.floor(weights * 255 + 0.5).astype(int)
    rows = np.arange(len(weights))
    bytes_[rows, weights.argmax(axis=1)] += 255 - bytes_.sum(axis=1)
    joints = np.where(bytes_ > 0, joints, 0)
    return bytes_.astype(np.uint8), joints.astype(np.uint8)
