"""Imports a BVH with Blender and prints how far its joints are from those of `gaitway pose`, in metres.

Usage: blender.py FILE.bvh GAITWAY MODEL CLIP
"""

import json
import subprocess
import sys

import bpy

bvh, gaitway, model, clip = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath=bvh, axis_forward="Y", axis_up="Z", frame_start=1, rotate_mode="NATIVE")
armature = bpy.context.object
header = open(bvh, encoding="utf-8").read().split("MOTION")[1].split("\n")
count, frame_secs = int(header[1].split()[1]), float(header[2].split()[2])
compared, worst = 0, 0.0
for frame in sorted({0, 1, count // 3, count // 2, count - 1}):
    bpy.context.scene.frame_set(1 + frame)
    command = [gaitway, "pose", model, "--clip", clip, "--time", str(frame * frame_secs), "--json"]
    pose = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    world = {node["name"].replace(" ", "_"): node["world"][12:15] for node in pose["nodes"]}
    for bone in armature.pose.bones:
        if bone.name in world:
            place = armature.matrix_world @ bone.head
            compared += 1
            worst = max(worst, max(abs(a - b) for a, b in zip(place, world[bone.name])))
print(json.dumps({"compared": compared, "worst": worst}))
