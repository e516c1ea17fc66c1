"""What tests of nodes in Python share."""

import os
import sys
import tempfile
import textwrap
import unittest

import fluidcarve

try:
    import numpy
except ImportError:
    numpy = None


# A build without OpenVDB AX has none.
EXPRESSIONS = os.path.exists(os.path.join(os.path.dirname(fluidcarve.program()), "fluidcarve_expressions.so"))


@unittest.skipUnless(numpy, "this Python has no numpy")
class ScriptTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.options = {"work": os.path.join(self.folder, "work"), "allow_plugins": True, "threads": 2}
        os.environ["FLUIDCARVE_PYTHON"] = sys.executable

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write(textwrap.dedent(text))
        return path

    def read(self, path):
        """What a file holds; of one that is not there, nothing."""
        if not os.path.exists(path):
            return ""
        with open(path) as file:
            return file.read()
