#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Fuzzes every door of the readers for a while (libFuzzer, AddressSanitizer, UndefinedBehaviorSanitizer).
#   scripts/fuzz.sh [SECONDS_EACH=60] [DOOR...]
# What is found is left in build/fuzz/found/; put a small one into tests/fuzz/corpus/ with the fix.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
shift || true
doors=("$@")
[ ${#doors[@]} -gt 0 ] || doors=(obj ply gltf assimp cityjson citygml image lode lodg quantized_mesh raster tiles count head)

command -v clang++ >/dev/null || { echo "fuzz.sh: clang++ is missing; install clang and libclang-rt-14-dev" >&2; exit 1; }
cmake --preset fuzz >/dev/null
targets=("${doors[@]/#/fuzz_}")
cmake --build build/fuzz --target "${targets[@]}"
mkdir -p build/fuzz/found
status=0
for door in "${doors[@]}"; do
  echo "== $door, ${seconds} s"
  work=build/fuzz/work/$door
  mkdir -p "$work"
  seeds=("tests/fuzz/corpus/$door")
  [ "$door" = count ] && seeds+=(tests/fuzz/corpus/{obj,ply,gltf})
  [ "$door" = head ] && seeds+=(tests/fuzz/corpus/image)
  # detect_leaks=0: assimp and tinygltf keep singletons.
  ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 \
    "build/fuzz/tests/fuzz/fuzz_$door" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=3000 -print_final_stats=1 \
    -artifact_prefix="build/fuzz/found/$door-" "$work" "${seeds[@]}" 2>"build/fuzz/$door.log" || {
    echo "   found something: see build/fuzz/found/ and build/fuzz/$door.log"
    status=1
  }
  grep -E "number_of_executed_units|peak_rss_mb" "build/fuzz/$door.log" | sed 's/^/   /' || true
done
exit $status
