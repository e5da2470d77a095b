#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs the checks that take minutes and are no part of the plain run, and prints their figures.
#
#   scripts/long_checks.sh [PATTERN]     only test programs whose name holds PATTERN, as in: viewer
#
# These are the tests that Catch2 hides (named "[.]" in the sources). They run in the release build, which is made where
# it is missing, on the real data beside the checkout or in $LODESTONE_DATA; without data they are skipped.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h | --help) sed -n '3,9s/^# \{0,1\}//p' "$0"; exit 0 ;; esac
mapfile -t sources < <(grep -rlE '"\[\.\]' tests --include=*.cpp | sort)
status=0
# Cluster graphs are tried on the dragon too, where npm can fetch it.
if [ -z "${LODESTONE_DRAGON:-}" ] && command -v npm > /dev/null; then LODESTONE_DRAGON=$(scripts/fetch_dragon.sh); fi
export LODESTONE_DRAGON=${LODESTONE_DRAGON:-}
[ -e build/release/build.ninja ] || cmake --preset release > /dev/null
for source in "${sources[@]}"; do
  folder=$(dirname "$source")
  program=$(grep -ohE 'lodestone_test\([a-z_0-9]+' "$folder/CMakeLists.txt" | sed -n '1s/.*(//p')
  [[ $program == *"${1:-}"* ]] || continue
  cmake --build build/release --target "$program" > /dev/null
  echo "== $program, hidden tests of $source"
  # One section after the other, each with its name and time; what a test prints comes before its name.
  "build/release/$folder/$program" '[.]' --durations yes || status=1
done
exit $status
