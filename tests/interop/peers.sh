# SPDX-License-Identifier: MIT
# To be sourced: installs what the network is compared with and says where it lies.
# After it: ONNX_RUNTIME_LIBRARY (the library inside npm's package) and ONNX_RUNTIME_FOLDER (its node_modules).
onnx_runtime_version=1.30.0

install_peers() {
  local missing=() package as_root=()
  for package in python3-torch python3-onnx python3-numpy libtorch-dev libopenblas0-pthread npm; do
    [ "$package" = npm ] && command -v npm >/dev/null && continue
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  if [ ${#missing[@]} -gt 0 ]; then
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    echo "Installing: ${missing[*]}" >&2
    "${as_root[@]}" apt-get update -qq >&2
    DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-remove --no-install-recommends \
      "${missing[@]}" >&2
  fi
  ONNX_RUNTIME_FOLDER=${XDG_CACHE_HOME:-$HOME/.cache}/thermorig/onnxruntime-node-$onnx_runtime_version
  local machine=x64
  [ "$(uname -m)" = aarch64 ] && machine=arm64
  ONNX_RUNTIME_LIBRARY=$ONNX_RUNTIME_FOLDER/node_modules/onnxruntime-node/bin/napi-v6/linux/$machine/libonnxruntime.so.1
  if [ ! -f "$ONNX_RUNTIME_LIBRARY" ]; then
    mkdir -p "$ONNX_RUNTIME_FOLDER"
    # Its install script would only fetch what graphics cards need.
    npm install --prefix "$ONNX_RUNTIME_FOLDER" --ignore-scripts --no-audit --no-fund \
      "onnxruntime-node@$onnx_runtime_version" >&2
  fi
  [ -f "$ONNX_RUNTIME_LIBRARY" ] || { echo "onnxruntime-node holds no library for this machine" >&2; return 1; }
}
