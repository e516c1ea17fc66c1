"""Grids as nodes in Python get them."""

from __future__ import annotations

import base64
import io
import math
from typing import Any, List, Mapping, Optional, Sequence, Tuple

try:
    import numpy as np
except ImportError as error:
    import sys

    raise ImportError(f"nodes in Python need numpy, and {sys.executable} has none: install it there, or name another interpreter by `python` or in the "
                      "environment variable FLUIDCARVE_PYTHON") from error

Array = Any  # numpy.ndarray; numpy before 1.20 has no types
Box = Tuple[Sequence[int], Sequence[int]]
EDGE = 8  # voxels along a leaf
VOXELS = EDGE**3


class Space:
    """The voxels that all grids of a call share: leaves of 8 x 8 x 8, in one order."""

    def __init__(self, origins: Array, states: Array, voxels: int, box: Box, matrix: Optional[List[float]]) -> None:
        self.origins = origins
        self.states = states
        self.voxels = voxels
        self.box = box
        self.matrix = matrix
        self._masks: Array = None

    @property
    def masks(self) -> Array:
        if self._masks is None:
            self._masks = masks_of(self.states)
        return self._masks

    @property
    def shape(self) -> Tuple[int, int, int]:
        """That of dense()."""
        low, high = self.box
        return (high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1)

    def blocks(self, box: Box, item: Tuple[int, ...], dtype: Any, fill: Any) -> Tuple[Array, Array, Array, Array]:
        """An array around a box, whose edges are edges of leaves; where no leaves are it is filled, unless `fill` is None.

        Returns it as leaves, `[i, j, k]` leaf by leaf; the box in it as `[x, y, z]`; which leaves of the space are in it, and their places.
        """
        low = np.asarray(box[0]) // EDGE
        count = np.maximum(np.asarray(box[1]) // EDGE - low + 1, 0)
        whole = np.empty((*(count * EDGE), *item), dtype)
        places = self.origins // EDGE - low
        inside = ((places >= 0) & (places < count)).all(axis=1)
        if fill is not None and np.count_nonzero(inside) < np.prod(count):
            whole[...] = fill
        split = whole.reshape(count[0], EDGE, count[1], EDGE, count[2], EDGE, *item)
        leaves = split.transpose(0, 2, 4, 1, 3, 5, *range(6, 6 + len(item)))
        cut = tuple(slice(box[0][n] - low[n] * EDGE, box[1][n] + 1 - low[n] * EDGE) for n in range(3))
        return leaves, whole[cut], inside, places[inside]


class Grid:
    """A grid of one frame. Voxels are those that are active in any grid of the call; they and their order are the same for all.

    name        of the grid in its file
    kind        "float", "vector" or "mask"
    background  the value where there are no voxels
    box         the lowest and the highest active voxel of all grids of the call, both inclusive
    transform   the matrix (4, 4) by which a position in the world is `transform @ [x, y, z, 1]`
    origins     (N, 3), the lowest voxel of each leaf
    masks       (N, 8, 8, 8), which voxels are active in any grid of the call
    active      (N, 8, 8, 8), which are so in this one

    Arrays are there for the time of the call, and are not to be changed: copy what is to be kept.
    """

    def __init__(self, space: Space, name: str, kind: str, leaves: Array, states: Array, background: Any, tiles: Sequence[Any]) -> None:
        self._space = space
        self._leaves = leaves
        self._states = states
        self._tiles = tiles
        self.name = name
        self.kind = kind
        self.background = background

    @property
    def box(self) -> Box:
        return self._space.box

    @property
    def transform(self) -> Array:
        if self._space.matrix is None:
            raise ValueError(f"the transform of '{self.name}' is no matrix: its voxels are not all of one size")
        return np.array(self._space.matrix).reshape(4, 4)

    @property
    def origins(self) -> Array:
        return self._space.origins

    @property
    def masks(self) -> Array:
        return self._space.masks

    @property
    def active(self) -> Array:
        return masks_of(self._states)

    @property
    def leaves(self) -> Array:
        """The values, leaf by leaf: (N, 8, 8, 8), of vectors (N, 8, 8, 8, 3). Nothing is copied."""
        return self.active if self.kind == "mask" else self._leaves

    @property
    def values(self) -> Array:
        """The values of all voxels: (n,), of vectors (n, 3)."""
        leaves = self.leaves
        return leaves[self.masks]

    @property
    def coords(self) -> Array:
        """The indices of all voxels: (n, 3), in the order of `values`."""
        leaf, *voxel = np.nonzero(self.masks)
        return self.origins[leaf] + np.stack(voxel, axis=1).astype(np.int32)

    def dense(self, box: Optional[Box] = None) -> Array:
        """The values in a box as one array [x, y, z], of vectors [x, y, z, 3]. Left out, it is `box`, which is the same for all grids of the call."""
        box = self.box if box is None else box
        item = (3,) if self.kind == "vector" else ()
        fill = False if self.kind == "mask" else self.background
        leaves, out, inside, places = self._space.blocks(box, item, bool if self.kind == "mask" else np.float32, fill)
        for low, edge, value in self._tiles:
            cut = tuple(slice(max(low[n] - box[0][n], 0), max(low[n] + edge - box[0][n], 0)) for n in range(3))
            out[cut] = value
        leaves[tuple(places.T)] = self.leaves if inside.all() else self.leaves[inside]
        return out

    def like(self, values: Any) -> "Grid":
        """A grid with the same voxels and other values: one number for all, or an array shaped like `values`, `leaves` or `dense()`."""
        return Grid(self._space, self.name, "float", leaves_of(self._space, values, "like"), self._space.states, 0.0, ())


def masks_of(states: Array) -> Array:
    """States, a bit for each voxel, as (N, 8, 8, 8) of bool."""
    return np.unpackbits(states, axis=1, bitorder="little").view(bool).reshape(-1, EDGE, EDGE, EDGE)


def array_in(memory: Any, at: int, dtype: Any, *shape: int) -> Array:
    """An array in shared memory, from a byte on; not to be changed."""
    out = np.frombuffer(memory, dtype, int(np.prod(shape)), at).reshape(shape)
    out.flags.writeable = False
    return out


def read(request: Mapping[str, Any], memory: Any) -> "tuple[Space, dict[str, Grid]]":
    """The grids of a request, whose arrays lie in shared memory."""

    def array(at: int, dtype: Any, *shape: int) -> Array:
        return array_in(memory, at, dtype, *shape)

    count = request["leaves"]
    space = Space(array(request["origins"], np.int32, count, 3), array(request["states"], np.uint8, count, VOXELS // 8), request["voxels"],
                  request["box"], request["matrix"])
    grids = {}
    for name, each in request["grids"].items():
        item = {"float": (), "vector": (3,), "mask": None}[each["kind"]]
        leaves = None if item is None else array(each["values"], np.float32, count, EDGE, EDGE, EDGE, *item)
        background = each.get("background", 0.0)
        grids[name] = Grid(space, each["name"], each["kind"], leaves, array(each["states"], np.uint8, count, VOXELS // 8),
                           math.nan if background is None else background, each.get("tiles", ()))
    return space, grids


def leaves_of(space: Space, values: Any, what: str) -> Array:
    """What a function returned, as leaves (N, 8, 8, 8). Raises TypeError or ValueError if it can't be one number for each voxel."""
    if isinstance(values, Grid):
        return values.leaves
    array = np.asarray(values)
    if array.dtype.kind not in "bufi":
        raise TypeError(f"{what} returned {_described(values, array)}; it must be numbers, as an array or a Grid")
    count = len(space.origins)
    if array.ndim == 0:
        return np.broadcast_to(array, (count, EDGE, EDGE, EDGE))
    if array.shape == (count, EDGE, EDGE, EDGE):
        return array
    if array.shape == (space.voxels,):
        out = np.zeros((count, EDGE, EDGE, EDGE), array.dtype)
        out[space.masks] = array
        return out
    if array.shape == space.shape:
        leaves, dense, inside, places = space.blocks(space.box, (), array.dtype, None)
        dense[...] = array
        if inside.all():
            return leaves[tuple(places.T)]
        out = np.zeros((count, EDGE, EDGE, EDGE), array.dtype)  # leaves without active voxels may lie outside
        out[inside] = leaves[tuple(places.T)]
        return out
    raise ValueError(f"{what} returned {_described(values, array)}; it must have the shape of dense(), {space.shape}, of values, ({space.voxels},), or of "
                     f"leaves, ({count}, 8, 8, 8)")


def states_of(space: Space, values: Any, what: str) -> "tuple[Array, Array]":
    """What a function returned as states of leaves, a bit for each voxel, and the origins of these leaves."""
    array = values.leaves if isinstance(values, Grid) else np.asarray(values)
    if array.dtype.kind == "f":
        raise TypeError(f"{what} returned {_described(values, array)}; it must be true or false: compare with a number, as in d.dense() > 0.5")
    if array.shape == space.shape and array.dtype.kind in "bui":
        # Also where no input has a leaf.
        leaves, dense, _, _ = space.blocks(space.box, (), bool, False)
        dense[...] = array
        places = np.argwhere(leaves.any(axis=(3, 4, 5)))
        masks, origins = leaves[tuple(places.T)], (places + np.asarray(space.box[0]) // EDGE) * EDGE
    else:
        masks = leaves_of(space, array, what).astype(bool) & space.masks
        some = masks.any(axis=(1, 2, 3))
        masks, origins = masks[some], space.origins[some]
    return np.packbits(masks.reshape(-1, VOXELS), axis=1, bitorder="little"), origins.astype(np.int32)


def found_as(found: Any, what: str) -> bytes:
    """What `finish` returned, a dict of numbers, texts and arrays, as bytes that any worker reads. Raises TypeError if it is something else."""
    if not isinstance(found, Mapping) or any(not isinstance(name, str) or np.asarray(value).dtype.hasobject for name, value in found.items()):
        raise TypeError(f"{what} returned a {type(found).__name__}; it must be a dict of numbers, texts and arrays, which become arguments")
    out = io.BytesIO()
    np.savez(out, **found)
    return out.getvalue()


def found_in(text: str) -> "dict[str, Any]":
    """What found_as() wrote, in base64."""
    with np.load(io.BytesIO(base64.b64decode(text)), allow_pickle=False) as arrays:
        return {name: arrays[name][()] for name in arrays.files}


def _described(values: Any, array: Array) -> str:
    if values is None:
        return "nothing"
    if array.dtype.kind == "O" or not isinstance(values, np.ndarray):
        return f"a {type(values).__name__}" + (f" of shape {array.shape}" if array.shape else "")
    return f"an array of type {array.dtype} and shape {array.shape}"
