"""Imports an FBX of --for blender with Blender and prints how far its bones are from the joints of `gaitway pose`, in metres.

Usage: blender_fbx.py FILE.fbx GAITWAY MODEL
"""

import json
import math
import subprocess
import sys

import bpy

fbx, gaitway, model = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.fbx(filepath=fbx)
scene = bpy.context.scene
armatures = [item for item in scene.objects if item.type == "ARMATURE"]
objects = []
for item in armatures:
    objects.append({"name": item.name, "scale": max(item.matrix_local.to_scale())})


def is_of(action, armature, clip):
    """Whether an action, called after the armature and the take, is a clip of the armature."""
    owner, *names = action.name.split("|")
    return owner == armature.name and clip["name"] in names


clips = json.loads(subprocess.run([gaitway, "inspect", model, "--json"], capture_output=True, text=True, check=True).stdout)["clips"]
compared, worst = 0, 0.0
for index, clip in enumerate(clips[:3]):
    for armature in armatures:
        actions = [action for action in bpy.data.actions if is_of(action, armature, clip)]
        if actions:
            armature.animation_data_create()
            armature.animation_data.action = actions[0]
    keys = sorted({round(point.co.x, 4) for action in actions for curve in action.fcurves for point in curve.keyframe_points})
    # Between keys, Blender's importer joins quaternions by lines.
    for frame in {keys[0], keys[len(keys) // 3], keys[len(keys) // 2], keys[-1]} if keys else {}:
        scene.frame_set(math.floor(frame), subframe=frame % 1)
        secs = (frame - 1) * scene.render.fps_base / scene.render.fps
        command = [gaitway, "pose", model, "--clip", str(index), "--time", str(max(secs, 0.0)), "--json"]
        nodes = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["nodes"]
        world = {node["name"]: node["world"][12:15] for node in nodes}
        for armature in armatures:
            for bone in armature.pose.bones:
                if bone.name in world:
                    x, y, z = world[bone.name]
                    place = armature.matrix_world @ bone.head
                    compared += 1
                    worst = max(worst, abs(place.x - x), abs(place.y + z), abs(place.z - y))
print(json.dumps({"compared": compared, "worst": worst, "objects": objects}))
