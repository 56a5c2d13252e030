"""Rays in batches of any shape."""

import threading
import unittest

import numpy as np

import geotex


def height(x, z):
    """Of a hill, 0.8 high."""
    return .8 * np.exp(-6 * (x ** 2 + z ** 2))


def hill(side=65):
    """The hill as a height grid: its middle lies at the anchor."""
    x = np.linspace(-1, 1, side)
    heights = height(x[None], x[:, None])
    return geotex.horizons([geotex.Grid(heights, (-1, -1), (x[1] - x[0],) * 2)], height_bits=16)


class Casting(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.asset = hill()
        cls.floor = -cls.asset.info.anchor[1]  # coordinates are relative to the anchor

    def test_heights_are_found_from_above(self):
        x, z = np.meshgrid(np.linspace(-.7, .7, 31), np.linspace(-.7, .7, 29))
        origins = np.stack([x, np.full_like(x, 5 + self.floor), z], -1)
        hits = self.asset.raycast(origins, [0, -2, 0])
        self.assertEqual((hits.shape, hits.dtype), ((29, 31), geotex.HIT))
        np.testing.assert_allclose(5 - 2 * hits["t"], height(x, z), atol=0.004)
        np.testing.assert_allclose(np.linalg.norm(hits["normal"], axis=-1), 1, atol=1e-5)
        # A hit's texel coordinates say where it lies.
        hit = hits[14, 17]
        points = self.asset.points(hit["patch"])
        near = points[int(round(float(hit["y"]))), int(round(float(hit["x"])))]
        place = origins[14, 17] + hit["t"] * np.array([0, -2, 0])
        self.assertLess(np.linalg.norm(near - place), 0.03)

    def test_shapes_are_broadcast(self):
        up = [0, 5, 0]
        one = self.asset.raycast(up, [0, -1, 0])
        self.assertEqual(one.shape, ())
        self.assertEqual(self.asset.raycast(np.zeros((0, 3)), up).shape, (0,))
        many = self.asset.raycast(up, np.broadcast_to([0., -1, 0], (4, 5, 3))[::-1, ::2])
        self.assertEqual(many.shape, (4, 3))
        self.assertTrue((many == one).all())
        for wrong in (np.zeros(4), np.zeros((2, 2)), 3):
            with self.assertRaises(ValueError):
                self.asset.raycast(wrong, up)
        with self.assertRaises(ValueError):
            self.asset.raycast(np.zeros((3, 3)), np.zeros((2, 3)))

    def test_misses_and_intervals(self):
        up, down = [0, 5, 0], [0, -1, 0]
        miss = self.asset.raycast([9, 5, 0], down)
        self.assertEqual((miss["patch"], miss["t"]), (geotex.NO_PATCH, np.inf))
        t = float(self.asset.raycast(up, down)["t"])
        least, most = [0, 0, t + .1, 0], [t - .1, t + .1, 99, 0]
        hits = self.asset.raycast(up, down, t_min=least, t_max=most)
        self.assertEqual(list(hits["patch"] != geotex.NO_PATCH), [False, True, False, False])
        for bad in ([np.nan, 5, 0], [np.inf, 5, 0]):
            self.assertEqual(self.asset.raycast(bad, down)["patch"], geotex.NO_PATCH)
        self.assertEqual(self.asset.raycast(up, [0, 0, 0])["patch"], geotex.NO_PATCH)

    def test_kinds_of_casting_agree(self):
        chance = np.random.default_rng(2)
        origins = chance.normal(size=(500, 3)) * 3
        rays = origins, -origins + chance.normal(size=(500, 3)) * .4
        hits = self.asset.raycast(*rays)
        slow = self.asset.raycast(*rays, exhaustive=True)
        self.assertGreater((hits["patch"] != geotex.NO_PATCH).sum(), 100)
        np.testing.assert_array_equal(hits["t"], slow["t"])
        shadow = self.asset.raycast(*rays, any_hit=True)
        np.testing.assert_array_equal(shadow["patch"] == geotex.NO_PATCH,
                                      hits["patch"] == geotex.NO_PATCH)

    def test_drop_and_colors(self):
        caster = geotex.Caster(self.asset, max_error=0.001)
        hits = caster.drop([[0, 3 + self.floor, 0], [9, 9, 9]])
        self.assertAlmostEqual(float(hits[0]["t"]), 3 - .8, 2)
        self.assertTrue(np.isinf(hits[1]["t"]))
        colors = caster.colors(hits)
        self.assertEqual(colors.shape, (2, 4))
        np.testing.assert_array_equal(colors[1], 1)
        self.assertLess(colors[0, 2], .2)  # the top of viridis is yellow
        wrong = hits.copy()
        wrong["patch"][0] = 12345
        with self.assertRaises(geotex.Error) as told:
            caster.colors(wrong)
        self.assertEqual(told.exception.name, "ARGUMENT")
        with self.assertRaises(geotex.Error) as told:
            geotex.Caster(self.asset, limits={"cells": 1})
        self.assertEqual(told.exception.limit, "cells")

    def test_threads_share_a_caster(self):
        caster = geotex.Caster(self.asset)
        rays = np.random.default_rng(3).normal(size=(2, 20000, 3))
        want, found = caster.raycast(*rays), [None] * 4
        def cast(k):
            found[k] = caster.raycast(*rays)
        threads = [threading.Thread(target=cast, args=(k,)) for k in range(4)]
        for step in (threading.Thread.start, threading.Thread.join):
            for thread in threads:
                step(thread)
        for hits in found:
            np.testing.assert_array_equal(hits, want)


unittest.main()
