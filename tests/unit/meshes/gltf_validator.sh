#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every GLB that write_glbs makes passes gltf-validator: gltf_validator.sh WRITE_GLBS FOLDER MODULES
set -euo pipefail
support=$(cd "$(dirname "$0")/../../clients/support" && pwd)
. "$support/need.sh"
need_program node
need_package "$3" gltf-validator
rm -rf "$2" && mkdir -p "$2"
"$1" "$2"
node "$support/validate.mjs" "$3" "$2"
