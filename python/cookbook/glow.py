"""An energy with scipy: high where the density changes over a few voxels, and a little wherever it is fast."""

from typing import Any

import numpy as np
from scipy.ndimage import gaussian_gradient_magnitude  # type: ignore


def energy(d: Any, vel: Any, width: float, fast: float, at: Any) -> Any:
    """`width` in voxels; `fast` is the share of the speed."""
    edges = gaussian_gradient_magnitude(d.dense(), width)
    speed = np.linalg.norm(vel.dense(), axis=-1)
    return edges / max(edges.max(), 1e-12) + fast * speed / max(speed.max(), 1e-12)
