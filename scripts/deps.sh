#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the Debian and Ubuntu packages that Lodestone is built with; does nothing if they are all there.
#
#   scripts/deps.sh                    what building and testing needs: groups build, viewer, test, clients
#   scripts/deps.sh --check            prints what is missing and ends with 1 if anything is
#   scripts/deps.sh --list             prints the packages of the groups asked for
#   scripts/deps.sh [...] GROUP...     only these groups: build viewer test bench clients
#
# Written for Debian 12. Ubuntu 22.04 and 24.04 use the same names except where a line names two, old|new.
set -euo pipefail

packages_of() {
  case "$1" in
    build) echo g++ cmake ninja-build pkg-config git ca-certificates \
      libglm-dev libtbb-dev libopenmesh-dev libnlopt-dev libmetis-dev libcereal-dev libzstd-dev libxxhash-dev \
      nlohmann-json3-dev libcli11-dev libmeshoptimizer-dev libcurl4-openssl-dev libassimp-dev libtinygltf-dev libdraco-dev libpugixml-dev \
      libspng-dev 'libturbojpeg0-dev|libturbojpeg-dev' libwebp-dev libgif-dev libstb-dev libproj-dev libopenscenegraph-dev libgdal-dev zlib1g-dev ;;
    viewer) echo libosmesa6-dev libglfw3-dev libimgui-dev libgl1-mesa-dri ;;
    test) echo ccache catch2 librapidcheck-dev python3 npm xvfb xdotool imagemagick assimp-testmodels ;;
    bench) echo libcgal-dev libeigen3-dev libtinyobjloader-dev npm python3-vtk9 ;;
    clients) echo npm chromium ;;
    *) echo "lodestone: deps.sh: no such group: $1 (build viewer test bench clients)" >&2; return 1 ;;
  esac
}

action=install
groups=()
for word in "$@"; do
  case "$word" in
    --check) action=check ;;
    --list) action=list ;;
    -h | --help) sed -n '3,10s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) groups+=("$word") ;;
  esac
done
[ ${#groups[@]} -gt 0 ] || groups=(build viewer test clients)

wanted=()
for group in "${groups[@]}"; do
  names=$(packages_of "$group")
  read -ra more <<<"$names"
  wanted+=("${more[@]}")
done
if [ "$action" = list ]; then printf '%s\n' "${wanted[@]}"; exit 0; fi

if ! command -v dpkg-query >/dev/null; then
  echo "lodestone: deps.sh: this is not Debian or Ubuntu; install the equivalents of: ${wanted[*]}" >&2
  exit 1
fi
# npm also comes with a Node.js that is not Debian's.
installed() {
  if [ "$1" = npm ] && command -v npm >/dev/null; then return 0; fi
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
for name in "${wanted[@]}"; do
  present=no
  for one in ${name//|/ }; do if installed "$one"; then present=yes; fi; done
  [ $present = yes ] || missing+=("$name")
done
if [ ${#missing[@]} -eq 0 ]; then echo "deps: all ${#wanted[@]} packages are there (${groups[*]})"; exit 0; fi
if [ "$action" = check ]; then printf 'deps: missing: %s\n' "${missing[*]}"; exit 1; fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "lodestone: deps.sh: needs root to install ${missing[*]}; run as root or install sudo" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "deps: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
chosen=()
for name in "${missing[@]}"; do
  pick=${name%%|*}
  for one in ${name//|/ }; do
    if apt-cache show "$one" >/dev/null 2>&1; then pick=$one; break; fi
  done
  chosen+=("$pick")
done
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${chosen[@]}" >/dev/null

# Ubuntu 22.04 has an older CMake than the project needs.
version=$(cmake --version | sed -n '1s/[^0-9]*//p')
if [ "$(printf '%s\n3.25\n' "$version" | sort -V | head -n 1)" != 3.25 ]; then
  echo "deps: CMake $version is too old, installing a newer one with pip"
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends python3-pip >/dev/null
  "${as_root[@]}" python3 -m pip install --quiet 'cmake>=3.25,<4'
fi
echo "deps: done"
