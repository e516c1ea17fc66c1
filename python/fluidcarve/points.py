"""Particles as nodes in Python get them: a dict of arrays. `P` holds positions in the world; a vector is one array (n, 3)."""

from __future__ import annotations

from typing import Any, Dict, List, Mapping

import numpy as np

from .grids import Array, array_in

_KEPT = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")
_AS = {"bool": "uint8", "int64": "int32", "uint64": "uint32", "float16": "float32"}


def read(request: Mapping[str, Any], memory: Any) -> Dict[str, Array]:
    """The points of a request, whose columns lie in shared memory."""
    columns = {each["name"]: array_in(memory, each["at"], each["type"], request["count"]) for each in request["columns"]}
    out = {"P": request["scale"] * np.stack([columns[axis].astype(np.float64) for axis in "xyz"], axis=1) + request["translate"]}
    for name, values in columns.items():
        base = name[:-2]
        parts: List[Any] = [columns.get(f"{base}_{axis}") for axis in "xyz"]
        if name in ("x", "y", "z"):
            continue
        if base and name[-2:] in ("_x", "_y", "_z") and all(part is not None and part.dtype == values.dtype for part in parts):
            out[base] = np.stack(parts, axis=1)
        else:
            out[name] = values.copy()
    return out


def columns_of(points: Any, like: Mapping[str, Any], what: str) -> Dict[str, Array]:
    """A dict of arrays as columns, positions in the space of the file that the source is from.

    Raises TypeError or ValueError if it can't be points.
    """
    if not isinstance(points, Mapping) or "P" not in points:
        raise TypeError(f"{what} returned a {type(points).__name__}; it must be a dict of arrays with the positions 'P'")
    types = {each["name"]: each["type"] for each in like["columns"]}
    positions = np.asarray(points["P"], np.float64)
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise ValueError(f"{what} returned positions 'P' of shape {positions.shape}; it must be (n, 3)")
    if not np.isfinite(positions).all():
        raise ValueError(f"{what} returned a position that is not finite, of point {int(np.argwhere(~np.isfinite(positions))[0][0])}")
    in_file = (positions - like["translate"]) / like["scale"]
    out = {axis: in_file[:, n].astype(types[axis]) for n, axis in enumerate("xyz")}
    for name, given in points.items():
        if name == "P":
            continue
        values = np.asarray(given)
        if values.shape not in ((len(positions),), (len(positions), 3)):
            raise ValueError(f"{what} returned '{name}' of shape {values.shape}; for {len(positions)} points it must be ({len(positions)},) or ({len(positions)}, 3)")
        for suffix, column in [("", values)] if values.ndim == 1 else [(f"_{axis}", values[:, n]) for n, axis in enumerate("xyz")]:
            out[name + suffix] = _stored(column, name, what)
    return out


def _stored(values: Array, name: str, what: str) -> Array:
    """Values of a type that files hold."""
    kind = str(values.dtype)
    if kind in _KEPT:
        return values
    if kind not in _AS:
        raise TypeError(f"{what} returned '{name}' of type {kind}; it must be numbers")
    out = values.astype(_AS[kind])
    if values.dtype.kind in "iu" and (out != values).any():
        raise ValueError(f"{what} returned '{name}' with whole numbers beyond 32 bits, which files of points do not hold")
    return out
