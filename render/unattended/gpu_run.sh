#!/usr/bin/env bash
# Record on a machine with a GPU, Python 3.12, numpy, scipy, pyarrow, pillow, typer, networkx and
# scikit-image, but no network.
#   here, in a checkout:  bash render/unattended/gpu_run.sh prepare FOLDER
#       makes FOLDER: wheels, OpenGL loaders and this script, about 7 MiB
#   there, as root:       bash FOLDER/gpu_run.sh run RESULTS [OPTION...]
#       installs them into a fresh folder and runs `python3 -m lodbench.render.unattended`
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

prepare() {
  local target=$1 platforms=() tag apt=(apt-get -qq)
  [ ! -e "$target" ] || { echo "error: expected a new folder, got $target; name another" >&2; exit 2; }
  for tag in manylinux_2_28 manylinux_2_27 manylinux_2_24 manylinux_2_17 manylinux2014 manylinux1; do
    platforms+=(--platform "${tag}_x86_64")
  done
  mkdir -p "$scratch/made/wheels" "$scratch/made/gl" "$scratch/lists/partial" "$scratch/source"
  git -C "$here/../.." archive HEAD | tar x -C "$scratch/source"
  python3 -m pip wheel -q --no-deps -w "$scratch/made/wheels" "$scratch/source"
  # What that machine lacks; casadi, plotly and rtree are not needed to record.
  python3 -m pip download -q --no-deps --only-binary=:all: --python-version 3.12 \
    --implementation cp "${platforms[@]}" -d "$scratch/made/wheels" moderngl glcontext msgspec \
    trimesh fast-simplification shapely emcee annotated-types annotated-doc
  apt+=(-oAPT::Architecture=amd64 -oAPT::Architectures=amd64 -oDir::State::Lists="$scratch/lists")
  "${apt[@]}" update
  (cd "$scratch/made/gl" && "${apt[@]}" download libegl1 libglvnd0 libopengl0 libgl1 libglx0)
  cp "$here/gpu_run.sh" "$scratch/made/"
  mkdir -p "$(dirname "$target")"
  mv "$scratch/made" "$target"
}

run() {
  local results=$1 vendor=/usr/local/nvidia/share/glvnd/egl_vendor.d/10_nvidia.json loader
  shift
  for loader in "$here"/gl/*.deb; do dpkg -x "$loader" /; done
  ldconfig
  python3 -m pip install -q --no-index --no-deps --no-cache-dir --target "$scratch/site" \
    "$here"/wheels/*.whl
  export PYTHONPATH=$scratch/site
  [ ! -f "$vendor" ] || export __EGL_VENDOR_LIBRARY_FILENAMES=$vendor
  python3 -m lodbench.render.unattended --out "$results" "$@"
}

case "${1:-}" in
  prepare | run) [ $# -ge 2 ] && { "$@"; exit; } ;;
esac
sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
exit 2
