#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""scripts/deps.sh on machines that it does not run on (stand-ins for their programs), scripts/demo.sh with small models.

    LODESTONE_ROOT=. test_scripts.py [Class.test]
"""
import os
import re
import shutil
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(os.environ.get("LODESTONE_ROOT", "."))
DEPS = ROOT / "scripts/deps.sh"


class Machine:
    """Programs that answer as another machine's would; what apt-get was asked to install is noted."""

    def __init__(self, folder, installed=(), unknown=(), debian=True, root=True, sudo=True):
        self.path = Path(folder)
        self.notes = self.path / "installed_now"
        for program in ("bash", "sed", "sort", "head", "env", "dirname"):
            (self.path / program).symlink_to(shutil.which(program))
        self.program("id", f"echo {0 if root else 1000}")
        if debian:
            self.program("dpkg-query", f'case " {" ".join(installed)} " in *" $4 "*) echo -n installed ;; *) exit 1 ;; esac')
        self.program("apt-cache", f'case " {" ".join(unknown)} " in *" $2 "*) exit 100 ;; esac')
        self.program("apt-get", f'if [ "$1" = install ]; then shift; echo "$@" >> {self.notes}; fi')
        if sudo:
            self.program("sudo", f'echo sudo >> {self.notes}; exec "$@"')

    def program(self, name, body):
        (self.path / name).write_text(f"#!{shutil.which('bash')}\n{body}\n")
        (self.path / name).chmod(0o755)

    def deps(self, *words):
        return subprocess.run([shutil.which("bash"), DEPS, *words], check=False, capture_output=True, text=True,
                              env={"PATH": str(self.path)})

    def asked_for(self):
        return self.notes.read_text().split() if self.notes.exists() else []


class Deps(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def machine(self, **options):
        return Machine(self.folder.name, **options)

    def names(self, *groups):
        done = subprocess.run([DEPS, "--list", *groups], check=True, capture_output=True, text=True)
        return done.stdout.split()

    def test_nothing_is_done_where_all_is_there(self):
        machine = self.machine(installed=[name.split("|")[0] for name in self.names()])
        for words in ((), ("--check",)):
            done = machine.deps(*words)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("packages are there", done.stdout)
        self.assertEqual(machine.asked_for(), [])

    def test_what_is_missing_is_named_and_only_that_is_installed(self):
        machine = self.machine(installed=[name.split("|")[0] for name in self.names() if name not in ("libglm-dev", "xvfb")])
        done = machine.deps("--check")
        self.assertEqual((done.returncode, done.stdout), (1, "deps: missing: libglm-dev xvfb\n"))
        self.assertEqual(machine.asked_for(), [])
        self.assertEqual(machine.deps().returncode, 0)
        self.assertEqual([word for word in machine.asked_for() if word[0] != "-"], ["libglm-dev", "xvfb"])

    def test_an_empty_machine_gets_all_of_every_group(self):
        machine = self.machine(root=False)
        done = machine.deps("build", "viewer", "test", "bench", "clients")
        self.assertEqual(done.returncode, 0, done.stderr)
        asked = machine.asked_for()
        self.assertEqual(asked[0], "sudo")
        for group in ("build", "viewer", "test", "bench", "clients"):
            self.assertLessEqual({name.split("|")[0] for name in self.names(group)}, set(asked))

    def test_another_name_is_taken_where_apt_knows_only_that(self):
        machine = self.machine(unknown=["libturbojpeg0-dev"])
        self.assertEqual(machine.deps("build").returncode, 0)
        self.assertIn("libturbojpeg-dev", machine.asked_for())

    def test_what_only_tests_need_may_be_missing_but_nothing_else(self):
        machine = self.machine(unknown=["chromium", "libmetis-dev"])
        done = machine.deps("test", "clients")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("left out: chromium", done.stdout)
        self.assertNotIn("chromium", machine.asked_for())
        self.assertIn("xvfb", machine.asked_for())
        done = machine.deps("build")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1)
        self.assertIn("libmetis-dev", done.stderr)

    def test_other_systems_other_groups_and_no_root_are_one_line(self):
        for machine, words, said in ((dict(debian=False), (), "not Debian"), ({}, ("castle",), "castle"),
                                     (dict(root=False, sudo=False), (), "run as root")):
            with tempfile.TemporaryDirectory() as folder:
                done = Machine(folder, **machine).deps(*words)
            self.assertEqual(done.returncode, 1, said)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(said, done.stderr)


class Demo(unittest.TestCase):
    def test_it_makes_what_it_promises(self):
        bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            done = subprocess.run([ROOT / "scripts/demo.sh"], check=False, capture_output=True, text=True,
                                  env=bare | {"HOUSE_TRIANGLES": "3000", "OUTCROP_TRIANGLES": "4000", "SWEEP_FRAMES": "10",
                                             "DEMO_FOLDER": name})
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual(len(re.findall(r"source_matches +true", done.stdout)), 2, done.stdout)
            self.assertIn("No window opened", done.stdout)
            for model in ("house", "outcrop"):
                self.assertGreater((folder / f"{model}.lode").stat().st_size, 10_000)
                width, height = struct.unpack(">II", (folder / f"{model}_levels.png").read_bytes()[16:24])
                self.assertGreaterEqual(width * height, 8 * 480 * 360)
                film = (folder / f"{model}_sweep.gif").read_bytes()
                self.assertEqual(film[:6], b"GIF89a")
                self.assertGreaterEqual(film.count(b"\x21\xf9\x04"), 10)  # one control block a frame

    def test_other_words_are_explained(self):
        done = subprocess.run([ROOT / "scripts/demo.sh", "--fast"], check=False, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("scripts/demo.sh [--no-window]", done.stdout)


if __name__ == "__main__":
    unittest.main()
