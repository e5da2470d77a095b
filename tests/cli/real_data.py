#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds and verifies every real building, outcrop, mesh and geological model, by the program, against its source.

    LODESTONE=path/to/lodestone real_data.py ROOT GROUP      GROUP: buildings street city ifc outcrops meshes geology

ROOT is $LODESTONE_DATA or the folder given; prints SKIPPED where it is absent.
"""
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = os.environ.get("LODESTONE", "lodestone")
HOLDS = ("exact", "monotone", "in_use_consistent", "source_matches")

IFC = Path("/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc")

GROUPS = {
    "buildings": ["buildings/[0-9]*/*.obj"],
    "street": ["buildings/street_all/*.obj"],
    "city": ["buildings/3ds/*.3ds", "buildings/citygml/*/*.xml"],
    "ifc": [],  # of Debian's assimp-testmodels
    "outcrops": ["outcrops/*/*.obj"],
    "meshes": ["meshes/*/*.obj", "meshes/*/*.ply", "meshes/*/*.glb", "meshes/*/*.gltf"],
    "geology": ["geology/obj/*.obj"],
}


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words), "--json"], check=False, capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}: exit {done.returncode}: {done.stderr.strip()[-500:]}")
    return json.loads(done.stdout)


def check(source, folder):
    """Builds, verifies; returns what is wrong, or nothing."""
    model = folder / (source.parent.name + "_" + source.stem + ".lode")
    try:
        built = run("build", source, "--reference-textures", "-o", model)
        found = run("verify", model, "--source", source)
    except (RuntimeError, subprocess.TimeoutExpired) as fault:
        return str(fault)
    wrong = [key for key in HOLDS if found[key] is not True]
    print(f"{source.name}: {built['triangles']} triangles, {found['records']} records, base {built['base_triangles']},"
          f" {built['build_seconds']:.2f} s", flush=True)
    return f"{source}: {', '.join(wrong)} do not hold" if wrong else ""


def main():
    root = Path(os.environ.get("LODESTONE_DATA") or sys.argv[1])
    if not root.is_dir():
        print("SKIPPED: real data not found; set LODESTONE_DATA or place it at ../shared/data")
        return 0
    sources = sorted(path for pattern in GROUPS[sys.argv[2]] for path in root.glob(pattern))
    if sys.argv[2] == "ifc":
        if not IFC.exists():
            print("SKIPPED: no IFC house; install assimp-testmodels")
            return 0
        sources = [IFC]
    if not sources:
        print(f"nothing of group {sys.argv[2]} in {root}")
        return 1
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        faults = [fault for fault in pool.map(lambda source: check(source, Path(folder)), sources) if fault]
    print("\n".join(faults) or f"all {len(sources)} hold")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
