"""Exports as baked meshes, beside xatlas: atlas.py GTX MODEL...

Of each model: `gtx cook` and `gtx export` of a level, and the same triangles unwrapped by xatlas
into as many texels, with the source's smooth normals baked into them at the closest points. Then random
points of the triangles look up both maps, and the truth is the normal of the source: `seen`, where
the line from the eye through the point meets it, from random eyes up to 60 degrees off the normal;
`closest`, where it is closest, which is what was baked for xatlas. PSNR is of normals as colours of
8 bits; xatlas's map has them in object space. Seconds: of cooking and exporting, all told, and of
xatlas alone, without the bake.

Needs numpy, scipy, trimesh, embreex, pillow and xatlas, which the tree does not use.
"""
import gzip
import io
import json
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import trimesh
import xatlas
from PIL import Image
from scipy.spatial import cKDTree

SAMPLES, PADDING = 100_000, 2
TYPES = {5121: np.uint8, 5125: np.uint32, 5126: np.float32}
SHAPES = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3, 'VEC4': 4}


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-20)


class Source:
    """A mesh, and its smooth normal at the point that is closest."""

    def __init__(self, path):
        with (gzip.open if path.endswith('.gz') else open)(path, 'rb') as file:
            kind = path.removesuffix('.gz').rsplit('.', 1)[1]
            mesh = trimesh.load(file, kind, process=False, force='mesh')
        places, self.faces = np.unique(np.asarray(mesh.vertices), axis=0, return_inverse=True)
        self.points, self.faces = places, self.faces.reshape(-1)[np.asarray(mesh.faces)]
        a, b, c = (self.points[self.faces[:, k]] for k in range(3))
        if np.einsum('ni,ni->', a, np.cross(b, c)) < 0:  # inside out, which gtx cook turns
            self.faces = self.faces[:, ::-1]
            b, c = c, b
        area = np.cross(b - a, c - a)
        self.normals = np.zeros_like(self.points)
        for k in range(3):
            np.add.at(self.normals, self.faces[:, k], area)
        self.normals = unit(self.normals)
        self.tree = cKDTree(self.points)
        self.rays = trimesh.ray.ray_pyembree.RayMeshIntersector(
            trimesh.Trimesh(self.points, self.faces, process=False))
        self.diagonal = np.linalg.norm(np.ptp(self.points, axis=0))
        order = np.argsort(self.faces.reshape(-1), kind='stable')
        self.around = order // 3
        self.first = np.searchsorted(self.faces.reshape(-1)[order], np.arange(len(places) + 1))

    def normals_seen(self, points, normals, random):
        """The normals, and for which of the points there are some."""
        eyes = unit(random.normal(size=points.shape))
        cosine = np.cos(np.radians(60) * np.sqrt(random.random(len(points))))[:, None]
        across = unit(eyes - normals * np.einsum('ni,ni->n', eyes, normals)[:, None])
        eyes = normals * cosine + across * np.sqrt(1 - cosine ** 2)
        far = 0.01 * self.diagonal
        places, rays, hit = self.rays.intersects_location(points + far * eyes, -eyes,
                                                          multiple_hits=False)
        near = np.linalg.norm(places - points[rays], axis=1) < far
        corners = self.faces[hit[near]]
        w = closest(places[near], *(self.points[corners[:, k]] for k in range(3)))
        return unit(np.einsum('ni,nij->nj', w, self.normals[corners])), rays[near]

    def normals_at(self, points, part=20_000):
        return np.concatenate([self._normals_at(points[i:i + part])
                               for i in range(0, len(points), part)])

    def _normals_at(self, points, near=3, most=8):
        best = np.full(len(points), np.inf)
        normal = np.zeros_like(points)
        _, vertices = self.tree.query(points, near)
        for v in vertices.T:
            for k in range(most):
                at = self.first[v] + k
                there = at < self.first[v + 1]
                corners = self.faces[self.around[np.minimum(at, len(self.around) - 1)]]
                w = closest(points, *(self.points[corners[:, i]] for i in range(3)))
                place = np.einsum('ni,nij->nj', w, self.points[corners])
                far = np.linalg.norm(points - place, axis=1)
                nearer = there & (far < best)
                best[nearer] = far[nearer]
                found = np.einsum('ni,nij->nj', w, self.normals[corners])
                normal[nearer] = found[nearer]
        return unit(normal)


def closest(p, a, b, c):
    """Weights of the corners at the points of triangles that are closest to p."""
    def on_edge(x, y):
        d = y - x
        return np.clip(np.einsum('ni,ni->n', p - x, d) /
                       np.maximum(np.einsum('ni,ni->n', d, d), 1e-30), 0, 1)

    corners, n = (a, b, c), len(p)
    u, v, w = b - a, c - a, p - a
    uu, uv, vv = (np.einsum('ni,ni->n', *x) for x in ((u, u), (u, v), (v, v)))
    wu, wv = np.einsum('ni,ni->n', w, u), np.einsum('ni,ni->n', w, v)
    det = np.maximum(uu * vv - uv * uv, 1e-30)
    s, t = (vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det
    out = np.stack([1 - s - t, s, t], 1)
    best = np.where((out >= 0).all(1), -1, np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        e = on_edge(corners[i], corners[j])
        weights = np.zeros((n, 3))
        weights[:, i], weights[:, j] = 1 - e, e
        far = np.linalg.norm(p - sum(weights[:, k:k + 1] * corners[k] for k in range(3)), axis=1)
        nearer = far < best
        best[nearer], out[nearer] = far[nearer], weights[nearer]
    return out


class Glb:
    """The one level of an export: its primitives' vertices, and the normal map of each."""

    def __init__(self, path):
        data = path.read_bytes()
        length = struct.unpack_from('<I', data, 12)[0]
        self.root, self.binary = json.loads(data[20:20 + length]), data[28 + length:]
        self.parts = []
        for p in self.root['meshes'][0]['primitives']:
            part = {name: self.read(a) for name, a in p['attributes'].items()}
            part['faces'] = self.read(p['indices']).reshape(-1, 3)
            if 'material' in p:
                material = self.root['materials'][p['material']]
                part['map'] = self.image(material['normalTexture']['index'])
            self.parts.append(part)

    def read(self, number):
        a = self.root['accessors'][number]
        view = self.root['bufferViews'][a['bufferView']]
        kind, count = TYPES[a['componentType']], SHAPES[a['type']]
        at = view.get('byteOffset', 0) + a.get('byteOffset', 0)
        return np.ndarray((a['count'], count), kind, self.binary, at,
                          (view.get('byteStride', count * np.dtype(kind).itemsize),
                           np.dtype(kind).itemsize)).copy()

    def image(self, texture):
        view = self.root['bufferViews'][self.root['images'][texture]['bufferView']]
        at = view.get('byteOffset', 0)
        return np.asarray(Image.open(io.BytesIO(self.binary[at:at + view['byteLength']])))


def look_up(image, uv):
    """Bilinear, as 0..255; texel i covers i to i + 1."""
    height, width = image.shape[:2]
    x = np.clip(uv[:, 0] * width - 0.5, 0, width - 1.001)
    y = np.clip(uv[:, 1] * height - 0.5, 0, height - 1.001)
    i, j = x.astype(int), y.astype(int)
    f, g = (x - i)[:, None], (y - j)[:, None]
    image = image.astype(float)
    return ((image[j, i] * (1 - f) + image[j, i + 1] * f) * (1 - g) +
            (image[j + 1, i] * (1 - f) + image[j + 1, i + 1] * f) * g)


def samples_of(points, faces, count, random):
    corners = points[faces].astype(float)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                          axis=1)
    chosen = random.choice(len(faces), count, p=area / area.sum())
    r = np.sqrt(random.random(count))
    s = random.random(count)
    return chosen, np.stack([1 - r, r * (1 - s), r * s], 1)


def mixed(values, faces, chosen, weights):
    return np.einsum('ni,nij->nj', weights, values[faces[chosen]].astype(float))


def bake(source, points, faces, uv, width, height):
    """The source's normals in the texels whose centres triangles cover, and around them."""
    places = np.zeros((height, width, 3))
    covered = np.zeros((height, width), bool)
    for face in faces:
        t = uv[face] * (width, height) - 0.5
        low = np.maximum(np.floor(t.min(0)).astype(int), 0)
        high = np.minimum(np.ceil(t.max(0)).astype(int) + 1, (width, height))
        x, y = np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1]))
        (ax, ay), (bx, by), (cx, cy) = t
        det = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if abs(det) < 1e-12:
            continue
        s = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / det
        r = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / det
        inside = (s >= -1e-6) & (r >= -1e-6) & (s + r <= 1 + 1e-6)
        w = np.stack([1 - s - r, s, r], -1)[inside]
        places[y[inside], x[inside]] = w @ points[face]
        covered[y[inside], x[inside]] = True
    image = np.zeros((height, width, 3))
    image[covered] = source.normals_at(places[covered])
    for _ in range(PADDING):
        total, count = np.zeros_like(image), np.zeros((height, width))
        for dy, dx in ((0, 1), (0, -1), (1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            total += np.roll(image * covered[..., None], (dy, dx), (0, 1))
            count += np.roll(covered, (dy, dx), (0, 1))
        fresh = ~covered & (count > 0)
        image[fresh] = unit(total[fresh])
        covered |= fresh
    return np.round((image * 0.5 + 0.5) * 255).astype(np.uint8)


def psnr(found, points, normals, source):
    """By what is seen, and by what is closest."""
    def of(found, truth):
        return 10 * np.log10(255 ** 2 / np.mean(((unit(found) - truth) * 127.5) ** 2))

    seen, which = source.normals_seen(points, unit(normals), np.random.default_rng(2))
    return f'{of(found[which], seen):.1f} | {of(found, source.normals_at(points)):.1f}'


def of_export(glb, source):
    parts = []
    random = np.random.default_rng(1)
    for p in glb.parts:
        share = len(p['faces']) / sum(len(q['faces']) for q in glb.parts)
        chosen, w = samples_of(p['POSITION'], p['faces'], int(SAMPLES * share), random)
        n, t, at, uv = (mixed(p[k], p['faces'], chosen, w)
                        for k in ('NORMAL', 'TANGENT', 'POSITION', 'TEXCOORD_0'))
        x, y, z = (look_up(p['map'], uv) / 127.5 - 1).T[:, :, None]
        parts.append((t[:, :3] * x + np.cross(n, t[:, :3]) * t[:, 3:] * y + n * z, at, n))
    return psnr(*map(np.concatenate, zip(*parts)), source)


def of_xatlas(points, faces, source, texels):
    pack, got = xatlas.PackOptions(), None
    pack.padding, pack.bilinear = PADDING, True
    a, b, c = (points[faces[:, k]].astype(float) for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    pack.texels_per_unit = (0.6 * texels / area) ** 0.5
    for _ in range(4):  # it is told a density: until the atlas has as many texels
        start = time.perf_counter()
        atlas = xatlas.Atlas()
        atlas.add_mesh(points, faces)
        atlas.generate(xatlas.ChartOptions(), pack, False)
        seconds = time.perf_counter() - start
        got = atlas.width * atlas.height
        if abs(got / texels - 1) < 0.01:
            break
        pack.texels_per_unit *= (texels / got) ** 0.5
    mapping, corners, uv = atlas[0]
    places = points[mapping].astype(float)
    image = bake(source, places, corners, uv.astype(float), atlas.width, atlas.height)
    chosen, w = samples_of(places, corners, SAMPLES, np.random.default_rng(1))
    found = look_up(image, mixed(uv, corners, chosen, w)) / 127.5 - 1
    a, b, c = (places[corners[chosen][:, k]] for k in range(3))
    at = mixed(places, corners, chosen, w)
    return seconds, got, psnr(found, at, np.cross(b - a, c - a), source)


def row(gtx, model, level, folder):
    def run(*arguments):
        start = time.perf_counter()
        subprocess.run([gtx, *map(str, arguments), '-q'], check=True)
        return time.perf_counter() - start

    asset, glb, bare = (folder / name for name in ('a.gtx', 'a.glb', 'b.glb'))
    seconds = run('cook', model, '-o', asset)
    seconds += run('export', asset, '--level', level, '--without-asset', '-o', glb)
    run('export', asset, '--level', level, '--collision', '-o', bare)
    exported, source = Glb(glb), Source(model)
    images = {p['map'].tobytes(): p['map'].size // 3 for p in exported.parts}
    texels = sum(images.values())
    mesh = Glb(bare).parts[0]
    theirs = of_xatlas(mesh['POSITION'], mesh['faces'], source, texels)
    print(f'| {Path(model).name.split(".")[0]} | {len(mesh["faces"])} | {seconds:.1f} | {texels} | '
          f'{of_export(exported, source)} | {theirs[0]:.1f} | {theirs[1]} | '
          f'{theirs[2]} |', flush=True)


def main():
    gtx, level, models = sys.argv[1], 1, sys.argv[2:]
    print('| model | triangles | gtx: s | texels | seen, dB | closest, dB '
          '| xatlas: s | texels | seen, dB | closest, dB |')
    print('|---' * 10 + '|')
    for model in models:
        with tempfile.TemporaryDirectory() as folder:
            row(gtx, model, level, Path(folder))


if __name__ == '__main__':
    main()
