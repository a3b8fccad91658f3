"""Retargets every BVH file of a folder to a model with Ray Data, on one machine or a cluster.

    python ray_folder.py hero.glb mocap/ retargeted/

Workers share the folders, as on a network drive. Each loads the model once.
"""

import sys
from pathlib import Path

import ray

import gaitway


class Retarget:
    """Retargets one motion after another, in a worker of its own."""

    def __init__(self, model: str, out: str) -> None:
        """Loads the model, which can't be sent from one process to another."""
        self.model = gaitway.load_model(model)
        self.out = Path(out)

    def __call__(self, row: dict) -> dict:
        """Writes the clip and returns its figures, or why there is none."""
        motion = Path(row["motion"])
        out = self.out / motion.with_suffix(".glb").name
        line = {"motion": str(motion), "out": str(out), "limb_error_degrees": None, "error": None}
        try:
            result = gaitway.retarget(self.model, gaitway.load_motion(motion))
            result.clip.write(out)
            line["limb_error_degrees"] = result.figures["limb_direction_error_degrees_mean"]
        except gaitway.Error as error:
            line["error"] = str(error)
        return line


def retarget_folder(model: Path, folder: Path, out: Path, workers: int = 2) -> "ray.data.Dataset":
    """Returns a data set with a row for each motion. Rows are computed when they are read."""
    out.mkdir(parents=True, exist_ok=True)
    motions = ray.data.from_items([{"motion": str(path)} for path in sorted(folder.glob("*.bvh"))])
    # Each actor retargets on one core.
    actors = ray.data.ActorPoolStrategy(size=workers)
    return motions.map(Retarget, fn_constructor_args=(str(model), str(out)), compute=actors, num_cpus=1)


if __name__ == "__main__":
    retarget_folder(*map(Path, sys.argv[1:4])).write_json("results")
