#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs of `lodestone terrain` as a whole: killed and resumed, and from several raster formats.

    runs.py LODESTONE killed|formats
"""
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = sys.argv[1]
STEP = 180 / 256 / 16  # the posts of zoom 4


def write_grid(file):
    columns, rows = 300, 220
    with open(file, "w", encoding="ascii") as out:
        out.write(f"ncols {columns}\nnrows {rows}\nxllcenter {2 * 180 / 16}\nyllcenter {180 / 16}\ncellsize {STEP!r}\nNODATA_value -9999\n")
        for j in range(rows):
            out.write(" ".join(f"{round(900 * math.sin(0.05 * i) * math.cos(0.07 * j) + 400 * math.sin(0.31 * i + 0.2 * j))}"
                               for i in range(columns)) + "\n")


def terrain(raster, folder, *options):
    subprocess.run([PROGRAM, "terrain", raster, "-o", folder, "--max-error", "20m", "--max-zoom", "4", "--quiet", *options],
                   check=True, stdout=subprocess.DEVNULL)


def tree(folder):
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


def killed(folder):
    raster = folder / "grid.asc"
    write_grid(raster)
    terrain(raster, folder / "whole", "--threads", "2")
    expected = tree(folder / "whole")
    assert len(expected) > 8, f"only {len(expected)} files"
    journal = folder / "killed" / "lodestone-terrain.unfinished"
    command = [PROGRAM, "terrain", raster, "-o", folder / "killed", "--max-error", "20m", "--max-zoom", "4", "--quiet", "--threads", "1"]
    for wanted in (3, 6):  # lines: a heading, then tiles
        with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
            while process.poll() is None:
                if journal.exists() and journal.read_bytes().count(b"\n") >= wanted:
                    process.send_signal(signal.SIGKILL)
                    break
                time.sleep(0.001)
            process.wait()
        assert process.returncode == -signal.SIGKILL, f"it ended with {process.returncode} before it was killed"
        assert tree(folder / "killed") != expected
        if "--resume" not in command:
            command.append("--resume")
    terrain(raster, folder / "killed", "--resume")
    assert tree(folder / "killed") == expected, "a resumed pyramid differs"


def formats(folder):
    if not shutil.which("gdal_translate") or not shutil.which("gdalwarp"):
        print("SKIPPED: GDAL's programs are not installed")
        return
    raster = folder / "grid.asc"
    write_grid(raster)
    terrain(raster, folder / "asc")
    expected = tree(folder / "asc")
    known = subprocess.run(["gdal_translate", "--formats"], check=True, capture_output=True, text=True).stdout
    for driver, name in (("GTiff", "grid.tif"), ("netCDF", "grid.nc"), ("VRT", "grid.vrt"), ("EHdr", "grid.bil")):
        if f" {driver} " not in known:
            continue
        subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:4326", "-ot", "Float32", "-of", driver, raster, folder / name], check=True)
        terrain(folder / name, folder / driver)
        assert tree(folder / driver) == expected, f"{driver} gives other tiles"
    subprocess.run(["gdalwarp", "-q", "-s_srs", "EPSG:4326", "-t_srs", "EPSG:3035", "-r", "bilinear", raster, folder / "projected.tif"], check=True)
    terrain(folder / "projected.tif", folder / "projected")
    projected = tree(folder / "projected")
    # The same tiles but at the rim, which a rotated raster does not meet.
    both = set(projected) & set(expected)
    assert len(both) > 0.8 * len(expected), f"only {len(both)} of {len(expected)} tiles"


with tempfile.TemporaryDirectory(prefix="lodestone-terrain-") as scratch:
    os.umask(0o022)
    {"killed": killed, "formats": formats}[sys.argv[2]](Path(scratch))
