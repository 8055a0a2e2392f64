# SPDX-License-Identifier: MIT
"""The host's side of tests/usb/run.sh: runs the guest, pulls its USB plugs and puts them back, echoes what its ports
send. Usage: host.py KERNEL INITRAMFS FOLDER"""
import json
import os
import socket
import subprocess
import sys
import threading
import time

PATIENCE_S = 150.0  # TCG on a busy machine; about half a minute on an idle one


class Qmp:
    """QEMU's machine protocol on a socket."""

    def __init__(self, path):
        self.socket = connected(path)
        self.stream = self.socket.makefile("rw")
        self.stream.readline()
        self.run("qmp_capabilities")

    def run(self, command, **arguments):
        self.stream.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self.stream.flush()
        while True:
            answer = json.loads(self.stream.readline())
            if "error" in answer:
                raise RuntimeError(f"{command}: {answer['error']['desc']}")
            if "return" in answer:
                return answer["return"]

    def wait_for(self, event, device):
        while True:
            answer = json.loads(self.stream.readline())
            if answer.get("event") == event and answer["data"].get("device") == device:
                return


def connected(path):
    end = time.monotonic() + 20
    while True:
        try:
            result = socket.socket(socket.AF_UNIX)
            result.connect(path)
            return result
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)


def echo(path):
    """The device behind a port."""
    line = connected(path)
    while True:
        try:
            data = line.recv(4096)
            if not data:
                return
            line.sendall(data)
        except OSError:
            return


SOCKETS = {"camera": 1, "gyro": 2}  # of the USB bus


def plug(qmp, name):
    qmp.run("device_add", driver="usb-serial", id=name, bus="usb.0", port=str(SOCKETS[name]), chardev="line-" + name)


def unplug(qmp, name):
    qmp.run("device_del", id=name)


def arguments(kernel, initramfs, folder):
    words = ["qemu-system-x86_64", "-accel", "tcg", "-m", "256", "-no-reboot", "-nodefaults", "-display", "none",
             "-kernel", kernel, "-initrd", initramfs, "-append", "console=ttyS0 quiet panic=-1",
             "-serial", "stdio", "-qmp", f"unix:{folder}/qmp,server=on,wait=off",
             "-device", "piix3-usb-uhci,id=usb"]
    for name, port in SOCKETS.items():
        words += ["-chardev", f"socket,id=line-{name},path={folder}/{name},server=on,wait=off",
                  "-device", f"usb-serial,id={name},bus=usb.0,port={port},chardev=line-{name}"]
    return words


def main():
    kernel, initramfs, folder = sys.argv[1:]
    begin = time.monotonic()
    guest = subprocess.Popen(arguments(kernel, initramfs, folder), stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True, errors="replace", bufsize=1)
    watchdog = threading.Timer(PATIENCE_S, guest.kill)
    watchdog.start()
    failures = None
    lines = []
    try:
        qmp = Qmp(os.path.join(folder, "qmp"))
        for name in SOCKETS:
            threading.Thread(target=echo, args=(os.path.join(folder, name),), daemon=True).start()
        for line in guest.stdout:
            line = line.rstrip()
            lines.append(line)
            if line.startswith(("ok ", "FAIL", "     ")):
                print(line, flush=True)
            if line.startswith("@ done"):
                failures = int(line.split()[2])
                break
            if line.startswith("@ "):
                _, action, name = line.split()
                (unplug if action == "unplug" else plug)(qmp, name)
                guest.stdin.write("\n")
                guest.stdin.flush()
    finally:
        watchdog.cancel()
        guest.kill()
        guest.wait()
    if failures is None:
        print("\n".join(lines[-40:]))
        print(f"the guest ended without a verdict, or took longer than {PATIENCE_S:.0f} s")
    print(f"{len([l for l in lines if l.startswith('ok ')])} checks passed, "
          f"{failures if failures is not None else 'unknown'} failed, {time.monotonic() - begin:.1f} s")
    sys.exit(0 if failures == 0 else 1)


main()
