# SPDX-License-Identifier: MIT
# To be sourced. What a client needs and is not there is printed as "SKIPPED: reason", which ctest reports as skipped.
skip() { echo "SKIPPED: $1"; exit 0; }
need_program() { command -v "$1" >/dev/null || skip "$1 is not installed"; }
need_package() { [ -d "$1/$2" ] || skip "npm's $2 is not installed"; }  # MODULES NAME
need_browser() {                                                        # MODULES
  need_program node
  need_package "$1" playwright-core
  [ -x "${CHROMIUM:-/usr/bin/chromium}" ] || skip "Chromium is not installed (scripts/deps.sh clients)"
}
