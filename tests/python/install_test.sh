#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The package is installed without a network, as docs/python.md says, and its installed copy is what is imported.
# Usage: install_test.sh SOURCE_FOLDER
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$1/app/python" "$folder/package" # building leaves files beside the sources
cd "$folder"
/usr/bin/python3 -m venv --system-site-packages venv
PIP_NO_INDEX=1 PIP_DISABLE_PIP_VERSION_CHECK=1 venv/bin/pip install --quiet --no-build-isolation ./package
venv/bin/python -I -c '
import thermorig, pathlib, sys
place = pathlib.Path(thermorig.__file__)
assert place.is_relative_to(sys.prefix), place
assert (place.parent / "py.typed").exists()
from importlib.metadata import version
assert version("thermorig") == thermorig.__version__
'
grep -q "VERSION $(venv/bin/python -c 'import thermorig; print(thermorig.__version__)') " "$1/CMakeLists.txt" # one version
