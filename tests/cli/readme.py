#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""README.md tells the truth: its code is the compiled example, its command lines run, its links lead somewhere.

    LODESTONE=path/to/lodestone LODESTONE_ROOT=. readme.py
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(os.environ.get("LODESTONE_ROOT", "."))
README = (ROOT / "README.md").read_text()


def block(marker):
    """The fenced block after `<!-- marker -->`."""
    return re.search(rf"<!-- {marker} -->\n```\w+\n(.*?)```", README, re.S).group(1)


class Readme(unittest.TestCase):
    def test_the_embedder_is_the_compiled_example(self):
        example = (ROOT / "examples/embed.cpp").read_text().split("// [embed]\n")[1]
        self.assertEqual(block("embed"), example)
        self.assertLessEqual(len(example.splitlines()), 15)

    def test_the_command_lines_run(self):
        lines = [line.split("#")[0].strip() for line in block("cli").splitlines()]
        self.assertEqual(len(lines), 5)
        with tempfile.TemporaryDirectory() as folder:
            for line in lines:
                words = shlex.split(line)
                self.assertEqual(words[0], "lodestone")
                done = subprocess.run([os.environ["LODESTONE"], *words[1:]], check=False, cwd=folder, capture_output=True,
                                      text=True)
                self.assertEqual(done.returncode, 0, line + "\n" + done.stderr)

    def test_the_links_lead_somewhere(self):
        for target in re.findall(r"\]\(([^)#:]+)\)", README):
            self.assertTrue((ROOT / target).exists(), target)


if __name__ == "__main__":
    sys.exit(unittest.main())
