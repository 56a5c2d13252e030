"""Rays into assets, in batches."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from . import native
from .asset import Asset
from .native import Limits, check, core, ffi

HIT = np.dtype([("t", "<f4"), ("patch", "<u4"), ("x", "<f4"), ("y", "<f4"), ("normal", "<f4", 3),
                ("facet", "<f4", 3), ("back", "<u4")])
"""A hit: `gtx_hit` of geotex.h. t is infinite and patch NO_PATCH where nothing was hit."""

RAY = np.dtype([("origin", "<f4", 3), ("t_min", "<f4"), ("direction", "<f4", 3), ("t_max", "<f4")])

NO_PATCH = 0xffffffff


def _pointer(kind: str, array: np.ndarray) -> Any:
    """An array's memory, which must stay alive meanwhile."""
    return ffi.cast(kind, array.ctypes.data)


class Caster:
    """What casting derives from an asset: made once, used by any number of threads at once; calls
    release the interpreter's lock.

    level:     of the height fields, 0 = finest .. 7
    max_error: object units; > 0 casts each patch at its coarsest level within this distance
    limits:    {"memory": bytes, "cells": n that a ray may visit}"""

    def __init__(self, asset: Asset, *, level: int = 0, max_error: float = 0,
                 limits: Optional[Limits] = None) -> None:
        desc, error, out = (ffi.new("gtx_caster_desc *"), native.new_error(),
                            ffi.new("gtx_caster **"))
        desc.level, desc.max_error = level, max_error
        native.fill_limits(desc.limits, limits)
        check(core.gtx_caster_create(asset._pointer, desc, out, error), error)
        self._pointer = ffi.gc(out[0], core.gtx_caster_destroy)
        self._asset = asset

    def raycast(self, origins: Any, directions: Any, *, t_min: Any = 0, t_max: Any = np.inf,
                any_hit: bool = False, two_sided: bool = False,
                exhaustive: bool = False) -> np.ndarray:
        """Casts rays: arrays of shape (..., 3), and (...) for t_min and t_max, that numpy
        broadcasts to one shape (...). Coordinates are in object units relative to the anchor; t
        counts in lengths of the direction. Returns hits of that shape, of dtype HIT; x and y are
        texel coordinates in the patch, normal the unit normal of the normal map, facet that of the
        height field, back 1 where the ray came from below.

        any_hit:    any hit will do (shadows)
        two_sided:  accept crossings from below in every patch
        exhaustive: visit every cell: the slow reference"""
        origin, direction = np.asarray(origins, np.float32), np.asarray(directions, np.float32)
        low, high = np.asarray(t_min, np.float32), np.asarray(t_max, np.float32)
        if origin.shape[-1:] != (3,) or direction.shape[-1:] != (3,):
            raise ValueError("origins and directions are arrays of (..., 3)")
        shape = np.broadcast_shapes(origin.shape[:-1], direction.shape[:-1], low.shape, high.shape)
        rays, hits = np.empty(shape, RAY), np.empty(shape, HIT)
        rays["origin"], rays["direction"] = origin, direction
        # To C, a greatest t of 0 or less means infinity; here it leaves nothing to hit.
        never = high <= 0
        rays["t_min"] = np.where(never, 1, low)
        rays["t_max"] = np.where(never, np.finfo(np.float32).tiny, high)
        flags = any_hit * 1 | two_sided * 2 | exhaustive * 4
        check(core.gtx_raycast(self._pointer, _pointer("const gtx_ray *", rays),
                               _pointer("gtx_hit *", hits), rays.size, flags))
        return hits

    def drop(self, points: Any, *, up: Any = (0, 1, 0), step: float = 0,
             two_sided: bool = False) -> np.ndarray:
        """The surface under points, (..., 3): hits (...) of dtype HIT whose t is the height of the
        point above the surface in object units, negative when the surface, at most `step` above
        it, is; infinite when there is none."""
        at, way = np.ascontiguousarray(points, np.float32), np.ascontiguousarray(up, np.float32)
        if at.shape[-1:] != (3,) or way.shape != (3,):
            raise ValueError("points are an array of (..., 3), up one of (3,)")
        hits = np.empty(at.shape[:-1], HIT)
        check(core.gtx_drop(self._pointer, _pointer("float *", way), step,
                            ffi.cast("float (*)[3]", at.ctypes.data),
                            _pointer("gtx_hit *", hits), hits.size, two_sided * 2))
        return hits

    def colors(self, hits: np.ndarray) -> np.ndarray:
        """The colour map at hits, (..., 4) float32: linear red, green, blue and alpha, 0..1; white
        where nothing was hit, or if the asset has no colours."""
        told = np.ascontiguousarray(hits, HIT)
        out = np.empty(told.shape + (4,), np.float32)
        check(core.gtx_hit_colors(self._asset._pointer, _pointer("const gtx_hit *", told),
                                  ffi.cast("float (*)[4]", out.ctypes.data), told.size))
        return out
