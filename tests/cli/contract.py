#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The contract of the command line: verbs, JSON keys, exit codes, clean failures. Run by ctest, test by test:

    LODESTONE=path/to/lodestone contract.py [Class.test]

LODESTONE_CLI_HOUSE names a folder made by `contract.py --make-house FOLDER`, so that not every test makes its own.
"""
import json
import math
import os
import pty
import re
import resource
import select
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = os.environ.get("LODESTONE", "lodestone")
MANUAL = Path(__file__).resolve().parents[2] / "docs" / "COMMAND_LINE.md"
COMMON = {"lodestone", "seconds", "peak_rss_bytes", "warnings"}
VERBS = ["inspect", "generate", "convert", "build", "verify", "play", "extract", "sweep", "render", "compare", "clusters", "cut",
         "distances", "outcrop", "terrain", "view"]


def run(*words, **options):
    return subprocess.run([PROGRAM, *map(str, words)], check=False, capture_output=True, text=True, timeout=300, **options)


def make_house(folder):
    """A small house and its model."""
    for words in (("generate", "house", "--triangles", 3000, "--texture-size", 64, "-o", folder / "house.obj"),
                  ("build", folder / "house.obj", "-o", folder / "house.lode")):
        done = run(*words)
        assert done.returncode == 0, done.stderr


class Contract(unittest.TestCase):
    """A scratch folder with a small house and its model."""

    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.mkdtemp(prefix="lodestone-cli-")
        cls.folder = Path(cls.kept)
        cls.house = cls.folder / "house.obj"
        cls.model = cls.folder / "house.lode"
        made = os.environ.get("LODESTONE_CLI_HOUSE")
        if made:
            shutil.copytree(made, cls.folder, dirs_exist_ok=True)
        else:
            make_house(cls.folder)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.kept)

    def setUp(self):
        self.scratch = self.folder / self.id().rsplit(".", 1)[-1]
        self.scratch.mkdir()

    def json(self, *words, code=0):
        """Runs with --json: stdout must be exactly one object on one line, with the common keys."""
        done = run(*words, "--json")
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout.count("\n"), 1, done.stdout)
        found = json.loads(done.stdout)
        self.assertIsInstance(found, dict)
        self.assertLessEqual(COMMON, set(found))
        self.assertIsInstance(found["warnings"], list)
        self.assertGreaterEqual(found["seconds"], 0)
        self.assertGreater(found["peak_rss_bytes"], 0)
        return found

    def fails(self, code, *words, **options):
        """Ends with `code` and one line on stderr that begins with the program's name."""
        done = run(*words, **options)
        self.assertEqual(done.returncode, code, done.stderr)
        lines = [line for line in done.stderr.splitlines() if "warning:" not in line]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertTrue(lines[0].startswith("lodestone: "), done.stderr)
        self.assertEqual(done.stdout, "")
        return lines[0]


class Help(Contract):
    def test_lists_the_verbs_that_exist(self):
        done = run("--help")
        self.assertEqual(done.returncode, 0)
        for verb in VERBS:
            self.assertRegex(done.stdout, rf"(?m)^\s+{verb}\s")

    def test_every_verb_explains_itself_with_an_example(self):
        for verb in VERBS:
            done = run(verb, "--help")
            self.assertEqual(done.returncode, 0)
            self.assertIn(f"Example:\n  lodestone {verb} ", done.stdout)
            for option in ("--json", "--quiet", "--strict", "--threads", "--max-memory"):
                self.assertIn(option, done.stdout)

    def test_the_examples_run_as_they_stand(self):
        order = ["generate", "inspect", "convert", "build", "verify", "play", "extract", "sweep", "render", "compare",
                 "clusters", "cut", "distances", "outcrop"]
        for verb in order:
            if verb == "outcrop":
                run("generate", "outcrop", "--triangles", 5000, "--texture-size", 64, "-o", self.scratch / "cliff.obj")
            example = run(verb, "--help").stdout.rsplit("Example:\n", 1)[1].splitlines()[0]
            words = shlex.split(example)
            self.assertEqual(words[0], "lodestone")
            done = run(*words[1:], cwd=self.scratch)
            self.assertEqual(done.returncode, 0, example + "\n" + done.stderr)

    def test_tells_its_version(self):
        self.assertRegex(run("--version").stdout, r"^\d+\.\d+\.\d+\n$")


class Keys(Contract):
    def keys(self, wanted, *words):
        """The keys of the contract are there, and every key that is there is in the manual."""
        found = self.json(*words)
        self.assertLessEqual(set(wanted.split()), set(found))
        row = re.search(rf"(?m)^\| `{words[0]} .*\| `([^`]*)` \|$", MANUAL.read_text())
        self.assertEqual(set(found) - COMMON, set(row.group(1).split()))
        return found

    def test_inspect(self):
        found = self.keys("vertices triangles materials textures components boundary_edges non_manifold_edges "
                          "degenerate_triangles bounds_m origin_m up_axis crs", "inspect", self.house)
        self.assertGreater(found["triangles"], 1000)
        low, high = found["bounds_m"]
        self.assertTrue(all(a < b for a, b in zip(low, high)))

    def test_the_reference_system_is_said_or_found_beside(self):
        bare = self.scratch / "bare.obj"
        bare.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertEqual(self.json("inspect", bare)["crs"], "")
        self.assertEqual(self.json("inspect", bare, "--crs", "EPSG:25833")["crs"], "EPSG:25833")
        prj = self.scratch / "bare.prj"
        prj.write_text('PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",AUTHORITY["EPSG","4258"]],AUTHORITY["EPSG","25832"]]')
        self.assertEqual(self.json("inspect", bare)["crs"], "EPSG:25832")
        prj.write_text('PROJCRS["ETRS89 / UTM zone 32N",BASEGEOGCRS["ETRS89",ID["EPSG",4258]],ID["EPSG",25832]]')
        self.assertEqual(self.json("inspect", bare)["crs"], "EPSG:25832")
        prj.write_text('PROJCS["ETRS_1989_UTM_Zone_32N",UNIT["Meter",1.0]]')
        self.assertEqual(self.json("inspect", bare)["crs"], "ETRS_1989_UTM_Zone_32N")
        built = self.scratch / "bare.lode"
        self.json("build", bare, "--crs", "EPSG:25832", "-o", built)
        self.assertEqual(self.json("inspect", built)["crs"], "EPSG:25832")

    def test_inspect_tells_facets(self):
        facets = self.json("inspect", self.house, "--facets")["facets"]
        self.assertEqual(facets["surfaces"], sum(facets[kind]["surfaces"] for kind in
                                                 ("wall", "roof", "ground", "opening", "installation", "other")))
        self.assertGreater(facets["depressions"], 10)
        self.assertEqual(facets["roofs"][0]["type"], "sloped")
        self.assertNotIn("facets", self.json("inspect", self.house))
        fine = self.json("inspect", self.house, "--facets", "--plane-angle", 20, "--plane-offset", "10cm")["facets"]
        self.assertLess(fine["surfaces"], facets["surfaces"])

    def test_inspect_reads_models(self):
        self.assertEqual(self.json("inspect", self.model)["triangles"], self.json("inspect", self.house)["triangles"])

    def test_generate(self):
        for kind in ("house", "street", "outcrop", "terrain"):
            out = self.scratch / f"{kind}.ply"
            found = self.keys("vertices triangles textures", "generate", kind, "--triangles", 20000, "--texture-size", 32,
                              "--seed", 7, "-o", out)
            self.assertGreater(out.stat().st_size, 0)
            self.assertEqual(self.json("inspect", out)["triangles"], found["triangles"])

    def test_convert(self):
        source = self.json("inspect", self.house)
        for kind in ("obj", "ply", "glb"):
            out = self.scratch / f"house.{kind}"
            found = self.keys("vertices triangles", "convert", self.house, "-o", out)
            again = self.json("inspect", out)
            self.assertEqual(found["triangles"], source["triangles"])
            self.assertEqual(again["triangles"], source["triangles"])
            for a, b in zip(sum(source["bounds_m"], []), sum(again["bounds_m"], [])):
                self.assertAlmostEqual(a, b, delta=1e-3)

    def test_build(self):
        found = self.keys("triangles vertices records base_triangles base_error_m file_bytes build_seconds "
                          "triangles_per_second", "build", self.house, "-o", self.scratch / "a.lode")
        self.assertEqual(found["file_bytes"], (self.scratch / "a.lode").stat().st_size)
        self.assertLess(found["base_triangles"], found["triangles"] / 10)

    def test_build_options_do_what_they_say(self):
        out = self.scratch / "a.lode"
        stopped = self.json("build", self.house, "--target-triangles", 1500, "-o", out)
        self.assertLessEqual(stopped["base_triangles"], 1500)
        self.assertGreater(stopped["base_triangles"], 1000)
        bounded = self.json("build", self.house, "--max-error", "1cm", "-o", out)
        self.assertLessEqual(bounded["base_error_m"], 0.0101)
        for placement in ("on-edge", "midpoint", "end-point", "subset"):
            self.json("build", self.house, "--placement", placement, "--attributes", "none", "-o", out)
            self.json("verify", out, "--source", self.house)
        exact = self.json("build", self.house, "-o", out)["file_bytes"]
        self.assertLess(self.json("build", self.house, "--quantize", 12, "-o", out)["file_bytes"], exact)
        self.assertLess(self.json("build", self.house, "--reference-textures", "-o", out)["file_bytes"], exact)

    def test_verify(self):
        found = self.keys("records exact monotone in_use_consistent source_matches", "verify", self.model, "--source",
                          self.house)
        for key in ("exact", "monotone", "in_use_consistent", "source_matches"):
            self.assertIs(found[key], True, key)
        self.assertIsNone(self.json("verify", self.model)["source_matches"])

    def test_verify_tells_a_wrong_source(self):
        other = self.scratch / "other.obj"
        run("generate", "house", "--triangles", 3000, "--roof", "flat", "--texture-size", 64, "-o", other)
        self.assertIs(self.json("verify", self.model, "--source", other, code=2)["source_matches"], False)

    def test_verify_says_that_a_quantised_model_cannot_be_its_source(self):
        coarse = self.scratch / "coarse.lode"
        self.json("build", self.house, "--quantize", 12, "-o", coarse)
        found = self.json("verify", coarse, "--source", self.house, code=2)
        self.assertIs(found["source_matches"], False)
        self.assertIs(found["exact"], True)
        self.assertIn("quantised to 12 bits", found["error"]["message"])

    def test_play(self):
        found = self.keys("records refine_records_per_second coarsen_records_per_second seek_seconds_p50 "
                          "seek_seconds_p99 bytes_per_triangle allocations", "play", self.model)
        self.assertEqual(found["allocations"], 0)
        self.assertGreater(found["refine_records_per_second"], 0)

    def test_extract(self):
        out = self.scratch / "level.ply"
        records = self.json("verify", self.model)["records"]
        all_of_it = self.json("inspect", self.house)["triangles"]
        for words in (("--triangles", 500), ("--ratio", 0.2), ("--error", "5cm"), ("--level", records // 2)):
            found = self.keys("triangles vertices error_m level", "extract", self.model, *words, "-o", out)
            self.assertEqual(self.json("inspect", out)["triangles"], found["triangles"])
            self.assertLessEqual(found["level"], records)
        self.assertLessEqual(self.json("extract", self.model, "--triangles", 500, "-o", out)["triangles"], 500)
        self.assertLessEqual(self.json("extract", self.model, "--ratio", 0.2, "-o", out)["triangles"], 0.2 * all_of_it)
        self.assertLessEqual(self.json("extract", self.model, "--error", "5cm", "-o", out)["error_m"], 0.05)

    def test_extract_from_a_part_of_the_file(self):
        size = self.model.stat().st_size
        out = self.scratch / "part.ply"
        triangles = self.json("inspect", self.house)["triangles"]
        self.assertEqual(self.json("extract", self.model, "--triangles", triangles, "--bytes", size, "-o", out)["triangles"],
                         triangles)
        self.json("extract", self.model, "--level", 0, "--bytes", size * 9 // 10, "-o", out)

    def test_compare(self):
        coarse = self.scratch / "coarse.ply"
        level = self.json("extract", self.model, "--ratio", 0.3, "-o", coarse)
        found = self.keys("hausdorff_m mean_m rms_m ratio_to_diagonal normal_deviation_deg image_rms", "compare",
                          self.house, coarse, "--samples", 20000)
        self.assertIsNone(found["image_rms"])
        self.assertLessEqual(found["mean_m"], found["rms_m"])
        self.assertLessEqual(found["rms_m"], found["hausdorff_m"])
        self.assertGreater(level["error_m"], 0)
        same = self.json("compare", self.house, self.house, "--samples", 1000, "--images")
        self.assertLess(same["hausdorff_m"], 1e-6)
        self.assertEqual(same["image_rms"], 0)

    def test_render(self):
        out = self.scratch / "house.png"
        full = self.keys("triangles frame_seconds", "render", self.house, "--size", "160x120", "-o", out)
        self.assertEqual(full["triangles"], self.json("inspect", self.house)["triangles"])
        self.assertEqual(out.read_bytes()[:4], b"\x89PNG")
        coarse = self.json("render", self.model, "--triangles", 400, "--wireframe", "--lod-colors", "--size", "160x120",
                           "--eye", "30,-30,20", "--target", "0,0,3", "--fov", 50, "-o", out)
        self.assertLessEqual(coarse["triangles"], 400)

    def test_render_draws_coarser_where_more_error_is_allowed(self):
        cliff = self.scratch / "cliff.obj"
        run("generate", "outcrop", "--triangles", 5000, "--texture-size", 64, "-o", cliff)
        self.json("outcrop", cliff, "-o", self.scratch / "tiles", "--tile-bytes", "20KB")
        self.json("clusters", self.house, "-o", self.scratch / "house.lodg")
        for file in (self.scratch / "tiles" / "tileset.json", self.scratch / "house.lodg"):
            words = ("render", file, "--size", "160x120", "-o", self.scratch / "a.png")
            usual, fine, coarse = (self.json(*words, *limit)["triangles"]
                                   for limit in ((), ("--error-px", 1), ("--error-px", 8)))
            self.assertEqual(usual, fine, file)
            self.assertLess(coarse, fine, file)

    def test_render_refuses_an_error_where_nothing_is_chosen_by_it(self):
        for file in (self.house, self.model):
            words = ("render", file, "--error-px", 1, "-o", self.scratch / "a.png")
            self.assertIn(f"{file}: --error-px needs a .lodg file", self.fails(1, *words))
        missing = self.scratch / "missing.obj"
        self.assertIn("no such file", self.fails(2, "render", missing, "--error-px", 1, "-o", self.scratch / "a.png"))

    def test_render_times_a_sheet(self):
        found = self.json("render", self.model, "--sheet", 2, "--size", "80x60", "-o", self.scratch / "sheet.png")
        self.assertGreater(found["frame_seconds"], 0)

    def test_sweep(self):
        wanted = "frames pop_max pop_mean frame_seconds_p50 frame_seconds_p99 memory_bytes"
        common = ("--frames", 12, "--from", 1, "--to", 0.05, "--size", "160x120")
        for style in ("morph", "hard", "discrete", "fade"):
            found = self.keys(wanted, "sweep", self.model, "--style", style, *common)
            self.assertEqual(found["frames"], 12)
            self.assertGreaterEqual(found["pop_max"], found["pop_mean"])
        gif = self.scratch / "sweep.gif"
        self.json("sweep", self.model, *common, "-o", self.scratch / "frames", "--video", gif)
        self.assertEqual(len(list((self.scratch / "frames").glob("*.png"))), 12)
        self.assertEqual(gif.read_bytes()[:6], b"GIF89a")

    def test_a_sweep_too_short_for_its_morph_is_remarked_upon(self):
        words = ("sweep", self.model, "--frames", 12, "--to", 0.05, "--size", "160x120")
        self.assertIn("lags behind", run(*words).stderr)
        self.assertNotIn("lags behind", run(*words, "--morph-seconds", 0.1).stderr)

    def test_sweep_by_what_an_eye_needs(self):
        small = ("--frames", 6, "--size", "160x120", "--style", "hard")
        near = self.json("sweep", self.model, *small, "--perceptual", "200", "-o", self.scratch / "near")
        far = self.json("sweep", self.model, *small, "--perceptual", "20000", "-o", self.scratch / "far")
        self.assertEqual(near["frames"], 6)
        self.assertGreater(far["pop_max"], near["pop_max"])  # it ends much coarser
        frames = [[(self.scratch / way / f"frame_{i:05}.png").read_bytes() for i in (0, 5)] for way in ("near", "far")]
        self.assertEqual(frames[0][0], frames[1][0])
        self.assertNotEqual(frames[0][1], frames[1][1])
        self.fails(1, "sweep", self.model, *small, "--perceptual", "1mm")

    def test_outcrop(self):
        cliff = self.scratch / "cliff.obj"
        run("generate", "outcrop", "--triangles", 5000, "--texture-size", 64, "-o", cliff)
        found = self.keys("tiles levels bytes root_error_m source_triangles seams_open",
                          "outcrop", cliff, "-o", self.scratch / "tiles", "--tile-bytes", "20KB")
        self.assertEqual(found["seams_open"], 0)
        self.assertEqual(found["warnings"], [])
        self.assertEqual(len(found["pyramid"]), found["levels"])
        self.assertEqual(sum(level["tiles"] for level in found["pyramid"]), found["tiles"])
        self.assertEqual(found["pyramid"][0]["triangles"], found["source_triangles"])
        size = sum(f.stat().st_size for f in (self.scratch / "tiles").rglob("*") if f.is_file())
        self.assertEqual(size, found["bytes"])

    def test_distances(self):
        folder = self.scratch / "plan"
        words = ("distances", self.model, "--levels", 3, "--samples", 12, "--screen", "320x256", "--sides", "front,left")
        found = self.keys("fit switch_m redundancy cost alternatives", *words, "-o", folder, "--threads", 1)
        self.assertLessEqual({"a", "b", "c", "d", "r_square", "rmse"}, set(found["fit"]))
        self.assertEqual(len(found["switch_m"]), 3)
        self.assertEqual(found["switch_m"], sorted(found["switch_m"]))
        self.assertEqual(found["switch_m"][0], found["first_m"])
        self.assertEqual([side["name"] for side in found["sides"]], ["front", "left"])
        for plan in found["alternatives"]:
            self.assertGreaterEqual(plan["redundancy"], found["design"]["redundancy"])
        self.assertLessEqual(max(found["noticeable_ratio"]), 0.01)
        written = json.loads((folder / "plan.json").read_text())["levels"]
        self.assertLessEqual({level["from_m"] for level in written[1:]}, set(found["switch_m"]))
        self.assertLessEqual({level["triangles"] for level in written[1:]}, set(found["triangles"]))
        self.assertEqual(found["display"]["luminance_cd_m2"], 200)
        self.assertAlmostEqual(found["display"]["max_frequency_cpd"], 14.82, 2)
        self.assertEqual([need["distance_m"] for need in found["needed"]][0], found["first_m"])
        for name in ("metric", "redundancy", "triangles", "rendered", "seen", "difference"):
            self.assertEqual((folder / f"{name}.png").read_bytes()[:4], b"\x89PNG", name)
        again = self.json(*words, "--threads", 8)
        self.assertNotIn("needed", again)  # only for plan.json
        for key in set(found) - COMMON - {"needed"}:
            self.assertEqual(again[key], found[key], key)
        people = run(*words)
        self.assertIn("minimum redundancy", people.stdout)
        self.assertIn("supersampling: off", people.stderr)
        self.assertNotIn('"name"', people.stdout)

    def test_distances_levels_are_written(self):
        folder = self.scratch / "plan"
        self.json("distances", self.model, "--levels", 4, "--samples", 12, "--screen", "320x256", "-o", folder)
        plan = json.loads((folder / "plan.json").read_text())
        levels = self.json("extract", self.model, "--plan", folder / "plan.json", "-o", self.scratch / "out")["levels"]
        self.assertEqual([level["level"] for level in levels], [level["level"] for level in plan["levels"]])
        for i, level in enumerate(levels):
            self.assertEqual(self.json("inspect", self.scratch / "out" / f"level_{i}.glb")["triangles"],
                             level["triangles"])
        starts = [level["from_m"] for level in plan["levels"]]
        # A client of 3D Tiles refines a tile whose error covers more than 16 pixels at the surface of its sphere.
        tileset = json.loads((self.scratch / "out" / "tileset.json").read_text())
        refined_m = lambda error: error * plan["focal_px"] / 16 + plan["radius_m"]
        self.assertAlmostEqual(refined_m(tileset["geometricError"]) / plan["last_m"], 1)
        tile = tileset["root"]
        for i in reversed(range(len(levels))):
            self.assertEqual(tile["content"]["uri"], f"level_{i}.glb")
            self.assertEqual(tile["boundingVolume"]["sphere"][3], plan["radius_m"])
            if i > 0:
                self.assertAlmostEqual(refined_m(tile["geometricError"]) / starts[i], 1)
                tile = tile["children"][0]
        self.assertEqual(tile["geometricError"], 0)
        self.assertNotIn("children", tile)
        # MSFT_lod: a level is left for the next where the sphere covers less of the screen than its coverage says.
        glb = (self.scratch / "out" / "levels.glb").read_bytes()
        gltf = json.loads(glb[20:20 + int.from_bytes(glb[12:16], "little")])
        self.assertIn("MSFT_lod", gltf["extensionsUsed"])
        node = next(node for node in gltf["nodes"] if "MSFT_lod" in node.get("extensions", {}))
        self.assertEqual(len(node["extensions"]["MSFT_lod"]["ids"]), len(levels) - 1)
        covered = node["extras"]["MSFT_screencoverage"]
        self.assertEqual(len(covered), len(levels))
        for share, end_m in zip(covered, starts[1:] + [plan["last_m"]]):
            radius_px = plan["radius_m"] * plan["focal_px"] / end_m
            self.assertAlmostEqual(share, math.pi * radius_px ** 2 / (plan["width_px"] * plan["height_px"]))
        ids = [gltf["nodes"].index(node)] + node["extensions"]["MSFT_lod"]["ids"]
        for level, i in zip(levels, ids):
            parts = gltf["meshes"][gltf["nodes"][i]["mesh"]]["primitives"]
            self.assertEqual(sum(gltf["accessors"][part["indices"]]["count"] for part in parts), 3 * level["triangles"])
        # A sweep that follows the plan.
        small = ("--frames", 4, "--size", "64x48", "--style", "hard")
        self.json("sweep", self.model, *small, "--perceptual", 4000, "--plan", folder / "plan.json")
        self.assertIn("how far away", self.fails(1, "sweep", self.model, *small, "--plan", folder / "plan.json"))
        # One level, where the plan was measured; half a pixel alone says another.
        needed = plan["needed"][len(plan["needed"]) // 2]
        one = ("--perceptual", f"{needed['distance_m']}m", "--plan", folder / "plan.json")
        self.assertEqual(self.json("extract", self.model, *one, "-o", self.scratch / "one.ply")["level"], needed["level"])
        drawn = self.json("render", self.model, *one, "--size", "64x48", "-o", self.scratch / "one.png")
        self.assertEqual(drawn["triangles"], self.json("extract", self.model, "--level", needed["level"], "-o",
                                                       self.scratch / "one.ply")["triangles"])
        self.assertIn("--perceptual", self.fails(1, "render", self.model, "--plan", folder / "plan.json", "-o",
                                                 self.scratch / "one.png"))
        other = self.scratch / "other.lode"
        self.json("build", self.house, "--placement", "midpoint", "--target-triangles", 2000, "-o", other)
        for words in (("extract", other, "-o", self.scratch / "no"),
                      ("extract", other, "--perceptual", 40, "-o", self.scratch / "no.ply"), ("sweep", other, *small, "--perceptual", 4000)):
            self.assertIn("another model", self.fails(1, *words, "--plan", folder / "plan.json"))
        (self.scratch / "bad.json").write_text('{"format": 3}')
        self.assertIn("bad.json", self.fails(2, "extract", self.model, "--plan", self.scratch / "bad.json", "-o",
                                             self.scratch / "no"))

    def test_distances_refuses_what_it_cannot_look_at(self):
        for words in (("--levels", "0"), ("--levels", "many"), ("--sides", "top"), ("--sides", ""), ("--samples", 3),
                      ("--fov", 0), ("--dpi", 0), ("--supersample", 9)):
            self.fails(1, "distances", self.model, *words)


    def test_clusters_and_cut(self):
        graph = self.scratch / "house.lodg"
        found = self.keys("levels pages page_bytes_max roots", "clusters", self.house, "-o", graph)
        self.assertEqual(found["roots"], 1)
        self.assertLessEqual(found["page_bytes_max"], 128 * 1024)
        self.assertEqual(set(found["levels"][0]), {"level", "clusters", "groups", "triangles", "mean_fill", "error_m"})
        self.assertEqual(found["levels"][-1]["clusters"], 1)
        wanted = "clusters triangles select_seconds cracks t_junctions max_error_px pages"
        found = self.keys(wanted, "cut", graph, "--eye", "30,-40,20", "--error-px", "4", "-o", self.scratch / "cut.ply")
        self.assertEqual(self.json("inspect", self.scratch / "cut.ply")["triangles"], found["triangles"])
        for morph in ([], ["--morph"]):
            found = self.json("cut", graph, "--random", 10, "--error-px", 3, *morph)
            self.assertEqual((found["cracks"], found["t_junctions"], found["changed_border_edges"]), (0, 0, 0))
            self.assertLessEqual(found["max_error_px"], 3)


class Failures(Contract):
    def test_wrong_arguments_end_with_1(self):
        self.assertIn("--help", self.fails(1))
        self.fails(1, "fly", self.house)
        self.fails(1, "inspect")
        self.fails(1, "inspect", self.house, "--no-such-option")
        self.fails(1, "extract", self.model, "-o", self.scratch / "a.obj")
        self.fails(1, "extract", self.model, "--level", 1, "--ratio", 1, "-o", self.scratch / "a.obj")
        self.fails(1, "extract", self.model, "--level", 99999999, "-o", self.scratch / "a.obj")
        self.assertIn("'5ft'", self.fails(1, "extract", self.model, "--error", "5ft", "-o", self.scratch / "a.obj"))
        self.assertIn(".lode", self.fails(1, "build", self.house, "-o", self.scratch / "a.obj"))
        self.assertIn("--bytes", self.fails(1, "extract", self.model, "--level", 0, "--bytes", 0, "-o", self.scratch / "a.obj"))
        self.assertIn("--unit", self.fails(1, "inspect", self.house, "--unit", 0))
        self.assertIn("--max-memory", self.fails(1, "inspect", self.house, "--max-memory", 1))
        self.assertIn(".gif", self.fails(1, "sweep", self.model, "--video", self.scratch / "a.mp4"))
        self.fails(1, "generate", "castle", "-o", self.scratch / "a.obj")
        self.fails(1, "generate", "terrain", "--roof", "hip", "-o", self.scratch / "a.obj")

    def test_an_unknown_verb_names_the_nearest(self):
        self.assertIn("did you mean 'build'", self.fails(1, "biuld", self.house))
        self.assertNotIn("did you mean", self.fails(1, "castle", self.house))
        self.assertIn("'castle'", self.json("castle", code=1)["error"]["message"])

    def test_too_few_triangles_are_a_warning(self):
        for kind in ("house", "outcrop"):
            found = self.json("generate", kind, "--triangles", 10, "--texture-size", 16, "-o", self.scratch / "a.ply")
            self.assertIn("too few", found["warnings"][0])

    def test_ratios_are_rounded(self):
        whole = self.json("inspect", self.model)["triangles"]
        for wanted in (whole - 2, whole // 3 * 2):
            found = self.json("extract", self.model, "--ratio", (wanted - 1e-3) / whole, "-o", self.scratch / "a.obj")
            self.assertEqual(found["triangles"],
                             self.json("extract", self.model, "--triangles", wanted, "-o", self.scratch / "a.obj")["triangles"])

    def test_automatic_choices_are_said(self):
        done = run("build", self.house, "-o", self.scratch / "a.lode")
        self.assertIn("facet-shift, because", done.stderr)
        self.assertEqual(self.json("build", self.house, "-o", self.scratch / "a.lode")["method"], "facet-shift")
        for method in ("facet-shift", "edge-collapse"):
            built = self.json("build", self.house, "--method", method, "-o", self.scratch / "a.lode")
            self.assertEqual(built["method"], method)

    def test_levels_of_buildings_have_names(self):
        built = self.json("build", self.house, "--method", "facet-shift", "-o", self.scratch / "a.lode")
        self.assertTrue(built["facet_shift"]["reached_block"])
        self.assertEqual([level["name"] for level in built["named_levels"]], ["lod3", "lod2", "lod1", "block"])
        triangles = [self.json("extract", self.scratch / "a.lode", "--level", name, "-o", self.scratch / "a.obj")["triangles"]
                     for name in ("lod3", "lod2", "lod1", "block")]
        self.assertEqual(triangles, sorted(triangles, reverse=True))
        self.assertIn("lod3", self.fails(1, "extract", self.scratch / "a.lode", "--level", "attic",
                                         "-o", self.scratch / "b.obj"))

    def test_missing_and_bad_files_end_with_2_and_name_the_file(self):
        missing = self.scratch / "missing.obj"
        self.assertIn(str(missing), self.fails(2, "inspect", missing))
        for name, data in (("a.lode", b"not a model"), ("b.glb", b"glTF\x02\0\0\0"), ("c.ply", b"ply\nformat binary"),
                           ("d.json", b"{"), ("e.bin", b""), ("f.lode", self.model.read_bytes()[:100])):
            bad = self.scratch / name
            bad.write_bytes(data)
            self.assertIn(name, self.fails(2, "inspect", bad))
        self.assertIn("a.lode", self.fails(2, "verify", self.scratch / "a.lode"))
        self.fails(2, "inspect", self.scratch)

    def test_no_surface_is_no_input(self):
        points = self.scratch / "points.obj"
        points.write_text("v 0 0 0\nv 1 0 0\nl 1 2\n")
        for words in (("inspect",), ("convert", "-o", self.scratch / "a.ply"), ("build", "-o", self.scratch / "a.lode"),
                      ("clusters", "-o", self.scratch / "a.lodg"), ("outcrop", "-o", self.scratch / "tiles"),
                      ("render", "-o", self.scratch / "a.png"), ("compare", self.house)):
            line = self.fails(2, words[0], points, *words[1:])
            self.assertIn("points.obj: has no face", line)
            self.assertIn("lines and points are left out", line)
        self.assertEqual(list(self.scratch.iterdir()), [points])

    def test_models_that_are_broken_on_purpose_are_read_or_refused(self):
        folder = Path("/usr/share/assimp/models/invalid")
        if not folder.is_dir():
            self.skipTest("needs Debian's assimp-testmodels")
        for model in sorted(folder.iterdir()):
            done = run("inspect", model, "--quiet")
            self.assertIn(done.returncode, (0, 2), model)
            if done.returncode == 2:
                self.assertRegex(done.stderr, rf"\Alodestone: {re.escape(str(model))}[^\n]*\n\Z")

    def test_errors_are_in_the_json_too(self):
        found = self.json("inspect", self.scratch / "missing.obj", code=2)
        self.assertEqual(found["error"]["code"], "not_found")
        self.assertEqual(self.json("extract", self.model, "--error", "x", code=1)["error"]["code"], "bad_argument")

    def test_warnings_end_with_3_only_when_strict(self):
        dirty = self.scratch / "dirty.obj"
        dirty.write_text("mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n")
        found = self.json("inspect", dirty)
        self.assertGreaterEqual(len(found["warnings"]), 1)
        self.assertEqual(run("inspect", dirty, "--strict").returncode, 3)
        self.assertIn("warning:", run("inspect", dirty).stderr)
        self.assertEqual(run("inspect", dirty, "--quiet").stderr, "")
        self.assertEqual(run("inspect", self.house, "--strict").returncode, 0)
        self.assertEqual(run("build", self.house, "--strict", "-o", self.scratch / "a.lode").returncode, 0)

    def test_a_place_that_cannot_be_written_is_named(self):
        nowhere = self.scratch / "no" / "such" / "folder" / "a.ply"
        self.assertIn("/no/such/folder", self.fails(2, "convert", self.house, "-o", nowhere))
        self.fails(2, "build", self.house, "-o", self.house / "a.lode", "--quiet")
        self.fails(2, "convert", self.house, "-o", "/proc/a.ply")
        self.assertIn(".xyz", self.fails(1, "convert", self.house, "-o", self.scratch / "a.xyz"))

    def test_what_is_no_plain_file_is_never_replaced(self):
        pipe = self.scratch / "pipe.lode"
        os.mkfifo(pipe)
        self.assertIn("not a plain file", self.fails(2, "build", self.house, "-o", pipe, "--quiet"))
        self.assertTrue(pipe.is_fifo())
        folder = self.scratch / "folder.ply"
        folder.mkdir()
        self.fails(2, "convert", self.house, "-o", folder)
        self.assertTrue(folder.is_dir())
        link = self.scratch / "link.ply"
        link.symlink_to("behind.ply")
        self.assertIn("leads nowhere", self.fails(2, "convert", self.house, "-o", link))
        (self.scratch / "behind.ply").write_text("old")
        self.assertEqual(run("convert", self.house, "-o", link).returncode, 0)
        self.assertTrue(link.is_symlink())
        self.assertEqual((self.scratch / "behind.ply").read_bytes()[:3], b"ply")

    def test_the_place_is_tried_before_the_work(self):
        missing = self.scratch / "missing.obj"
        for words in (("build", missing, "-o", self.scratch / "no" / "a.lode"), ("render", missing, "-o", "/proc/a.png"),
                      ("generate", "outcrop", "--triangles", "90M", "-o", self.scratch / "no" / "a.ply")):
            self.assertIn(str(words[-1]), self.fails(2, *words))
        self.assertEqual(list(self.scratch.iterdir()), [])

    def test_a_window_without_a_display_is_one_line(self):
        bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.assertIn("display", self.fails(2, "view", self.model, env=bare).lower())

    def test_a_full_disk_leaves_the_old_file(self):
        def small_files_only():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        for name, words in (("a.lode", ("build", self.house, "--quiet")), ("a.obj", ("convert", self.house)),
                            ("a.ply", ("convert", self.house)), ("a.glb", ("convert", self.house))):
            out = self.scratch / name
            out.write_text("old")
            self.assertIn(name, self.fails(2, *words, "-o", out, preexec_fn=small_files_only))
            self.assertEqual(out.read_text(), "old")
        self.assertEqual(sorted(p.name for p in self.scratch.iterdir() if p.suffix in (".lode", ".obj", ".ply", ".glb")),
                         ["a.glb", "a.lode", "a.obj", "a.ply"])

    def test_a_report_that_cannot_be_written_is_an_error(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([PROGRAM, "inspect", self.house, "--json"], check=False, stdout=full,
                                  stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 2)

    def test_too_little_memory_is_one_line(self):
        if os.environ.get("LODESTONE_SANITIZED"):
            self.skipTest("a sanitizer's own memory counts too")
        line = self.fails(2, "generate", "outcrop", "--triangles", "20M", "--max-memory", "200MB", "-o",
                          self.scratch / "a.ply")
        self.assertIn("--max-memory", line)


class Interruption(Contract):
    @staticmethod
    def listens(process):
        """The program has come to where it handles SIGINT; before, a busy machine may take its time."""
        caught = re.search(r"(?m)^SigCgt:\s*([0-9a-f]+)", Path(f"/proc/{process.pid}/status").read_text())
        return bool(caught) and bool(int(caught.group(1), 16) & 1 << (signal.SIGINT - 1))

    def interrupt(self, seconds, *words):
        with subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            while process.poll() is None and not self.listens(process):
                time.sleep(0.01)
            time.sleep(seconds)
            if process.poll() is not None:
                return None, 0.0
            asked = time.monotonic()
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=60)
            return process.returncode, time.monotonic() - asked

    def test_ctrl_c_ends_with_4_and_leaves_nothing(self):
        big = self.folder / "big.ply"
        if not big.exists():
            self.json("generate", "outcrop", "--triangles", 600000, "--texture-size", 64, "-o", big)
        cases = [("generate", "outcrop", "--triangles", "8M", "--texture-size", 64, "-o", self.scratch / "a.ply"),
                 ("build", big, "-o", self.scratch / "a.lode")]
        for words in cases:
            for seconds in (0.2, 0.6):
                code, late = self.interrupt(seconds, *words)
                self.assertEqual(code, 4, words)
                self.assertLess(late, 5.0)
                self.assertEqual(list(self.scratch.iterdir()), [], words)


    def test_ctrl_c_before_the_first_tile_promises_nothing(self):
        rock = self.scratch / "rock.ply"
        self.json("generate", "outcrop", "--triangles", 200000, "--texture-size", 64, "-o", rock)
        folder = self.scratch / "tiles"
        with subprocess.Popen([PROGRAM, "outcrop", str(rock), "-o", str(folder), "--quiet", "--threads", "1"],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            while process.poll() is None and not folder.is_dir():
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 4, said)
        self.assertRegex(said, r"\Alodestone: [^\n]*tiles: cancelled before anything was written\n\Z")
        self.assertFalse(folder.exists())

    def test_ctrl_c_of_a_pyramid_says_how_to_go_on(self):
        heights = self.scratch / "heights.asc"
        side = 700
        rows = (" ".join(str(i * j % 97 + i // 2) for i in range(side)) for j in range(side))
        heights.write_text(f"ncols {side}\nnrows {side}\nxllcorner 8\nyllcorner 44\ncellsize 0.001\n" + "\n".join(rows))
        folder = self.scratch / "tiles"
        words = ("terrain", heights, "-o", folder, "--quiet", "--threads", 1)
        with subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as process:
            while process.poll() is None and not (folder.is_dir() and any(folder.rglob("*.terrain"))):
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 4, said)
        self.assertRegex(said, r"\Alodestone: [^\n]*tiles: cancelled, [^\n]*--resume[^\n]*\n\Z")
        self.assertEqual([name for name in folder.rglob("*") if name.suffix not in ("", ".terrain", ".json", ".unfinished")], [])
        again = self.json(*words, "--resume")
        self.assertGreater(again["kept_tiles"], 0)
        self.assertGreater(again["tiles"], again["kept_tiles"])


class Threads(Contract):
    def test_the_bytes_do_not_depend_on_them(self):
        outcrop = self.scratch / "outcrop.glb"
        self.json("generate", "outcrop", "--triangles", 30000, "--texture-size", 32, "-o", outcrop)
        for source in (self.house, outcrop):
            written = set()
            for threads in (1, 2, 8):
                out = self.scratch / f"{threads}.lode"
                self.json("build", source, "--threads", threads, "-o", out)
                written.add(out.read_bytes())
            self.assertEqual(len(written), 1, source)
            written = set()
            for threads in (1, 2, 8):
                out = self.scratch / f"{threads}.lodg"
                self.json("clusters", source, "--threads", threads, "-o", out)
                written.add(out.read_bytes())
            self.assertEqual(len(written), 1, source)

    def test_nor_do_generated_models(self):
        for kind in ("house", "street", "outcrop", "terrain"):
            written = set()
            for threads in (1, 2, 8):
                out = self.scratch / f"{threads}.glb"
                self.json("generate", kind, "--triangles", 20000, "--texture-size", 32, "--threads", threads, "-o", out)
                written.add(out.read_bytes())
            self.assertEqual(len(written), 1, kind)


class Terminal(Contract):
    def stderr_on_a_terminal(self, *words):
        """What a terminal would be shown on stderr."""
        master, slave = pty.openpty()
        with subprocess.Popen([PROGRAM, *map(str, words)], stdout=subprocess.DEVNULL, stderr=slave) as process:
            os.close(slave)
            shown = b""
            while True:
                ready, _, _ = select.select([master], [], [], 0.2)
                if ready:
                    try:
                        shown += os.read(master, 65536)
                    except OSError:
                        break
                elif process.poll() is not None:
                    break
        os.close(master)
        return shown

    def test_long_work_shows_a_bar_only_there(self):
        # Well over the second after which the bar appears, on fast machines too.
        words = ("generate", "outcrop", "--triangles", "10M", "--texture-size", 64, "-o", self.scratch / "a.ply")
        self.assertIn(b"%", self.stderr_on_a_terminal(*words))
        self.assertNotIn(b"%", self.stderr_on_a_terminal(*words, "--quiet"))
        self.assertEqual(run(*words).stderr, "")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--make-house"]:
        shutil.rmtree(sys.argv[2], ignore_errors=True)
        Path(sys.argv[2]).mkdir(parents=True)
        make_house(Path(sys.argv[2]))
    else:
        unittest.main(verbosity=1)
