"""An energy by a network: two layers over the 27 voxels around each, in numpy alone.

The weights, network.npz, came from `python3 network.py density.npy...`: arrays [x, y, z], from which it learns to foretell a voxel by
those around it. What it can't foretell is detail, and keeps its look. Any library may stand in for numpy here.
"""

import hashlib
import os
from typing import Any

import numpy as np

WEIGHTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "network.npz")
# The results depend on the file of weights, too.
VERSION = hashlib.sha1(open(WEIGHTS, "rb").read()).hexdigest() if os.path.exists(WEIGHTS) else ""
_layers = dict(np.load(WEIGHTS)) if VERSION else {}


def neighbours(dense: Any) -> Any:
    """The 26 voxels around each, [x, y, z, 26]."""
    wide = np.pad(dense, 1)
    steps = [(x, y, z) for x in range(3) for y in range(3) for z in range(3) if (x, y, z) != (1, 1, 1)]
    return np.stack([wide[x:x + dense.shape[0], y:y + dense.shape[1], z:z + dense.shape[2]] for x, y, z in steps], axis=-1)


def foretold(around: Any, layers: "dict[str, Any]") -> Any:
    """What the network takes each voxel for."""
    hidden = np.maximum(around @ layers["w1"] + layers["b1"], 0)
    return (hidden @ layers["w2"] + layers["b2"])[..., 0]


def energy(d: Any) -> Any:
    dense = d.dense()
    return np.abs(dense - foretold(neighbours(dense), _layers))


def train(volumes: "list[Any]", units: int = 8, steps: int = 2000, rate: float = 0.01) -> "dict[str, Any]":
    """Weights that foretell the voxels of some volumes, by Adam."""
    random = np.random.default_rng(1)
    layers = {"w1": random.normal(0, 0.3, (26, units)), "b1": np.zeros(units), "w2": random.normal(0, 0.3, (units, 1)), "b2": np.zeros(1)}
    around = np.concatenate([neighbours(each).reshape(-1, 26) for each in volumes])
    wanted = np.concatenate([each.reshape(-1) for each in volumes])
    some = np.flatnonzero(wanted > 0.01)
    moments = {name: (np.zeros_like(value), np.zeros_like(value)) for name, value in layers.items()}
    for step in range(1, steps + 1):
        batch = random.choice(some, 1024)
        x, y = around[batch], wanted[batch, None]
        hidden = np.maximum(x @ layers["w1"] + layers["b1"], 0)
        error = 2 * (hidden @ layers["w2"] + layers["b2"] - y) / len(batch)
        back = error @ layers["w2"].T * (hidden > 0)
        slopes = {"w1": x.T @ back, "b1": back.sum(0), "w2": hidden.T @ error, "b2": error.sum(0)}
        for name, slope in slopes.items():
            first, second = moments[name]
            first[...] = 0.9 * first + 0.1 * slope
            second[...] = 0.999 * second + 0.001 * slope * slope
            layers[name] -= rate * (first / (1 - 0.9**step)) / (np.sqrt(second / (1 - 0.999**step)) + 1e-8)
    return {name: value.astype(np.float32) for name, value in layers.items()}


if __name__ == "__main__":
    import sys

    np.savez(WEIGHTS, **train([np.load(path) for path in sys.argv[1:]]))
