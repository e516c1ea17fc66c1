"""Writes the files of this folder: own values in the structure of public files. Needs python3-openvdb and numpy.

    python3 tests/data/found/make.py
"""

import math
import os
import struct

import numpy as np
import pyopenvdb as vdb

HERE = os.path.dirname(os.path.abspath(__file__))
SIZE = 20


def swirl(x, y, z):
    """A smooth blob of smoke that differs in all directions."""
    distance = np.sqrt((x - 10) ** 2 + 1.5 * (y - 9) ** 2 + (z - 8) ** 2)
    return np.where(distance < 8, (1 - distance / 8) * (1.2 + np.sin(0.9 * x) * np.cos(0.7 * y)), 0).astype(np.float32)


PLACES = np.mgrid[0:SIZE, 0:SIZE, 0:SIZE].astype(np.float32)
SMOKE = swirl(*PLACES)


def grid(name, values=SMOKE, kind=vdb.FloatGrid, transform=None, cls=vdb.GridClass.FOG_VOLUME, half=False, **metadata):
    out = kind()
    out.copyFromArray(values)
    out.name = name
    out.gridClass = cls
    out.saveFloatAsHalf = half
    out.transform = transform or vdb.createLinearTransform(0.1)
    for key, value in metadata.items():
        out[key] = value
    return out


def path(name):
    return os.path.join(HERE, name)


def patched(name, patch):
    with open(path(name), "rb") as file:
        data = bytearray(file.read())
    patch(data)
    with open(path(name), "wb") as file:
        file.write(data)


def turned(degrees, shear=0.0):
    """A map of voxels that are turned around z, and sheared."""
    c, s = 0.1 * math.cos(math.radians(degrees)), 0.1 * math.sin(math.radians(degrees))
    return vdb.createLinearTransform([[c, s, 0, 0], [-s + shear, c, 0, 0], [0, 0, 0.1, 0], [1, 2, 3, 1]])


def volumes():
    vdb.write(path("turned.vdb"), grid("density", transform=turned(30)))
    vdb.write(path("sheared.vdb"), grid("density", transform=turned(0, 0.03)))
    vdb.write(path("same_names.vdb"), [grid("density"), grid("density", SMOKE[::-1].copy())])
    # Fire as a renderer's exporter writes it: half floats, its own names, a unit scale in the metadata.
    vdb.write(path("flames.vdb"), [grid("density", half=True), grid("flames", SMOKE * 0.5, half=True), grid("temperature", SMOKE * 1500, half=True)],
              metadata={"creator": "a simulator", "scale": 0.1})
    # Houdini: a velocity in three grids, each on the faces of its axis.
    parts = []
    for n, axis in enumerate("xyz"):
        at = vdb.createLinearTransform(0.1)
        at.translate(tuple(-0.05 if n == other else 0.0 for other in range(3)))
        parts.append(grid(f"vel.{axis}", SMOKE * (n + 1), transform=at, cls=vdb.GridClass.STAGGERED))
    vdb.write(path("staggered.vdb"), [grid("density"), *parts])
    # A file of OpenVDB 13: laid out as those of 224.
    vdb.write(path("version_225.vdb"), grid("density"))
    patched("version_225.vdb", lambda data: data.__setitem__(slice(8, 12), struct.pack("<I", 225)))
    # A file from a stream: it has no places of its grids.
    vdb.write(path("streamed.vdb"), grid("density"))
    patched("streamed.vdb", stream)


def stream(data):
    at = 8 + 4 + 4 + 4
    data[at] = 0
    at += 1 + 36

    def text(at):
        (size,) = struct.unpack_from("<I", data, at)
        return at + 4 + size

    (entries,) = struct.unpack_from("<I", data, at)
    at += 4
    for _ in range(entries):
        at = text(text(at))
        (size,) = struct.unpack_from("<I", data, at)
        at += 4 + size
    at = text(text(text(at + 4)))
    data[at:at + 24] = bytes(24)


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def exr(name, channels, data=None, display=None, attributes=b""):
    """Scanlines without compression. channels: {name: array [y][x] of float32, float16 or uint32}"""
    kinds = {"uint32": 0, "float16": 1, "float32": 2}
    names = sorted(channels)
    height, width = channels[names[0]].shape
    data = data or (0, 0, width - 1, height - 1)
    listed = b"".join(each.encode() + b"\0" + struct.pack("<iB3xii", kinds[str(channels[each].dtype)], 0, 1, 1) for each in names) + b"\0"
    head = struct.pack("<ii", 20000630, 2) + attribute("channels", "chlist", listed) + attribute("compression", "compression", b"\0")
    head += attribute("dataWindow", "box2i", struct.pack("<4i", *data)) + attribute("displayWindow", "box2i", struct.pack("<4i", *(display or data)))
    head += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    head += attributes + b"\0"
    row = sum(channels[each].dtype.itemsize for each in names) * width
    body = b"".join(struct.pack("<ii", data[1] + y, row) + b"".join(channels[each][y].tobytes() for each in names) for y in range(height))
    offsets = struct.pack(f"<{height}Q", *[len(head) + 8 * height + y * (8 + row) for y in range(height)])
    with open(path(name), "wb") as file:
        file.write(head + offsets + body)


def images():
    height, width = 40, 60
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    shade = {c: (0.5 + 0.3 * np.sin(x / (5 + n)) * np.cos(y / 7)).astype(np.float32) for n, c in enumerate("RGB")}
    depth = np.full((height, width), np.inf, np.float32)
    depth[10:30, 15:45] = 5
    # Blender: layers by name, depth that is infinite behind all.
    exr("layers.exr", {**{f"ViewLayer.Combined.{c}": each for c, each in shade.items()}, "ViewLayer.Depth.Z": depth})
    # Cryptomatte: hashes of names as floats, each with its coverage, and whole numbers.
    ids = np.where(depth < 6, np.float32(1.7e-33), np.float32(-4.2e17)).astype(np.float32)
    matte = {"CryptoObject00.r": ids, "CryptoObject00.g": np.ones_like(ids), "CryptoObject00.b": ids[:, ::-1].copy(), "CryptoObject00.a": np.zeros_like(ids)}
    key = attribute("cryptomatte/bf35ab6/name", "string", b"CryptoObject") + attribute("cryptomatte/bf35ab6/hash", "string", b"MurmurHash3_32")
    exr("cryptomatte.exr", {**shade, **matte, "id": (depth < 6).astype(np.uint32) * np.uint32(4000000001)}, attributes=key)
    # A renderer's crop: the data window is a part of the picture.
    exr("window.exr", {c: each.astype(np.float16) for c, each in shade.items()}, data=(20, 10, 79, 49), display=(0, 0, 99, 79))


def meshes():
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    obj = "# a cube\r\no Würfel\r\n" + "".join(f"v {x} {y} {z}\r\n" for x, y, z in corners)
    obj += "".join("f " + " ".join(str(n + 1) for n in face) + "\r\n" for face in faces)
    with open(path("utf16.obj"), "wb") as file:
        file.write(obj.encode("utf-16"))
    with open(path("marked.obj"), "wb") as file:
        file.write(obj.encode("utf-8-sig"))
    head = "ply\nformat binary_big_endian 1.0\ncomment a scan\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "property uchar red\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    body = b"".join(struct.pack(">fffB", *corner, 200) for corner in corners) + b"".join(struct.pack(">B4i", 4, *face) for face in faces)
    with open(path("scan.ply"), "wb") as file:
        file.write(head.encode() + body)
    triangles = [t for f in faces for t in ((f[0], f[1], f[2]), (f[0], f[2], f[3]))]
    with open(path("solid.stl"), "wb") as file:  # binary, though it begins as the text form does
        file.write(b"solid made by a modeller".ljust(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *[v for n in triangle for v in corners[n]], 0))
    with open(path("dimension.off"), "w", encoding="utf-8") as file:
        file.write("OFF\n8 6 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners))
        file.write("".join("4 " + " ".join(map(str, face)) + "\n" for face in faces))
    with open(path("marked.csv"), "wb") as file:
        file.write("x,y,z\r\n0,0,0\r\n0.5,1,0\r\n1,2,0.5\r\n".encode("utf-8-sig"))


volumes()
images()
meshes()
