#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds generated outcrops under a ladder of --max-memory. Each run ends well or is refused with a limit that will do, which is
tried next. Prints limit, peak and their ratio; ends with 1 if a peak is above 1.2 times its limit or a limit that was named
does not do. Then one image of 10,000 x 10,000 pixels without a limit.
outcrop_limits.py FOLDER [BUILD_FOLDER]"""
import json
import random
import re
import shutil
import struct
import subprocess
import sys
import zlib
from pathlib import Path

WORK = Path(sys.argv[1])
PROGRAM = str(Path(sys.argv[2] if len(sys.argv) > 2 else "build/release").resolve() / "cli/lodestone")
LIMITS_MB = (40, 60, 80, 100, 150, 200, 300, 500)


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words), "--quiet"], capture_output=True, text=True, check=False, cwd=WORK)
    return done.returncode, done.stdout, done.stderr.strip()


def generate(name, triangles, textures, size):
    code, _, said = run("generate", "outcrop", "-o", name, "--triangles", triangles, "--textures", textures,
                        "--texture-size", size, "--seed", 1)
    assert code == 0, said


def build(name, *more):
    code, told, said = run("outcrop", name, "-o", "tiles", "--json", *more)
    shutil.rmtree(WORK / "tiles", ignore_errors=True)
    return code, json.loads(told)["peak_rss_bytes"] * 1e-6, said


def within(name, limit_mb, *more):
    """Whether the limit was kept or refused; the limit named."""
    code, peak_mb, said = build(name, "--max-memory", f"{limit_mb}MB", *more)
    named = re.search(r"(\d+)MB will do", said)
    end = "built" if code == 0 else f"refused, {named.group(1)} MB named" if named else f"failed: {said}"
    print(f"{name} {' '.join(map(str, more))}: limit {limit_mb} MB, peak {peak_mb:.0f} MB, ratio {peak_mb / limit_mb:.2f}, {end}",
          flush=True)
    return (code == 0 or named is not None) and peak_mb <= 1.2 * limit_mb, int(named.group(1)) if named else 0


def large_png(file, side):
    """Grey noise on a gradient."""
    random.seed(1)
    noise = bytes(random.randrange(48) for _ in range(3 * side + 997))
    packer = zlib.compressobj(1)
    rows = []
    for y in range(side):
        brighter = bytes((value + 160 * y // side) % 256 for value in range(256))
        rows.append(packer.compress(b"\0" + noise[y % 997:y % 997 + 3 * side].translate(brighter)))
    rows.append(packer.flush())

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)) +
                     chunk(b"IDAT", b"".join(rows)) + chunk(b"IEND", b""))


def main():
    WORK.mkdir(parents=True, exist_ok=True)
    good = True
    for triangles in (100000, 300000, 600000):
        name = f"outcrop_{triangles}.obj"
        generate(name, triangles, 6, 1024)
        for threads in (1, 8):
            limits = set()
            for limit_mb in LIMITS_MB:
                kept, named_mb = within(name, limit_mb, "--threads", threads)
                good &= kept
                limits |= {named_mb} - {0}
            for named_mb in sorted(limits):
                kept, again_mb = within(name, named_mb, "--threads", threads)
                good &= kept and again_mb == 0
    generate("large.obj", 20000, 1, 64)
    image = next((WORK / "large_textures").iterdir())
    side = 10000
    large_png(image, side)
    for ratio in (0.5, 0.8):
        _, peak_mb, _ = build("large.obj", "--threads", 1, "--ratio", ratio)
        print(f"image of {side} x {side}, {3e-6 * side * side:.0f} MB decoded, ratio {ratio}: peak {peak_mb:.0f} MB")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
