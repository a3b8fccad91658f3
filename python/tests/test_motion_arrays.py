"""Arrays that motion models write, made and evaluated with NumPy: independently of the reader."""

from pathlib import Path

import numpy as np
import pytest

import gaitway

PARENTS = [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19]
FRAMES = 40


def matrices(turns: np.ndarray) -> np.ndarray:
    """Rotation matrices of axes times angles (Rodrigues)."""
    angle = np.linalg.norm(turns, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(turns, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(*x.shape, 3, 3)
    return np.eye(3) + np.sinc(angle / np.pi) * cross + np.sinc(angle / 2 / np.pi) ** 2 / 2 * cross @ cross


def placed(local: np.ndarray, bones: np.ndarray, path: np.ndarray) -> np.ndarray:
    """Positions of the joints: frames × joints × 3."""
    world, positions = [local[:, 0]], [path]
    for joint in range(1, len(PARENTS)):
        parent = PARENTS[joint]
        positions.append(positions[parent] + world[parent] @ bones[joint])
        world.append(world[parent] @ local[:, joint])
    return np.stack(positions, 1)


@pytest.fixture
def person() -> tuple[np.ndarray, np.ndarray]:
    """Rotations of a body whose left side mirrors its right one, and where that puts its joints."""
    rest = np.zeros((22, 3))
    rest[[1, 4, 7, 10, 13, 16, 18, 20], 0] = [0.1, 0.02, 0, 0.02, 0.08, 0.12, 0.27, 0.25]
    rest[[1, 4, 7, 10, 13], 1] = [-0.08, -0.4, -0.41, -0.06, 0.1]
    rest[10, 2] = 0.13
    rest[[2, 5, 8, 11, 14, 17, 19, 21]] = rest[[1, 4, 7, 10, 13, 16, 18, 20]] * [-1, 1, 1]
    rest[[3, 6, 9, 12, 15], 1] = [0.12, 0.13, 0.06, 0.2, 0.1]
    time = np.arange(FRAMES)[:, None, None] / 20
    turns = 0.3 * np.sin(2 * time + np.arange(66).reshape(22, 3))
    turns[:, [4, 5], 0] += 0.6
    turns[:, 18, 1] -= 0.6
    turns[:, 19, 1] += 0.6
    turns[:, 0, 1] += time[:, 0, 0]
    path = np.stack([time[:, 0, 0] * 0.5, np.full(FRAMES, 0.95), 0.1 * np.sin(time[:, 0, 0])], 1)
    local = matrices(turns)
    return local, placed(local, rest, path)


def positions_in(clip: gaitway.Clip, motion: gaitway.Motion, frames_per_sec: int) -> np.ndarray:
    """Positions in the order of the arrays: the motion lists children after their parents."""
    return clip.sample(np.arange(FRAMES) / frames_per_sec)[0][:, np.argsort(motion.nodes)]


@pytest.mark.parametrize("order", ["tjc", "jct", "ctj"])
@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_positions_alone(tmp_path: Path, person, order: str, kind: type) -> None:
    _, positions = person
    path = tmp_path / "motion.npy"
    np.save(path, np.einsum(f"tjc->{order}", positions).astype(kind))
    motion = gaitway.load_motion(path)
    [clip] = motion.clips
    assert (clip.frames_per_sec, len(motion.joints)) == (20, 22)
    assert positions_in(clip, motion, 20) == pytest.approx(positions, abs=1e-5)
    assert "positions of 22 joints in 40 frames" in motion.inspect()["generator"]


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("rot6d", lambda local: local[..., :2].reshape(FRAMES, 22, 6)),
        ("rot6d", lambda local: local[..., :2].swapaxes(-1, -2).reshape(FRAMES, 22, 6)),
        ("thetas", lambda local: local[..., :2, :].reshape(FRAMES, 22, 6)),
        ("local_rot_mats", lambda local: local[None]),
    ],
)
def test_rotations_besides_positions(tmp_path: Path, person, name: str, write) -> None:
    local, positions = person
    path = tmp_path / "motion.npz"
    np.savez_compressed(path, **{name: write(local)}, posed_joints=positions, fps=30)
    motion = gaitway.load_motion(path)
    [clip] = motion.clips
    assert clip.frames_per_sec == 30
    assert positions_in(clip, motion, 30) == pytest.approx(positions, abs=1e-5)


def test_samples_are_clips_and_pickles_are_refused(tmp_path: Path, person) -> None:
    _, positions = person
    # As MDM has it: samples × joints × 3 × frames.
    samples = np.stack([positions, positions[::-1]]).transpose(0, 2, 3, 1)
    path = tmp_path / "results.npy"
    np.save(path, {"motion": samples, "text": ["walk"] * 2}, allow_pickle=True)
    with pytest.raises(gaitway.Error, match=r"results\.npy: .*pickled Python objects.*\[\"motion\"\]"):
        gaitway.load_motion(path)
    # What the message says to do.
    np.save(tmp_path / "motion.npy", np.load(path, allow_pickle=True).item()["motion"])
    motion = gaitway.load_motion(tmp_path / "motion.npy")
    first, second = motion.clips
    assert positions_in(first, motion, 20) == pytest.approx(positions, abs=1e-5)
    assert positions_in(second, motion, 20) == pytest.approx(positions[::-1], abs=1e-5)
