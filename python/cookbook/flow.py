"""An energy by optical flow, where no velocity was stored: high where the picture along an axis moves.

The flow is that of Lucas and Kanade, in two dimensions, by least squares in windows of (2 r + 1)^2 pixels.
"""

from typing import Any

import numpy as np

pictures: "list[Any]" = []  # of all frames: the lowest voxel of each, and the mean along the axis


def add(d: Any, axis: int, at: Any) -> None:
    """Called for each frame, in order."""
    low = np.delete(np.asarray(d.box[0]), axis)
    pictures.append((low, d.dense().mean(axis=axis)))


def finish(r: int) -> "dict[str, Any]":
    """Called once, after the last frame: what it returns are arguments of `energy`."""
    low = np.min([corner for corner, _ in pictures], axis=0)
    size = np.max([corner - low + picture.shape for corner, picture in pictures], axis=0)
    all_frames = np.zeros((len(pictures), *size), np.float32)
    for t, (corner, picture) in enumerate(pictures):
        x, y = corner - low
        all_frames[t, x:x + picture.shape[0], y:y + picture.shape[1]] = picture
    return {"low": low, "speed": np.stack([speed(all_frames[max(t - 1, 0)], all_frames[min(t + 1, len(pictures) - 1)], r) for t in range(len(pictures))])}


def window_sum(values: Any, r: int) -> Any:
    """Sums over windows."""
    sums = np.pad(np.pad(values, r).cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    n = 2 * r + 1
    return sums[n:, n:] - sums[:-n, n:] - sums[n:, :-n] + sums[:-n, :-n]


def speed(before: Any, after: Any, r: int) -> Any:
    """How far each pixel moves between two frames, in pixels; 0 where the picture does not tell."""
    x, y = np.gradient((before + after) / 2)
    t = after - before
    xx, xy, yy, xt, yt = (window_sum(a * b, r) for a, b in ((x, x), (x, y), (y, y), (x, t), (y, t)))
    area = xx * yy - xy * xy
    clear = area > 1e-3 * area.max()
    u, v = yy * xt - xy * yt, xx * yt - xy * xt
    return np.where(clear, np.hypot(u, v) / np.where(clear, area, 1), 0)


def energy(d: Any, axis: int, low: Any, speed: Any, at: Any) -> Any:
    x, y = np.delete(np.asarray(d.box[0]), axis) - low
    shape = np.delete(d.dense().shape, axis)
    return np.expand_dims(speed[at.time, x:x + shape[0], y:y + shape[1]], axis) * abs(d.dense())
