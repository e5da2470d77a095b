#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Formats every C++ file that git knows, in place; with --check only tells which would change.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(-i)
if [ "${1:-}" = --check ]; then mode=(--dry-run --Werror); fi
git ls-files '*.h' '*.cpp' | xargs -r clang-format "${mode[@]}"
