#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# clang-tidy over the sources of the library and the programs, or over the files named. Needs a configured build/release.
set -euo pipefail
cd "$(dirname "$0")/.."
[ -f build/release/compile_commands.json ] || cmake --preset release >/dev/null
if [ $# -gt 0 ]; then files=("$@"); else mapfile -t files < <(git ls-files 'lib/*.cpp' 'formats/*.cpp' 'viewer/*.cpp' 'cli/*.cpp'); fi
printf '%s\n' "${files[@]}" | xargs -r -P "${JOBS:-$(nproc)}" -n 4 clang-tidy -p build/release --quiet
