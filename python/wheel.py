#!/usr/bin/env python3
"""Makes the wheel of the package, without network and tools: `python3 python/wheel.py FOLDER`. The same files give the same bytes."""

import base64
import hashlib
import pathlib
import re
import sys
import zipfile

PYTHON = pathlib.Path(__file__).resolve().parent
METADATA = """\
Metadata-Version: 2.1
Name: fluidcarve
Version: {version}
Summary: Writes and runs pipelines of fluidcarve
Requires-Python: >=3.9
Provides-Extra: arrays
Requires-Dist: numpy ; extra == 'arrays'
"""
WHEEL = "Wheel-Version: 1.0\nGenerator: fluidcarve\nRoot-Is-Purelib: true\nTag: py3-none-any\n"


def main(folder: str) -> None:
    found = re.search(r"project\(fluidcarve VERSION ([0-9.]+)", (PYTHON.parent / "CMakeLists.txt").read_text())
    assert found is not None
    version = found.group(1)
    info = f"fluidcarve-{version}.dist-info"
    files = {f"fluidcarve/{path.name}": path.read_bytes() for path in sorted((PYTHON / "fluidcarve").iterdir()) if path.is_file()}
    files[f"{info}/METADATA"] = METADATA.format(version=version).encode()
    files[f"{info}/WHEEL"] = WHEEL.encode()
    record = "".join(f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()},{len(data)}\n"
                     for name, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    out = pathlib.Path(folder) / f"fluidcarve-{version}-py3-none-any.whl"
    out.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in files.items():
            wheel.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED)
    print(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
