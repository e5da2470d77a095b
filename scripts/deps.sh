#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Installs the Debian and Ubuntu packages that Lodestone is built with; does nothing if they are all there.
#
#   scripts/deps.sh                    what building and testing needs: groups build, viewer, test, clients
#   scripts/deps.sh --check            prints what is missing and ends with 1 if anything is
#   scripts/deps.sh --list             prints the packages of the groups asked for
#   scripts/deps.sh [...] GROUP...     only these groups: build viewer test bench clients
#
# Written for Debian 12. A line may name two, one|other, for systems that name a package otherwise. What apt does not know
# and only tests, clients or peers need is left out: these skip themselves (Ubuntu has no package of Chromium).
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

must="$(packages_of build) $(packages_of viewer)"
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
left_out=()
for name in "${missing[@]}"; do
  pick=
  for one in ${name//|/ }; do
    if [ -z "$pick" ] && apt-cache show "$one" >/dev/null 2>&1; then pick=$one; fi
  done
  if [ -n "$pick" ]; then
    chosen+=("$pick")
  elif [[ " $must " == *" $name "* ]]; then
    echo "lodestone: deps.sh: apt knows no package $name, without which nothing is built" >&2
    exit 1
  else
    left_out+=("$name")
  fi
done
if [ ${#chosen[@]} -gt 0 ]; then
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${chosen[@]}" >/dev/null
fi
if [ ${#left_out[@]} -gt 0 ]; then echo "deps: not packaged here, left out: ${left_out[*]}"; fi
echo "deps: done"
