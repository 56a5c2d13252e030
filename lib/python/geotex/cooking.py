"""Cooking models and height grids, comparing, exporting: libgeotex-cook."""

from __future__ import annotations

import json
import os
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import native
from .asset import Asset
from .native import Limits, ProgressFn, Source, Watch, cook_library, ffi

Path = Union[str, "os.PathLike[str]"]

_PARTITIONS = {name: k + 1 for k, name in
               enumerate(("cuts", "vsa", "pgp", "layers", "relief", "auto"))}
_EXTRACT = {"cpu": 1, "gpu": 2}
_COLORS = {"viridis": 0, "rainbow": 1, "none": 2}
_LOD_LEVELS_NONE = 0xffffffff
_TEXEL_DENSITY_RELIEF = -1.0


class Warned(NamedTuple):
    """What a call warned of, or noted."""

    name: str                         # what kind it is, such as "open-edges"
    sentence: str
    is_note: bool                     # of what is as it should be in many models


class Report(NamedTuple):
    """What a call did."""

    data: Dict[str, Any]              # the report; its schema is in format/
    summary: str                      # one line
    warnings: List[Warned]
    sources: List[str]                # the files behind the models
    unchanged: bool                   # if_changed, and the output was left alone


class Comparison(NamedTuple):
    """The figures that a build may put limits on; format/measures.md has the rules of each."""

    hole_pixels: int
    wall_pixels: int
    turned_pixels: int
    surface_pixels: int
    silhouette_iou: float
    silhouette_iou_min: float
    forward_rms: float                # fractions of the source's bounding diagonal
    reverse_max: float
    seam_p99_steps: float             # gaps between patches, in height steps
    seam_max_steps: float
    report: Report


class Grid(NamedTuple):
    """Values at the nodes of a lattice. Node values[j, i] lies at
    origin + R(rotation) (i * spacing[0], j * spacing[1]), x to the east and y to the north."""

    values: np.ndarray                # (ny, nx) float32, NaN where there is none
    origin: Tuple[float, float] = (0.0, 0.0)
    spacing: Tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0             # degrees, counter-clockwise
    property: Optional[np.ndarray] = None   # likewise, the values to colour by
    in_degrees: bool = False          # origin and spacing, but not the values: horizons refuses
    categories: bool = False          # the values to colour by are kinds, which a legend names


def _read(report: Any) -> Report:
    """Copies a report and frees it."""
    try:
        first_note = report.warning_count - report.note_count
        warnings = [Warned(native.text_of(report.warning_names[k]) or "",
                           native.text_of(report.warnings[k]) or "", k >= first_note)
                    for k in range(report.warning_count)]
        sources = [os.fsdecode(ffi.string(report.sources[k])) for k in range(report.source_count)]
        data = json.loads(ffi.buffer(report.json, report.size)[:]) if report.json else {}
        return Report(data, native.text_of(report.summary) or "", warnings, sources,
                      bool(report.unchanged))
    finally:
        cook_library().gtx_report_free(report)


def _names(paths: Sequence[bytes]) -> Tuple[Any, List[Any]]:
    """An array of strings, and what must stay alive with it."""
    kept = [ffi.new("char[]", path) for path in paths]
    return ffi.new("const char *[]", kept or [ffi.NULL]), kept


def _call(desc: Any, progress: Optional[ProgressFn], limits: Optional[Limits],
          call: Callable[[Any, Any], int]) -> Report:
    """Makes a call that takes long, with another thread's Python going on meanwhile."""
    native.fill_limits(desc.limits, limits)
    report, error = ffi.new("gtx_report *"), native.new_error()
    watch = Watch(desc, progress)
    watch.check(call(report, error), error)
    return _read(report)


def cook(model: Source, output: Optional[Path] = None, *, name: Optional[Path] = None,
         partition: str = "cuts", extract: str = "cpu", charts: int = 0, resolution: int = 0,
         height_bits: int = 0, dilation: int = 0, mips: int = 0, zstd: int = 6, threads: int = 0,
         unit: float = 1, up: str = "y", error: float = 0, measure: bool = False,
         lod_levels: int = 5, charts_ply: Optional[Path] = None, more: Sequence[Path] = (),
         strict: bool = False, allow: Sequence[str] = (), if_changed: bool = False,
         adaptive: bool = False, texel_density: Optional[float] = None,
         cache: Optional[Path] = None, limits: Optional[Limits] = None,
         progress: Optional[ProgressFn] = None) -> Tuple[Optional[Asset], Report]:
    """Cooks a model, from a path or from its bytes, and gives the asset and the report. With
    `output`, of a model at a path, it writes the file instead, and the asset is None.

    Options have the names and defaults of `gtx cook`; 0 asks for a default.
      name           of bytes: a path whose extension tells the format; textures lie beside it
      partition      "cuts", "vsa", "pgp", "layers", "relief", "auto"; adaptive: see cook.h
      extract        "cpu" or "gpu"; charts: patches to aim at; resolution: 64..512 texels a side
      height_bits    8 or 16; dilation, mips, lod_levels (0: no LOD meshes), zstd (0: stored)
      unit           metres per unit of the model; up: its axis, "y" or "z"
      error          greatest RMS distance from the source, as a fraction of its diagonal
      measure        whether the report has the error
      texel_density  texels for a pixel of the textures along a side; 0: as relief needs; None: by
                     their detail
      charts_ply     where to write the partition; more: further models for the same asset
      strict         a warning that `allow` does not name is an Error; if_changed: see cook.h
      cache          a folder of cooked assets by their keys, which machines may share
      limits         of gtx_limits, such as {"memory": bytes}
      progress       called with a Progress now and then; returning True or raising stops the call
    Raises Error, Cancelled, and what `progress` raises. Other threads run meanwhile."""
    desc = ffi.new("gtx_cook_desc *")
    if up not in ("y", "z"):
        raise ValueError("up is y or z")
    native.fill(desc, dict(
        partition=native.choose(_PARTITIONS, "partition", partition), charts=charts,
        extract=native.choose(_EXTRACT, "extract", extract), resolution=resolution,
        height_bits=height_bits, dilation=dilation, mips=mips, zstd_level=zstd or -1,
        threads=threads, unit=unit, z_up=up == "z", error=error, measure=measure,
        lod_levels=lod_levels or _LOD_LEVELS_NONE, strict=strict, if_changed=if_changed,
        adaptive=adaptive))
    if texel_density is not None:
        desc.texel_density = texel_density or _TEXEL_DENSITY_RELIEF
    others, kept = _names([native.path_of(path) for path in more])
    allowed, kept_names = _names([kind.encode() for kind in allow])
    desc.more, desc.more_count = others, len(kept)
    desc.allow, desc.allow_count = allowed, len(kept_names)
    ply = ffi.new("char[]", native.path_of(charts_ply)) if charts_ply is not None else ffi.NULL
    desc.charts_ply = ply

    kept_cache = ffi.new("char[]", native.path_of(cache)) if cache is not None else ffi.NULL
    desc.cache = kept_cache

    library = cook_library()
    if native.is_path(model) and output is not None:
        source = native.path_of(model)  # type: ignore[arg-type]
        to = native.path_of(output)
        return None, _call(desc, progress, limits, lambda report, told:
                           library.gtx_cook_file(source, to, desc, report, told))
    if output is not None or if_changed:
        raise ValueError("output and if_changed are for a model at a path")
    if native.is_path(model):
        name = model  # type: ignore[assignment]
        with open(native.path_of(name), "rb") as file:  # type: ignore[arg-type]
            model = file.read()
    data, out = native.bytes_of(model), ffi.new("gtx_asset **")
    label = native.path_of(name) if name is not None else b"model"
    report = _call(desc, progress, limits, lambda report, told: library.gtx_cook_memory(
        ffi.cast("const void *", data), len(data), label, desc, out, report, told))
    return Asset(out[0]), report


def compare(asset: Path, model: Path, *, size: int = 1024, levels: int = 0, threads: int = 0,
            up: str = "y", more: Sequence[Path] = (), random_views: int = 0, seed: int = 0,
            any_model: bool = False, figures_only: bool = False, local_metres: bool = False,
            depths: bool = False, limits: Optional[Limits] = None,
            progress: Optional[ProgressFn] = None) -> Comparison:
    """Measures an asset's file against the model that it was cooked from, in 26 views of `size`
    pixels a side and random ones; `up` and `more` as it was cooked. A model that the asset does not
    name as its source is refused, but with `any_model`. With `figures_only` the report has no
    levels beyond the finest, and no details, which take most of the time. With `local_metres` grids
    in degrees become metres, true at the latitude of the first one's middle; with `depths` values
    of grids are depths, positive downwards. Raises Error."""
    desc, result = ffi.new("gtx_compare_desc *"), ffi.new("gtx_compare_result *")
    if up not in ("y", "z"):
        raise ValueError("up is y or z")
    native.fill(desc, dict(size=size, levels=levels, threads=threads, z_up=up == "z",
                           random_views=random_views, seed=seed,
                           any_model=any_model, figures_only=figures_only,
                           local_metres=local_metres, depths=depths))
    others, kept = _names([native.path_of(path) for path in more])
    desc.more, desc.more_count = others, len(kept)
    paths = native.path_of(asset), native.path_of(model)
    report = _call(desc, progress, limits, lambda report, told:
                   cook_library().gtx_compare_files(*paths, desc, result, report, told))
    figures = {field: getattr(result, field) for field in Comparison._fields if field != "report"}
    return Comparison(report=report, **figures)


def export(asset: Union[Asset, Source], output: Optional[Path] = None, *, level: int = 0,
           lods: bool = False, max_error: float = 0, collision: bool = False,
           without_asset: bool = False, threads: int = 0, limits: Optional[Limits] = None,
           progress: Optional[ProgressFn] = None) -> Tuple[Optional[bytes], Report]:
    """An asset, or its file or bytes, as glTF 2.0: the bytes of a GLB; or of a file, with
    `output`, a file. Options as for `gtx export`. Raises Error."""
    desc = ffi.new("gtx_export_desc *")
    native.fill(desc, dict(level=level, lods=lods, max_error=max_error, collision=collision,
                           without_asset=without_asset, threads=threads))
    library = cook_library()
    if output is not None and not isinstance(asset, Asset) and native.is_path(asset):
        paths = native.path_of(asset), native.path_of(output)  # type: ignore[arg-type]
        return None, _call(desc, progress, limits, lambda report, told:
                           library.gtx_export_file(*paths, desc, report, told))
    if output is not None:
        raise ValueError("output is for an asset at a path")
    if isinstance(asset, Asset):
        asset = asset.encode()
    elif native.is_path(asset):
        with open(native.path_of(asset), "rb") as file:  # type: ignore[arg-type]
            asset = file.read()
    data, out, size = native.bytes_of(asset), ffi.new("void **"), ffi.new("size_t *")
    report = _call(desc, progress, limits, lambda report, told: library.gtx_export_memory(
        ffi.cast("const void *", data), len(data), desc, out, size, report, told))
    try:
        return ffi.buffer(out[0], size[0])[:], report
    finally:
        native.free(out[0])


def read_grid(path: Path, *, missing: Optional[float] = None,
              range: Optional[Tuple[float, float]] = None,
              limits: Optional[Limits] = None) -> Grid:
    """Reads a height grid: the formats of `gtx horizons`. missing: the value of a node without
    one; range: the values of an image's lowest and highest codes. Raises Error."""
    desc, grid, error = (ffi.new("gtx_height_grid_desc *"), ffi.new("gtx_height_grid *"),
                         native.new_error())
    if missing is not None:
        desc.has_missing, desc.missing = 1, missing
    if range is not None:
        desc.range = range
    native.fill_limits(desc.limits, limits)
    library = cook_library()
    native.check(library.gtx_height_grid_read(native.path_of(path), desc, grid, error), error)
    owner = ffi.gc(grid, library.gtx_height_grid_free)
    values = native.array_of(grid.values, "<f4", (grid.ny, grid.nx), owner)
    return Grid(values, tuple(grid.origin), tuple(grid.spacing), grid.rotation,
                in_degrees=bool(grid.in_degrees))


def horizons(grids: Sequence[Grid], *, colors: str = "viridis",
             color_range: Tuple[float, float] = (0, 0), depths: bool = False, vertical: float = 1,
             one_surface: bool = False, tile: int = 0, height_bits: int = 0, mips: int = 0,
             lod_levels: int = 5, unit: float = 1, threads: int = 0,
             limits: Optional[Limits] = None,
             progress: Optional[ProgressFn] = None) -> Asset:
    """One asset of height grids; options as for `gtx horizons`. Values are read as float32, and
    copied where they are not that. East becomes +X, up +Y, north -Z. Raises Error."""
    desc, out, error = (ffi.new("gtx_horizons_desc *"), ffi.new("gtx_asset **"),
                        native.new_error())
    native.fill(desc, dict(
        colors=native.choose(_COLORS, "colors", colors), depths=depths, vertical=vertical,
        color_range=color_range, one_surface=one_surface, tile=tile, height_bits=height_bits,
        mips=mips, lod_levels=lod_levels or _LOD_LEVELS_NONE, unit=unit, threads=threads))
    native.fill_limits(desc.limits, limits)
    told, kept = ffi.new("gtx_height_grid[]", max(len(grids), 1)), []
    for struct, grid in zip(told, grids):
        values = np.ascontiguousarray(grid.values, np.float32)
        if values.ndim != 2:
            raise ValueError("a grid's values are an array of (ny, nx)")
        kept.append(values)
        struct.ny, struct.nx = values.shape
        struct.values = ffi.cast("const float *", values.ctypes.data)
        native.fill(struct, dict(origin=grid.origin, spacing=grid.spacing,
                                 rotation=grid.rotation, in_degrees=grid.in_degrees,
                                 categories=grid.categories))
        if grid.property is not None:
            colored = np.ascontiguousarray(grid.property, np.float32)
            if colored.shape != values.shape:
                raise ValueError("a property has its grid's shape")
            kept.append(colored)
            struct.property = ffi.cast("const float *", colored.ctypes.data)
    watch = Watch(desc, progress)
    watch.check(cook_library().gtx_horizons(told, len(grids), desc, out, ffi.NULL, error), error)
    return Asset(out[0])
