"""Assets: opening, inspecting, maps and meshes as arrays, encoding."""

from __future__ import annotations

import builtins
import json
import os
from typing import Any, Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np

from . import native
from .native import Error, Limits, Result, Source, check, core, ffi

MAPS: Dict[str, Tuple[int, int]] = {
    "height": (0, 1), "trim": (1, 1), "normal": (2, 2), "color": (3, 4), "material": (4, 4),
    "emission": (5, 3)}
"""Names of the maps: the number of each in C, and its channels."""

PATCH = np.dtype([
    ("origin", "<f4", 3), ("extent_x", "<f4"), ("axis_x", "<f4", 3), ("extent_y", "<f4"),
    ("axis_y", "<f4", 3), ("extent_z", "<f4"), ("axis_z", "<f4", 3), ("coverage", "<f4"),
    ("page", "<u4"), ("rect", "<u2", 4), ("dilation", "<u2"), ("flags", "<u2"),
    ("sphere", "<f4", 4), ("source_triangles", "<u4"), ("reserved", "<u4", 7)])
"""The record of a patch: `gtx_patch` of geotex.h, 128 bytes."""


class Info(NamedTuple):
    """What an asset's header says. Lengths are in object units, relative to `anchor`."""

    version: Tuple[int, int]          # of the format
    patch_count: int
    page_count: int
    page_width: int                   # texels, at level 0
    page_height: int
    mip_count: int                    # levels of every map but height and trim
    height_bits: int                  # 8 or 16
    has_color: bool
    has_material: bool
    has_emission: bool
    lod_levels: int
    bounds_min: Tuple[float, float, float]
    bounds_max: Tuple[float, float, float]
    unit: float                       # metres per object unit
    emission_scale: float
    anchor: Tuple[float, float, float]
    source_triangles: int
    content_hash: int
    file_size: int                    # bytes that were opened, 0 for an asset made in memory


class LodMesh(NamedTuple):
    """The surface as triangles."""

    positions: np.ndarray             # (vertices, 3) float32, object units, relative to the anchor
    indices: np.ndarray               # (triangles, 3) uint32; read-only, the asset's own memory
    first: np.ndarray                 # (patches + 1,) uint32: triangles first[p]:first[p + 1] are
                                      # of patch p; read-only, the asset's own memory
    error: float                      # distance from the source, object units
    far: bool                         # a triangle may be larger than its patch


class Issue(NamedTuple):
    """A broken rule of format/gtx.md."""

    rule: int
    name: str
    message: str
    is_error: bool                    # else a warning
    offset: int                       # the byte of the file


class Asset:
    """An asset in memory, checked; it never changes, and any number of threads may read it.

    Arrays that are said to be the asset's own memory are not copied and read-only; they keep the
    memory alive after the Asset has gone."""

    def __init__(self, pointer: Any) -> None:
        self._pointer = ffi.gc(pointer, core.gtx_close)
        told = ffi.new("gtx_info *")
        core.gtx_get_info(self._pointer, told)
        flags = {name: bool(getattr(told, name))
                 for name in ("has_color", "has_material", "has_emission")}
        vectors = {name: tuple(getattr(told, name))
                   for name in ("bounds_min", "bounds_max", "anchor")}
        plain = {name: getattr(told, name) for name in Info._fields
                 if name != "version" and name not in flags and name not in vectors}
        self._info = Info(version=(told.version_major, told.version_minor), **flags, **vectors,
                          **plain)
        self._caster: Any = None

    @property
    def info(self) -> Info:
        return self._info

    @property
    def patches(self) -> np.ndarray:
        """The patches' records, (patch_count,) of dtype PATCH: the asset's own memory.

        Texel (i, j) of a patch's w x h rectangle with height code c > 0 lies at
            origin + (i + .5) / w * extent_x * axis_x + (j + .5) / h * extent_y * axis_y
                   + (c - 1) / (2^bits - 2) * extent_z * axis_z"""
        return native.array_of(core.gtx_patches(self._pointer), PATCH, (self.info.patch_count,),
                               self._pointer)

    @property
    def frames(self) -> np.ndarray:
        """The patches' frames as matrices, (patch_count, 4, 4) float64, made anew: each takes
        (x, y, z, 1), 0..1 along the sides of the box, to object units relative to the anchor."""
        patches = self.patches
        out = np.zeros((len(patches), 4, 4))
        for k, axis in enumerate("xyz"):
            out[:, :3, k] = patches["axis_" + axis] * patches["extent_" + axis][:, None]
        out[:, :3, 3] = patches["origin"]
        out[:, 3, 3] = 1
        return out

    def map(self, name: str, level: int = 0) -> Optional[np.ndarray]:
        """A level of the map `name` of MAPS: the asset's own memory; None if it has no such map.

        (page_count, page_height >> level, page_width >> level) for "height" (uint8, or uint16 for
        heights of 16 bits; codes, 0 is empty) and "trim" (uint8, (c - 128) / 16 texels outside the
        outline), which have level 0 alone; and with one axis more for the channels, all uint8:
        "normal" 2 (hemi-octahedral in the patch's frame), "color" 4 (sRGB, linear alpha),
        "material" 4 (occlusion, roughness, metallic, share of lighting), "emission" 3 (sRGB).
        Raises KeyError, IndexError."""
        number, channels = MAPS[name]
        info = self.info
        if not 0 <= level < (1 if number < 2 else info.mip_count):
            raise IndexError(f"the map {name!r} has no level {level}")
        data = core.gtx_map_data(self._pointer, number, level, ffi.NULL)
        if not data:
            return None
        shape: Tuple[int, ...] = (info.page_count, info.page_height >> level,
                                  info.page_width >> level)
        kind = "<u2" if name == "height" and info.height_bits == 16 else "u1"
        return native.array_of(data, kind, shape + (channels,) * (channels > 1), self._pointer)

    def patch_map(self, patch: int, name: str, level: int = 0) -> Optional[np.ndarray]:
        """One patch's part of a map, (h, w) or (h, w, channels): the asset's own memory. From level
        1 on, the texels that its rectangle covers."""
        pages = self.map(name, level)
        if pages is None:
            return None
        record = self.patches[patch]
        x, y, w, h = (int(side) for side in record["rect"])
        x, y, right, bottom = x >> level, y >> level, -(-(x + w) >> level), -(-(y + h) >> level)
        return pages[record["page"], y:bottom, x:right]

    def points(self, patch: int) -> np.ndarray:
        """Where the texels of a patch lie, (h, w, 3) float64 in object units relative to the
        anchor, made anew; NaN where they are empty."""
        codes = self.patch_map(patch, "height")
        assert codes is not None  # every asset has heights
        h, w = codes.shape
        at = np.empty((h, w, 4))
        at[..., 0] = (np.arange(w) + 0.5) / w
        at[..., 1] = ((np.arange(h) + 0.5) / h)[:, None]
        at[..., 2] = np.where(codes, (codes - 1.0) / (2 ** self.info.height_bits - 2), np.nan)
        at[..., 3] = 1
        return at @ self.frames[patch].T[:, :3]

    def lod_mesh(self, level: int = 0) -> LodMesh:
        """LOD mesh `level`, 0 being the finest. Raises IndexError."""
        if not 0 <= level < self.info.lod_levels:
            raise IndexError(f"there is no LOD mesh {level}")
        mesh = ffi.new("gtx_lod_mesh *")
        check(core.gtx_get_lod_mesh(self._pointer, level, mesh))
        own = self._pointer
        codes = native.array_of(mesh.positions, "<u2", (mesh.vertex_count, 3), own)
        origin = np.array(list(mesh.origin), np.float32)
        return LodMesh(
            origin + np.float32(mesh.step) * codes.astype(np.float32),
            native.array_of(mesh.indices, "<u4", (mesh.triangle_count, 3), own),
            native.array_of(mesh.first, "<u4", (self.info.patch_count + 1,), own),
            mesh.error, bool(mesh.flags & 1))

    @property
    def meta(self) -> Any:
        """What the META section says, from its JSON; None when absent. Informative."""
        size = ffi.new("size_t *")
        text = core.gtx_meta(self._pointer, size)
        return json.loads(ffi.buffer(text, size[0])[:]) if text else None

    def raycast(self, origins: Any, directions: Any, **options: Any) -> np.ndarray:
        """Caster.raycast at the finest level; the caster is made once and kept."""
        from .rays import Caster
        if self._caster is None:
            self._caster = Caster(self)
        return self._caster.raycast(origins, directions, **options)

    def encode(self, *, zstd: int = 6) -> bytes:
        """The bytes of a .gtx file; `zstd` 0 stores them, 1..19 compresses."""
        desc, data, size = ffi.new("gtx_encode_desc *"), ffi.new("void **"), ffi.new("size_t *")
        error = native.new_error()
        desc.zstd_level = zstd or -1  # to C, 0 is the default
        check(core.gtx_encode(self._pointer, desc, data, size, error), error)
        try:
            return ffi.buffer(data[0], size[0])[:]
        finally:
            native.free(data[0])

    def save(self, path: Union[str, "os.PathLike[str]"], *, zstd: int = 6) -> None:
        """Writes a .gtx file: whole, or not at all."""
        desc, error = ffi.new("gtx_encode_desc *"), native.new_error()
        desc.zstd_level = zstd or -1  # to C, 0 is the default
        check(core.gtx_save_file(self._pointer, native.path_of(path), desc, error), error)

    def __repr__(self) -> str:
        return (f"<geotex.Asset: {self.info.patch_count} patches, {self.info.page_count} pages of "
                f"{self.info.page_width} x {self.info.page_height}>")


def open(source: Source, *, limits: Optional[Limits] = None) -> Asset:
    """Opens a .gtx file, or a GLB that holds an asset, from a path or from its bytes, which are
    not needed afterwards. Every rule of the format is checked.

    limits: {"memory": bytes, "texels": n, "patches": n}; what is left out has its default, which
            grows with the bytes that are read. Raises Error."""
    desc, error, out = ffi.new("gtx_open_desc *"), native.new_error(), ffi.new("gtx_asset **")
    native.fill_limits(desc.limits, limits)
    if native.is_path(source):
        path = native.path_of(source)  # type: ignore[arg-type]
        result = core.gtx_open_file(path, desc, out, error)
        if result == Result.NOT_GTX and _is_glb(path):
            result = native.cook_library().gtx_open_exported(path, desc, out, error)
    else:
        data = native.bytes_of(source)
        start, size = ffi.cast("const void *", data), len(data)
        if ffi.buffer(data)[:4] == b"glTF":
            found, length = ffi.new("const void **"), ffi.new("size_t *")
            check(native.cook_library().gtx_find_asset(start, size, found, length, error), error)
            start, size = found[0], length[0]
        result = core.gtx_open_memory(start, size, desc, out, error)
    check(result, error)
    return Asset(out[0])


def _is_glb(path: bytes) -> bool:
    try:
        with builtins.open(path, "rb") as file:
            return file.read(4) == b"glTF"
    except OSError:
        return False


def validate(source: Source, *, limits: Optional[Limits] = None) -> List[Issue]:
    """Checks the bytes of a .gtx file against every rule of the format: what is broken, in the
    order of the specification; an empty list for a sound file. Raises Error where it cannot be
    told, such as for a file that cannot be read or passes a limit."""
    if native.is_path(source):
        try:
            with builtins.open(native.path_of(source), "rb") as file:  # type: ignore[arg-type]
                source = file.read()
        except OSError as why:
            raise Error(str(why), Result.READ) from why
    issues: List[Issue] = []

    @ffi.callback("gtx_issue_fn")
    def keep(issue: Any, _user: Any) -> None:
        issues.append(Issue(issue.rule, native.text_of(issue.name) or "",
                            native.text_of(issue.message) or "", bool(issue.is_error),
                            issue.offset))

    struct, error = ffi.new("gtx_limits *"), native.new_error()
    native.fill_limits(struct, limits)
    data = native.bytes_of(source)
    result = core.gtx_validate(ffi.cast("const void *", data), len(data), struct, keep, ffi.NULL,
                               error)
    if result and not any(issue.is_error for issue in issues):
        check(result, error)
    return issues
