"""Assets as arrays: what they hold, who owns it, and bytes that are no asset."""

import gc
import pathlib
import pickle
import tempfile
import unittest

import numpy as np

import geotex

GOOD = pathlib.Path("tests/golden/good")
BAD = pathlib.Path("tests/golden/bad")


class Opening(unittest.TestCase):
    def test_paths_and_bytes_are_the_same_asset(self):
        path = GOOD / "material.gtx"
        a, b = geotex.open(path), geotex.open(memoryview(bytearray(path.read_bytes())))
        self.assertEqual(a.info, b.info)
        self.assertEqual(a.info.file_size, path.stat().st_size)
        self.assertTrue(a.info.has_material)
        self.assertRegex(geotex.__version__, r"^\d+\.\d+\.\d+$")

    def test_all_good_files_have_maps_of_the_shapes_that_are_said(self):
        seen = set()
        for path in GOOD.glob("*.gtx"):
            asset = geotex.open(path)
            info = asset.info
            for name, (_, channels) in geotex.MAPS.items():
                has = getattr(info, "has_" + name, True)
                top = asset.map(name)
                self.assertEqual(top is not None, has, (path, name))
                if not has:
                    continue
                seen.add((name, top.dtype.itemsize))
                for level in range(1 if name in ("height", "trim") else info.mip_count):
                    shape = (info.page_count, info.page_height >> level, info.page_width >> level)
                    self.assertEqual(asset.map(name, level).shape,
                                     shape + ((channels,) if channels > 1 else ()))
                with self.assertRaises(IndexError):
                    asset.map(name, 1 if name in ("height", "trim") else info.mip_count)
        self.assertEqual(seen, {("height", 1), ("height", 2), ("trim", 1), ("normal", 1),
                                ("color", 1), ("material", 1), ("emission", 1)})
        with self.assertRaises(KeyError):
            geotex.open(GOOD / "minimal.gtx").map("depth")

    def test_records_frames_and_points_agree(self):
        for name in ("color", "height16", "two-pages"):
            asset = geotex.open(GOOD / (name + ".gtx"))
            self.assertEqual(asset.patches.dtype.itemsize, 128)
            low, high = (np.array(side) for side in (asset.info.bounds_min, asset.info.bounds_max))
            for k, patch in enumerate(asset.patches):
                codes, points = asset.patch_map(k, "height"), asset.points(k)
                self.assertEqual(codes.shape, tuple(patch["rect"][[3, 2]]))
                self.assertAlmostEqual(float(np.mean(codes > 0)), float(patch["coverage"]), 6)
                solid = points[codes > 0]
                self.assertTrue(np.isnan(points[codes == 0]).all())
                self.assertTrue((solid >= low - 1e-4).all() and (solid <= high + 1e-4).all())
                far = np.linalg.norm(solid - patch["sphere"][:3], axis=-1).max()
                self.assertLessEqual(far, patch["sphere"][3] * 1.001 + 1e-6)
                # By the words of the header, for one texel.
                j, i = np.argwhere(codes > 0)[0]
                h, w = codes.shape
                steps = 2 ** asset.info.height_bits - 2
                by_hand = (patch["origin"] + (i + .5) / w * patch["extent_x"] * patch["axis_x"]
                           + (j + .5) / h * patch["extent_y"] * patch["axis_y"]
                           + (int(codes[j, i]) - 1) / steps * patch["extent_z"] * patch["axis_z"])
                np.testing.assert_allclose(points[j, i], by_hand, atol=1e-5)

    def test_lod_meshes(self):
        asset = geotex.open(GOOD / "lod.gtx")
        self.assertGreater(asset.info.lod_levels, 0)
        for level in range(asset.info.lod_levels):
            mesh = asset.lod_mesh(level)
            self.assertEqual(mesh.first[-1], len(mesh.indices))
            self.assertLess(mesh.indices.max(), len(mesh.positions))
            self.assertTrue(np.isfinite(mesh.positions).all())
        with self.assertRaises(IndexError):
            asset.lod_mesh(asset.info.lod_levels)

    def test_arrays_keep_the_memory_and_cannot_be_written(self):
        asset = geotex.open(GOOD / "color.gtx")
        array, row = asset.map("color"), asset.patches["origin"][0]
        before, origin = array.copy(), row.copy()
        self.assertEqual(array.ctypes.data, asset.map("color").ctypes.data)
        with self.assertRaises(ValueError):
            array[0, 0, 0] = 1
        part = asset.patch_map(0, "height")
        codes = part.copy()
        del asset
        gc.collect()
        others = [geotex.open(GOOD / "two-pages.gtx") for _ in range(50)]  # would take its place
        np.testing.assert_array_equal(array, before)
        np.testing.assert_array_equal(row, origin)
        np.testing.assert_array_equal(part, codes)
        self.assertEqual(len(others), 50)

    def test_encoding_gives_the_same_asset(self):
        asset = geotex.open(GOOD / "color.gtx")
        stored = asset.encode(zstd=0)
        self.assertEqual(geotex.open(stored).info.content_hash, asset.info.content_hash)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "saved.gtx")
            asset.save(path, zstd=0)
            self.assertEqual(path.read_bytes(), stored)
            with self.assertRaises(geotex.Error) as told:
                asset.save(pathlib.Path(folder, "none", "saved.gtx"))
            self.assertEqual(told.exception.code, geotex.Result.WRITE)


class Hostile(unittest.TestCase):
    def test_broken_rules_are_named(self):
        count = 0
        for path in BAD.glob("*.gtx"):
            rule = int(path.name[:3])
            with self.assertRaises(geotex.Error) as told:
                geotex.open(path.read_bytes())
            issues = geotex.validate(path)
            self.assertIn(rule, [issue.rule for issue in issues], path)
            self.assertTrue(issues[0].name and issues[0].message)
            if told.exception.code == geotex.Result.CORRUPT:
                self.assertTrue(told.exception.rule and told.exception.rule_name)
                count += 1
        self.assertGreater(count, 20)
        self.assertEqual(geotex.validate(GOOD / "color.gtx"), [])

    def test_any_byte_may_be_wrong(self):
        data = (GOOD / "zstd-lod.gtx").read_bytes()
        chance = np.random.default_rng(1)
        for _ in range(2000):
            broken = bytearray(data)
            for place in chance.integers(0, len(data), 3):
                broken[place] = chance.integers(256)
            del broken[chance.integers(0, 2 * len(data)):]
            try:
                asset = geotex.open(broken)
                asset.points(0), asset.raycast([0, 9, 0], [0, -1, 0])
            except geotex.Error as told:
                self.assertNotEqual(told.code, geotex.Result.INTERNAL)

    def test_what_is_no_file(self):
        for source in (b"", b"g", b"glTF", b"glTF" + bytes(40), "no/such/file", "."):
            with self.assertRaises(geotex.Error):
                geotex.open(source)
            if source != ".":
                self.assertTrue(source == "no/such/file" or geotex.validate(source))
        with self.assertRaises(geotex.Error):
            geotex.validate("no/such/file")
        with self.assertRaises(ValueError):
            geotex.open("a\0b")
        with self.assertRaises(TypeError):
            geotex.open(7)

    def test_limits_name_themselves(self):
        with self.assertRaises(geotex.Error) as told:
            geotex.open(GOOD / "color.gtx", limits={"memory": 1000})
        again = pickle.loads(pickle.dumps(told.exception))
        for error in (told.exception, again):
            self.assertEqual((error.code, error.name, error.limit),
                             (geotex.Result.LIMIT, "LIMIT", "memory"))
            self.assertIn("LIMIT", str(error))
        with self.assertRaises(TypeError):
            geotex.open(GOOD / "color.gtx", limits={"minutes": 3})
        with self.assertRaises(OverflowError):
            geotex.open(GOOD / "color.gtx", limits={"memory": -1})


unittest.main()
