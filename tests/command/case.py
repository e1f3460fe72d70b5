# SPDX-License-Identifier: MIT
"""What the tests of the command share: folders, and a run of the program, which is the first argument."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

L1L2STAB = os.path.abspath(sys.argv[1])


class OneFolder(unittest.TestCase):
    """A folder for all tests of a class: `path`, which is also `stock`."""
    timeout = 200

    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.path = cls.stock = Path(cls.holder.name)

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def run_command(self, *arguments, code=0, **options):
        """Runs the command in `path`. It has to end with this exit code; None: with any."""
        run = subprocess.run([L1L2STAB, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             timeout=self.timeout, cwd=self.path, errors='surrogateescape', encoding='utf-8',
                             **options)
        if code is not None:
            self.assertEqual(run.returncode, code, run.stderr)
        return run


class FolderEach(OneFolder):
    """A folder of its own for each test, `path`, beside what is made once for all in `stock`."""
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()
