#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs what is missing, builds everything and runs all tests: once optimised, once under ASan and UBSan.
#
#   scripts/test.sh            all of it
#   scripts/test.sh release    the optimised build only
#   scripts/test.sh dev        the sanitizer build only
#
# Real data (../shared/data or $LODESTONE_DATA) is used by the optimised run where it is there; those tests say
# "skipped" where it is not. JOBS sets how many compilers and tests run at once.
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
only=${1:-all}
case "$only" in all | release | dev) ;; *) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 1 ;; esac

step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }

if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
fi

run() {  # run PRESET CTEST_OPTIONS...: configure, build, test
  local preset=$1
  shift
  step "$preset: configure"
  cmake --preset "$preset" | tail -n 1
  step "$preset: build"
  cmake --build --preset "$preset" -j "$jobs" | tail -n 1
  step "$preset: test"
  ctest --preset "$preset" -j "$jobs" --no-tests=error "$@" | grep -vE '(Passed|^ +Start) ' || return 1
}

step "packages"
scripts/deps.sh
if [ "$only" != dev ]; then run release; fi
if [ "$only" != release ]; then
  # Sanitized code is some five times slower: real data, packaging, other people's clients and the rules of the house are
  # left to the optimised run.
  export ASAN_OPTIONS=allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
  export LSAN_OPTIONS=suppressions=$PWD/tests/leaks.supp:print_suppressions=0
  LODESTONE_DATA=none run dev --label-exclude optimised_only
fi
step "all tests passed"
