# Types of the package; `help(gaitway)` has the documentation.
from collections.abc import Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

_Path: TypeAlias = str | PathLike[str]
_Space: TypeAlias = Literal["model", "parent"]
_RootPart: TypeAlias = Literal["keep", "in-place", "freeze"]
_Keep: TypeAlias = Literal["auto", "keep", "drop"]
_Rest: TypeAlias = Literal["auto", "node", "bind", "first-frame"]

class Error(ValueError):
    file: str | None
    where: str | None
    expected: str | None
    found: str | None
    hint: str | None

class File:
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def parents(self) -> NDArray[np.int32]: ...
    @property
    def nodes(self) -> NDArray[np.int32]: ...
    @property
    def clips(self) -> list[Clip]: ...
    def rest(self, space: _Space = "model") -> tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    def inspect(self) -> dict[str, Any]: ...

class Model(File):
    def write(self, path: _Path, clips: Sequence[Clip] = ...) -> None: ...
    def export(
        self,
        path: _Path,
        motions: Sequence[Motion] = ...,
        map: dict[str, Any] | _Path | None = None,
        **options: Unpack[ExportOptions],
    ) -> dict[str, Any]: ...

class Motion(File):
    @staticmethod
    def from_arrays(
        file: File,
        times: ArrayLike,
        rotations: ArrayLike,
        translations: ArrayLike | None = None,
        *,
        name: str = "arrays",
    ) -> Motion: ...

class Clip:
    @property
    def name(self) -> str: ...
    @property
    def duration_secs(self) -> float: ...
    @property
    def frames_per_sec(self) -> float: ...
    @property
    def key_times(self) -> NDArray[np.float32]: ...
    def sample(self, times: ArrayLike, space: _Space = "model") -> tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    def matrices(self, times: ArrayLike) -> NDArray[np.float32]: ...
    def write(self, path: _Path) -> None: ...

class Retargeted:
    @property
    def clip(self) -> Clip: ...
    @property
    def figures(self) -> dict[str, Any]: ...
    @property
    def report(self) -> dict[str, Any]: ...

class Scene:
    @property
    def html(self) -> str: ...
    def write(self, path: _Path) -> None: ...

class ExportOptions(TypedDict, total=False):
    clips: str | list[str] | None
    rename: dict[str, str] | None
    fewer_keys: bool | tuple[float, float]
    root_bone: bool
    root_height: bool
    in_place: str | list[str] | None
    for_: Literal["unity", "unreal", "godot", "blender", "web", "vrm", "as-is"] | None
    format: Literal["glb", "bvh", "vrma"] | None

class RetargetOptions(TypedDict, total=False):
    clip: str | int | None
    horizontal: _RootPart | None
    vertical: _RootPart | None
    yaw: _RootPart | None
    extract_root: bool
    origin: Literal["rest", "feet"] | None
    feet: Literal["off", "plant"] | None
    contacts: Literal["off", "keep"] | None
    translations: _Keep | None
    scales: _Keep | None
    rest_model: _Rest | None
    rest_motion: _Rest | None
    up: Literal["auto", "y", "z"] | None
    unmapped: str | int | None
    name: str | None
    mirror: bool
    trim: tuple[float, float] | None
    reverse: bool
    speed: float | None
    make_loop: float | None
    offset: tuple[float, float] | None
    turn: float | None
    layer: list[str] | None
    pin: list[str] | None
    loops: int | None

def load_model(*paths: _Path) -> Model: ...
def load_motion(path: _Path) -> Motion: ...
def propose_map(model: Model, motion: Motion) -> dict[str, Any]: ...
def retarget(
    model: Model, motion: Motion, map: dict[str, Any] | _Path | None = None, **options: Unpack[RetargetOptions]
) -> Retargeted: ...
def show(
    model: Model,
    motion: Motion | None = None,
    *,
    clip: str | int | None = None,
    view: str | None = None,
    map: dict[str, Any] | _Path | None = None,
    title: str | None = None,
    renderer: Literal["webgl2", "webgpu"] = "webgl2",
    height: int = 480,
    file: _Path | None = None,
    page: _Path | None = None,
) -> Scene: ...
