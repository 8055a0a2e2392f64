# SPDX-License-Identifier: MIT
"""Measures a live run on simulated ports. Used by live_process.sh: PROGRAM SERVER MODEL [--json] [--seconds N]"""
import argparse
import json
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

WARM_S = 10.0


def cpu_s(pid):
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def resident_mb(pid):
    with open(f"/proc/{pid}/status") as file:
        return int(re.search(r"VmRSS:\s+(\d+)", file.read())[1]) / 1024


def say_end(code, messages, errors, tally):
    """What the program itself told of its end, and how late the simulated rig was: without it nobody knows what to mend."""
    print(f"the run ended by itself, exit code {code}" + (f" (signal {-code})" if code < 0 else ""), file=sys.stderr)
    for message in [message for message in messages if message["event"] not in ("frame", "state")][-12:] + messages[-1:]:
        print(f"  {json.dumps(message)[:600]}", file=sys.stderr)
    for state in [message for message in messages if message["event"] == "state"][-1:]:
        print(f"  devices: {json.dumps(state['devices'])}", file=sys.stderr)
    print(f"  the simulated rig: {json.dumps(tally)}", file=sys.stderr)
    for line in errors[-12:]:
        print(f"  standard error: {line.rstrip()}", file=sys.stderr)


def runs_for(live, seconds):
    """False if the program ended before."""
    try:
        live.wait(seconds)
        return False
    except subprocess.TimeoutExpired:
        return True


def watch_page(url, stopped):
    """A page that reads all it gets: without one the server would send nothing."""
    port, token = re.search(r":(\d+)/#t=([0-9a-f]{32})", url).groups()
    with socket.create_connection(("127.0.0.1", int(port))) as page:
        page.sendall((f"GET /stream HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
                      "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n").encode())
        if b" 101 " not in page.recv(4096):  # nothing may be sent ahead of the answer
            sys.exit("the page's stream was refused")
        payload = json.dumps({"token": token}).encode()
        page.sendall(bytes([0x81, 0x80 | len(payload), 0, 0, 0, 0]) + payload)  # masked with zeros
        page.settimeout(1.0)
        total = 0
        while not stopped.is_set():
            try:
                part = page.recv(1 << 16)
            except TimeoutError:
                continue
            if not part:
                break
            total += len(part)
        watch_page.bytes = total


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("server")
    parser.add_argument("model")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--seconds", type=float, default=60.0)
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        profile = os.path.join(folder, "fast.toml")
        server = subprocess.Popen([words.server, profile], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        if server.stdout.readline() != "ready\n":
            sys.exit("the simulated rig did not start")
        live = subprocess.Popen([words.program, "live", "--rig", profile, "--model", words.model, "--loop", "--record", "--json",
                                 "--output", os.path.join(folder, "kept"), "--page-port", "0", "--frames-per-leg", "200"],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, "XDG_STATE_HOME": folder})
        url, messages, errors, stopped = live.stderr.readline(), [], [], threading.Event()
        readers = [threading.Thread(target=lambda: messages.extend(json.loads(line) for line in live.stdout)),
                   threading.Thread(target=lambda: errors.extend(live.stderr))]
        page = threading.Thread(target=watch_page, args=(url, stopped))
        for thread in readers + [page]:
            thread.start()
        on = runs_for(live, WARM_S)
        if on:
            begin, begin_cpu, begin_mb = time.monotonic(), cpu_s(live.pid), resident_mb(live.pid)
            on = runs_for(live, words.seconds)
        if on:
            wall_s, used_s, end_mb = time.monotonic() - begin, cpu_s(live.pid) - begin_cpu, resident_mb(live.pid)
            live.send_signal(signal.SIGINT)
        for thread in readers:
            thread.join()
        stopped.set()
        page.join()
        code = live.wait()
        server.stdin.close()
        tally = json.loads(server.stdout.read())
        server.wait()
        if not on or code not in (0, 3, 130):
            say_end(code, messages, errors, tally)
            sys.exit(1)
    frames = [message for message in messages if message["event"] == "frame"]
    state = [message for message in messages if message["event"] == "state"][-1]
    elapsed_s = state["time_s"]
    figures = {
        "process_cpu_percent": round(100 * used_s / wall_s, 2),
        "resident_begin_mb": round(begin_mb, 1), "resident_end_mb": round(end_mb, 1),
        "frames_per_s": round(len(frames) / elapsed_s, 1),
        "gyro_samples_per_s": round(state["devices"]["gyro"]["messages"] / elapsed_s, 1),
        "dropped": sum(message["frames"] for message in messages if message["event"] == "dropped"),
        "lost": sum(device["lost"] + device["bad"] for device in state["devices"].values()),
        "inference_median_us": sorted(message["inference_us"] or 0.0 for message in frames)[len(frames) // 2],
        "page_mb": round(watch_page.bytes / 1e6, 1), "seconds": round(wall_s, 1),
        # Of the simulated side: how late its thread was; what the terminal had no room for, at once or at all.
        "simulator_worst_lag_s": tally["worst_lag_s"], "simulator_bytes_delayed": tally["bytes_delayed"],
        "simulator_bytes_overrun": tally["bytes_overrun"],
    }
    if words.json:
        print(json.dumps(figures))
        return
    for key, value in figures.items():
        print(f"{key:28} {value}")


if __name__ == "__main__":
    main()
