"""The package `fluidcarve` of Python, and the program that it calls.

The add-on bears the same name, so that the package is loaded as a part of it, `NAME_OF_THE_ADDON.package`.
"""

from __future__ import annotations

import functools
import importlib
import importlib.util
import os
import subprocess
import sys
from types import ModuleType

_HERE = os.path.dirname(os.path.realpath(__file__))
# In the archive of the add-on; beside it in a checkout and in an installation.
_PLACES = (os.path.join(_HERE, "package"), os.path.join(_HERE, "..", "..", "python", "fluidcarve"))


def _load() -> ModuleType:
    name = f"{__package__}.package"
    if name in sys.modules:
        return sys.modules[name]
    place = next((each for each in _PLACES if os.path.isfile(os.path.join(each, "__init__.py"))), None)
    if place is None:
        raise ImportError("the Python package of fluidcarve is neither in the add-on nor beside it; install the add-on from its archive")
    spec = importlib.util.spec_from_file_location(name, os.path.join(place, "__init__.py"), submodule_search_locations=[place])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


fluidcarve = _load()
call = importlib.import_module(f"{fluidcarve.__name__}.program").call


def set_program(path: str) -> None:
    """Names the program. Empty: the one beside the package, or on PATH."""
    if path:
        os.environ["FLUIDCARVE"] = path
    elif os.environ.get("FLUIDCARVE") == _set[0]:
        os.environ.pop("FLUIDCARVE", None)
    _set[0] = path


_set = [""]


@functools.lru_cache(maxsize=None)
def interpreter() -> str:
    """An interpreter with numpy for nodes in Python: Blender's own, which has it, or the one that Blender was built with. Empty: neither."""
    name = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    for path in (sys.executable, os.path.join(sys.base_prefix, "bin", name), os.path.join("/usr/bin", name)):
        if os.path.isfile(path) and subprocess.run([path, "-c", "import numpy"], stderr=subprocess.DEVNULL).returncode == 0:
            return path
    return ""
