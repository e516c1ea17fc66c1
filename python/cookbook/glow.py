"""An energy with scipy: high where the density changes over a few voxels, and a little wherever it is fast."""

import numpy as np
from scipy.ndimage import gaussian_gradient_magnitude


def energy(d, vel, width, fast, at):
    """`width` in voxels; `fast` is the share of the speed."""
    edges = gaussian_gradient_magnitude(d.dense(), width)
    speed = np.linalg.norm(vel.dense(), axis=-1)
    return edges / max(edges.max(), 1e-12) + fast * speed / max(speed.max(), 1e-12)
