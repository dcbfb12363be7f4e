#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Set-up shared by test.sh and demo.sh: installs what is missing on Debian 12, configures and builds.
# Sourced by them; run by itself it only installs, what is named or what the build needs.

palpate_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

palpate_packages=(
  g++ cmake ninja-build ccache pkg-config
  libeigen3-dev libcgal-dev libtet1.5-dev libopenmesh-dev libtinygltf-dev libstb-dev libcpp-httplib-dev nlohmann-json3-dev
  libinsighttoolkit5-dev libnifti-dev zlib1g-dev
  libsuitesparse-dev libopenblas-dev libceres-dev libxxhash-dev libfmt-dev libtomlplusplus-dev libcli11-dev
  libusb-1.0-0-dev umockdev libumockdev-dev libgtest-dev libbenchmark-dev python3
)

# For the page of `palpate report`: without these everything else is built. A node that did not come from Debian brings
# its own npm.
palpate_install_page() {
  local packages=(clang lld wasi-libc libc++-dev-wasm32 libclang-rt-dev-wasm32)
  command -v npm >/dev/null || packages+=(nodejs npm)
  palpate_install "${packages[@]}" || echo "palpate: palpate report is built without its page" >&2
}

# palpate_install [PACKAGE...]: installs those of them (or of all that the build needs) that are missing, or says exactly
# which are and how to get them. Returns 1 when some stay missing.
palpate_install() {
  [ $# -gt 0 ] || set -- "${palpate_packages[@]}"
  local missing=() package
  for package; do
    # A package that was removed is still known: only "installed" will do.
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0

  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
    if ! sudo -n true 2>/dev/null; then
      palpate_ask "${missing[@]}"
      return 1
    fi
  fi
  if ! command -v apt-get >/dev/null; then
    palpate_ask "${missing[@]}"
    return 1
  fi
  echo "palpate: installing ${missing[*]}" >&2
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o Acquire::http::Timeout=30)
  if ! "${apt[@]}" update >&2 || ! "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >&2; then
    palpate_ask "${missing[@]}"
    return 1
  fi
}

palpate_ask() {
  printf 'palpate: missing packages: %s\n' "$*" >&2
  printf 'palpate: on Debian 12, an administrator gets them by:\n' >&2
  printf '  apt-get update && apt-get install --no-install-recommends %s\n' "$*" >&2
}

# Compilations that run at once: one a processor, and 2 GB of memory for each (CGAL takes 1.5).
palpate_jobs() {
  local processors memory
  processors=$(env -u OMP_NUM_THREADS nproc)  # which is about solvers, not about builds
  memory=$(awk '/^MemAvailable:/ {print int($2 / 2000000)}' /proc/meminfo)
  [ "$memory" -lt 1 ] && memory=1
  echo $((processors < memory ? processors : memory))
}

# palpate_build PRESET [TARGET...]: configures the preset and builds the targets, or all.
palpate_build() {
  local preset=$1 launcher=()
  shift
  command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  cmake -S "$palpate_root" --preset "$preset" "${launcher[@]}" >&2 || return
  local targets=()
  [ $# -gt 0 ] && targets=(--target "$@")
  cmake --build "$palpate_root/build/$preset" -j "$(palpate_jobs)" "${targets[@]}" >&2
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  set -euo pipefail
  palpate_install "$@"
  echo "palpate: everything is installed"
fi
