"""Reads a model with assimp and prints its number of triangles and the size of its vertices' box.

Usage: assimp_fbx.py FILE
"""

import json
import sys

import assimp_py

scene = assimp_py.import_file(sys.argv[1], assimp_py.Process_Triangulate)
triangles = sum(len(mesh.indices) // 3 for mesh in scene.meshes)
low, high = [float("inf")] * 3, [float("-inf")] * 3
for mesh in scene.meshes:
    values = list(mesh.vertices)
    points = values if values and not isinstance(values[0], float) else list(zip(*[iter(values)] * 3))
    for axis in range(3):
        low[axis] = min([low[axis], *(point[axis] for point in points)])
        high[axis] = max([high[axis], *(point[axis] for point in points)])
print(json.dumps({"triangles": triangles, "size": [top - bottom for top, bottom in zip(high, low)]}))
