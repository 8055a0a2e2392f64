# SPDX-License-Identifier: MIT
"""Writes the golden vectors of protocols/vectors as seed files for a fuzzer; the model fuzzer's are files.

Usage: seeds.py FUZZER VECTORS_FOLDER CORPUS_FOLDER. A vector's second column is its hex.
"""
import pathlib
import shutil
import sys

fuzzer, vectors, corpus = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
if fuzzer.startswith("model"):
    for path in sorted((pathlib.Path(__file__).parent / "model_seeds").glob("*.onnx")):
        shutil.copy(path, corpus)
    sys.exit()
wanted = {"camera": "gy_mcu90640", "witmotion": "witmotion", "text": "text_gyro", "servo": "servo_link"}
stem = next((file for key, file in wanted.items() if fuzzer.startswith(key)), None)
for path in sorted(vectors.glob("*.txt")):
    if stem and path.stem != stem:
        continue
    for number, line in enumerate(path.read_text().splitlines()):
        fields = [field.strip() for field in line.split("|")]
        if line.startswith("#") or len(fields) < 2:
            continue
        try:
            (corpus / f"{path.stem}-{number}").write_bytes(bytes.fromhex(fields[1]))
        except ValueError:
            sys.exit(f"{path}:{number + 1}: the second column is not hex")
