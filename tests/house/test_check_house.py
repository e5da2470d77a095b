#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Shows that every rule of check_house.py catches the fault it is there for, and lets a clean tree pass."""
import subprocess
import sys
import tempfile
from pathlib import Path

CHECK = Path(__file__).with_name("check_house.py")
SPDX = "// SPDX-License-Identifier: MIT\n"

CLEAN = {
    "lib/include/lodestone/mesh.h": SPDX,
    "lib/src/base/heap.h": SPDX,
    "lib/src/mesh/weld.cpp": SPDX + '#include "base/heap.h"\n#include <lodestone/mesh.h>\n',
    "formats/include/lodestone/formats.h": SPDX + "#include <lodestone/mesh.h>\n",
    "cli/main.cpp": SPDX + "#include <lodestone/formats.h>\n",
}

FAULTS = [
    ("arrows", "lib/src/base/heap.h", SPDX + '#include "mesh/weld.cpp"\n'),
    ("arrows", "formats/src/obj.cpp", SPDX + '#include "base/heap.h"\n'),
    ("arrows", "lib/src/mesh/io.cpp", SPDX + "#include <lodestone/formats.h>\n"),
    ("names", "lib/src/base/a.cpp", SPDX + "#include <OpenMesh/Core/IO/MeshIO.hh>\n"),
    ("names", "cli/b.cpp", SPDX + "#include <nlohmann/json.hpp>\n"),
    ("lib_is_pure", "lib/src/mesh/c.cpp", SPDX + "#include <fstream>\n"),
    ("licences", "lib/src/mesh/d.cpp", "int x;\n"),
    ("sizes", "lib/src/mesh/e.cpp", SPDX + "//\n" * 700),
    ("sizes", "lib/src/mesh/f.cpp", SPDX + "int f() {\n" + "  ;\n" * 90 + "}\n"),
    ("paths", "README.md", "see /home/someone/file\n"),
]


def run(files, rule):
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        return subprocess.run([sys.executable, CHECK, folder, rule], check=False, capture_output=True).returncode


def main():
    wrong = []
    for rule in sorted({rule for rule, _, _ in FAULTS}):
        if run(CLEAN, rule) != 0:
            wrong.append(f"{rule}: refuses a clean tree")
    for rule, name, text in FAULTS:
        if run(CLEAN | {name: text}, rule) != 1:
            wrong.append(f"{rule}: does not catch the fault in {name}")
    print("\n".join(wrong) or "all rules bite")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
