"""Poses as arrays: the numbers of `gaitway pose`, and clips from arrays."""

import numpy as np
import pytest
from support import MODEL, MOTION, cli

import gaitway

# Smallest difference of positions that isn't rounding, in metres.
TOLERANCE = 2e-6


def turned(rotation: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Applies quaternions x y z w to vectors."""
    axis, real = rotation[..., :3], rotation[..., 3:]
    twice = 2 * np.cross(axis, vector)
    return vector + real * twice + np.cross(axis, twice)


def product(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Multiplies quaternions x y z w."""
    (a, s), (b, t) = (first[..., :3], first[..., 3:]), (second[..., :3], second[..., 3:])
    return np.concatenate([s * b + t * a + np.cross(a, b), s * t - (a * b).sum(-1, keepdims=True)], axis=-1)


def same_rotations(first: np.ndarray, second: np.ndarray) -> bool:
    return bool((np.abs((first * second).sum(-1)) > 1 - 1e-5).all())


@pytest.mark.parametrize("time", [0.0, 0.37, 99.0])
def test_poses_are_those_of_the_command_line(model: gaitway.Model, motion: gaitway.Motion, time: float) -> None:
    clip = gaitway.retarget(model, motion).clip
    positions, _ = clip.sample([time])
    matrices = clip.matrices([time])
    nodes = cli("pose", MODEL, "--motion", MOTION, "--time", time)["nodes"]
    world = np.array([nodes[node]["world"] for node in model.nodes]).reshape(-1, 4, 4).transpose(0, 2, 1)
    assert [nodes[node]["name"] for node in model.nodes] == model.joints
    assert matrices[0] == pytest.approx(world, abs=TOLERANCE)
    assert positions[0] == pytest.approx(world[:, :3, 3], abs=TOLERANCE)


def test_the_rest_pose(model: gaitway.Model) -> None:
    nodes = cli("pose", MODEL)["nodes"]
    positions, rotations = model.rest()
    assert positions == pytest.approx(np.array([nodes[node]["world"][12:15] for node in model.nodes]), abs=TOLERANCE)
    assert np.linalg.norm(rotations, axis=-1) == pytest.approx(1)


def test_model_space_follows_from_parents(motion: gaitway.Motion) -> None:
    [clip] = motion.clips
    times = np.linspace(0, clip.duration_secs, 7)
    positions, rotations = clip.sample(times)
    locals_, local_rotations = clip.sample(times, space="parent")
    for joint, parent in enumerate(motion.parents):
        if parent < 0:
            assert positions[:, joint] == pytest.approx(locals_[:, joint])
            continue
        placed = positions[:, parent] + turned(rotations[:, parent], locals_[:, joint])
        assert positions[:, joint] == pytest.approx(placed, abs=TOLERANCE)
        assert same_rotations(rotations[:, joint], product(rotations[:, parent], local_rotations[:, joint]))


def test_arrays_own_what_was_sampled(motion: gaitway.Motion) -> None:
    [clip] = motion.clips
    times, joints = [0, 0.1, 0.2], len(motion.joints)
    positions, rotations = clip.sample(times)
    assert positions.dtype == rotations.dtype == clip.matrices(times).dtype == np.float32
    assert (positions.shape, rotations.shape) == ((3, joints, 3), (3, joints, 4))
    assert clip.matrices(np.array(times, np.float32)).shape == (3, joints, 4, 4)
    assert clip.sample([])[0].shape == (0, joints, 3)
    # They wrap the vectors that Rust sampled into, and can be changed.
    for array in (positions, rotations, clip.matrices(times)):
        assert not array.flags.owndata
        assert array.flags.writeable
        assert array.flags.c_contiguous
    positions += 1


def test_clips_from_arrays(model: gaitway.Model, motion: gaitway.Motion, tmp_path) -> None:
    [clip] = motion.clips
    positions, rotations = clip.sample(clip.key_times, space="parent")
    again = gaitway.Motion.from_arrays(motion, clip.key_times, rotations, positions, name="again")
    [same] = again.clips
    assert (same.name, same.duration_secs) == ("again", clip.duration_secs)
    times = np.linspace(0, clip.duration_secs, 50)
    assert same.sample(times)[0] == pytest.approx(clip.sample(times)[0], abs=TOLERANCE)
    figures = gaitway.retarget(model, motion).figures
    assert gaitway.retarget(model, again).figures == pytest.approx(figures, rel=1e-3, abs=1e-3)
    # A clip of the model's own joints is written with it.
    own = gaitway.retarget(model, motion).clip
    held = gaitway.Motion.from_arrays(
        model, [0, 1], own.sample([0.2, 0.2], "parent")[1].astype(np.float64), name="held"
    )
    model.write(tmp_path / "held.glb", held.clips)
    written = gaitway.load_model(tmp_path / "held.glb").clips[-1]
    assert (written.name, written.duration_secs) == ("held", 1)
    assert same_rotations(written.sample([0.5], "parent")[1], own.sample([0.2], "parent")[1])


def test_arrays_that_are_not_clips(motion: gaitway.Motion) -> None:
    rotations = np.tile(motion.rest("parent")[1], (2, 1, 1))
    positions = np.tile(motion.rest("parent")[0], (2, 1, 1))

    def check(message: str, times=(0, 1), rotations=rotations, positions=None) -> None:
        with pytest.raises(gaitway.Error, match=message):
            gaitway.Motion.from_arrays(motion, times, rotations, positions)

    joints = len(motion.joints)
    check(rf"rotations: expected .* \[3, {joints}, 4\], found \[2, {joints}, 4\]", times=[0, 1, 2])
    check(rf"translations: expected .* \[2, {joints}, 3\]", positions=positions[:, 1:])
    check("times: key 1 at 0 s does not come after", times=[0, 0])
    check("times: key 0: expected a non-negative time", times=[-1, 0])
    check("times: expected finite numbers of seconds, found NaN", times=[0, np.nan])
    check("times: there are no keys", times=[], rotations=rotations[:0])
    bad = rotations.copy()
    bad[1, 2] = 0
    check(r"rotations\[1, 2\]: expected a quaternion", rotations=bad)
    bad = positions.copy()
    bad[0, 3, 1] = np.inf
    check(r"translations\[0, 3\]: expected finite numbers", positions=bad)
    with pytest.raises(gaitway.Error, match="space: expected “model” or “parent”, found “world”"):
        motion.rest("world")
    with pytest.raises((TypeError, ValueError)):
        motion.clips[0].sample("soon")
    with pytest.raises(gaitway.Error, match="finite"):
        motion.clips[0].sample([np.inf])
