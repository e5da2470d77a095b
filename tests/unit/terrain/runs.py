#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs of `lodestone terrain` as a whole: killed and resumed, and from several raster formats.

    runs.py LODESTONE killed|refused|formats|hostile|by_zoom
"""
import array
import json
import math
import os
import re
import resource
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


def check_layer(folder):
    """layer.json names the tiles that there are, and no other."""
    layer = json.loads((folder / "layer.json").read_text())
    named = [f"{zoom}/{x}/{y}.terrain" for zoom, ranges in enumerate(layer["available"]) for box in ranges
             for x in range(box["startX"], box["endX"] + 1) for y in range(box["startY"], box["endY"] + 1)]
    there = sorted(str(file.relative_to(folder)) for file in folder.rglob("*.terrain"))
    assert sorted(named) == there, f"{len(named)} tiles are named, {len(there)} are there"


def killed(folder):
    raster = folder / "grid.asc"
    write_grid(raster)
    methods = [("--method", name) for name in ("edge-collapse", "points-random", "points-grid", "points-hierarchy", "points-wlop")]
    for options in [("--method", "greedy"), *methods, ("--borders", "shared"), ("--as", "3dtiles")]:
        name = "-".join(options).replace("-", "")
        whole, other = folder / f"{name}_whole", folder / name
        terrain(raster, whole, "--threads", "2", *options)
        expected = tree(whole)
        assert len(expected) > 8, f"only {len(expected)} files"
        if "3dtiles" not in options:
            check_layer(whole)
        journal = other / "lodestone-terrain.unfinished"
        command = [PROGRAM, "terrain", raster, "-o", other, "--max-error", "20m", "--max-zoom", "4", "--quiet", "--threads", "1", *options]
        for wanted in (3, 6) if "greedy" in options else (4,):  # lines: a heading, then tiles
            with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
                while process.poll() is None:
                    if journal.exists() and journal.read_bytes().count(b"\n") >= wanted:
                        process.send_signal(signal.SIGKILL)
                        break
                    time.sleep(0.001)
                process.wait()
            assert process.returncode == -signal.SIGKILL, f"{name} ended with {process.returncode} before it was killed"
            assert tree(other) != expected
            if "--resume" not in command:
                command.append("--resume")
        terrain(raster, other, "--resume", *options)
        assert tree(other) == expected, f"a resumed pyramid differs: {options}"


def refused(folder):
    """A disk that is full and folders that cannot be written: one line that names the place, and --resume goes on."""
    def small_files_only():
        resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000))

    raster = folder / "grid.asc"
    write_grid(raster)
    for form in ("quantized-mesh", "3dtiles"):
        terrain(raster, folder / f"{form}_whole", "--as", form)
        expected = tree(folder / f"{form}_whole")
        out = folder / form
        command = [PROGRAM, "terrain", raster, "-o", out, "--as", form, "--max-error", "20m", "--max-zoom", "4", "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, preexec_fn=small_files_only)
        lines = done.stderr.strip().splitlines()
        assert done.returncode == 2 and "cannot be written" in lines[-1] and str(out) in lines[-1], done.stderr
        assert not [file for file in out.rglob("*.part*")], "something half written is left"
        assert not (out / "layer.json").exists() and not (out / "tileset.json").exists()
        terrain(raster, out, "--as", form, "--resume")
        assert tree(out) == expected, "what a full disk stopped is resumed to other bytes"
    (folder / "file").write_text("not a folder")
    for place in (folder / "file", folder / "file" / "below", Path("/proc/tiles")):
        done = subprocess.run([PROGRAM, "terrain", raster, "-o", place, "--quiet"], capture_output=True, text=True)
        lines = done.stderr.strip().splitlines()
        assert done.returncode in (1, 2) and str(place) in lines[-1], f"{place}: {done.returncode} {done.stderr}"


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
    # Packed by the file's own scale and offset; in feet; in a unit that is none.
    packing = ["-ot", "Int16", "-scale", "-1500", "1500", "0", "12000", "-a_scale", "0.25", "-a_offset", "-1500"]
    subprocess.run(["gdal_translate", "-q", "-a_srs", "EPSG:4326", *packing, raster, folder / "packed.tif"], check=True)
    terrain(folder / "packed.tif", folder / "packed")
    assert tree(folder / "packed") == expected, "packed samples are not unpacked"
    described = (folder / "grid.vrt").read_text(encoding="utf-8")
    for unit in ("ft", "K"):
        (folder / f"{unit}.vrt").write_text(re.sub("(<VRTRasterBand[^>]*>)", rf"\1<UnitType>{unit}</UnitType>", described),
                                            encoding="utf-8")
    terrain(folder / "ft.vrt", folder / "feet")
    terrain(raster, folder / "scaled", "--scale", "0.3048")
    assert tree(folder / "feet") == tree(folder / "scaled"), "feet are not converted"
    kelvin = subprocess.run([PROGRAM, "terrain", folder / "K.vrt", "-o", folder / "kelvin", "--max-zoom", "1", "--json"],
                            check=True, capture_output=True, text=True)
    assert 'in "K"' in json.loads(kelvin.stdout)["warnings"][0], kelvin.stdout
    # SRTM's own format, in which the name says the place: samples in big-endian words, north first.
    samples = array.array("h", (round(900 * math.sin(0.011 * i) * math.cos(0.017 * j) + 400 * math.sin(0.07 * i + 0.05 * j))
                                for j in range(1201) for i in range(1201)))
    samples[600 * 1201 + 600] = -32768
    samples.byteswap()
    (folder / "N11E022.hgt").write_bytes(samples.tobytes())
    subprocess.run(["gdal_translate", "-q", folder / "N11E022.hgt", folder / "hgt.tif"], check=True)
    terrain(folder / "N11E022.hgt", folder / "hgt")
    terrain(folder / "hgt.tif", folder / "hgt_tif")
    assert tree(folder / "hgt") == tree(folder / "hgt_tif") and "4/17/8.terrain" in tree(folder / "hgt"), "a .hgt gives other tiles"
    subprocess.run(["gdalwarp", "-q", "-s_srs", "EPSG:4326", "-t_srs", "EPSG:3035", "-r", "bilinear", raster, folder / "projected.tif"], check=True)
    terrain(folder / "projected.tif", folder / "projected")
    projected = tree(folder / "projected")
    # The same tiles but at the rim, which a rotated raster does not meet.
    both = set(projected) & set(expected)
    assert len(both) > 0.8 * len(expected), f"only {len(both)} of {len(expected)} tiles"


def hostile(folder):
    """Rasters at the edge of what there is: a report without cracks within the tolerance, or one clear line."""
    def grid(name, rows, west, south, cell):
        text = "\n".join(" ".join(str(value) for value in row) for row in rows)
        (folder / name).write_text(f"ncols {len(rows[0])}\nnrows {len(rows)}\nxllcenter {west}\nyllcenter {south}\n"
                                   f"cellsize {cell}\nNODATA_value -9999\n{text}\n", encoding="ascii")
        return folder / name

    def run(raster, *options):
        out = folder / f"out{len(list(folder.iterdir()))}"
        done = subprocess.run([PROGRAM, "terrain", raster, "-o", out, "--quiet", "--json", *options], capture_output=True, text=True)
        assert done.returncode in (0, 1, 2), f"{raster}: ended with {done.returncode}: {done.stderr}"
        said = json.loads(done.stdout.splitlines()[-1])
        if done.returncode == 0:
            assert said["cracks"] == 0, f"{raster}: {said['cracks']} cracks"
        return done.returncode, said, done.stderr + done.stdout

    waves = [[round(3000 * math.sin(0.7 * i) * math.cos(0.9 * j)) for i in range(32)] for j in range(17)]
    two = grid("two.asc", [[1, 2], [3, 4]], 10, 50, 0.01)
    assert run(two, "--max-error", "1m")[0] == 0
    # The whole globe, both poles and the antimeridian; a strip across it; a mountain at a pole.
    for name, west, south, cell in (("world", -180, -90, 11.25), ("across", 175, -4, 0.5), ("pole", 20, 80, 0.625)):
        finest = "1" if name == "world" else "3"
        for borders in ("nested", "shared"):
            code, said, text = run(grid(f"{name}.asc", waves, west, south, cell), "--max-error", "50m", "--max-zoom", finest, "--borders", borders)
            assert code == 0, text
            for zoom in said["zooms"]:
                assert zoom["max_error_m"] <= 1.02 * zoom["tolerance_m"], f"{name}: {zoom}"
    for scale in ("1e6", "-1000", "1e-6"):
        code, said, text = run(folder / "across.asc", "--scale", scale, "--max-zoom", "2", "--max-error", "1km")
        assert code == 0 or "error" in text, text
    # What cannot be made is said in one line.
    nothing = grid("nothing.asc", [[-9999] * 4] * 4, 0, 0, 1)
    code, _, text = run(nothing)
    assert code == 2 and "missing" in text, text
    assert run(nothing, "--nodata", "fill", "--fill", "7")[0] == 0
    code, _, text = run(two, "--sea-level", "0m", "--water-mask", two)
    assert code == 1 and "--sea-level" in text and "--water-mask" in text, text
    for option, value in (("--keep", "0.5,2"), ("--cell", "0"), ("--cluster", "a/2"), ("--max-error", "-1m"), ("--grid", "3")):
        code, _, text = run(two, option, value)
        assert code == 1 and (option in text or "grid" in text), text
    # Damaged: cut and scrambled at many places.
    if shutil.which("gdal_translate"):
        subprocess.run(["gdal_translate", "-q", "-ot", "Int16", "-co", "COMPRESS=DEFLATE", folder / "world.asc", folder / "world.tif"], check=True)
        whole = (folder / "world.tif").read_bytes()
        for at in range(0, len(whole), max(1, len(whole) // 6)):
            for damaged in (whole[:at], whole[:at] + bytes(byte ^ 0x5A for byte in whole[at:at + 8]) + whole[at + 8:]):
                (folder / "damaged.tif").write_bytes(damaged)
                run(folder / "damaged.tif", "--max-zoom", "0")


def by_zoom(folder):
    """Values given by zoom: a list, or that of zoom 0 doubled, are the same; one for all is not."""
    raster = folder / "grid.asc"
    write_grid(raster)
    counts = {}
    for keep in ("0.005,0.01,0.02,0.04,0.08", "0.005x2", "0.08/2", "0.08"):
        out = folder / keep.replace("/", "h")
        done = subprocess.run([PROGRAM, "terrain", raster, "-o", out, "--max-zoom", "4", "--method", "points-random", "--keep", keep,
                               "--grid", "1", "--hausdorff", "--quiet", "--json"], check=True, capture_output=True, text=True)
        zooms = json.loads(done.stdout.splitlines()[-1])["zooms"]
        counts[keep] = [zoom["mean_triangles"] for zoom in zooms]
        assert zooms[4]["mean_hausdorff_m"] > 0 and zooms[4]["max_hausdorff_m"] >= zooms[4]["mean_hausdorff_m"]
    assert counts["0.005,0.01,0.02,0.04,0.08"] == counts["0.005x2"]
    assert counts["0.08"][4] == counts["0.005x2"][4] and counts["0.08"][3] > 1.3 * counts["0.005x2"][3], counts
    assert counts["0.08/2"][4] < counts["0.08"][4], counts


with tempfile.TemporaryDirectory(prefix="lodestone-terrain-") as scratch:
    os.umask(0o022)
    {"killed": killed, "refused": refused, "formats": formats, "hostile": hostile, "by_zoom": by_zoom}[sys.argv[2]](Path(scratch))
