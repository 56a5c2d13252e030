"""geotex: geometry textures. Finely tessellated models as oriented height maps.

    asset = geotex.open("model.gtx")
    heights = asset.map("height")                  # numpy, not copied
    hits = asset.raycast(origins, directions)      # numpy in and out
    asset, report = geotex.cook("model.glb", charts=200)

Words and formats: README.md and CONTRIBUTING.md of geotex; the C headers say more of each call."""

from .asset import MAPS, PATCH, Asset, Info, Issue, LodMesh, open, validate
from .cooking import (Comparison, Grid, Report, Warned, compare, cook, export, horizons,
                      read_grid)
from .native import Cancelled, Error, Progress, Result, version
from .rays import HIT, NO_PATCH, Caster

__version__ = version()
__all__ = ["MAPS", "PATCH", "HIT", "NO_PATCH", "Asset", "Caster", "Cancelled", "Comparison",
           "Error", "Grid", "Info", "Issue", "LodMesh", "Progress", "Report", "Result", "Warned",
           "compare", "cook", "export", "horizons", "open", "read_grid", "validate", "version"]
