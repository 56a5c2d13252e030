"""Cooking, comparing and exporting, with the interpreter going on meanwhile."""

import pathlib
import tempfile
import threading
import unittest

import numpy as np

import geotex


def bumps(side):
    """A bumpy surface as the text of an OFF file: 2 side^2 triangles."""
    x, z = np.meshgrid(np.linspace(-1, 1, side + 1), np.linspace(-1, 1, side + 1))
    y = .1 * np.sin(7 * x) * np.cos(9 * z)
    a = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    quads = np.stack([a, a + side + 1, a + side + 2, a + 1], -1)
    lines = [f"OFF {y.size} {len(quads)} 0"]
    lines += ["%.5f %.5f %.5f" % tuple(v) for v in np.stack([x, y, z], -1).reshape(-1, 3)]
    lines += ["4 %d %d %d %d" % tuple(q) for q in quads]
    return "\n".join(lines).encode()


class Cooking(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.model = self.folder / "bumps.off"
        self.model.write_bytes(bumps(40))

    def test_files_and_bytes_give_the_same_asset(self):
        output = self.folder / "bumps.gtx"
        none, report = geotex.cook(self.model, output, charts=9, measure=True)
        self.assertIsNone(none)
        self.assertEqual(report.data["source"]["triangles"], 3200)
        self.assertGreater(report.data["error"]["forward"]["rms"], 0)
        self.assertEqual(report.sources, [str(self.model)])
        self.assertIn("open-edges", [warned.name for warned in report.warnings])
        asset, _ = geotex.cook(self.model.read_bytes(), name="bumps.off", charts=9)
        cached = geotex.cook(self.model, output, charts=9, cache=self.folder / "cache")[1]
        self.assertFalse(cached.unchanged)
        self.assertTrue(any((self.folder / "cache").rglob("*")))
        self.assertEqual(asset.info.content_hash, geotex.open(output).info.content_hash)
        self.assertTrue(geotex.cook(self.model, output, charts=9, if_changed=True)[1].unchanged)
        other, _ = geotex.cook(self.model, charts=9, height_bits=16, lod_levels=0)
        self.assertEqual((other.info.height_bits, other.info.lod_levels), (16, 0))

    def test_refusals(self):
        for wrong, name in ((b"OFF 9 9 9\n", "INPUT"), (b"", "INPUT"), (b"\0" * 99, "INPUT")):
            with self.assertRaises(geotex.Error) as told:
                geotex.cook(wrong, name="x.off")
            self.assertIn(told.exception.name, (name, "EMPTY"))
        with self.assertRaises(geotex.Error) as told:
            geotex.cook(self.folder / "none.off", self.folder / "none.gtx")
        self.assertEqual(told.exception.name, "READ")
        with self.assertRaises(geotex.Error) as told:
            geotex.cook(self.model, limits={"triangles": 10})
        self.assertEqual(told.exception.limit, "triangles")
        with self.assertRaises(geotex.Error) as told:
            geotex.cook(self.model, height_bits=9)
        self.assertEqual(told.exception.name, "ARGUMENT")
        for options in (dict(partition="nets"), dict(up="x"), dict(extract="hand")):
            with self.assertRaises(ValueError):
                geotex.cook(self.model, **options)
        with self.assertRaises(TypeError):
            geotex.cook(self.model, patches=3)

    def test_progress_can_stop_a_cook(self):
        stages = []
        geotex.cook(self.model, progress=lambda told: stages.append((told.stage, told.fraction)))
        self.assertIn("bake", [stage for stage, _ in stages])
        self.assertEqual([f for _, f in stages], sorted(f for _, f in stages))
        with self.assertRaises(geotex.Cancelled):
            geotex.cook(self.model, progress=lambda told: True)
        with self.assertRaises(ZeroDivisionError):
            geotex.cook(self.model, progress=lambda told: 1 / 0)

    def test_other_threads_run_during_a_cook(self):
        data, done, turns = bumps(100), threading.Event(), []
        def count():
            while not done.wait(.0005):
                turns.append(None)
        counter = threading.Thread(target=count)
        counter.start()
        found = [None, None]
        def cook(k):
            found[k] = geotex.cook(data, name="x.off", threads=1)[0].info.content_hash
        cooks = [threading.Thread(target=cook, args=(k,)) for k in range(2)]
        for step in (threading.Thread.start, threading.Thread.join):
            for thread in cooks:
                step(thread)
        done.set()
        counter.join()
        self.assertEqual(found[0], found[1])
        self.assertIsNotNone(found[0])
        self.assertGreater(len(turns), 20)

    def test_comparing(self):
        output = self.folder / "bumps.gtx"
        geotex.cook(self.model, output)
        figures = geotex.compare(output, self.model, size=64)
        self.assertGreater(figures.silhouette_iou, .98)
        self.assertGreater(figures.surface_pixels, 26 * 100)
        self.assertLess(figures.forward_rms, 1e-3)
        self.assertIn("views", figures.report.data)
        with self.assertRaises(geotex.Error):
            geotex.compare(self.model, self.model, size=64)

    def test_exporting(self):
        asset, _ = geotex.cook(self.model)
        data, report = geotex.export(asset)
        self.assertEqual(data[:4], b"glTF")
        self.assertTrue(report.data)
        self.assertEqual(geotex.open(data).info.content_hash, asset.info.content_hash)
        with self.assertRaises(geotex.Error) as told:
            geotex.export(asset, level=99)
        self.assertEqual(told.exception.name, "ARGUMENT")
        saved, output = self.folder / "a.gtx", self.folder / "a.glb"
        asset.save(saved)
        self.assertIsNone(geotex.export(saved, output)[0])
        self.assertEqual(geotex.open(output).info.patch_count, asset.info.patch_count)

    def test_grids(self):
        values = np.fromfunction(lambda j, i: np.sin(i / 9) + j / 20, (40, 60))
        values[:5, :5] = np.nan
        grid = geotex.Grid(values, (10, 20), (2, 3), property=values[::-1])
        asset = geotex.horizons([grid], colors="rainbow", vertical=2)
        self.assertEqual(sum(int((asset.patch_map(k, "height") > 0).sum())
                             for k in range(asset.info.patch_count)) >= 40 * 60 - 25, True)
        size = np.subtract(asset.info.bounds_max, asset.info.bounds_min)
        np.testing.assert_allclose(size[[0, 2]], [2 * 59, 3 * 39], rtol=.01)
        rocks = grid._replace(property=1 + (values > 0), categories=True)
        self.assertEqual(geotex.horizons([rocks]).meta["categories"], [1, 2])
        text = "-996 3 2. 2.\n0. 2. 0. 4.\n2 0. 0. 0.\n0 0 0 0 0 0 0\n1 2 3 4 9999900 6\n"
        path = self.folder / "grid.irap"
        path.write_text(text)
        read = geotex.read_grid(path)
        self.assertEqual((read.values.shape, read.spacing), ((3, 2), (2.0, 2.0)))
        np.testing.assert_array_equal(read.values, [[1, 2], [3, 4], [np.nan, 6]])
        try:  # by the program that the wheel holds, where NetCDF was there to build it
            read = geotex.read_grid("tests/golden/grids/netcdf4.nc")
            self.assertEqual((read.values.shape, read.spacing), ((2, 3), (10.0, 20.0)))
        except geotex.Error as error:
            self.assertIn("geotex-netcdf is not there", str(error))
        with self.assertRaises(ValueError):
            geotex.horizons([geotex.Grid(np.zeros(4))])
        with self.assertRaises(geotex.Error):
            geotex.horizons([])


unittest.main()
