"""Shows an asset's maps by matplotlib: python_maps.py ASSET.gtx OUT.png

Needs the wheel (`make wheel`) and Debian's python3-matplotlib. The picture has the page of heights
with the patches' rectangles, the colours or else the normals, the surface as rays find it, and how
much of the patches' rectangles is empty."""

import sys

import geotex
import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import patches as shapes, pyplot  # noqa: E402


def look(asset, side=400):
    """The asset from above and in front, lit by a headlight: (side, side), NaN where it is not."""
    low, high = np.array(asset.info.bounds_min), np.array(asset.info.bounds_max)
    centre, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    away = np.array([0.4, 0.5, 0.77]) / np.linalg.norm([0.4, 0.5, 0.77])
    right = np.cross([0, 1, 0], away)
    right /= np.linalg.norm(right)
    up = np.cross(away, right)
    v, u = np.meshgrid(np.linspace(radius, -radius, side), np.linspace(-radius, radius, side),
                       indexing="ij")
    origins = centre + away * 2 * radius + u[..., None] * right + v[..., None] * up
    hits = asset.raycast(origins, -away)
    shade = np.abs(hits["normal"] @ away)
    return np.where(hits["patch"] != geotex.NO_PATCH, 0.15 + 0.85 * shade, np.nan)


def draw(asset, path):
    heights = asset.map("height")[0]
    figure, axes = pyplot.subplots(2, 2, figsize=(11, 9), layout="constrained")
    (of_heights, of_colors), (of_rays, of_shares) = axes

    shown = of_heights.imshow(np.ma.masked_equal(heights, 0), interpolation="nearest")
    figure.colorbar(shown, ax=of_heights, label="height code")
    for x, y, w, h in asset.patches["rect"][asset.patches["page"] == 0]:
        of_heights.add_patch(shapes.Rectangle((x - .5, y - .5), w, h, fill=False, linewidth=.4))
    of_heights.set_title(f"{asset.info.patch_count} patches")

    color = asset.map("color")
    if color is not None:
        of_colors.imshow(color[0, ..., :3])
        of_colors.set_title("colours")
    else:
        normal = asset.map("normal")[0]
        blue = np.full(normal.shape[:2] + (1,), 128, np.uint8)
        of_colors.imshow(np.concatenate([normal, blue], -1))
        of_colors.set_title("normals, hemi-octahedral")

    of_rays.imshow(look(asset), cmap="gray", vmin=0, vmax=1)
    of_rays.set_title("cast, 400 x 400 rays")
    for axis in (of_heights, of_colors, of_rays):
        axis.set_axis_off()

    of_shares.hist(100 * (1 - asset.patches["coverage"]), bins=20, range=(0, 100))
    of_shares.set_xlabel("empty texels of a patch, %")
    of_shares.set_ylabel("patches")
    figure.savefig(path, dpi=100)


if len(sys.argv) != 3:
    sys.exit(__doc__)
try:
    draw(geotex.open(sys.argv[1]), sys.argv[2])
except geotex.Error as error:
    sys.exit(f"{sys.argv[1]}: {error}")
