#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the rules of the house that a compiler does not: who may include whom, sizes, licence lines, paths.

    check_house.py ROOT RULE      RULE: arrows names lib_is_pure licences sizes paths
"""
import re
import subprocess
import sys
from pathlib import Path

# Folders of lib/src that a folder may include, besides itself and the public headers.
LIB_ARROWS = {
    "base": set(),
    "geometry": {"base"},
    "mesh": {"base", "geometry"},
    "progressive": {"base"},
    "collapse": {"base", "geometry", "mesh", "progressive"},
    "metrics": {"base", "geometry", "mesh"},
    "generate": {"base", "geometry", "mesh"},
    "image": {"base"},
    "perception": {"base", "geometry", "mesh", "metrics"},
    "facets": {"base", "geometry", "mesh", "progressive", "collapse"},
    "mixed": {"base", "mesh", "progressive", "collapse", "facets"},
    "partition": {"base", "geometry", "mesh"},
    "graph": {"base"},
    "clusters": {"base", "geometry", "mesh", "collapse", "partition", "graph"},
    "outcrop": {"base", "geometry", "mesh", "collapse", "partition", "graph", "image"},
    "terrain": {"base", "geometry", "mesh", "collapse", "partition", "graph"},
}
# Only this part of collapse/ may know the recorder.
COLLAPSE_RECORDS = re.compile(r"^build")

# What a part may include of the others, all of it through public headers.
PART_ARROWS = {
    "lib": set(),
    "formats": {"lib"},
    "viewer": {"lib", "formats"},
    "cli": {"lib", "formats", "viewer"},
    "examples": {"lib", "formats"},
}

# A library's name and the one place (file or folder) where it may stand.
NAMES = {
    r"OpenMesh/": ["lib/src/mesh/", "lib/include/lodestone/openmesh.h"],
    r"metis\.h": ["lib/src/partition/"],
    r"cereal/": ["formats/src/model_file/"],
    r"GL/osmesa\.h": ["viewer/headless/"],
    r"gdal|ogr_|cpl_": ["formats/src/raster/"],
    r"zlib\.h": ["formats/src/quantized_mesh/"],
    r"GLFW/": ["viewer/window/"],
    r"imgui": ["viewer/"],
    r"GL/|GLES\d?/|epoxy/|glad/": ["viewer/"],
    r"assimp/": ["formats/src/meshes/"],
    r"osg(DB|Util|Viewer)?/": ["formats/src/osgb/"],
    r"proj\.h": ["formats/src/tiles3d/"],
    r"CLI/": ["cli/frame/", "viewer/window/main.cpp"],
    r"nlohmann/": ["formats/src/", "cli/frame/report.cpp"],
}

# The core prints nothing and touches no file.
NOT_IN_LIB = re.compile(r"^(fstream|iostream|cstdio|stdio\.h|filesystem|print|unistd\.h|fcntl\.h)$")

MAX_FILE_LINES = 600
MAX_FUNCTION_LINES = 80
CODE_PARTS = ("lib/", "formats/", "viewer/", "cli/", "examples/")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)


class House:
    def __init__(self, root):
        self.root = Path(root).resolve()
        self.faults = []
        self.files = self.list_files()

    def list_files(self):
        """Tracked and new files where git is there, else all outside build folders."""
        git = subprocess.run(["git", "-C", self.root, "ls-files", "-co", "--exclude-standard"],
                             capture_output=True, text=True, check=False)
        if git.returncode == 0:
            names = [n for n in git.stdout.splitlines() if (self.root / n).is_file()]
        else:
            names = [str(p.relative_to(self.root)) for p in self.root.rglob("*") if p.is_file()]
            names = [n for n in names if not n.startswith(("build/", "out/", ".git/"))]
        return sorted(names)

    def code(self, *parts):
        return [n for n in self.files if n.endswith((".h", ".cpp", ".h.in")) and n.startswith(parts or ("",))]

    def text(self, name):
        return (self.root / name).read_text(encoding="utf-8", errors="replace")

    def includes(self, name):
        return [(m.group(1), m.group(2)) for m in INCLUDE.finditer(self.text(name))]

    def fault(self, name, what):
        self.faults.append(f"{name}: {what}")

    def home_of(self, name, target):
        """The file of this tree that a quoted include means, relative to the root; None if it is not here."""
        part = name.split("/")[0]
        folder = (self.root / name).parent
        for base in (folder, self.root / part / "src", self.root / part, self.root / "lib/src", self.root / "formats/src",
                     self.root):
            candidate = (base / target).resolve()
            if candidate.is_file() and candidate.is_relative_to(self.root):
                return str(candidate.relative_to(self.root))
        return None

    def arrows(self):
        for name in self.code(*CODE_PARTS):
            part = name.split("/")[0]
            for kind, target in self.includes(name):
                if target.startswith("lodestone/"):
                    owner = next((p for p in PART_ARROWS if (self.root / p / "include" / target).is_file()), None)
                    if owner is None:
                        self.fault(name, f"includes {target}, which is no public header")
                    elif owner != part and owner not in PART_ARROWS[part]:
                        self.fault(name, f"{part} may not include {target} of {owner}")
                elif kind == '"':
                    self.check_private(name, part, target)

    def check_private(self, name, part, target):
        home = self.home_of(name, target)
        if home is None:
            return
        other = home.split("/")[0]
        if other != part:
            # A program may use the viewer's two doors; everything else goes through public headers.
            if not (part == "cli" and other == "viewer"):
                self.fault(name, f"includes {home}; {part} sees {other} only through its public headers")
            return
        if part != "lib" or not name.startswith("lib/src/"):
            return
        mine, theirs = name.split("/")[2], home.split("/")[2]
        if mine == theirs:
            return
        if theirs not in LIB_ARROWS.get(mine, set()):
            self.fault(name, f"lib/src/{mine} may not include lib/src/{theirs}")
        if mine == "collapse" and theirs == "progressive" and not COLLAPSE_RECORDS.match(Path(name).name):
            self.fault(name, "only collapse/build* may include progressive/")

    def names(self):
        for name in self.code(*CODE_PARTS):
            for _, target in self.includes(name):
                for library, places in NAMES.items():
                    if re.match(library, target):
                        if not any(name.startswith(place) for place in places):
                            self.fault(name, f"names {target}, which belongs in {' or '.join(places)}")
                        break

    def lib_is_pure(self):
        for name in self.code("lib/"):
            for _, target in self.includes(name):
                if NOT_IN_LIB.match(target):
                    self.fault(name, f"includes <{target}>; the core prints nothing and touches no file")

    def licences(self):
        for name in self.files:
            if name.endswith((".h", ".cpp", ".sh", ".py", ".mjs")) or name == ".ci/run":
                if "SPDX-License-Identifier: MIT" not in "\n".join(self.text(name).splitlines()[:2]):
                    self.fault(name, "has no line 'SPDX-License-Identifier: MIT' at its top")

    def sizes(self):
        for name in self.code():
            lines = self.text(name).splitlines()
            if len(lines) > MAX_FILE_LINES:
                self.fault(name, f"has {len(lines)} lines, at most {MAX_FILE_LINES}")
            if name.startswith(CODE_PARTS):
                self.check_functions(name, lines)

    def check_functions(self, name, lines):
        """A function at namespace level, as clang-format lays it out: starts and ends in the first column."""
        begin = None
        for number, line in enumerate(lines, 1):
            if begin is None and line.endswith("{") and re.match(r"[A-Za-z~\[]", line):
                if not re.match(r"(inline )?(namespace|struct|class|enum|union|extern)\b", line):
                    begin = number
            elif begin is None and re.match(r"[ ]{4,}\S.*\) (const )?(noexcept )?\{$", line):
                begin = number  # last line of a signature that was broken over several
            elif line == "}" and begin is not None:
                if number - begin + 1 > MAX_FUNCTION_LINES:
                    self.fault(f"{name}:{begin}", f"function of {number - begin + 1} lines, at most {MAX_FUNCTION_LINES}")
                begin = None
            elif line.startswith("}"):
                begin = None

    def paths(self):
        forbidden = re.compile(r"(?<![\w.])/(work|home|root|Users)/\w")
        for name in self.files:
            path = self.root / name
            if path.stat().st_size > 2_000_000:
                self.fault(name, "is larger than 2 MB; large data is generated or installed, not committed")
                continue
            data = path.read_bytes()
            if b"\0" in data[:4096]:
                continue
            for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
                if forbidden.search(line) and not name.startswith("tests/house/"):
                    self.fault(f"{name}:{number}", "names a folder of one machine")


def main():
    root, rule = sys.argv[1:3]
    house = House(root)
    if not house.code(*CODE_PARTS):
        print("no sources found")
        return 2
    getattr(house, rule)()
    for fault in house.faults:
        print(fault)
    return 1 if house.faults else 0


if __name__ == "__main__":
    sys.exit(main())
